//! Obstacles with an inside: tests whether a point is in one.

use mp_geom::{Aabb, TriMesh};
use nalgebra::Point3;
use std::sync::Arc;

/// A closed, consistently oriented obstacle in the world, with triangles facing outward.
#[derive(Clone, Debug)]
pub(crate) struct SolidObstacle {
    pub(crate) name: String,
    mesh: Arc<TriMesh>,
    bounds: Aabb,
}

/// Whether a mesh is a solid: closed, consistently oriented, triangles facing outward. A point robot inside of a solid touches it.
#[must_use]
pub fn is_solid(mesh: &TriMesh) -> bool {
    // First what takes less time.
    mesh.balls().is_empty() && mesh.signed_volume() > 0.0 && mesh.is_closed_and_oriented()
}

impl SolidObstacle {
    /// `mesh`, in the world, which is a [solid](is_solid).
    pub(crate) fn new(name: &str, mesh: &Arc<TriMesh>) -> Self {
        Self { name: name.to_owned(), mesh: Arc::clone(mesh), bounds: mesh.aabb() }
    }

    /// Whether `p` is inside, by its winding number. For points within rounding of the surface either answer is
    /// possible.
    pub(crate) fn contains(&self, p: &Point3<f64>) -> bool {
        self.bounds.contains(p) && self.mesh.winding_number(p) > 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives::{cuboid, torus};
    use proptest::prelude::*;

    fn solid(mesh: TriMesh) -> Option<SolidObstacle> {
        is_solid(&mesh).then(|| SolidObstacle::new("it", &Arc::new(mesh)))
    }

    proptest! {
        #[test]
        fn inside_a_torus_is_known_by_its_equation(p in prop::array::uniform3(-3.0..3.0_f64)) {
            let solid = solid(torus(2.0, 0.7, 96, 48).unwrap()).unwrap();
            let from_tube = mp_math::hypot(mp_math::hypot(p[0], p[1]) - 2.0, p[2]);
            // The mesh is inscribed.
            prop_assume!(!(0.69..=0.7).contains(&from_tube));
            prop_assert_eq!(solid.contains(&Point3::from(p)), from_tube < 0.7);
        }
    }

    #[test]
    fn rooms_and_sheets_are_no_solids() {
        let cube = cuboid(1.0, 1.0, 1.0).unwrap();
        assert!(solid(cube.clone()).is_some());
        assert!(solid(cube.reversed()).is_none());
        let sheet = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[..4].to_vec()).unwrap();
        assert!(solid(sheet).is_none());
        // The cavity of a hollow solid is outside.
        let hollow = TriMesh::merged([&cube, &cuboid(0.5, 0.5, 0.5).unwrap().reversed()]).unwrap();
        let hollow = solid(hollow).unwrap();
        assert!(!hollow.contains(&Point3::origin()) && hollow.contains(&Point3::new(0.3, 0.3, 0.3)));
    }
}
