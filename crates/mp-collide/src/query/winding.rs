//! The winding number of a mesh around a point.

use nalgebra::Point3;
use std::ops::Range;

use crate::bvh::frames::fits;
use crate::bvh::{LEAF, Tree};
use crate::counters::Counters;
use crate::triangle::passes;

impl Tree {
    /// The winding number around `p` of the triangles whose numbers are in `solids`, which ascend: how many of them a ray from `p`
    /// along x passes outward, less how many it passes inward. `None` when `p` is on one of them. Exact.
    pub(crate) fn winding(
        &self,
        p: &Point3<f64>,
        solids: &[Range<u32>],
        stack: &mut Vec<(u32, u32)>,
        counters: &mut Counters,
    ) -> Option<i32> {
        let q = p - self.center;
        let pad = 4e-6 * self.radius_center + 1e-13 * (self.radius + p.coords.norm());
        if q.norm() > self.radius_center + pad {
            return Some(0);
        }
        let filter = fits(self.radius_center);
        let all = matches!(solids, [solid] if solid.start == 0 && solid.end as usize >= self.ids.len());
        let counts = |id: u32| {
            let solid = solids.get(solids.partition_point(|solid| solid.end <= id));
            solid.is_some_and(|solid| solid.start <= id)
        };
        let mut turns = 0;
        stack.clear();
        stack.push((self.root, 0));
        while let Some((x, _)) = stack.pop() {
            counters.box_tests += 1;
            if x & LEAF != 0 {
                let leaf = &self.leaves[(x & !LEAF) as usize];
                let own = leaf.first as usize..(leaf.first + leaf.count) as usize;
                counters.triangle_tests += u64::from(leaf.count);
                for (triangle, id) in self.triangles[own.clone()].iter().zip(&self.ids[own]) {
                    if all || counts(*id) {
                        turns += i32::from(passes(p, triangle)?);
                    }
                }
                continue;
            }
            let node = &self.nodes[x as usize];
            for (lane, child) in node.children().enumerate() {
                // How far the box is from `p` along a coordinate, and how far it reaches.
                let gap = |d: usize| f64::from(node.center[d][lane]) - q[d];
                let reach = |d: usize| {
                    let along = |k: usize| f64::from(node.half[k][lane] * node.axes[k][d][lane].abs());
                    along(0) + along(1) + along(2) + pad
                };
                let missed = gap(1).abs() > reach(1) || gap(2).abs() > reach(2) || gap(0) + reach(0) < 0.0;
                if !(filter && missed) {
                    stack.push((child, 0));
                }
            }
        }
        Some(turns)
    }
}

#[cfg(test)]
mod tests {
    use crate::CollisionMesh;
    use crate::triangle::intersect;
    use mp_geom::TriMesh;
    use mp_geom::primitives::{cuboid, sphere, torus};
    use nalgebra::Point3;

    /// The solid angles of the triangles as seen from `p`, over 4π (Van Oosterom and Strackee 1983).
    fn naive_winding(mesh: &TriMesh, p: &Point3<f64>) -> f64 {
        let angle = (0..mesh.triangles().len()).map(|i| {
            let [a, b, c] = mesh.triangle(i).map(|v| (v - p).normalize());
            2.0 * mp_math::atan2(a.dot(&b.cross(&c)), 1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a))
        });
        angle.sum::<f64>() / (4.0 * std::f64::consts::PI)
    }

    /// Rays through corners, along edges and in faces give the right number too.
    #[test]
    fn windings_are_those_of_solid_angles() {
        let cube = cuboid(2.0, 2.0, 2.0).unwrap();
        let hollow = TriMesh::merged([&cube, &cuboid(1.0, 1.0, 1.0).unwrap().reversed()]).unwrap();
        let twice = TriMesh::merged([&cube, &cuboid(1.0, 1.0, 1.0).unwrap()]).unwrap();
        let meshes = [hollow, twice, torus(1.0, 0.5, 16, 8).unwrap(), sphere(1.5, 2).unwrap()];
        let mut seen = [0; 3];
        for mesh in &meshes {
            let tree = CollisionMesh::new(mesh);
            let corners = mesh.vertices().iter().map(|v| [v.y, v.z]).take(60);
            let grid = (0..81).map(|i| [f64::from(i % 9), f64::from(i / 9)].map(|c| 0.25 * c - 1.0));
            let (mut stack, mut counters) = (Vec::new(), Default::default());
            for [y, z] in corners.chain(grid) {
                for x in [-3.0, -0.9, -0.3, 0.1, 0.77, 1.4, 2.5] {
                    let p = Point3::new(x, y, z);
                    if (0..mesh.triangles().len()).any(|i| intersect(&mesh.triangle(i), &[p; 3])) {
                        continue;
                    }
                    let expected = naive_winding(mesh, &p);
                    let all = 0..mesh.triangles().len() as u32;
                    let found = tree.tree().winding(&p, &[all], &mut stack, &mut counters);
                    assert_eq!(found, Some(expected.round() as i32), "{p}");
                    seen[expected.round() as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|n| *n > 10), "{seen:?}");
    }
}
