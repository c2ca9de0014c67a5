//! Shortcuts that are chosen before they are tested.

use super::random::{Piece, arc_lengths, random_piece};
use super::{Draft, Effort};
use crate::{CoarseToFine, Factored, MotionValidity, Rng, Validity};
use rand::RngExt;

/// From how many random shortcuts the one to be tested is chosen.
const CANDIDATES: usize = 40;

/// Of the candidates, the part that joins two states of the path, and the part that joins two places of it. The others straighten one factor.
const JOINED: f64 = 0.4;
const STRAIGHT: f64 = 0.2;

/// How many tests a shortcut counts for that has none between its ends.
const ENDS: f64 = 4.0;

/// A part of a path, and what may take its place: the states from that with index `first` to that with index `last`, both included.
struct Candidate<S> {
    first: usize,
    last: usize,
    states: Vec<S>,
    origin: Vec<f64>,
    /// Which of the motions between `states` are not known to be free.
    asked: std::ops::Range<usize>,
    /// What it gains for its tests.
    score: f64,
}

/// Takes shortcuts as [`shortcut`](super::shortcut) and [`partial_shortcut`](super::partial_shortcut), and between states of the path, for robots
/// that take long to answer: of 40 random ones that which gains most for the states to be tested, unless it comes nearer than `near` to a state that
/// is known not to be free.
///
/// Ends when [`Effort::patience`] shortcuts in turn have failed, or after [`Effort::attempts`]. The length does not increase.
pub(super) fn chosen<C: Factored, V: Validity<C::State>>(
    space: &C,
    check: &mut CoarseToFine<'_, C, V>,
    mut draft: Draft<C::State>,
    near: f64,
    effort: Effort,
    rng: &mut Rng,
) -> Draft<C::State> {
    let mut failed = 0;
    for _ in 0..effort.attempts {
        if failed >= effort.patience || draft.states.len() < 3 || check.is_interrupted() {
            break;
        }
        failed += 1;
        let Some(best) = best(space, check, &draft, near, effort, rng) else { continue };
        let asked = &best.states[best.asked.start..=best.asked.end];
        let motions: Vec<_> = asked.windows(2).map(|w| [&w[0], &w[1]]).collect();
        if check.are_free(&motions) {
            failed = 0;
            let edges = best.states.len() - 1;
            draft.free.splice(best.first..best.last, vec![true; edges]);
            draft.origin.splice(best.first..=best.last, best.origin);
            draft.states.splice(best.first..=best.last, best.states);
        }
    }
    draft
}

/// The best of some random shortcuts.
fn best<C: Factored, V: Validity<C::State>>(
    space: &C,
    check: &CoarseToFine<'_, C, V>,
    draft: &Draft<C::State>,
    near: f64,
    effort: Effort,
    rng: &mut Rng,
) -> Option<Candidate<C::State>> {
    let s = arc_lengths(space, &draft.states);
    let least_gain = effort.least_gain.max(1e-9) * s[s.len() - 1];
    let mut best: Option<Candidate<C::State>> = None;
    for _ in 0..CANDIDATES {
        let piece = random_piece(space, draft, &s, rng);
        let (kind, factor) = (rng.random::<f64>(), rng.random_range(0..space.factors().max(1)));
        let Some(piece) = piece else { continue };
        let mut new = match kind {
            kind if kind < JOINED => joined(draft, &piece),
            kind if kind < JOINED + STRAIGHT || space.factors() < 2 => {
                straightened(space, draft, &s, &piece, None)
            }
            _ => straightened(space, draft, &s, &piece, Some(factor)),
        };
        let at = arc_lengths(space, &new.states);
        let gain = s[new.last] - s[new.first] - at[at.len() - 1];
        new.score = gain / (at[new.asked.end] - at[new.asked.start] + ENDS * check.spacing());
        let is_better = gain > least_gain && best.as_ref().is_none_or(|best| new.score > best.score);
        let asked = &new.states[new.asked.start..=new.asked.end];
        if is_better && !asked.windows(2).any(|w| check.comes_near_collision(&w[0], &w[1], near)) {
            best = Some(new);
        }
    }
    best
}

/// Joins the states around a piece.
fn joined<S: Clone>(draft: &Draft<S>, piece: &Piece<S>) -> Candidate<S> {
    let (first, last) = (piece.first, piece.last + 1);
    let states = vec![draft.states[first].clone(), draft.states[last].clone()];
    Candidate {
        first,
        last,
        states,
        origin: vec![draft.origin[first], draft.origin[last]],
        asked: 0..1,
        score: 0.0,
    }
}

/// Joins the ends of a piece, by a straight motion or with only one factor straight.
fn straightened<C: Factored>(
    space: &C,
    draft: &Draft<C::State>,
    s: &[f64],
    piece: &Piece<C::State>,
    factor: Option<usize>,
) -> Candidate<C::State> {
    let (first, last) = (piece.first, piece.last + 1);
    let mut states = vec![draft.states[first].clone(), piece.from.clone()];
    let mut origin = vec![draft.origin[first], piece.origin.0];
    if let Some(factor) = factor {
        let (s1, s2) = piece.s;
        let between = first + 1..last;
        origin.extend_from_slice(&draft.origin[between.clone()]);
        for (q, s) in draft.states[between.clone()].iter().zip(&s[between]) {
            let (mut q, t) = (q.clone(), ((s - s1) / (s2 - s1)).clamp(0.0, 1.0));
            space.interpolate_factor(factor, &piece.from, &piece.to, t, &mut q);
            states.push(q);
        }
    }
    states.extend([piece.to.clone(), draft.states[last].clone()]);
    origin.extend([piece.origin.1, draft.origin[last]]);
    // The first and the last motion are parts of edges.
    let edges = states.len() - 1;
    let asked = usize::from(draft.free[first])..edges - usize::from(draft.free[last - 1]);
    Candidate { first, last, states, origin, asked, score: 0.0 }
}
