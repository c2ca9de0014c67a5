//! Random shortcuts.

use super::{Draft, Effort, all_free, reduced};
use crate::{Factored, MotionValidity, Objective, Path, PathLength, Rng, Space};
use rand::RngExt;

/// A path with this many times the states it had is [reduced](super::reduce): each shortcut of one factor asks about all states between its ends.
const CROWDED: usize = 4;

/// A piece of a path: it begins on edge `first` and ends on edge `last`, at the arc lengths `s`, the states `from` and `to`, and the
/// [origins](Draft::origin) `origin`.
pub(super) struct Piece<S> {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) s: (f64, f64),
    pub(super) from: S,
    pub(super) to: S,
    pub(super) origin: (f64, f64),
}

/// Of each state, the length of the path up to it.
pub(super) fn arc_lengths<C: Space>(space: &C, states: &[C::State]) -> Vec<f64> {
    costs_up_to(&mut PathLength(space), states)
}

/// Of each state, the cost of the path up to it.
fn costs_up_to<S>(objective: &mut impl Objective<S>, states: &[S]) -> Vec<f64> {
    let mut s = vec![0.0];
    for w in states.windows(2) {
        s.push(s[s.len() - 1] + objective.cost(&w[0], &w[1]));
    }
    s
}

/// A random piece over two edges or more.
pub(super) fn random_piece<C: Space>(
    space: &C,
    draft: &Draft<C::State>,
    s: &[f64],
    rng: &mut Rng,
) -> Option<Piece<C::State>> {
    let total = s[s.len() - 1];
    let (x, y) = (total * rng.random::<f64>(), total * rng.random::<f64>());
    let (s1, s2) = if x < y { (x, y) } else { (y, x) };
    // Never an edge of zero length, except perhaps the last.
    let edge_at = |at: f64| s.partition_point(|&end| end <= at).clamp(1, s.len() - 1) - 1;
    let (first, last) = (edge_at(s1), edge_at(s2));
    let place = |edge: usize, at: f64| {
        let t = ((at - s[edge]) / (s[edge + 1] - s[edge])).clamp(0.0, 1.0);
        let state = space.interpolate(&draft.states[edge], &draft.states[edge + 1], t);
        (state, draft.origin[edge] + t * (draft.origin[edge + 1] - draft.origin[edge]))
    };
    (first < last).then(|| {
        let ((from, start), (to, end)) = (place(first, s1), place(last, s2));
        Piece { first, last, s: (s1, s2), from, to, origin: (start, end) }
    })
}

/// Calls `propose` until the effort is used up, and takes the proposals that cost less and are free.
///
/// A proposal replaces the states strictly between the start of edge `first` and the end of edge `last`.
pub(super) fn improve<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    objective: &mut impl Objective<C::State>,
    mut draft: Draft<C::State>,
    effort: Effort,
    rng: &mut Rng,
    mut propose: impl FnMut(&[C::State], &[f64], Piece<C::State>, &mut Rng) -> Vec<C::State>,
) -> Draft<C::State> {
    let mut s = arc_lengths(space, &draft.states);
    let mut costs = costs_up_to(objective, &draft.states);
    let mut failed = 0;
    let mut crowded = CROWDED * draft.states.len();
    // A gain within rounding does not count.
    let least_gain = effort.least_gain.max(1e-9);
    for _ in 0..effort.attempts {
        if failed >= effort.patience || draft.states.len() < 3 || check.is_interrupted() {
            break;
        }
        failed += 1;
        let Some(piece) = random_piece(space, &draft, &s, rng) else { continue };
        let (first, last, origin) = (piece.first, piece.last, piece.origin);
        let middle = propose(&draft.states, &s, piece, rng);
        let mut new = vec![draft.states[first].clone()];
        new.extend(middle);
        new.push(draft.states[last + 1].clone());
        let cost = costs_up_to(objective, &new)[new.len() - 1];
        let is_cheaper = costs[last + 1] - costs[first] - cost > least_gain * costs[costs.len() - 1];
        if is_cheaper && all_free(check, &new, [draft.free[first], draft.free[last]]) {
            failed = 0;
            new.pop();
            // The states between keep theirs, if there are any.
            let kept = if new.len() > 3 { first + 1..last + 1 } else { 0..0 };
            let mut origins = vec![draft.origin[first], origin.0];
            origins.extend_from_slice(&draft.origin[kept]);
            origins.push(origin.1);
            draft.origin.splice(first..=last, origins);
            draft.free.splice(first..=last, vec![true; new.len()]);
            draft.states.splice(first..=last, new);
            if draft.states.len() > crowded {
                draft = reduced(check, objective, draft);
                crowded = CROWDED * draft.states.len();
            }
            s = arc_lengths(space, &draft.states);
            costs = costs_up_to(objective, &draft.states);
        }
    }
    draft
}

/// Joins two random places of the path by a straight motion wherever that is free and shorter,
/// again and again (Geraerts and Overmars 2007, *Creating high-quality paths for motion
/// planning*).
///
/// The length does not increase.
pub fn shortcut<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Path<C::State> {
    straightened(space, check, &mut PathLength(space), Draft::of(space, path), effort, rng).path()
}

pub(super) fn straightened<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    objective: &mut impl Objective<C::State>,
    path: Draft<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Draft<C::State> {
    improve(space, check, objective, path, effort, rng, |_, _, piece, _| vec![piece.from, piece.to])
}

/// Straightens one random [factor](Factored) of the space between two random places of the path,
/// the other factors unchanged, wherever that is free and shorter (the partial shortcut of Geraerts
/// and Overmars 2007).
///
/// This removes needless turning that plain shortcuts cannot remove, as they change all factors at
/// once. The length does not increase.
pub fn partial_shortcut<C: Factored>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Path<C::State> {
    straightened_by_factor(space, check, &mut PathLength(space), Draft::of(space, path), effort, rng).path()
}

pub(super) fn straightened_by_factor<C: Factored>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    objective: &mut impl Objective<C::State>,
    path: Draft<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Draft<C::State> {
    let factors = space.factors();
    if factors < 2 {
        return path;
    }
    improve(space, check, objective, path, effort, rng, |states, s, piece, rng| {
        let factor = rng.random_range(0..factors);
        let (s1, s2) = piece.s;
        let mut new = vec![piece.from.clone()];
        for i in piece.first + 1..=piece.last {
            let mut q = states[i].clone();
            let t = ((s[i] - s1) / (s2 - s1)).clamp(0.0, 1.0);
            space.interpolate_factor(factor, &piece.from, &piece.to, t, &mut q);
            new.push(q);
        }
        new.push(piece.to);
        new
    })
}
