//! Shortening and smoothing of paths without ever leaving free space.
//!
//! Every edge these functions add, halves of old edges included, has been found free by `check`; a
//! change with an edge that is not free is dropped. All are bounded in work and depend on their
//! arguments only: the same seed gives the same path. When `check` is [interrupted](MotionValidity::interrupt_by), the path is
//! returned as it is by then.
//!
//! | function | does |
//! |---|---|
//! | [`reduce`] | leaves out states, deterministic |
//! | [`shortcut`] | joins random places of the path by straight motions |
//! | [`partial_shortcut`] | the same for one factor of the space at a time |
//! | [`bspline`] | rounds corners by cubic B-spline subdivision |
//! | [`simplify`] | all of these in a good order |

mod bspline;
mod random;

pub use bspline::bspline;
pub use random::{partial_shortcut, shortcut};

use crate::{Factored, MotionValidity, Path, Rng, Space, trace};

/// How much work to put into shortening a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Shortcuts tried at most, of each kind.
    pub attempts: usize,
    /// Shortcuts that may gain less than a thousandth of the length, one after another, before giving up.
    pub patience: usize,
    /// Rounds of corner rounding, each at most doubling the number of states; at most 10 are done.
    pub rounds: usize,
}

impl Default for Effort {
    /// 200 attempts, patience 60, 3 rounds.
    fn default() -> Self {
        Self { attempts: 200, patience: 60, rounds: 3 }
    }
}

/// Leaves out states: joins each kept state straight to a later one, as far along as `check` allows,
/// trying the goal first and halving the number of states skipped after each failure.
///
/// At most `n·log₂ n` checks for `n` states. The length does not increase.
pub fn reduce<C: Space>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
) -> Path<C::State> {
    let old = &path.states;
    let mut states: Vec<C::State> = old.first().cloned().into_iter().collect();
    let mut first = 0;
    while first + 1 < old.len() {
        let mut last = old.len() - 1;
        if check.is_interrupted() {
            states.extend_from_slice(&old[first + 1..]);
            break;
        }
        while last > first + 1 && !is_shortcut(space, check, &old[first..=last]) {
            last = first + (last - first) / 2;
        }
        states.push(old[last].clone());
        first = last;
    }
    Path::straight(states)
}

/// Whether the straight motion between the ends of a piece of path is free and no longer than it.
fn is_shortcut<C: Space>(space: &C, check: &mut impl MotionValidity<C::State>, piece: &[C::State]) -> bool {
    let [first, .., last] = piece else { return false };
    let along: f64 = piece.windows(2).map(|w| space.distance(&w[0], &w[1])).sum();
    space.distance(first, last) <= along && check.check_motion(first, last).is_free()
}

/// Whether every edge through `states` is free. The first and the last one are asked about last: they are parts of edges that were
/// free, so others are likelier to refuse.
fn all_free<S>(check: &mut impl MotionValidity<S>, states: &[S]) -> bool {
    let mut free = |states: &[S]| states.windows(2).all(|w| check.check_motion(&w[0], &w[1]).is_free());
    let n = states.len();
    match n {
        0..4 => free(states),
        _ => free(&states[1..n - 1]) && free(&states[..2]) && free(&states[n - 2..]),
    }
}

/// Reduces, takes shortcuts of both kinds, reduces again and rounds the corners.
///
/// In a metric of constant speed the length does not increase.
pub fn simplify<C: Factored>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Path<C::State> {
    let short = reduce(space, check, path);
    let short = shortcut(space, check, &short, effort, rng);
    let short = partial_shortcut(space, check, &short, effort, rng);
    let short = reduce(space, check, &short);
    let short = bspline(space, check, &short, effort.rounds);
    trace::simplified([path, &short].map(|path| path.states.len()));
    short
}
