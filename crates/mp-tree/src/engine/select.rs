//! Slot: which nodes to grow from.

use mp_cspace::{Hit, NearestNeighbors, NodeId, Rng, Space};

/// Why a tree grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// Toward a sample, to explore the space.
    Explore,
    /// Toward a node of another tree or a goal, to meet it.
    Join,
}

/// Slot: chooses the nodes to grow from, and learns from the results.
///
/// `points` are always the states of one tree, by id. The selector is informed of each new node in order; it
/// owns the index of the tree, and whatever is remembered per node.
pub trait Selector<C: Space> {
    /// Writes the candidates in the order to try them to `out` (cleared first), with their distances to
    /// `target`. No candidate means that this target is refused.
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        purpose: Purpose,
        rng: &mut Rng,
        out: &mut Vec<Hit>,
    );
    /// Writes all nodes within `radius` of `q` (inclusive), in order of distance, to `out` (cleared first).
    fn near(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>);
    /// Writes the `k` nodes nearest to `q`, in order of distance, to `out` (cleared first).
    ///
    /// The default sorts all nodes: override it where there is an index.
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        self.near(space, points, q, f64::INFINITY, out);
        out.truncate(k);
    }
    /// Node `id` is new; `parent` is `None` for a root.
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId, parent: Option<NodeId>);
    /// Called with whether the tree grew from `id`, and for which purpose.
    fn feedback(&mut self, _id: NodeId, _purpose: Purpose, _grew: bool) {}
    /// Whether no node is left to grow from, for any target; by default never.
    fn exhausted(&self) -> bool {
        false
    }
    /// Nodes were removed: what is now node `i` was node `survivors[i]`, and `points` are the remaining
    /// states.
    fn pruned(&mut self, space: &C, points: &[C::State], survivors: &[NodeId]);
}

/// Selects the nearest node.
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
