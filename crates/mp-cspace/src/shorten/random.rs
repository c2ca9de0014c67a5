//! Random shortcuts.

use super::{Effort, all_free, reduce};
use crate::{Factored, MotionValidity, Path, Rng, Space};
use rand::RngExt;

/// Shortcuts end when [`Effort::patience`] of them, one after another, have not gained this part of the length.
const WORTH: f64 = 1e-3;
/// A path with this many times the states it had is [reduced](reduce): each shortcut of one factor asks about all states between its ends.
const CROWDED: usize = 4;

/// A piece of a path: it begins on edge `first` and ends on edge `last`, at the arc lengths `s` and the
/// states `from` and `to`.
struct Piece<S> {
    first: usize,
    last: usize,
    s: (f64, f64),
    from: S,
    to: S,
}

fn arc_lengths<C: Space>(space: &C, states: &[C::State]) -> Vec<f64> {
    let mut s = vec![0.0];
    for w in states.windows(2) {
        s.push(s[s.len() - 1] + space.distance(&w[0], &w[1]));
    }
    s
}

/// A random piece over two edges or more.
fn random_piece<C: Space>(
    space: &C,
    states: &[C::State],
    s: &[f64],
    rng: &mut Rng,
) -> Option<Piece<C::State>> {
    let total = s[s.len() - 1];
    let (x, y) = (total * rng.random::<f64>(), total * rng.random::<f64>());
    let (s1, s2) = if x < y { (x, y) } else { (y, x) };
    // Never an edge of zero length, except perhaps the last.
    let edge_at = |at: f64| s.partition_point(|&end| end <= at).clamp(1, s.len() - 1) - 1;
    let (first, last) = (edge_at(s1), edge_at(s2));
    let state_at = |edge: usize, at: f64| {
        let t = ((at - s[edge]) / (s[edge + 1] - s[edge])).clamp(0.0, 1.0);
        space.interpolate(&states[edge], &states[edge + 1], t)
    };
    (first < last).then(|| Piece {
        first,
        last,
        s: (s1, s2),
        from: state_at(first, s1),
        to: state_at(last, s2),
    })
}

/// Calls `propose` until the effort is used up, and takes the proposals that are shorter and free.
///
/// A proposal replaces the states strictly between the start of edge `first` and the end of edge `last`.
fn improve<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
    mut propose: impl FnMut(&[C::State], &[f64], Piece<C::State>, &mut Rng) -> Vec<C::State>,
) -> Path<C::State> {
    let mut states = path.states.clone();
    let mut s = arc_lengths(space, &states);
    // Shortcuts tried since the path had the length `before`.
    let (mut tried, mut before) = (0, s[s.len() - 1]);
    let mut crowded = CROWDED * states.len();
    for _ in 0..effort.attempts {
        if tried >= effort.patience || states.len() < 3 || check.is_interrupted() {
            break;
        }
        tried += 1;
        let Some(piece) = random_piece(space, &states, &s, rng) else { continue };
        let (first, last) = (piece.first, piece.last);
        let middle = propose(&states, &s, piece, rng);
        let mut new = vec![states[first].clone()];
        new.extend(middle);
        new.push(states[last + 1].clone());
        let length = arc_lengths(space, &new)[new.len() - 1];
        // A gain within rounding does not count.
        let gain = s[last + 1] - s[first] - length;
        let is_shorter = gain > 1e-9 * s[s.len() - 1];
        if is_shorter && all_free(check, &new) {
            new.pop();
            states.splice(first..=last, new);
            if states.len() > crowded {
                states = reduce(space, check, &Path::straight(states)).states;
                crowded = CROWDED * states.len();
            }
            s = arc_lengths(space, &states);
            let length = s[s.len() - 1];
            if before - length > WORTH * length {
                (tried, before) = (0, length);
            }
        }
    }
    Path::straight(states)
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
    improve(space, check, path, effort, rng, |_, _, piece, _| vec![piece.from, piece.to])
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
    let factors = space.factors();
    if factors < 2 {
        return path.clone();
    }
    improve(space, check, path, effort, rng, |states, s, piece, rng| {
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
