//! Room for a finer check.

use super::Draft;
use super::random::arc_lengths;
use crate::{MotionValidity, Path, Rng, Space};
use rand::RngExt;

/// How often states are moved, twice as far each time.
const ROUNDS: usize = 6;

/// Moves the ends of edges that `check` does not find free toward the places of the `given` path that they have come from: by `step`, in the
/// metric, and twice as far each time, until `check` finds all edges free, or six times. Returns the path, and the edges of it that `check` does not
/// find free.
///
/// For paths made short by a coarser check: short paths graze what they lead round, and dip into it between the states that were tested. Asks
/// about each edge once, and each time one of its ends has moved.
pub fn loosen<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    given: &Path<C::State>,
    draft: &Draft<C::State>,
    step: f64,
) -> (Path<C::State>, Vec<usize>) {
    let old = &draft.states;
    let arcs = arc_lengths(space, &given.states);
    let given_at = |at: f64| {
        let edge = arcs.partition_point(|&end| end <= at).clamp(1, arcs.len() - 1) - 1;
        let length = arcs[edge + 1] - arcs[edge];
        let t = if length > 0.0 { ((at - arcs[edge]) / length).clamp(0.0, 1.0) } else { 0.0 };
        space.interpolate(&given.states[edge], &given.states[edge + 1], t)
    };
    let s = arc_lengths(space, old);
    let mut states = old.clone();
    let mut moved = vec![0.0_f64; states.len()];
    let mut blocked: Vec<usize> = (1..states.len()).collect();
    for round in 0..=ROUNDS {
        blocked.retain(|&i| !check.check_motion(&states[i - 1], &states[i]).is_free());
        if blocked.is_empty() || round == ROUNDS || check.is_interrupted() {
            break;
        }
        let before = moved.clone();
        for i in blocked.iter().flat_map(|&i| [i - 1, i]) {
            moved[i] = (2.0 * before[i]).max(step);
        }
        // Those near them move with them, less with the distance: no corner becomes sharper than it need be.
        for i in 1..moved.len() {
            moved[i] = moved[i].max(moved[i - 1] - (s[i] - s[i - 1]));
        }
        for i in (1..moved.len()).rev() {
            moved[i - 1] = moved[i - 1].max(moved[i] - (s[i] - s[i - 1]));
        }
        let has_moved = |i: usize| i > 0 && i + 1 < old.len() && moved[i] > before[i];
        for i in (0..old.len()).filter(|&i| has_moved(i)) {
            let place = given_at(draft.origin[i]);
            let far = space.distance(&old[i], &place);
            states[i] = space.interpolate(&old[i], &place, if moved[i] < far { moved[i] / far } else { 1.0 });
        }
        // An edge from start to goal stays blocked.
        let is_asked = |i: &usize| has_moved(i - 1) || has_moved(*i) || blocked.contains(i);
        blocked = (1..old.len()).filter(is_asked).collect();
    }
    (Path::straight(states), blocked.into_iter().map(|i| i - 1).collect())
}

/// How many random states are tried to lead round what an edge hits.
const TRIES: usize = 40;

/// Leads the edges of `draft` that were `refused` round what they hit: by a state no farther than `reach` from the middle of the edge, in a random
/// direction, where `check` finds both new edges free. Returns whether all were led round.
///
/// For what [`loosen`] leaves: there the given path hits something too, between the states that its planner has tested.
pub fn bypass<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    draft: &mut Draft<C::State>,
    refused: &[usize],
    reach: f64,
    rng: &mut Rng,
) -> bool {
    // Edges before them keep their numbers.
    for &edge in refused.iter().rev() {
        let [from, to] = [&draft.states[edge], &draft.states[edge + 1]];
        let middle = space.interpolate(from, to, 0.5);
        let beside = (0..TRIES).find_map(|_| {
            let other = space.sample_uniform(rng);
            let (far, moved) = (space.distance(&middle, &other), reach * rng.random::<f64>());
            let q = if moved < far { space.interpolate(&middle, &other, moved / far) } else { other };
            (!check.is_interrupted()
                && check.check_motion(from, &q).is_free()
                && check.check_motion(&q, to).is_free())
            .then_some(q)
        });
        let Some(q) = beside else { return false };
        draft.states.insert(edge + 1, q);
        draft.origin.insert(edge + 1, 0.5 * (draft.origin[edge] + draft.origin[edge + 1]));
        draft.free.splice(edge..=edge, [true; 2]);
    }
    true
}
