//! Spaces and metrics.

use crate::Rng;
use std::fmt::Debug;

/// A distance between states.
///
/// `distance` is finite, non-negative and zero from a state to itself. It need not be symmetric
/// nor satisfy the triangle inequality: a metric that does also implements [`TrueMetric`].
pub trait Metric<S> {
    /// The distance from `from` to `to`, in the metric's own unit.
    fn distance(&self, from: &S, to: &S) -> f64;
}

/// Marker: the metric is symmetric and satisfies the triangle inequality.
///
/// Metric trees prune with it, so they demand it.
pub trait TrueMetric<S>: Metric<S> {}

impl<S, M: Metric<S> + ?Sized> Metric<S> for &M {
    #[inline]
    fn distance(&self, from: &S, to: &S) -> f64 {
        (**self).distance(from, to)
    }
}
impl<S, M: TrueMetric<S> + ?Sized> TrueMetric<S> for &M {}

/// A configuration space (or state space): what states are, how far apart, and what lies between.
///
/// Contract, checked by the conformance test kit:
/// `interpolate(a, b, 0) = a`, `interpolate(a, b, 1) = b`,
/// `distance(a, interpolate(a, b, t)) = t · distance(a, b)` (constant speed along a shortest
/// curve), and every sample is contained.
pub trait Space: Metric<Self::State> {
    /// A configuration. Equality is exact: planners use it to tell a state they already have.
    type State: Clone + Debug + PartialEq;

    /// Number of degrees of freedom.
    fn dim(&self) -> usize;

    /// An upper bound on the distance between any two states: the diameter of the space.
    ///
    /// Resolutions and steps given as a *fraction* are fractions of this.
    fn extent(&self) -> f64;

    /// The state at fraction `t` ∈ \[0, 1\] of the way from `from` to `to`, written to `out`.
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State);

    /// The state at `u` ∈ \[0, 1)^[`dim`](Space::dim): a measure-preserving map of the unit cube
    /// onto the space. Uniform and low-discrepancy samplers both go through it.
    ///
    /// # Panics
    /// When `u.len() < self.dim()`.
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State;

    /// A state drawn uniformly.
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State;

    /// Whether `q` is finite and within the bounds of the space.
    fn contains(&self, q: &Self::State) -> bool;

    /// As [`interpolate_into`](Space::interpolate_into), returning the state.
    fn interpolate(&self, from: &Self::State, to: &Self::State, t: f64) -> Self::State {
        let mut out = from.clone();
        self.interpolate_into(from, to, t, &mut out);
        out
    }
}
