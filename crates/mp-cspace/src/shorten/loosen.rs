//! Room for a finer check.

use super::Draft;
use super::random::arc_lengths;
use crate::{MotionValidity, Path, Space};

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
