//! Slot: which nodes to grow from.

use mp_cspace::{Hit, NearestNeighbors, NodeId, Rng, Space};

/// Why a tree is asked to grow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// Toward a sample, to see more of the space.
    Explore,
    /// Toward a node of another tree or a goal, to meet it.
    Join,
}

/// Chooses the nodes to grow from, and learns from what became of them.
///
/// `points` are always the states of one tree, by id. The selector is told of each node in order
/// and owns the index of the tree; per-node memory belongs here.
pub trait Selector<C: Space> {
    /// The candidates to try in order, into `out` (cleared first), with their distances to
    /// `target`. None at all means that this target is refused.
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        why: Purpose,
        rng: &mut Rng,
        out: &mut Vec<Hit>,
    );
    /// All nodes within `radius` of `q` (inclusive), in order of distance, into `out` (cleared
    /// first).
    fn near(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>);
    /// The `k` nodes nearest to `q`, in order of distance, into `out` (cleared first).
    ///
    /// The default sorts all nodes: give a better one where there is an index.
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        self.near(space, points, q, f64::INFINITY, out);
        out.truncate(k);
    }
    /// Node `id` is new; `parent` is `None` for a root.
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId, parent: Option<NodeId>);
    /// Whether the tree grew from `id` when asked for `why`.
    fn feedback(&mut self, _id: NodeId, _why: Purpose, _grew: bool) {}
    /// Whether no node is left to grow from, whatever the target; the default knows of none such.
    fn exhausted(&self) -> bool {
        false
    }
    /// Nodes were removed: node `i` was `survivors[i]`, and `points` are what remains.
    fn pruned(&mut self, space: &C, points: &[C::State], survivors: &[NodeId]);
}

/// The nearest node.
#[derive(Clone, Debug, Default)]
pub struct NearestSelector<N>(pub N);

impl<C: Space, N: NearestNeighbors<C>> Selector<C> for NearestSelector<N> {
    #[inline]
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        _: Purpose,
        _: &mut Rng,
        out: &mut Vec<Hit>,
    ) {
        out.clear();
        out.extend(self.0.nearest(space, points, target));
    }
    fn near(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        self.0.within(space, points, q, radius, out);
    }
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        self.0.k_nearest(space, points, q, k, out);
    }
    #[inline]
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId, _: Option<NodeId>) {
        self.0.inserted(space, points, id);
    }
    fn pruned(&mut self, space: &C, points: &[C::State], _: &[NodeId]) {
        self.0.clear();
        for end in 1..=points.len() {
            self.0.inserted(space, &points[..end], (end - 1) as NodeId);
        }
    }
}
