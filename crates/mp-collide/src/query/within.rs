//! Do two trees come within a tolerance?

use crate::bvh::frames::{FrameTransform, Frames};
use crate::bvh::{LEAF, Tree};
use crate::counters::Counters;
use crate::kernels::leaf_pair::near_each_other;
use crate::kernels::triangle_distance::{Bounds, DistanceKernel, SeparatingDirection};
use crate::query::intersect::push;
use crate::simd::{Kernel, Lanes, Mask};
use crate::triangle::{closest_within, intersect};

/// Depth-first over pairs of nodes whose boxes come within the tolerance; ends at the first pair of
/// triangles that does.
pub(crate) struct Within<'q> {
    pub(crate) a: &'q Tree,
    pub(crate) b: &'q Tree,
    pub(crate) frames: &'q Frames,
    /// Above 0 (metres).
    pub(crate) tolerance: f64,
    pub(crate) stack: &'q mut Vec<(u32, u32)>,
    pub(crate) counters: &'q mut Counters,
}

impl Kernel for Within<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> bool {
        let (a, b, frames, tolerance) = (self.a, self.b, self.frames, self.tolerance);
        let margin = ((f64::from(frames.pad) + tolerance) * (1.0 + 1e-6)) as f32;
        let (into_a, into_b) =
            (FrameTransform::<L>::new(&frames.into_a), FrameTransform::<L>::new(&frames.into_b));
        let limit = Limit::new(tolerance, margin);
        let (far_a, far_b) = (a.is_large(), b.is_large());
        let mut tests = 0;
        self.stack.clear();
        self.stack.push((a.root, b.root));
        let mut found = false;
        while let Some((x, y)) = self.stack.pop() {
            if x & y & LEAF != 0 {
                let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
                tests += 2;
                if self.leaf_pair::<L>(i, j, &into_a, &limit) {
                    found = true;
                    break;
                }
                continue;
            }
            tests += 1;
            let stack = &mut *self.stack;
            let open_a = x & LEAF == 0 && (y & LEAF != 0 || a.own(x).size >= b.own(y).size);
            if open_a {
                let node = &a.nodes[x as usize];
                push::<L>(a, far_a, node, &into_a, b.own(y), margin, |child| stack.push((child, y)));
            } else {
                let node = &b.nodes[y as usize];
                push::<L>(b, far_b, node, &into_b, a.own(x), margin, |child| stack.push((x, child)));
            }
        }
        self.counters.box_tests += tests;
        found
    }
}

/// The tolerance.
struct Limit {
    /// Boxes farther apart are of no interest.
    margin: f32,
    /// Squared: points less far apart than this are near enough.
    squared: f64,
    /// Rounded up and down.
    maybe: f32,
    surely: f32,
}

impl Limit {
    fn new(tolerance: f64, margin: f32) -> Self {
        let squared = tolerance.next_up() * tolerance.next_up();
        Self {
            margin,
            squared,
            maybe: ((squared * (1.0 + 1e-6)) as f32).next_up(),
            surely: (tolerance * tolerance * (1.0 - 1e-6)) as f32,
        }
    }
}

impl Within<'_> {
    /// Whether two triangles of two leaves come near enough.
    #[inline(always)]
    fn leaf_pair<L: Lanes>(&mut self, i: usize, j: usize, into_a: &FrameTransform<L>, limit: &Limit) -> bool {
        let (a, b, frames) = (self.a, self.b, self.frames);
        let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
        let boxes = (&a.leaf_boxes[i], &b.leaf_boxes[j]);
        let (mask_a, mut singles) = near_each_other((leaf_a, leaf_b), boxes, frames, into_a, limit.margin);
        if mask_a == 0 || singles == 0 {
            return false;
        }
        let gaps = DistanceKernel::<L>::new(leaf_a, &SeparatingDirection::default());
        while singles != 0 {
            let l = leaf_b.first as usize + singles.trailing_zeros() as usize;
            singles &= singles - 1;
            let single = frames.exact.triangle(&b.triangles[l]);
            self.counters.triangle_tests += 1;
            let mut bounds = Bounds::default();
            let close = gaps.between(&single, mask_a, limit.maybe, &mut bounds);
            if L::load(&bounds.far).le(L::splat(limit.surely)).bits() & close.near != 0 {
                return true;
            }
            let mut lanes = close.near | close.crossing;
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let other = &a.triangles[leaf_a.first as usize + lane];
                if (close.crossing >> lane & 1 != 0 && intersect(other, &single))
                    || (close.near >> lane & 1 != 0
                        && closest_within(other, &single, limit.squared).is_some())
                {
                    return true;
                }
            }
        }
        false
    }
}
