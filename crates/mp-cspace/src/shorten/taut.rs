//! Paths pulled taut: shortcuts between states and cut corners, in turn.

use super::{Draft, Effort, is_shortcut};
use crate::shorten::random::arc_lengths;
use crate::{MotionValidity, Path, PathLength, Space};

/// A corner that would move less than this part of the length of the path stays.
const LEAST_MOVE: f64 = 5e-3;

/// How far a corner moves toward the point midway between its neighbours: the first of these parts of the way that is free.
const MOVES: [f64; 3] = [0.5, 0.25, 0.125];

/// Shortcuts between states that may fail, for each of [`Effort::attempts`]: paths of many states have many pairs of them.
const FAILURES: usize = 10;

/// Pulls the path taut, in [`Effort::taut`] rounds at most. In each round
///
/// - each state is joined straight to the farthest later one that `check` allows;
/// - each edge is cut at its middle, and each corner moves toward the point midway between the middles of its two edges: half of the way, or
///   a quarter or an eighth if that is not free.
///
/// It ends when no corner moves. Random shortcuts seldom find the last few that gain; this follows obstacles ever more closely. Thomason,
/// Kingston and Kavraki 2024, *Motions in microseconds via vectorized sampling-based planning*, simplify paths in such rounds, with moves of
/// half the way only.
///
/// The first and last state stay. At most ten of the straight motions are refused for each of [`Effort::attempts`]; corners ask about six motions at most
/// in each round. In a metric of constant speed the length does not increase.
pub fn tauten<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
) -> Path<C::State> {
    tautened(space, check, Draft::of(space, path), effort).path()
}

pub(super) fn tautened<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    mut draft: Draft<C::State>,
    effort: Effort,
) -> Draft<C::State> {
    let mut failures = FAILURES * effort.attempts;
    for round in 0..=effort.taut {
        joined(space, check, &mut draft, &mut failures);
        if round == effort.taut || draft.states.len() < 3 {
            break;
        }
        let least = LEAST_MOVE * arc_lengths(space, &draft.states)[draft.states.len() - 1];
        let mut cut = halved(space, &draft);
        if !cut_corners(space, check, &mut cut, least) {
            break;
        }
        draft = cut;
    }
    draft
}

/// Joins each state straight to the farthest later one that `check` allows.
fn joined<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    draft: &mut Draft<C::State>,
    failures: &mut usize,
) {
    let mut first = 0;
    while first + 2 < draft.states.len() {
        for last in (first + 2..draft.states.len()).rev() {
            if *failures == 0 || check.is_interrupted() {
                return;
            }
            if is_shortcut(check, &mut PathLength(space), &draft.states[first..=last]) {
                draft.states.drain(first + 1..last);
                draft.origin.drain(first + 1..last);
                draft.free.splice(first..last, [true]);
                break;
            }
            *failures -= 1;
        }
        first += 1;
    }
}

/// The same path with a state in the middle of each edge.
pub(super) fn halved<C: Space>(space: &C, old: &Draft<C::State>) -> Draft<C::State> {
    let mut new = Draft { states: Vec::new(), free: Vec::new(), origin: Vec::new() };
    for (i, w) in old.states.windows(2).enumerate() {
        new.states.extend([w[0].clone(), space.interpolate(&w[0], &w[1], 0.5)]);
        new.origin.extend([old.origin[i], 0.5 * (old.origin[i] + old.origin[i + 1])]);
        new.free.extend([old.free[i]; 2]);
    }
    new.states.extend(old.states.last().cloned());
    new.origin.extend(old.origin.last());
    new
}

/// Moves each second state toward the point midway between its neighbours, as far as [`MOVES`] and `check` allow, but not by less than `least`.
/// Returns whether one has moved.
fn cut_corners<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    draft: &mut Draft<C::State>,
    least: f64,
) -> bool {
    let mut has_moved = false;
    for i in (2..draft.states.len().saturating_sub(2)).step_by(2) {
        if check.is_interrupted() {
            break;
        }
        let [before, corner, after] = [&draft.states[i - 1], &draft.states[i], &draft.states[i + 1]];
        let straight = space.interpolate(before, after, 0.5);
        let moved = MOVES.iter().map(|part| space.interpolate(corner, &straight, *part));
        let far_enough = moved.take_while(|new| space.distance(corner, new) >= least);
        let free = far_enough.into_iter().find(|new| {
            check.check_motion(before, new).is_free() && check.check_motion(new, after).is_free()
        });
        if let Some(new) = free {
            draft.states[i] = new;
            draft.free[i - 1..=i].fill(true);
            has_moved = true;
        }
    }
    has_moved
}
