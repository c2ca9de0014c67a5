//! Whether two trees have triangles that meet.

use crate::bvh::Tree;
use crate::bvh::frames::{FrameTransform, Frames, Placed};
use crate::counters::Counters;
use crate::kernels::leaf_pair::{LeafFrame, corners, near_box};
use crate::kernels::triangle_pair::{TriangleFilter, Verdict};
use crate::query::descend::LeafPair;
use crate::triangle::intersect;
use mp_simd::Lanes;

/// Ends a walk at two triangles that meet, as positions in the trees.
pub(crate) struct Intersect<'q> {
    /// Any two triangles that surely meet will do, not always the same two.
    pub(crate) any: bool,
    pub(crate) filter: &'q mut TriangleFilter,
    pub(crate) counters: &'q mut Counters,
}

impl LeafPair for Intersect<'_> {
    type Found = (usize, usize);

    #[inline(always)]
    fn compare<L: Lanes>(
        &mut self,
        (a, i): (&Tree, usize),
        (b, j): (&Tree, usize),
        frames: &Frames,
        into_a: &FrameTransform<L>,
    ) -> Option<(usize, usize)> {
        let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
        let near = LeafFrame::new(leaf_a, leaf_b, frames);
        let corners_a = corners::<L>(leaf_a);
        let box_b = into_a.place(&b.leaf_boxes[j]).centred_at(near.shift);
        let mask_a = near_box(&corners_a, leaf_a.edge, &box_b, &near, frames.pad) & leaf_a.all();
        if mask_a == 0 {
            return None;
        }
        let own_b = corners::<L>(leaf_b);
        let corners_b = near.carry(&own_b, frames);
        let box_a = Placed::at_origin(&a.leaf_boxes[i]);
        let mask_b = near_box(&corners_b, leaf_b.edge, &box_a, &near, frames.pad) & leaf_b.all();
        if mask_b == 0 {
            return None;
        }
        self.filter.set((leaf_a, &corners_a), (leaf_b, &corners_b, &own_b), (&near, frames));
        let (first_a, first_b) = (leaf_a.first as usize, leaf_b.first as usize);
        let mut singles = mask_b;
        while singles != 0 {
            let single = singles.trailing_zeros() as usize;
            singles &= singles - 1;
            self.counters.triangle_tests += 1;
            let Verdict { mut maybe, sure } = self.filter.of::<L>(single, mask_a);
            if self.any && sure != 0 {
                maybe = sure;
            }
            while maybe != 0 {
                let lane = maybe.trailing_zeros() as usize;
                let (k, l) = (first_a + lane, first_b + single);
                if sure & (1 << lane) != 0
                    || intersect(&a.triangles[k], &frames.exact.triangle(&b.triangles[l]))
                {
                    return Some((k, l));
                }
                maybe &= maybe - 1;
            }
        }
        None
    }

    #[inline(always)]
    fn counters(&mut self) -> &mut Counters {
        self.counters
    }
}
