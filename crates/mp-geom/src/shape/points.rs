//! Sets of points, such as those of a depth camera, each with a ball around it.

use super::{Made, finite, sphere};
use crate::{MeshError, PrimitiveError, TriMesh};
use nalgebra::Point3;

/// Points, and how far around each of them nothing may be.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// The points (m).
    pub at: Vec<Point3<f64>>,
    /// The radius (m) of the ball around each.
    pub radius: f64,
}

/// The most points: together they have as many triangles as a mesh may have.
const MAX_POINTS: usize = 50_000_000;

impl Points {
    /// An icosahedron around each ball: 20 triangles. O(n) for n points.
    pub(super) fn mesh(&self) -> Made {
        let ball = sphere::around(self.radius, 0)?;
        if self.at.is_empty() {
            return Err(PrimitiveError::NoInside { what: "a set of no points" });
        }
        if self.at.len() > MAX_POINTS {
            return Err(MeshError::TooLarge { what: "points", count: self.at.len() }.into());
        }
        finite(&self.at)?;
        let each = ball.vertices().len() as u32;
        let vertices = self.at.iter().flat_map(|p| ball.vertices().iter().map(move |v| v + p.coords));
        let triangles = (0..self.at.len() as u32)
            .flat_map(|i| ball.triangles().iter().map(move |t| t.map(|v| v + i * each)));
        let mesh = TriMesh::new(vertices.collect(), triangles.collect())?;
        Ok(mesh.trusted_solids(self.at.len() as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_point_is_a_solid() {
        let at = vec![Point3::origin(), Point3::new(0.05, 0.0, 0.0), Point3::new(3.0, 0.0, 1.0)];
        let points = Points { at: at.clone(), radius: 0.1 };
        let mesh = points.mesh().unwrap();
        assert_eq!((mesh.triangles().len(), mesh.solids()), (60, &[0..20, 20..40, 40..60][..]));
        for p in &at {
            for direction in [nalgebra::Vector3::x(), -nalgebra::Vector3::y(), nalgebra::Vector3::z()] {
                assert!(mesh.winding_number(&(p + 0.0999 * direction)) > 0.9);
            }
        }
        assert!(mesh.winding_number(&Point3::new(3.0, 0.13, 1.0)).abs() < 1e-9);
        assert!(Points { at: Vec::new(), radius: 0.1 }.mesh().is_err());
        assert!(Points { at: vec![Point3::new(f64::NAN, 0.0, 0.0)], radius: 0.1 }.mesh().is_err());
        assert!(Points { at, radius: 0.0 }.mesh().is_err());
    }
}
