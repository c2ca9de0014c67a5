//! Sets of points, such as those of a depth camera, each with a ball around it.

use super::{Made, sphere};
use crate::primitives::positive;
use crate::{PrimitiveError, ThinError, TriMesh, thin};
use nalgebra::Point3;

/// Points, and how far around each of them nothing may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// The points (m). Those that are not finite are left out.
    pub at: Vec<Point3<f64>>,
    /// The radius (m) of the ball around each.
    pub radius: f64,
    /// The side (m) of the cells on which they are [thinned](thin).
    pub cell: f64,
}

impl Points {
    /// Points with this radius (m), thinned on cells of half of it.
    #[must_use]
    pub fn new(at: Vec<Point3<f64>>, radius: f64) -> Self {
        Self { at, radius, cell: 0.5 * radius }
    }

    /// Balls around the thinned points, larger by their padding. O(n log n) for n points.
    pub(super) fn mesh(&self) -> Made {
        let thinned = thin(&self.at, self.cell).map_err(|e| match e {
            ThinError::NoPoint { .. } => PrimitiveError::NoInside { what: "a set of no points" },
            ThinError::Cell { cell, .. } => PrimitiveError::NotPositive { what: "cell", value: cell },
        })?;
        positive("radius", self.radius)?;
        TriMesh::of_balls(thinned.centers, self.radius + thinned.padding)
    }
}

/// A mesh around a ball: an icosahedron, of which each triangle is divided into four, `divided` times.
pub(crate) fn ball(radius: f64, divided: u32) -> Made {
    sphere::around(radius, divided)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_become_balls() {
        let at = vec![Point3::origin(), Point3::new(0.06, 0.0, 0.0), Point3::new(3.0, 0.0, 1.0)];
        let mesh = Points::new(at.clone(), 0.1).mesh().unwrap();
        assert_eq!((mesh.vertices().len(), mesh.balls()), (3, &[(0..3, 0.1)][..]));
        let coarse = Points { cell: 0.5, ..Points::new(at.clone(), 0.1) }.mesh().unwrap();
        assert_eq!(coarse.vertices(), [Point3::new(0.03, 0.0, 0.0), at[2]]);
        assert!((coarse.rounding().unwrap() - 0.13).abs() < 1e-9);
        let bad = Point3::new(f64::NAN, 0.0, 0.0);
        assert_eq!(Points::new(vec![bad, at[0]], 0.1).mesh().unwrap().vertices(), [at[0]]);
        assert!(Points::new(vec![bad], 0.1).mesh().is_err());
        assert!(Points::new(Vec::new(), 0.1).mesh().is_err());
        assert!(Points { cell: 0.0, ..Points::new(at.clone(), 0.1) }.mesh().is_err());
        assert!(Points { cell: 0.1, ..Points::new(at, 0.0) }.mesh().is_err());
    }
}
