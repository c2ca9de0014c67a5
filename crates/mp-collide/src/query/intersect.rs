//! Do two trees meet?

use crate::bvh::frames::{FrameTransform, Frames, Placed};
use crate::bvh::{LEAF, Leaf, Node, Tree};
use crate::counters::Counters;
use crate::kernels::leaf_pair::{Near, corners, near_box};
use crate::kernels::separating_axes::touching;
use crate::kernels::triangle_pair::{TriangleFilter, Verdict};
use crate::simd::{Kernel, Lanes, prefetch};
use crate::triangle::intersect;

/// Depth-first over pairs of nodes; the larger box is opened.
pub(crate) struct Intersect<'q> {
    pub(crate) a: &'q Tree,
    pub(crate) b: &'q Tree,
    pub(crate) frames: &'q Frames,
    /// Any two triangles that meet will do, not always the same.
    pub(crate) any: bool,
    pub(crate) stack: &'q mut Vec<(u32, u32)>,
    pub(crate) meeting: &'q mut TriangleFilter,
    pub(crate) counters: &'q mut Counters,
}

impl Kernel for Intersect<'_> {
    /// Two triangles that meet, as positions in the trees.
    type Output = Option<(usize, usize)>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, frames, any, stack, meeting, counters } = self;
        let pad = frames.pad;
        let (into_a, into_b) =
            (FrameTransform::<L>::new(&frames.into_a), FrameTransform::<L>::new(&frames.into_b));
        let (far_a, far_b) = (a.is_large(), b.is_large());
        let mut tests = 0;
        stack.clear();
        stack.push((a.root, b.root));
        let mut found = None;
        while let Some((x, y)) = stack.pop() {
            if x & y & LEAF != 0 {
                let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
                tests += 2;
                found = leaf_pair::<L>((a, i), (b, j), frames, &into_a, any, meeting, counters);
                if found.is_some() {
                    break;
                }
                continue;
            }
            tests += 1;
            let open_a = x & LEAF == 0 && (y & LEAF != 0 || a.own(x).size >= b.own(y).size);
            if open_a {
                let node = &a.nodes[x as usize];
                push::<L>(a, far_a, node, &into_a, b.own(y), pad, |child| stack.push((child, y)));
            } else {
                let node = &b.nodes[y as usize];
                push::<L>(b, far_b, node, &into_b, a.own(x), pad, |child| stack.push((x, child)));
            }
        }
        counters.box_tests += tests;
        found
    }
}

/// Calls `push` for every child of `node` (of `tree`) that may come within `margin` of `other`.
#[inline(always)]
pub(crate) fn push<L: Lanes>(
    tree: &Tree,
    far: bool,
    node: &Node,
    frame: &FrameTransform<L>,
    other: &crate::bvh::NodeBox,
    margin: f32,
    mut push: impl FnMut(u32),
) {
    let mut mask = touching::<L>(node, &frame.place(other), margin);
    while mask != 0 {
        let child = node.child[mask.trailing_zeros() as usize & 7];
        mask &= mask - 1;
        if far {
            prefetch_node(tree, child);
        }
        push(child);
    }
}

/// Fetches a node or leaf that will be looked at soon.
#[inline(always)]
pub(crate) fn prefetch_node(tree: &Tree, reference: u32) {
    if reference & LEAF != 0 {
        prefetch::<Leaf>(&tree.leaves[(reference & !LEAF) as usize]);
    } else {
        prefetch::<Node>(&tree.nodes[reference as usize]);
    }
    prefetch(tree.own(reference));
}

/// Two triangles of two leaves that meet: the first two, or any that surely do.
#[inline(always)]
pub(crate) fn leaf_pair<L: Lanes>(
    (a, i): (&Tree, usize),
    (b, j): (&Tree, usize),
    frames: &Frames,
    into_a: &FrameTransform<L>,
    any: bool,
    meeting: &mut TriangleFilter,
    counters: &mut Counters,
) -> Option<(usize, usize)> {
    let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
    let near = Near::new(leaf_a, leaf_b, frames);
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
    meeting.set((leaf_a, &corners_a), (leaf_b, &corners_b, &own_b), (&near, frames));
    let (first_a, first_b) = (leaf_a.first as usize, leaf_b.first as usize);
    let mut singles = mask_b;
    while singles != 0 {
        let single = singles.trailing_zeros() as usize;
        singles &= singles - 1;
        counters.triangle_tests += 1;
        let Verdict { mut maybe, sure } = meeting.of::<L>(single, mask_a);
        if any && sure != 0 {
            maybe = sure;
        }
        while maybe != 0 {
            let lane = maybe.trailing_zeros() as usize;
            let (k, l) = (first_a + lane, first_b + single);
            if sure & (1 << lane) != 0 || intersect(&a.triangles[k], &frames.exact.triangle(&b.triangles[l]))
            {
                return Some((k, l));
            }
            maybe &= maybe - 1;
        }
    }
    None
}
