//! Corner rounding.

use super::all_free;
use crate::{MotionValidity, Path, Space};

/// Rounds of subdivision done at most: each may double the number of states.
const MAX_ROUNDS: usize = 10;

/// Rounds the corners of the path by `rounds` of cubic B-spline subdivision (Lane and Riesenfeld
/// 1980): edges are cut at their middles, and each state moves half way toward the point midway between
/// the middles of its two edges, where that is free. Start and goal stay.
///
/// In a metric of constant speed the length does not increase.
pub fn bspline<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    rounds: usize,
) -> Path<C::State> {
    let mut states = path.states.clone();
    for _ in 0..rounds.min(MAX_ROUNDS) {
        match round(space, check, &states) {
            Some(rounded) => states = rounded,
            None => break,
        }
    }
    Path::straight(states)
}

/// One round, `None` when nothing moved.
fn round<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    states: &[C::State],
) -> Option<Vec<C::State>> {
    let middle = |a: &C::State, b: &C::State| space.interpolate(a, b, 0.5);
    // Corners that would move less are straight enough.
    let least = 1e-6 * space.extent();
    // The new states of each inner state that moves: its own, between the middles of its two edges.
    let mut moved: Vec<Option<[C::State; 3]>> = vec![None; states.len()];
    for (i, w) in states.windows(3).enumerate() {
        if check.is_interrupted() {
            return None;
        }
        let (before, after) = (middle(&w[0], &w[1]), middle(&w[1], &w[2]));
        let new = middle(&middle(&w[1], &before), &middle(&w[1], &after));
        if space.distance(&w[1], &new) > least {
            // All edges that may arise, whichever neighbours move.
            let edges = [w[0].clone(), before, new, after, w[2].clone()];
            if all_free(check, &edges) {
                let [_, before, new, after, _] = edges;
                moved[i + 1] = Some([before, new, after]);
            }
        }
    }
    if moved.iter().all(Option::is_none) {
        return None;
    }
    let mut out = Vec::with_capacity(2 * states.len());
    for (i, state) in states.iter().enumerate() {
        match &moved[i] {
            Some([before, new, after]) => {
                // The corner before has added this middle already.
                if moved[i - 1].is_none() {
                    out.push(before.clone());
                }
                out.push(new.clone());
                out.push(after.clone());
            }
            None => out.push(state.clone()),
        }
    }
    Some(out)
}
