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

/// A ball around the boxes of all solids.
fn around(solids: &[(Range<u32>, Aabb)]) -> (Point3<f64>, f64) {
    let all = solids.iter().fold(Aabb::empty(), |all, (_, bounds)| all.union(bounds));
    (nalgebra::center(&all.min, &all.max), 0.5 * (all.max - all.min).norm())
}

impl RefMesh {
    /// Whether a component of one of the meshes is inside of a [solid](TriMesh::solids) of the other; their surfaces must be apart.
    /// Linear in the triangles of solids whose boxes hold a vertex.
    #[must_use]
    pub fn is_nested(&self, pose_wa: &Isometry3<f64>, other: &Self, pose_wb: &Isometry3<f64>) -> bool {
        self.holds(pose_wa, other, pose_wb) || other.holds(pose_wb, self, pose_wa)
    }

    /// Whether a component of `other` is inside of a solid of this mesh. As the surfaces are apart, one vertex decides for each. Only those
    /// vertices are looked at that may be in the ball around all solids.
    fn holds(&self, pose_ws: &Isometry3<f64>, other: &Self, pose_wo: &Isometry3<f64>) -> bool {
        if self.solids.is_empty() {
            return false;
        }
        let pose = pose_ws.inverse() * pose_wo;
        let vertices = other.components.get_or_init(|| {
            let few = other.mesh.vertices_of_few_parts();
            let mut vertices = few.unwrap_or_else(|| other.mesh.component_vertices());
            vertices.sort_by(|p, q| p.x.total_cmp(&q.x));
            vertices
        });
        let (center, radius) = self.around_solids.get_or_init(|| around(&self.solids));
        let center_o = pose.inverse() * center;
        // Far more than rounding.
        let reach = radius + 1e-9 * (radius + self.size + other.size + pose.translation.vector.norm());
        let first = vertices.partition_point(|p| p.x < center_o.x - reach);
        let near = vertices[first..].iter().take_while(|p| p.x <= center_o.x + reach);
        near.filter(|p| (*p - center_o).norm() <= reach).any(|p| self.has_inside(&(pose * p)))
    }

    /// Whether a point, in the frame of the mesh, is inside of one of its solids.
    fn has_inside(&self, p: &Point3<f64>) -> bool {
        let around = |(solid, bounds): &(Range<u32>, Aabb)| {
            bounds.contains(p) && self.mesh.winding_number_of(solid.clone(), p) > 0.5
        };
        self.solids.iter().any(around)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;
    use nalgebra::Vector3;

    /// Whatever the order of vertices and the ball around solids leave out, the answer is that of asking for every vertex.
    #[test]
    fn what_is_left_out_is_inside_of_nothing() {
        let at = |x: f64, y: f64| Isometry3::translation(x, y, 0.0);
        let [cube, ball] =
            [primitives::cuboid(0.5, 0.4, 0.3), primitives::sphere(0.2, 1)].map(Result::unwrap);
        let solids = TriMesh::merged([&cube, &ball.transformed(&at(1.0, 0.5))]).unwrap();
        let crumb = primitives::cuboid(0.01, 0.02, 0.01).unwrap();
        let crumbs: Vec<TriMesh> =
            (0..30).map(|i| crumb.transformed(&at(0.2 * f64::from(i) - 3.0, 0.0))).collect();
        let crumbs = TriMesh::merged(&crumbs).unwrap();
        let (a, b) = (RefMesh::new(&solids), RefMesh::new(&crumbs));
        let mut inside = 0;
        for i in 0..500 {
            let t = f64::from(i);
            let shift =
                Vector3::new(2.0 * mp_math::sin(t), mp_math::cos(0.7 * t), 0.1 * mp_math::sin(0.3 * t));
            let pose = Isometry3::new(shift, Vector3::new(0.0, 0.1 * mp_math::cos(t), t));
            let plain = |p: &Point3<f64>| a.has_inside(&(pose * p));
            let expected = crumbs.component_vertices().iter().any(plain);
            assert_eq!(a.holds(&Isometry3::identity(), &b, &pose), expected, "{i}");
            inside += u32::from(expected);
        }
        assert!(inside > 50 && inside < 450, "{inside}");
    }
}
