//! Shortening and smoothing of paths without ever leaving free space.
//!
//! Every edge that these functions add was found free by `check`, or is a part of an edge that was; a change with an edge that is not free
//! is dropped. All are bounded in work and depend on their arguments only: the same seed gives the same path. When `check` is
//! [interrupted](MotionValidity::interrupt_by), the path is returned as it is by then.
//!
//! | function | does |
//! |---|---|
//! | [`reduce`] | leaves out states, deterministic |
//! | [`shortcut`] | joins random places of the path by straight motions |
//! | [`partial_shortcut`] | the same for one factor of the space at a time |
//! | [`bspline`] | rounds corners by cubic B-spline subdivision |
//! | [`tauten`] | joins states of the path, and cuts corners, in turn |
//! | [`simplify`] | reduces, pulls taut, takes shortcuts of one factor and rounds corners, in a good order |
//! | [`cheapen`] | lowers what the path costs by an [`Objective`] |
//! | [`simplified_by_samples`] | the same with few tests, for robots that take long to answer |
//! | [`hybridized`] | merges several paths into one |
//! | [`loosen`] | makes room where a finer check finds too little of it |
//! | [`bypass`] | leads edges round what they hit where that does not help |

mod bspline;
mod cheaper;
mod greedy;
mod hybrid;
mod loosen;
mod random;
mod taut;

pub use bspline::bspline;
pub use cheaper::cheapen;
pub use hybrid::hybridized;
pub use loosen::{bypass, loosen};
pub use random::{partial_shortcut, shortcut};
pub use taut::tauten;

use crate::{
    CoarseToFine, Factored, MotionValidity, Objective, Path, PathLength, Rng, Space, Validity, trace,
};

/// How much work to put into shortening a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Shortcuts tried at most, of each kind.
    pub attempts: usize,
    /// Shortcuts that may fail, one after another, before giving up.
    pub patience: usize,
    /// What a shortcut must gain, as a part of the length of the path.
    pub least_gain: f64,
    /// Rounds of [pulling the path taut](tauten), before shortcuts and after them.
    pub taut: usize,
    /// Rounds of corner rounding, each at most doubling the number of states; at most 10 are done.
    pub rounds: usize,
}

impl Default for Effort {
    /// 200 attempts, patience 60, a least gain of a thousandth, one round of pulling taut, 3 of rounding.
    fn default() -> Self {
        Self { attempts: 200, patience: 60, least_gain: 1e-3, taut: 1, rounds: 3 }
    }
}

/// A path that is being shortened.
#[derive(Clone, Debug)]
pub struct Draft<S> {
    /// The states, joined by straight motions.
    pub states: Vec<S>,
    /// Of each edge, whether it was found free, or is a part of an edge that was. The others are edges of the given path.
    pub free: Vec<bool>,
    /// Of each state, which place of the given path it has come from, as the length of that path up to there.
    pub origin: Vec<f64>,
}

impl<S: Clone> Draft<S> {
    /// A draft that is still the given path: no edge is known to be free.
    pub fn of(space: &impl Space<State = S>, path: &Path<S>) -> Self {
        Self {
            states: path.states.clone(),
            free: vec![false; path.states.len().saturating_sub(1)],
            origin: random::arc_lengths(space, &path.states),
        }
    }

    /// The path as it is now.
    pub fn path(self) -> Path<S> {
        Path::straight(self.states)
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
    reduced(check, &mut PathLength(space), Draft::of(space, path)).path()
}

fn reduced<S: Clone>(
    check: &mut impl MotionValidity<S>,
    objective: &mut impl Objective<S>,
    old: Draft<S>,
) -> Draft<S> {
    let mut kept = vec![0; old.states.len().min(1)];
    let mut free = Vec::new();
    let mut first = 0;
    while first + 1 < old.states.len() {
        let mut last = old.states.len() - 1;
        if check.is_interrupted() {
            kept.extend(first + 1..=last);
            free.extend_from_slice(&old.free[first..]);
            break;
        }
        while last > first + 1 && !is_shortcut(check, objective, &old.states[first..=last]) {
            last = first + (last - first) / 2;
        }
        kept.push(last);
        free.push(last > first + 1 || old.free[first]);
        first = last;
    }
    let states = kept.iter().map(|&i| old.states[i].clone()).collect();
    Draft { states, free, origin: kept.iter().map(|&i| old.origin[i]).collect() }
}

/// Whether the straight motion between the ends of a piece of path is free and, but for rounding, costs no more than it.
fn is_shortcut<S>(
    check: &mut impl MotionValidity<S>,
    objective: &mut impl Objective<S>,
    piece: &[S],
) -> bool {
    let [first, .., last] = piece else { return false };
    let along: f64 = piece.windows(2).map(|w| objective.cost(&w[0], &w[1])).sum();
    objective.cost(first, last) <= along * (1.0 + 1e-12) && check.check_motion(first, last).is_free()
}

/// Whether every edge through `states` is free. The first and the last one are parts of edges of which `known` says whether they were found
/// free: then they are not asked about, and otherwise last, as others are likelier to refuse.
fn all_free<S>(check: &mut impl MotionValidity<S>, states: &[S], known: [bool; 2]) -> bool {
    let mut free = |states: &[S]| states.windows(2).all(|w| check.check_motion(&w[0], &w[1]).is_free());
    let n = states.len();
    free(&states[1..n - 1]) && (known[0] || free(&states[..2])) && (known[1] || free(&states[n - 2..]))
}

/// Reduces, makes the path taut, takes shortcuts of one factor at a time, makes it taut again and rounds the corners.
///
/// Plain random shortcuts are not among them: one round of [`tauten`] in their place makes paths as short in two thirds of the time.
/// In a metric of constant speed the length does not increase.
pub fn simplify<C: Factored>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Path<C::State> {
    simplified(space, check, path, effort, rng).path()
}

/// As [`simplify`], and says what it knows of each edge.
pub fn simplified<C: Factored>(
    space: &C,
    check: &mut impl MotionValidity<C::State>,
    path: &Path<C::State>,
    effort: Effort,
    rng: &mut Rng,
) -> Draft<C::State> {
    let length = &mut PathLength(space);
    let short = reduced(check, length, Draft::of(space, path));
    let short = taut::tautened(space, check, short, effort);
    let short = random::straightened_by_factor(space, check, length, short, effort, rng);
    let short = taut::tautened(space, check, short, effort);
    let short = bspline::rounded(space, check, short, effort.rounds);
    trace::simplified([path.states.len(), short.states.len()]);
    short
}

/// Reduces, takes shortcuts of which each is chosen before it is tested, and rounds the corners, for robots that take long to answer: a fifth of the
/// states is tested that [`simplified`] tests, or fewer. Shortcuts keep the distance `near`, in the metric of the space, from states that are known not to be free.
pub fn simplified_by_samples<C: Factored, V: Validity<C::State>>(
    space: &C,
    check: &mut CoarseToFine<'_, C, V>,
    path: &Path<C::State>,
    near: f64,
    effort: Effort,
    rng: &mut Rng,
) -> Draft<C::State> {
    let short = reduced(check, &mut PathLength(space), Draft::of(space, path));
    let short = greedy::chosen(space, check, short, near, effort, rng);
    let short = bspline::rounded(space, check, short, effort.rounds);
    trace::simplified([path.states.len(), short.states.len()]);
    short
}
