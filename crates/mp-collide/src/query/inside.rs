//! Whether part of a mesh is inside a box.

use nalgebra::{Point3, Vector3};

use crate::bvh::frames::{FrameTransform, Frames};
use crate::bvh::{LEAF, Tree};
use crate::counters::Counters;
use crate::kernels::separating_axes::touching;
use crate::pose::Relative;
use crate::simd::{Kernel, Lanes};

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
