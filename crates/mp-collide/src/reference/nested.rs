//! What is inside of solids, by winding numbers.

use super::RefMesh;
use mp_geom::{Aabb, TriMesh};
use nalgebra::{Isometry3, Point3};
use std::ops::Range;

/// The triangles of each solid of a mesh, and the box around them.
pub(super) fn solids(mesh: &TriMesh) -> Vec<(Range<u32>, Aabb)> {
    let corners =
        |solid: &Range<u32>| solid.clone().flat_map(|i| mesh.triangle(i as usize)).collect::<Vec<_>>();
    mesh.solids().iter().map(|solid| (solid.clone(), Aabb::of_points(&corners(solid)))).collect()
}

impl RefMesh {
    /// Whether a component of one of the meshes is inside of a [solid](TriMesh::solids) of the other; their surfaces must be apart.
    /// Linear in the triangles of solids whose boxes hold a vertex.
    #[must_use]
    pub fn is_nested(&self, pose_wa: &Isometry3<f64>, other: &Self, pose_wb: &Isometry3<f64>) -> bool {
        self.holds(pose_wa, other, pose_wb) || other.holds(pose_wb, self, pose_wa)
    }

    /// Whether a component of `other` is inside of a solid of this mesh. As the surfaces are apart, one vertex decides for each.
    fn holds(&self, pose_ws: &Isometry3<f64>, other: &Self, pose_wo: &Isometry3<f64>) -> bool {
        if self.solids.is_empty() {
            return false;
        }
        let pose = pose_ws.inverse() * pose_wo;
        let vertices = other.components.get_or_init(|| other.mesh.component_vertices());
        vertices.iter().any(|p| self.has_inside(&(pose * p)))
    }

    /// Whether a point, in the frame of the mesh, is inside of one of its solids.
    fn has_inside(&self, p: &Point3<f64>) -> bool {
        let around = |(solid, bounds): &(Range<u32>, Aabb)| {
            bounds.contains(p) && self.mesh.winding_number_of(solid.clone(), p) > 0.5
        };
        self.solids.iter().any(around)
    }
}
