//! Nearest neighbours: one trait, several indexes with identical answers.
//!
//! | index | for | how |
//! |---|---|---|
//! | [`Linear`] | any space | measures every state; the reference for the others |
//! | [`KdTree`] | metrics bounded by coordinates: R^n, tori, SO, SE, products | a bucketed k-d tree that grows |
//! | [`MetricTree`] | any [`TrueMetric`](crate::TrueMetric), such as maximum displacement | a vantage-point tree that grows |
//!
//! A planner that leaves the choice to the space uses `C::Nn` of [`DefaultNn`].

mod collect;
mod embed;
mod growth;
mod kd;
mod leaf;
mod linear;
mod metric_tree;
mod node;
mod spaces;
mod states;

pub use crate::layout::Layout;
pub use embed::Embed;
pub use growth::grow;
pub use kd::KdTree;
pub use linear::Linear;
pub use metric_tree::MetricTree;

use crate::Space;

/// Identifies a state of a tree or roadmap: its index in insertion order.
pub type NodeId = u32;

/// A neighbour and its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The neighbour, as an index in insertion order.
    pub id: NodeId,
    /// Its distance to the query in the metric of the space.
    pub distance: f64,
}

impl Hit {
    /// The order of answers: by distance, ties by id.
    #[inline]
    fn precedes(&self, other: &Hit) -> bool {
        self.distance < other.distance || (self.distance == other.distance && self.id < other.id)
    }

    /// As [`precedes`](Self::precedes), for sorting.
    #[inline]
    fn order(&self, other: &Hit) -> std::cmp::Ordering {
        self.distance.total_cmp(&other.distance).then(self.id.cmp(&other.id))
    }
}

/// An index of states that its caller owns.
///
/// `points` is always the same growing slice, and `space` the same space. The caller announces each new
/// point by [`inserted`](NearestNeighbors::inserted), once, in any order. Distances are *from* the point
/// *to* the query. Ties go to the smallest id, so every implementation gives identical answers, to the
/// bit. States at a distance that is NaN are never found.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no index of nearest neighbours for the space `{C}`",
    label = "not a `NearestNeighbors<{C}>`",
    note = "`Linear` serves every space; a space whose `DefaultNn` is given needs no index"
)]
pub trait NearestNeighbors<C: Space> {
    /// Adds the state `points[id]` to the index.
    ///
    /// # Panics
    /// When `id` is not below the number of `points`.
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId);
    /// Removes all states from the index; the caller inserts them again.
    fn clear(&mut self);
    /// The nearest point, `None` when there is none.
    fn nearest(&self, space: &C, points: &[C::State], q: &C::State) -> Option<Hit>;
    /// The `k` nearest points in order of distance, into `out` (cleared first).
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>);
    /// All points within `radius` (inclusive), in order of distance, into `out` (cleared first).
    fn within(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>);
}

/// A space that names the index which serves it best, so that planners need no choice.
///
/// A space of your own may always set `type Nn = Linear;`.
pub trait DefaultNn: Space + Sized {
    /// The index.
    type Nn: NearestNeighbors<Self> + Default + Clone + std::fmt::Debug + Send + Sync;
}
