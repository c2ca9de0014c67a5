//! Pictures of scenes in space and in the plane, drawn on the CPU: no window, no driver, the same pixels
//! everywhere.
//!
//! - [`Scene`]: bodies (meshes with poses), a robot at its start, at its goal and on its way; drawn as a
//!   [`Picture`].
//! - [`Drawing`]: areas and lines in the plane, as SVG or as a [`Picture`].
//! - [`palette`]: the colours, for drawings in the same style.
//! - [`Shot`]: a scene drawn at many moments, as the frames of a film; [`Gif`] puts frames into one file.
//!
//! Nothing here writes files: a [`Picture`] becomes the bytes of a PNG file by [`Picture::to_png`]. Lengths
//! are metres, colours `0xRRGGBB` in sRGB.
//!
//! ```
//! use mp_geom::primitives::cuboid;
//! use mp_render::{Body, Scene};
//! use nalgebra::{Isometry3, Point3};
//!
//! let at = |x: f64| Isometry3::translation(x, 0.0, 1.0);
//! let robot = Body::new(&cuboid(0.4, 0.2, 0.2)?, at(-2.0));
//! let path = [at(-2.0), at(2.0)];
//! let scene = Scene {
//!     title: "A box among boxes".into(),
//!     obstacles: vec![Body::new(&cuboid(0.2, 3.0, 0.5)?, Isometry3::identity())],
//!     goal: Some(robot.at(path[1])),
//!     copies: robot.along(&path),
//!     trace: path.iter().map(|pose| Point3::from(pose.translation.vector)).collect(),
//!     start: Some(robot),
//!     ..Scene::default()
//! };
//! let picture = scene.draw((320, 240))?;
//! assert_eq!((picture.width(), picture.height()), (320, 240));
//! assert!(picture.to_png().starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod ambient_occlusion;
mod body;
mod camera;
mod canvas;
mod cutaway;
mod decorate;
mod drawing;
mod error;
mod gif;
mod lights;
mod model;
pub mod palette;
mod path;
mod picture;
mod quantize;
mod raster;
mod scene;
mod shot;
mod text;
mod view;
mod viewpoint;

pub use body::Body;
pub use drawing::{Drawing, Item};
pub use error::{MAX_SIDE, RenderError};
pub use gif::Gif;
pub use mp_geom::evenly;
pub use picture::Picture;
pub use scene::Scene;
pub use shot::{Animation, Moment, Shot};
pub use view::{Mode, View};
