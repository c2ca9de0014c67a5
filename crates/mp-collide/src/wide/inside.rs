//! Is part of a mesh inside a box? And which point of a mesh is the lowest?

use nalgebra::{Point3, Vector3};

use super::boxes::touching;
use super::frames::{Carrier, Frames};
use super::{LEAF, Tree, WIDTH};
use crate::pose::Relative;
use crate::query::Counters;
use crate::simd::{Kernel, Lanes};

/// Whether the first corner of some triangle is inside a box: depth-first over the nodes whose boxes touch
/// it.
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
        let place = Carrier::<L>::new(&frames.into_a).place(b.own(b.root));
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
        // Boxes hold what they are for to 1e-6 of their size, in sizes `f32` can count.
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
                let along = |v: &[super::Lane; 3]| {
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
