//! Whether two trees come within a tolerance of each other.

use crate::bvh::Tree;
use crate::bvh::frames::{FrameTransform, Frames};
use crate::counters::Counters;
use crate::kernels::leaf_pair::near_each_other;
use crate::kernels::triangle_distance::{DistanceBounds, DistanceKernel, SeparatingDirection};
use crate::query::descend::LeafPair;
use crate::triangle::{closest_within, intersect};
use mp_simd::{Lanes, Mask};

/// Ends a walk at two triangles within a tolerance.
pub(crate) struct Within<'q> {
    /// Boxes farther apart than this are of no interest: the tolerance (m) and rounding.
    pub(crate) margin: f32,
    /// Squared: points less far apart than this are near enough.
    squared: f64,
    /// The same, rounded up and rounded down.
    maybe: f32,
    surely: f32,
    counters: &'q mut Counters,
}

impl<'q> Within<'q> {
    /// `tolerance` is above 0 (metres).
    #[inline(always)]
    pub(crate) fn new(tolerance: f64, frames: &Frames, counters: &'q mut Counters) -> Self {
        let squared = tolerance.next_up() * tolerance.next_up();
        Self {
            margin: ((f64::from(frames.pad) + tolerance) * (1.0 + 1e-6)) as f32,
            squared,
            maybe: ((squared * (1.0 + 1e-6)) as f32).next_up(),
            surely: (tolerance * tolerance * (1.0 - 1e-6)) as f32,
            counters,
        }
    }
}

impl LeafPair for Within<'_> {
    type Found = ();

    #[inline(always)]
    fn compare<L: Lanes>(
        &mut self,
        (a, i): (&Tree, usize),
        (b, j): (&Tree, usize),
        frames: &Frames,
        into_a: &FrameTransform<L>,
    ) -> Option<()> {
        let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
        let boxes = (&a.leaf_boxes[i], &b.leaf_boxes[j]);
        let (mask_a, mut singles) = near_each_other((leaf_a, leaf_b), boxes, frames, into_a, self.margin);
        if mask_a == 0 || singles == 0 {
            return None;
        }
        let kernel = DistanceKernel::<L>::new(leaf_a, &SeparatingDirection::default());
        while singles != 0 {
            let l = leaf_b.first as usize + singles.trailing_zeros() as usize;
            singles &= singles - 1;
            let single = frames.exact.triangle(&b.triangles[l]);
            self.counters.triangle_tests += 1;
            let mut bounds = DistanceBounds::default();
            let close = kernel.between(&single, mask_a, self.maybe, None, &mut bounds);
            if L::load(&bounds.far).le(L::splat(self.surely)).bits() & close.near != 0 {
                return Some(());
            }
            let mut lanes = close.near | close.crossing;
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let other = &a.triangles[leaf_a.first as usize + lane];
                if (close.crossing >> lane & 1 != 0 && intersect(other, &single))
                    || (close.near >> lane & 1 != 0 && closest_within(other, &single, self.squared).is_some())
                {
                    return Some(());
                }
            }
        }
        None
    }

    #[inline(always)]
    fn counters(&mut self) -> &mut Counters {
        self.counters
    }
}
