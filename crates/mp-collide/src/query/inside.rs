//! Whether part of a mesh is inside a box, its lowest point, and its winding number around a point.

use nalgebra::{Point3, Vector3};

use crate::bvh::frames::{FrameTransform, Frames, fits};
use crate::bvh::{LEAF, Tree, WIDTH};
use crate::counters::Counters;
use crate::kernels::separating_axes::touching;
use crate::pose::Relative;
use crate::simd::{Kernel, Lanes};
use crate::triangle::passes;

/// Finds a triangle whose first corner is inside a box: depth-first over the nodes whose boxes touch it.
pub(crate) struct Inside<'q> {
    pub(crate) a: &'q Tree,
    /// The surface of the box, centred on its origin.
    pub(crate) b: &'q Tree,
    pub(crate) half: &'q Vector3<f64>,
    pub(crate) frames: &'q Frames,
    pub(crate) stack: &'q mut Vec<(u32, u32)>,
    pub(crate) counters: &'q mut Counters,
}

impl Kernel for Inside<'_> {
    /// That corner.
    type Output = Option<Point3<f64>>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, half, frames, stack, counters } = self;
        let place = FrameTransform::<L>::new(&frames.into_a).place(b.own(b.root));
        stack.clear();
        stack.push((a.root, b.root));
        while let Some((x, _)) = stack.pop() {
            counters.box_tests += 1;
            if x & LEAF == 0 {
                let node = &a.nodes[x as usize];
                let mut mask = touching::<L>(node, &place, frames.pad);
                while mask != 0 {
                    stack.push((node.child[mask.trailing_zeros() as usize & 7], b.root));
                    mask &= mask - 1;
                }
                continue;
            }
            let leaf = &a.leaves[(x & !LEAF) as usize];
            let first = leaf.first as usize;
            for triangle in &a.triangles[first..first + leaf.count as usize] {
                counters.triangle_tests += 1;
                if is_inside(&triangle[0], half, &frames.exact) {
                    return Some(triangle[0]);
                }
            }
        }
        None
    }
}

/// Whether a point of `a` is in the box of these half edges, centred on the origin of `b`.
pub(crate) fn is_inside(p: &Point3<f64>, half: &Vector3<f64>, pose_ab: &Relative) -> bool {
    let local = pose_ab.rotation.tr_mul(&(p.coords - pose_ab.translation));
    (0..3).all(|k| local[k].abs() <= half[k])
}

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
                let along = |v: &[crate::bvh::Lane; 3]| {
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

impl Tree {
    /// The winding number of the surface around `p`: how many triangles a ray from `p` along x passes outward, less how
    /// many it passes inward. `None` when `p` is on a triangle. Exact.
    pub(crate) fn winding(
        &self,
        p: &Point3<f64>,
        stack: &mut Vec<(u32, u32)>,
        counters: &mut Counters,
    ) -> Option<i32> {
        let q = p - self.center;
        let pad = 4e-6 * self.radius_center + 1e-13 * (self.radius + p.coords.norm());
        if q.norm() > self.radius_center + pad {
            return Some(0);
        }
        let filter = fits(self.radius_center);
        let mut turns = 0;
        stack.clear();
        stack.push((self.root, 0));
        while let Some((x, _)) = stack.pop() {
            counters.box_tests += 1;
            if x & LEAF != 0 {
                let leaf = &self.leaves[(x & !LEAF) as usize];
                let first = leaf.first as usize;
                counters.triangle_tests += u64::from(leaf.count);
                for triangle in &self.triangles[first..first + leaf.count as usize] {
                    turns += i32::from(passes(p, triangle)?);
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
    use crate::triangle::intersect;
    use crate::{CollisionMesh, Query, Solid};
    use mp_geom::TriMesh;
    use mp_geom::primitives::{cuboid, sphere, torus};
    use nalgebra::{Isometry3, Point3};

    /// The solid angles of the triangles as seen from `p`, over 4π (Van Oosterom and Strackee 1983).
    fn naive_winding(mesh: &TriMesh, p: &Point3<f64>) -> f64 {
        let angle = (0..mesh.triangles().len()).map(|i| {
            let [a, b, c] = mesh.triangle(i).map(|v| (v - p).normalize());
            2.0 * a.dot(&b.cross(&c)).atan2(1.0 + a.dot(&b) + b.dot(&c) + c.dot(&a))
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
                    let found = tree.tree().winding(&p, &mut stack, &mut counters);
                    assert_eq!(found, Some(expected.round() as i32), "{p}");
                    seen[expected.round() as usize] += 1;
                }
            }
        }
        assert!(seen.iter().all(|n| *n > 10), "{seen:?}");
    }

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
