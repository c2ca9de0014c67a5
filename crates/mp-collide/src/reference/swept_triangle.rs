//! The convex hull of a moving triangle.

use super::triangle::Triangle;
use nalgebra::{Point3, Vector3};

/// The convex hull of a triangle at the start and at the end of a motion, by its corners.
pub(super) struct SweptTriangle([Point3<f64>; 6]);

impl SweptTriangle {
    pub(super) fn new([a, b, c]: Triangle, [d, e, f]: Triangle) -> Self {
        Self([a, b, c, d, e, f])
    }

    /// The hull as it is seen along a direction.
    pub(super) fn along(&self, way: Vector3<f64>) -> Front {
        Front { way, least: least_along(&self.0, &way).0 }
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
            let nearest = self.0[least_along(&self.0, &direction).1];
            let between = nearest - triangle[least_along(triangle, &-direction).1];
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

/// The least coordinate of a hull along a direction: what shows many triangles at once to be apart from it.
pub(super) struct Front {
    way: Vector3<f64>,
    least: f64,
}

impl Front {
    /// Of no hull: nothing is apart from it.
    pub(super) fn none() -> Self {
        Self { way: Vector3::zeros(), least: f64::NEG_INFINITY }
    }

    /// The gap between the hull and a triangle along the direction.
    pub(super) fn gap(&self, triangle: &Triangle) -> f64 {
        let [a, b, c] = triangle.map(|p| p.coords.dot(&self.way));
        self.least - a.max(b).max(c)
    }
}

/// How many directions are tried for a pair of triangles.
const TRIES: usize = 5;

/// The least coordinate of points along a direction, and which of them has it. Without branches: a processor cannot predict them here.
fn least_along<const N: usize>(points: &[Point3<f64>; N], direction: &Vector3<f64>) -> (f64, usize) {
    let along = points.map(|p| p.coords.dot(direction));
    let mut least = (f64::INFINITY, 0);
    for (i, along) in along.into_iter().enumerate() {
        let less = along < least.0;
        least = (if less { along } else { least.0 }, if less { i } else { least.1 });
    }
    least
}
