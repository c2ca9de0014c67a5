//! Two triangles: whether they intersect (exactly), and their distance.

mod closest;
mod exact;
mod hulls;

pub use closest::closest;
pub(crate) use closest::{Closest, closest_to_point, closest_within, crossing, is_farther, is_nearest};
pub use exact::intersect;
pub(crate) use exact::passes;
pub(crate) use hulls::are_apart;

use nalgebra::Point3;

/// The corners of a triangle, in any order. Its corners may coincide or lie on a line: a triangle is the
/// convex hull of its corners.
pub type Triangle = [Point3<f64>; 3];
