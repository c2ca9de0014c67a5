//! The plane: polygons, and worlds of polygons with fast distance queries.
//!
//! - [`Polygon`]: rings of points, holes included.
//! - [`PlanarWorld`]: polygons, with or without walls around them, and distances from points and segments.
//! - [`outline`]: the polygon of the occupied squares of a grid map.
//!
//! ```
//! use mp_geom::planar::{PlanarWorld, Polygon};
//! use nalgebra::Point2;
//!
//! let crate_ = Polygon::rectangle([1.0, 1.0], [2.0, 2.0])?;
//! let world = PlanarWorld::new(vec![crate_], Some([[0.0, 0.0], [4.0, 3.0]]))?;
//! assert!(world.contains(&Point2::new(1.5, 1.5)));
//! assert_eq!(world.signed_distance(&Point2::new(2.5, 1.5)), 0.5);
//! let near = world.nearest_to_segment(&Point2::new(0.5, 0.5), &Point2::new(3.5, 0.5), f64::INFINITY);
//! assert_eq!(near.unwrap().distance, 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cells;
mod edge;
mod outline;
mod polygon;
mod tree;
mod world;

pub use outline::outline;
pub use polygon::{Polygon, PolygonError};
pub use world::{NearestToPoint, NearestToSegment, PlanarWorld, PlanarWorldError};
