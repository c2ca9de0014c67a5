//! The walk over two trees: pairs of nodes whose boxes come near each other, depth first.

use crate::bvh::frames::{FrameTransform, Frames};
use crate::bvh::{LEAF, Leaf, Node, Tree};
use crate::counters::Counters;
use crate::kernels::separating_axes::touching;
use mp_simd::{Kernel, Lanes, prefetch};

/// How a walk compares two leaves.
pub(crate) trait LeafPair {
    /// What ends the walk.
    type Found;

    /// Compares leaf `i` of `a` with leaf `j` of `b`.
    fn compare<L: Lanes>(
        &mut self,
        a_i: (&Tree, usize),
        b_j: (&Tree, usize),
        frames: &Frames,
        into_a: &FrameTransform<L>,
    ) -> Option<Self::Found>;

    /// Where the work is counted.
    fn counters(&mut self) -> &mut Counters;
}

/// Depth-first over pairs of nodes whose boxes come within `margin`, until two leaves end it; of two nodes the one with
/// the larger box is opened.
pub(crate) struct Descend<'q, P> {
    pub(crate) a: &'q Tree,
    pub(crate) b: &'q Tree,
    pub(crate) frames: &'q Frames,
    /// Metres; rounding included.
    pub(crate) margin: f32,
    pub(crate) stack: &'q mut Vec<(u32, u32)>,
    pub(crate) leaves: P,
}

impl<P: LeafPair> Kernel for Descend<'_, P> {
    type Output = Option<P::Found>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, frames, margin, stack, mut leaves } = self;
        let (into_a, into_b) =
            (FrameTransform::<L>::new(&frames.into_a), FrameTransform::<L>::new(&frames.into_b));
        let (large_a, large_b) = (a.is_large(), b.is_large());
        let mut tests = 0;
        stack.clear();
        stack.push((a.root, b.root));
        let mut found = None;
        while let Some((x, y)) = stack.pop() {
            if x & y & LEAF != 0 {
                let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
                tests += 2;
                found = leaves.compare::<L>((a, i), (b, j), frames, &into_a);
                if found.is_some() {
                    break;
                }
                continue;
            }
            tests += 1;
            if opens_first((a, x), (b, y)) {
                let node = &a.nodes[x as usize];
                let mask = touching::<L>(node, &into_a.place(b.own(y)), margin);
                for_children((a, large_a), node, mask, |child| stack.push((child, y)));
            } else {
                let node = &b.nodes[y as usize];
                let mask = touching::<L>(node, &into_b.place(a.own(x)), margin);
                for_children((b, large_b), node, mask, |child| stack.push((x, child)));
            }
        }
        leaves.counters().box_tests += tests;
        found
    }
}

/// Whether of two nodes, not both leaves, the first is opened: the one with the larger box.
#[inline(always)]
pub(crate) fn opens_first((a, x): (&Tree, u32), (b, y): (&Tree, u32)) -> bool {
    x & LEAF == 0 && (y & LEAF != 0 || a.own(x).size >= b.own(y).size)
}

/// Calls `visit` with the children of `node` whose bits are set in `mask`; of a large tree they are prefetched.
#[inline(always)]
pub(crate) fn for_children(
    (tree, large): (&Tree, bool),
    node: &Node,
    mut mask: u32,
    mut visit: impl FnMut(u32),
) {
    while mask != 0 {
        let child = node.child[mask.trailing_zeros() as usize & 7];
        mask &= mask - 1;
        if large {
            prefetch_node(tree, child);
        }
        visit(child);
    }
}

/// Fetches a node or leaf that will be compared soon.
#[inline(always)]
pub(crate) fn prefetch_node(tree: &Tree, reference: u32) {
    if reference & LEAF != 0 {
        prefetch::<Leaf>(&tree.leaves[(reference & !LEAF) as usize]);
    } else {
        prefetch::<Node>(&tree.nodes[reference as usize]);
    }
    prefetch(tree.own(reference));
}
