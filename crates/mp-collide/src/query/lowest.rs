//! The lowest point of a mesh along a direction.

use nalgebra::{Point3, Vector3};

use crate::bvh::{LEAF, Lane, Tree, WIDTH};
use crate::counters::Counters;

impl Tree {
    /// The corner with the least coordinate along the unit vector `up`, measured from `origin`, and that
    /// coordinate.
    pub(crate) fn lowest(
        &self,
        up: &Vector3<f64>,
        origin: &Point3<f64>,
        stack: &mut Vec<(u32, u32)>,
        counters: &mut Counters,
    ) -> (f64, Point3<f64>) {
        let mut best = (f64::INFINITY, Point3::origin());
        // Boxes hold their triangles to 1e-6 of the size of the mesh, where that size is in the range of `f32`.
        let filter = (1e-9..=1e9).contains(&self.radius_center);
        let base = (self.center - origin).dot(up);
        let pad = 4e-6 * self.radius_center + 1e-13 * (self.radius_center + base.abs());
        stack.clear();
        stack.push((self.root, f32::NEG_INFINITY.to_bits()));
        while let Some((x, bound)) = stack.pop() {
            if base + f64::from(f32::from_bits(bound)) - pad > best.0 {
                continue;
            }
            counters.box_tests += 1;
            if x & LEAF != 0 {
                let leaf = &self.leaves[(x & !LEAF) as usize];
                let first = leaf.first as usize;
                counters.triangle_tests += u64::from(leaf.count);
                for p in self.triangles[first..first + leaf.count as usize].iter().flatten() {
                    let height = (p - origin).dot(up);
                    if height < best.0 {
                        best = (height, *p);
                    }
                }
                continue;
            }
            let node = &self.nodes[x as usize];
            let from = stack.len();
            for lane in (0..WIDTH).filter(|&lane| node.half[0][lane] >= 0.0) {
                let along = |v: &[Lane; 3]| {
                    f64::from(v[0][lane]) * up.x + f64::from(v[1][lane]) * up.y + f64::from(v[2][lane]) * up.z
                };
                let mut low = along(&node.center);
                for k in 0..3 {
                    low -= f64::from(node.half[k][lane]) * along(&node.axes[k]).abs();
                }
                let bound = if filter { low as f32 } else { f32::NEG_INFINITY };
                stack.push((node.child[lane], bound.to_bits()));
            }
            // The lowest is popped first.
            stack[from..].sort_by(|x, y| f32::from_bits(y.1).total_cmp(&f32::from_bits(x.1)));
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use crate::{CollisionMesh, Query, Solid};
    use mp_geom::primitives::sphere;
    use nalgebra::Isometry3;

    /// Such sizes overflow or vanish in `f32`: no box may be skipped.
    #[test]
    fn the_lowest_point_is_found_at_any_size() {
        let (ground, mut query) = (Solid::half_space(), Query::default());
        for scale in [1e-60, 1e-12, 1.0, 1e12, 1e40, 1e70] {
            let ball = CollisionMesh::new(&sphere(scale, 3).unwrap());
            let (low, high) = [0.5, 1.5].map(|z| Isometry3::translation(0.0, 0.0, z * scale)).into();
            let here = Isometry3::identity();
            assert!(query.solid_intersects(&ball, &low, &ground, &here), "{scale:e}");
            let distance = query.solid_distance(&ball, &high, &ground, &here).distance;
            assert!((distance / scale - 0.5).abs() < 1e-3, "{scale:e} {distance:e}");
        }
    }
}
