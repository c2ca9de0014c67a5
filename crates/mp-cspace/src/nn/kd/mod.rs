//! A bucketed k-d tree that grows while it is queried.

mod bounded;
mod build;
mod insert;
mod layout;
mod scan;
mod search;

use super::collect::{KNearest, OneNearest, WithinRadius};
use super::leaf::Leaves;
use super::node::{Ref, Weight};
use super::states::SpaceStates;
use super::{Embed, Hit, NearestNeighbors, NodeId};
use layout::TreeLayout;

/// The `K` that means "as many coordinates as the layout has", and the most there may then be.
const ANY: usize = 16;

/// Splits space: coordinate `dim` is ≤ `split` in the first child and ≥ `split` in the second.
#[derive(Clone, Copy, Debug)]
struct Inner {
    split: f64,
    children: [Ref; 2],
    dim: u32,
    weight: Weight,
}

/// An exact index for spaces whose metric has a lower bound in coordinates ([`Embed`]): the
/// fastest there is for R^n, SO(2), SO(3), SE(2), SE(3), tori and their products.
///
/// A k-d tree (Bentley 1975, *Multidimensional binary search trees used for associative
/// searching*) with buckets (Friedman, Bentley, Finkel 1977) that split at the median of their
/// widest coordinate. Unbalanced subtrees are rebuilt as in a scapegoat tree (Galperin, Rivest
/// 1993), so insertion takes amortised O(log² n) whatever the order of the states. The search
/// descends depth first with incremental distances to the cells (Arya, Mount 1993). Buckets hold
/// `f32` coordinates, structure of arrays, as a filter with a conservative margin; the metric itself
/// decides about the states that pass, in `f64`. Hence answers are those of
/// [`Linear`](super::Linear), to the bit. Symmetries (periods, q ~ −q) are handled by searching for
/// the images of the query.
///
/// `K` is the layout's number of coordinates, best given where it is known at compile time; 16
/// stands for any number up to 16. Of more coordinates than `K` the index uses only the first.
/// Queries allocate nothing, unless there are more than 16 coordinates.
#[derive(Clone, Debug)]
pub struct KdTree<const K: usize = 16> {
    layout: TreeLayout<K>,
    root: Option<Ref>,
    inner: Vec<Inner>,
    free_inner: Vec<usize>,
    leaves: Leaves,
    /// Bounds of all coordinates, relative to the origin.
    bounds: [[f64; K]; 2],
    /// The largest absolute value of a coordinate.
    largest: f64,
    /// The least square of the norm of coordinates that mean the same when negated.
    least_antipode: f64,
    /// The inner nodes above the leaf found last, and which child was taken.
    path: Vec<(usize, usize)>,
}

impl<const K: usize> Default for KdTree<K> {
    fn default() -> Self {
        Self {
            layout: TreeLayout::default(),
            root: None,
            inner: Vec::new(),
            free_inner: Vec::new(),
            leaves: Leaves::default(),
            bounds: [[f64::INFINITY; K], [f64::NEG_INFINITY; K]],
            largest: 0.0,
            least_antipode: f64::INFINITY,
            path: Vec::new(),
        }
    }
}

impl<const K: usize> KdTree<K> {
    /// An empty index.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The number of coordinates used.
    #[inline]
    fn dim(&self) -> usize {
        if K == ANY { self.layout.dim } else { K }
    }
}

impl<C: Embed, const K: usize> NearestNeighbors<C> for KdTree<K> {
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId) {
        self.insert(&SpaceStates { space, points, query: &points[id as usize] }, id);
    }

    fn clear(&mut self) {
        *self = Self::default();
    }

    fn nearest(&self, space: &C, points: &[C::State], q: &C::State) -> Option<Hit> {
        OneNearest::of(|nearest| {
            self.search(&SpaceStates { space, points, query: q }, nearest);
        })
    }

    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        let states = SpaceStates { space, points, query: q };
        if !self.k_nearest_by_bounds(&states, k, out) {
            KNearest::of(k, out, |nearest| {
                self.search(&states, nearest);
            });
        }
    }

    fn within(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        WithinRadius::of(radius, out, |within| {
            self.search(&SpaceStates { space, points, query: q }, within);
        });
    }
}
