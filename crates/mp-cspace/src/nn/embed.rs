//! Spaces with coordinates.

use crate::{Space, nn::Layout};

/// A space whose states have coordinates that bound the metric from below: what
/// [`KdTree`](super::KdTree) prunes with. Distances themselves are always the metric's own.
///
/// Contract: the bound of [`Layout`] holds, up to a relative error of 1e-7; the layout of a space
/// never changes.
pub trait Embed: Space {
    /// How the coordinates bound the metric.
    fn layout(&self) -> Layout;
    /// Writes the coordinates of `state` to the front of `out`, which is long enough, and returns
    /// their number: the layout's [`dim`](Layout::dim).
    fn embed(&self, state: &Self::State, out: &mut [f64]) -> usize;
}
