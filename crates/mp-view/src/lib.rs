//! A scene, its paths, trees and roadmap as one binary file, and as a page for the browser.
//!
//! [`SceneFile`] is the model: bodies with their meshes, start and goals, paths sampled finely enough to be animated,
//! trees, a roadmap, and the report of the run. It is written and read as bytes, in the format of docs/formats/viewer.md,
//! and written as glTF for other programs ([`SceneFile::to_glb`]).
//!
//! ```
//! use mp_plan::{Request, Scene};
//! use mp_view::SceneFile;
//! let scene = Scene::find("easy")?;
//! let report = scene.plan(&Request::new("rrt-connect").seed(7))?;
//! let mut file = SceneFile::of(&scene)?;
//! file.add_report(&scene, &report)?;
//! let bytes = file.to_bytes();
//! assert_eq!(SceneFile::parse(&bytes)?, file);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Session`] answers the page when it opens, edits, checks, plans and saves; [`Worker`] is the same without threads.

mod arrays;
mod bytes;
mod error;
pub mod fuzz;
mod glb;
mod growth;
mod message;
mod model;
mod of_scene;
#[cfg(not(target_family = "wasm"))]
mod page;
mod session;

pub use error::ViewError;
pub use growth::GrownTrees;
pub use model::{
    Area, Bends, Body, Configuration, Mesh, PathTrack, Polyline, Roadmap, Role, SceneFile, Shape, Tree,
};
#[cfg(not(target_family = "wasm"))]
pub use page::{Planner, page, page_with_files};
#[cfg(not(target_family = "wasm"))]
pub use session::Session;
pub use session::{Opening, Thumbnail, Worker, is_mesh, scene_of_mesh};
