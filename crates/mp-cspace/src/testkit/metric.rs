//! Axioms of metrics.

use crate::{Space, TrueMetric};
use std::fmt::Debug;

/// Checks the distance of a space on every pair of `states`: distances are finite and not negative, and zero
/// from a state to itself.
///
/// # Panics
/// When an axiom is violated, naming it.
pub fn check_metric<C: Space + ?Sized>(space: &C, states: &[C::State]) {
    for a in states {
        let own = space.distance(a, a);
        assert!(own == 0.0, "metric: distance(a, a) = 0 violated: {own} for a = {a:?}");
        for b in states {
            let d = space.distance(a, b);
            assert!(
                d.is_finite() && d >= 0.0,
                "metric: distances are finite and not negative, violated: {d}\n  from {a:?}\n  to   {b:?}"
            );
        }
    }
}

/// Checks the distance of a [`TrueMetric`] space on every triple of `states`: symmetry and the triangle
/// inequality, to `tolerance` relative to the greatest distance.
///
/// # Panics
/// When an axiom is violated, naming it.
pub fn check_true_metric<C: Space + TrueMetric>(space: &C, states: &[C::State], tolerance: f64) {
    check_pairs(space, states, tolerance);
}

/// As [`check_true_metric`]: the distance of each space is compiled once.
fn check_pairs<S: Clone + Debug + PartialEq + Send + Sync>(
    space: &dyn Space<State = S>,
    states: &[S],
    tolerance: f64,
) {
    check_metric(space, states);
    let n = states.len();
    let d: Vec<f64> = states.iter().flat_map(|a| states.iter().map(|b| space.distance(a, b))).collect();
    let slack = tolerance * d.iter().copied().fold(0.0, f64::max);
    for i in 0..n {
        for j in 0..n {
            let (there, back) = (d[i * n + j], d[j * n + i]);
            let (a, b) = (&states[i], &states[j]);
            assert!(
                (there - back).abs() <= slack,
                "true metric: symmetry violated: {there} there, {back} back\n  a = {a:?}\n  b = {b:?}"
            );
            for k in 0..n {
                let around = d[i * n + k] + d[k * n + j];
                assert!(
                    there <= around + slack,
                    "true metric: triangle inequality violated: {there} directly, {around} around\n  from {a:?}\n  by   {:?}\n  to   {b:?}",
                    states[k]
                );
            }
        }
    }
}
