//! The answer to a distance query.

use nalgebra::Point3;

/// How far two bodies are apart, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// The distance (metres); 0 exactly when they intersect.
    pub distance: f64,
    /// A nearest point of the first, in the world; a common point when they intersect.
    pub point_a: Point3<f64>,
    /// A nearest point of the second, in the world.
    pub point_b: Point3<f64>,
}
