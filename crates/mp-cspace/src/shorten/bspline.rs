//! Corner rounding.

use super::{Draft, all_free};
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
    rounded(space, check, Draft::of(space, path), rounds).path()
}

pub(super) fn rounded<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    mut draft: Draft<C::State>,
    rounds: usize,
) -> Draft<C::State> {
    for _ in 0..rounds.min(MAX_ROUNDS) {
        match round(space, check, &draft) {
            Some(rounded) => draft = rounded,
            None => break,
        }
    }
    draft
}

/// One round, `None` when nothing moved.
fn round<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    Draft { states, free, origin }: &Draft<C::State>,
) -> Option<Draft<C::State>> {
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
            if all_free(check, &edges, [free[i], free[i + 1]]) {
                let [_, before, new, after, _] = edges;
                moved[i + 1] = Some([before, new, after]);
            }
        }
    }
    if moved.iter().all(Option::is_none) {
        return None;
    }
    let half_way = |i: usize| (origin[i] + origin[i + 1]) / 2.0;
    let mut out = Draft {
        states: states[..1].to_vec(),
        free: Vec::with_capacity(2 * states.len()),
        origin: origin[..1].to_vec(),
    };
    let mut add = |state: &C::State, free, origin| {
        out.states.push(state.clone());
        out.free.push(free);
        out.origin.push(origin);
    };
    for (i, state) in states.iter().enumerate().skip(1) {
        let is_after_moved = moved[i - 1].is_some();
        match &moved[i] {
            Some([before, new, after]) => {
                // The corner before has added this middle already.
                if !is_after_moved {
                    add(before, true, half_way(i - 1));
                }
                add(new, true, origin[i] / 2.0 + (half_way(i - 1) + half_way(i)) / 4.0);
                add(after, true, half_way(i));
            }
            None => add(state, is_after_moved || free[i - 1], origin[i]),
        }
    }
    Some(out)
}
