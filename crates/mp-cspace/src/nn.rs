//! Nearest neighbours.

use crate::Space;

/// Identifies a state of a tree or roadmap: its index in insertion order.
pub type NodeId = u32;

/// A neighbour and its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Which node.
    pub id: NodeId,
    /// Its distance to the query in the metric of the space.
    pub distance: f64,
}

/// An index over states owned by somebody else.
///
/// `points` is always the same growing slice; the index is told of each new point by
/// [`inserted`](NearestNeighbors::inserted), in order. Distances are *from* the point *to* the
/// query. Ties go to the smallest id, so every implementation gives identical answers.
pub trait NearestNeighbors<C: Space> {
    /// Tells the index that `points[id]` is new.
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId);
    /// Forgets everything; the caller inserts again.
    fn clear(&mut self);
    /// The nearest point, `None` when there is none.
    fn nearest(&self, space: &C, points: &[C::State], q: &C::State) -> Option<Hit>;
    /// The `k` nearest points in order of distance, into `out` (cleared first).
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>);
    /// All points within `radius` (inclusive), in order of distance, into `out` (cleared first).
    fn within(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>);
}
