//! A metric tree that grows while it is queried.

mod build;
mod search;

use super::collect::{KNearest, OneNearest, WithinRadius};
use super::leaf::{CAP, Coincident, Leaves};
use super::node::{Ref, Weight};
use super::states::{SpaceStates, States};
use super::{Hit, NearestNeighbors, NodeId};
use crate::{Space, TrueMetric};
use build::Items;

/// To how many ancestors a leaf stores the distances.
const ROWS: usize = 8;

/// Splits space by the distance from a state.
#[derive(Clone, Debug)]
struct Inner {
    vantage: NodeId,
    /// States equal to the vantage point.
    coincident: Option<Coincident>,
    /// New states at most this far go to the first child.
    split: f64,
    /// The least and greatest distance of the states below each child.
    ranges: [(f64, f64); 2],
    children: [Ref; 2],
    weight: Weight,
}

/// One step down the tree.
#[derive(Clone, Copy, Debug)]
struct Step {
    node: usize,
    side: usize,
    /// From the vantage point of the node to the state being inserted.
    distance: f64,
}

/// An exact index for any [`TrueMetric`]: it uses nothing but distances and the triangle
/// inequality. For costly metrics, and for metrics without a lower bound by coordinates.
///
/// A vantage-point tree (Yianilos 1993, *Data structures and algorithms for nearest neighbor
/// search in general metric spaces*) with buckets that store the distances to the last eight
/// vantage points above them (Bozkaya, Özsoyoglu 1997, *Distance-based indexing for
/// high-dimensional metric spaces*), which excludes most of a bucket's states unmeasured.
/// Unbalanced subtrees are rebuilt as in a scapegoat tree, so insertion takes amortised O(log² n)
/// distances. Answers are those of [`Linear`](super::Linear), to the bit, provided distances obey
/// the triangle inequality to a relative error of 1e-10. Queries allocate nothing.
#[derive(Clone, Debug, Default)]
pub struct MetricTree {
    root: Option<Ref>,
    inner: Vec<Inner>,
    free_inner: Vec<usize>,
    leaves: Leaves,
    /// States whose distance from themselves is not finite, which therefore have no place in the tree.
    unmeasurable: Vec<NodeId>,
    /// The steps down to the leaf found last.
    path: Vec<Step>,
}

/// A distance as the tree stores it: capping never enlarges a difference, so lower bounds stay valid.
#[inline]
fn capped(distance: f64) -> f64 {
    if distance < 1e17 { distance } else { 1e17 }
}

impl MetricTree {
    /// An empty index.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The leaf of state `id`; sets `path` to the steps down to it. `Err` when the state equals a vantage
    /// point: it then joins that.
    fn descend(&mut self, states: &dyn States, id: NodeId) -> Result<usize, ()> {
        self.path.clear();
        let Some(mut r) = self.root else {
            let leaf = self.leaves.alloc(ROWS);
            self.root = Some(Ref::leaf(leaf));
            return Ok(leaf);
        };
        loop {
            let i = match r.get() {
                Err(leaf) => return Ok(leaf),
                Ok(i) => i,
            };
            let node = &mut self.inner[i];
            let distance = capped(states.distance(node.vantage, id));
            if distance == 0.0 && states.same(node.vantage, id) {
                let coincident =
                    node.coincident.get_or_insert_with(|| Coincident { ids: Vec::new(), same: true });
                node.vantage = coincident.join(node.vantage, id);
                return Err(());
            }
            let side = usize::from(distance > node.split);
            let (low, high) = &mut node.ranges[side];
            (*low, *high) = (low.min(distance), high.max(distance));
            self.path.push(Step { node: i, side, distance });
            r = node.children[side];
        }
    }

    fn insert(&mut self, states: &dyn States, id: NodeId) {
        if !states.distance(id, id).is_finite() {
            self.unmeasurable.push(id);
            return;
        }
        let Ok(leaf) = self.descend(states, id) else { return };
        let ids = self.leaves.ids(leaf);
        if self.leaves.head(leaf).has_coincident && states.same(ids[0], id) {
            self.leaves.join(leaf, id, true);
            return;
        }
        if ids.len() < CAP {
            let mut rows = [0.0; ROWS];
            for (depth, step) in self.path.iter().enumerate() {
                rows[depth % ROWS] = step.distance as f32;
            }
            self.leaves.push(leaf, ROWS, id, |row| rows[row]);
            return;
        }
        self.rebuild(states, self.path.len(), Ref::leaf(leaf), Some(id));
        // The highest node that is out of balance.
        let unbalanced = |step: &Step| {
            let node = &self.inner[step.node];
            let [a, b] = node.children.map(|child| self.leaves_below(child));
            node.weight.is_unbalanced(a.max(b))
        };
        if let Some(depth) = self.path.iter().position(unbalanced) {
            self.rebuild(states, depth, Ref::inner(self.path[depth].node), None);
        }
    }

    fn leaves_below(&self, r: Ref) -> u32 {
        r.get().map_or(1, |i| self.inner[i].weight.leaves)
    }

    /// Rebuilds the subtree `r`, which is at `depth` of the path, with the state `more` added.
    fn rebuild(&mut self, states: &dyn States, depth: usize, r: Ref, more: Option<NodeId>) {
        let before = self.leaves_below(r);
        let mut items = Items::default();
        self.gather(states, depth, depth, r, &mut items);
        if let Some(id) = more {
            items.push(id, None, |row| self.ancestor_distance(states, depth, row, id));
        }
        let r = self.build(states, depth, &mut items);
        match depth.checked_sub(1).map(|parent| self.path[parent]) {
            Some(parent) => self.inner[parent.node].children[parent.side] = r,
            None => self.root = Some(r),
        }
        let change = i64::from(self.leaves_below(r)) - i64::from(before);
        for step in &self.path[..depth] {
            self.inner[step.node].weight.change(change);
        }
    }
}

impl<C> NearestNeighbors<C> for MetricTree
where
    C: Space + TrueMetric,
{
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId) {
        self.insert(&SpaceStates { space, points, query: &points[id as usize] }, id);
    }

    fn clear(&mut self) {
        *self = Self::default();
    }

    fn nearest(&self, space: &C, points: &[C::State], q: &C::State) -> Option<Hit> {
        OneNearest::of(|nearest| self.search(&SpaceStates { space, points, query: q }, nearest))
    }

    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        KNearest::of(k, out, |nearest| self.search(&SpaceStates { space, points, query: q }, nearest));
    }

    fn within(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        WithinRadius::of(radius, out, |within| self.search(&SpaceStates { space, points, query: q }, within));
    }
}
