//! Tests of states and of motions: whether they are free, and their clearance.

use crate::{Curve, Interrupt};

/// Whether a state is free.
///
/// Scratch memory and counters are plain fields of the implementor: clone it per thread.
/// Closures implement it.
pub trait Validity<S> {
    /// Whether `q` is free (no collision, every constraint holds).
    fn is_valid(&mut self, q: &S) -> bool;

    /// The index of a state that is not free, `None` when all are free. Override it for checks that test
    /// several states at once. The states come in the order in which they should be tested.
    fn first_invalid(&mut self, states: &[S]) -> Option<usize> {
        states.iter().position(|q| !self.is_valid(q))
    }

    /// The best number of states for one call of [`first_invalid`](Validity::first_invalid), at least one.
    /// Sampled motion checks pass that many.
    fn batch_size(&self) -> usize {
        1
    }
}

impl<S, F: FnMut(&S) -> bool> Validity<S> for F {
    #[inline]
    fn is_valid(&mut self, q: &S) -> bool {
        self(q)
    }
}

/// A lower bound on the distance between the robot and the obstacles, in metres.
pub trait Clearance<S> {
    /// A lower bound on the distance between the robot at `q` and the nearest obstacle.
    ///
    /// The search may stop as soon as the bound reaches `enough`: any return value ≥ `enough`
    /// means only "at least `enough`". Zero or less means contact, or that no bound is known.
    fn clearance(&mut self, q: &S, enough: f64) -> f64;

    /// The same without what parts of the robot keep from each other: for costs of being near obstacles, as some
    /// parts are always near each other. By default [`clearance`](Self::clearance).
    fn obstacle_clearance(&mut self, q: &S, enough: f64) -> f64 {
        self.clearance(q, enough)
    }

    /// Whether the robot at `q` certainly touches an obstacle. Override it where an intersection test is
    /// cheaper than a distance. A wrong `false` costs time, never safety.
    fn in_contact(&mut self, q: &S) -> bool {
        self.clearance(q, f64::MIN_POSITIVE) <= 0.0
    }
}

/// An interval of a motion about the state in its middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionInterval<'a, S> {
    /// Where the whole motion starts.
    pub from: &'a S,
    /// Where the whole motion ends.
    pub to: &'a S,
    /// The state in the middle of the interval.
    pub middle: &'a S,
    /// Half the interval, as a fraction of the motion.
    pub half: f64,
    /// A bound (m) on how far any point of the robot travels over half the interval.
    pub travel: f64,
    /// The clearance (m) to keep.
    pub margin: f64,
}

/// A search for the [least clearance](MotionClearance::least_along) along a motion.
#[allow(missing_debug_implementations, reason = "functions have none")]
pub struct ClearanceSearch<'a, S> {
    /// Where the motion starts.
    pub from: &'a S,
    /// Where it ends.
    pub to: &'a S,
    /// The clearance (m) at both ends, or less.
    pub ends: [f64; 2],
    /// The state at each fraction of the motion.
    pub at: &'a dyn Fn(f64) -> S,
    /// A clearance (m) known from elsewhere: of parts that keep more, no more is wanted than that.
    pub known: f64,
    /// How far (m) the bound may be below the least clearance found.
    pub accuracy: f64,
    /// The most states to look at. When there are more, the bound known by then is the answer.
    pub states: usize,
}

/// The answer to a [`ClearanceSearch`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastClearance {
    /// A lower bound (m) on the clearance all along the motion.
    pub bound: f64,
    /// The least clearance (m) found at a state; the one known, when none is less.
    pub found: f64,
    /// The fraction of the motion at which it was found; `None` for the one known.
    pub at: Option<f64>,
}

/// The clearance over a [`MotionInterval`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntervalClearance {
    /// Free to either side of the middle, with a clearance of at least `margin`, as far as no point of the
    /// robot travels more than `clearance - margin`; that may be beyond the ends of the interval. Returned
    /// whenever the clearance in the middle is at least `travel + margin`.
    Free {
        /// The clearance (m) in the middle, or a number that implies the same.
        clearance: f64,
    },
    /// Free over `part` of the motion to either side of the middle, with a clearance of at least `margin`.
    /// Where the clearance `c` in the middle is at least twice the margin, `part` is at least `c - margin`
    /// divided by the travel of the whole motion.
    FreeOver {
        /// The fraction of the motion, above zero; may reach beyond its ends.
        part: f64,
    },
    /// Neither proved nor refuted: a shorter interval may be decided.
    Unproven,
    /// The clearance at `at` is less than twice the margin: shorter intervals are not tried.
    TooClose {
        /// As a fraction of half the interval, from −1 at its start to 1 at its end.
        at: f64,
    },
    /// In contact at `at`.
    Collision {
        /// As a fraction of half the interval, from −1 at its start to 1 at its end.
        at: f64,
    },
}

impl IntervalClearance {
    /// The answer for a clearance (m) in the middle when `margin` (m) is to be kept.
    #[must_use]
    pub fn of(clearance: f64, margin: f64) -> Self {
        if clearance <= 0.0 {
            Self::Collision { at: 0.0 }
        } else if clearance >= 2.0 * margin {
            Self::Free { clearance }
        } else {
            Self::TooClose { at: 0.0 }
        }
    }
}

impl<S, V: Clearance<S> + ?Sized> Clearance<S> for &mut V {
    fn clearance(&mut self, q: &S, enough: f64) -> f64 {
        (**self).clearance(q, enough)
    }
    fn obstacle_clearance(&mut self, q: &S, enough: f64) -> f64 {
        (**self).obstacle_clearance(q, enough)
    }
    fn in_contact(&mut self, q: &S) -> bool {
        (**self).in_contact(q)
    }
}

/// Bounds along motions: how far the robot travels, and what clearance it keeps. With these
/// [`Certified`](crate::Certified) proves motions free.
///
/// A robot of your own gives [`motion_bound`](Self::motion_bound); the rest has defaults by its [`Clearance`].
pub trait MotionClearance<S>: Clearance<S> {
    /// An upper bound on the length (m) of the curve traced by any point of the robot while it moves
    /// from `from` to `to` along the space's interpolation.
    ///
    /// Travel is at constant speed: over a part `dt` of the motion, no point travels farther
    /// than `dt` times this.
    fn motion_bound(&self, from: &S, to: &S) -> f64;

    /// The clearance over an interval of a motion.
    ///
    /// The default uses the clearance in the middle, and assumes that some point travels as far as the interval's bound.
    /// Override it where more is known, such as how far each part of the robot travels, and whether toward an obstacle or
    /// along it.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, S>) -> IntervalClearance {
        let enough = interval.travel.max(interval.margin) + interval.margin;
        IntervalClearance::of(self.clearance(interval.middle, enough), interval.margin)
    }

    /// How many intervals of a motion it computes together if it knows them [ahead](Self::look_ahead). 1, the default: none.
    fn intervals_at_once(&self) -> usize {
        1
    }

    /// Says which intervals of one motion are likely to be asked about next, in this order: at most
    /// [`intervals_at_once`](Self::intervals_at_once), the rest is ignored. Answers hold without it too. How much they prove beyond an interval
    /// may depend on it, so callers say the same each time.
    fn look_ahead(&mut self, _intervals: &[MotionInterval<'_, S>]) {}

    /// The least clearance along a motion: what [`least_clearance`](crate::least_clearance) asks for each edge.
    ///
    /// The default assumes that some point travels as far as the [bound](Self::motion_bound), in every direction. Override it
    /// where parts of the robot move less than others.
    fn least_along(&mut self, search: &ClearanceSearch<'_, S>) -> LeastClearance {
        crate::path::clearance::by_motion_bound(self, search)
    }

    /// How many states it tests for [contact](Self::first_within) together at about the cost of one. 1, the default: none.
    fn contacts_at_once(&self) -> usize {
        1
    }

    /// The index of a state with less clearance than `clearance` (m), or [in contact](Clearance::in_contact) if that is zero: the first such
    /// state, or another one that is found sooner. A wrong `None` costs time, never safety.
    fn first_within(&mut self, states: &[&S], clearance: f64) -> Option<usize> {
        states.iter().position(|q| match clearance > 0.0 {
            true => self.clearance(q, clearance) < clearance,
            false => self.in_contact(q),
        })
    }

    /// Whether [`in_contact`](Clearance::in_contact) costs so much less than
    /// [`interval_clearance`](Self::interval_clearance) that [`Certified`](crate::Certified) first tests for contact at
    /// states two strides apart along the whole motion.
    fn contact_first(&self) -> bool {
        false
    }
}

impl<S, V: MotionClearance<S> + ?Sized> MotionClearance<S> for &mut V {
    fn motion_bound(&self, from: &S, to: &S) -> f64 {
        (**self).motion_bound(from, to)
    }
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, S>) -> IntervalClearance {
        (**self).interval_clearance(interval)
    }
    fn intervals_at_once(&self) -> usize {
        (**self).intervals_at_once()
    }
    fn look_ahead(&mut self, intervals: &[MotionInterval<'_, S>]) {
        (**self).look_ahead(intervals);
    }
    fn least_along(&mut self, search: &ClearanceSearch<'_, S>) -> LeastClearance {
        (**self).least_along(search)
    }
    fn contacts_at_once(&self) -> usize {
        (**self).contacts_at_once()
    }
    fn first_within(&mut self, states: &[&S], clearance: f64) -> Option<usize> {
        (**self).first_within(states, clearance)
    }
    fn contact_first(&self) -> bool {
        (**self).contact_first()
    }
}

/// The answer of a check of a whole motion. Its fractions of the motion are in \[0, 1\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionCheck {
    /// Free all along; `clearance` (m) is a lower bound on the distance to any obstacle over the
    /// whole motion, zero where the check gives none (a discrete check never does).
    Free {
        /// Lower bound on clearance, metres.
        clearance: f64,
    },
    /// The state at fraction `at` is in collision.
    Collision {
        /// Fraction of the motion.
        at: f64,
    },
    /// Proved neither free nor in collision: within the tolerance of contact at fraction `at` (grazing).
    /// Planners treat it as a collision.
    Unproven {
        /// Fraction of the motion.
        at: f64,
    },
}

impl MotionCheck {
    /// The fraction of the motion at which it failed, `None` when it is free.
    #[must_use]
    pub fn failed_at(&self) -> Option<f64> {
        match *self {
            Self::Free { .. } => None,
            Self::Collision { at } | Self::Unproven { at } => Some(at),
        }
    }

    /// Whether the motion was found free.
    #[must_use]
    pub fn is_free(&self) -> bool {
        matches!(self, Self::Free { .. })
    }
}

/// Which end of a motion is already known to be free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum KnownFree {
    /// No end: both have to be tested.
    Neither,
    /// The state it starts from.
    From,
    /// The state it leads to.
    To,
}

/// Whether a whole motion along the space's interpolation is free.
///
/// The checks that planners use for edges (discrete or certified) implement it, and so do the independent
/// verifiers of finished paths.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not check motions between states `{S}`",
    label = "not a `MotionValidity<{S}>`",
    note = "a check of single states (`Validity`, or a closure) becomes one by `Discrete::new`, a clearance by `Certified::new`"
)]
pub trait MotionValidity<S> {
    /// Checks the motion from `from` to `to`, both ends included.
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck;

    /// Checks a motion with an end that is known to be free, as it is a node already: that end need not be
    /// tested again.
    fn check_extension(&mut self, from: &S, to: &S, _known: KnownFree) -> MotionCheck {
        self.check_motion(from, to)
    }

    /// Checks a whole curve. A fault is the first one, up to what the check resolves: all before it is free. Fractions are of the number
    /// of pieces. `None`, the default, where only straight motions are checked.
    fn check_curve(&mut self, _curve: &dyn Curve) -> Option<MotionCheck> {
        None
    }

    /// From now on asks `interrupt` whether to end, also within a check. A check that was interrupted finds no motion free. Checks
    /// that take little time need not implement this.
    fn interrupt_by(&mut self, _interrupt: &Interrupt) {}

    /// Whether the check was interrupted: then its answers mean nothing, and whoever asks should end too.
    fn is_interrupted(&mut self) -> bool {
        false
    }
}

macro_rules! behind {
    ($($pointer:ty),*) => {$(
    impl<S, V: MotionValidity<S> + ?Sized> MotionValidity<S> for $pointer {
        fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
            (**self).check_motion(from, to)
        }
        fn check_extension(&mut self, from: &S, to: &S, known: KnownFree) -> MotionCheck {
            (**self).check_extension(from, to, known)
        }
        fn check_curve(&mut self, curve: &dyn Curve) -> Option<MotionCheck> {
            (**self).check_curve(curve)
        }
        fn interrupt_by(&mut self, interrupt: &Interrupt) {
            (**self).interrupt_by(interrupt);
        }
        fn is_interrupted(&mut self) -> bool {
            (**self).is_interrupted()
        }
    }
    )*};
}
behind!(&mut V, Box<V>);
