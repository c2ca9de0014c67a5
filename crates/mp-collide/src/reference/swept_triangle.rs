//! The convex hull of a moving triangle.

use super::triangle::Triangle;
use nalgebra::{Point3, Vector3};

/// The convex hull of a triangle at the start and at the end of a motion, by its corners.
pub(super) struct SweptTriangle([Point3<f64>; 6]);

impl SweptTriangle {
    pub(super) fn new([a, b, c]: Triangle, [d, e, f]: Triangle) -> Self {
        Self([a, b, c, d, e, f])
    }

    /// The gap between the hull and a triangle along some direction, if possible at least `enough`, and that direction.
    /// Tries `first`, or the normal of the triangle when that is zero; then turns away from the points nearest along it
    /// (Chung and Wang, *Quick collision detection of polytopes in virtual environments*, VRST 1996).
    pub(super) fn gap_from(
        &self,
        triangle: &Triangle,
        first: Vector3<f64>,
        enough: f64,
    ) -> (f64, Vector3<f64>) {
        let mut direction = first;
        if direction == Vector3::zeros() {
            let normal = (triangle[1] - triangle[0]).cross(&(triangle[2] - triangle[0]));
            let side = normal.dot(&(self.0[0] - triangle[0]));
            direction = (normal * side.signum()).try_normalize(0.0).unwrap_or(Vector3::x());
        }
        let mut most = (f64::NEG_INFINITY, direction);
        for _ in 0..TRIES {
            let between = first_along(&self.0, &direction) - first_along(triangle, &-direction);
            let gap = between.dot(&direction);
            if gap > most.0 {
                most = (gap, direction);
            }
            if gap >= enough {
                break;
            }
            let Some(across) = between.try_normalize(0.0) else { break };
            let Some(next) = (direction - across * (2.0 * across.dot(&direction))).try_normalize(0.0) else {
                break;
            };
            direction = next;
        }
        most
    }
}

/// How many directions are tried for a pair of triangles.
const TRIES: usize = 5;

/// The point with the least coordinate along a direction.
fn first_along(points: &[Point3<f64>], direction: &Vector3<f64>) -> Point3<f64> {
    let mut first = (f64::INFINITY, Point3::origin());
    for p in points {
        let along = p.coords.dot(direction);
        if along < first.0 {
            first = (along, *p);
        }
    }
    first.1
}
