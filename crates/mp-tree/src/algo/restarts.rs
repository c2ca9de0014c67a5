//! Restarts: a planner that takes too long is started again, with other random numbers.
//!
//! The time to a path varies with the random numbers, and its distribution often has a heavy tail: a tree that
//! begins badly continues badly. A restart after a fixed number of iterations cuts the tail, but the best number is not
//! known. Without knowing the distribution, these schedules come within a logarithmic factor of the best:
//!
//! - `luby`: M. Luby, A. Sinclair and D. Zuckerman, *Optimal speedup of Las Vegas algorithms*,
//!   Information Processing Letters 47, 1993. Run lengths 1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8, …:
//!   whenever two runs of one length have been made, one of twice that follows.
//! - `counter`: in the manner of the counter search of N. Amato, S. Ashur and S. Har-Peled, *Faster
//!   motion planning via restarts*, 2025, and S. Ashur and S. Har-Peled, *Quickly avoiding a random
//!   catastrophe*, 2025. A counter goes up 1, 2, 3, …; at each count n there is a run of every length
//!   t for which t² divides n. So all lengths are swept at once, length t in one of t² counts: the same shares as
//!   `zeta`, but deterministic.
//! - `zeta`: the ζ(2) search of the same two papers. Each run length t is drawn with probability
//!   6/(π·t)².
//!
//! Repeat:
//! 1. make a planner for attempt k = 1, 2, …, which draws from stream (seed, k);
//! 2. let it make as many iterations as the schedule says, times `unit`;
//! 3. when it finds a path, return the path; otherwise drop the planner.
//!
//! The seed is the first number drawn from the generator of the first step. Stepping on after a
//! path continues the same attempt.
//!
//! **When to use it.** When some seeds take many times longer than most: when the mean over seeds is
//! nearly one and a half times the median, or more. The unit should be about what a fast run needs.
//! Where the tail is lighter than that of an exponential distribution, restarts only cost time. Measured with
//! RRT-Connect and `luby` on `twisty` over 100 seeds, in iterations (median, 95th percentile):
//!
//! | step | mean / median | no restarts | unit 100 | unit 250 | unit 1000 |
//! |---|---|---|---|---|---|
//! | 5%, the default | 3.8 | 799, 14 949 | 869, 2555 | 465, 2185 | 612, 4269 |
//! | 10% | 1.40 | 14 793, 65 904 | 2077, 12 131 | 3213, 14 197 | 5154, 28 602 |
//! | 20% | 1.15 | 46 443, 129 811 | | 58 000, 285 000 | 71 000, 367 000 |
//!
//! With steps of 20% no unit is better than no restarts, as resampling those 100 runs shows.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `schedule`: which run lengths | `luby`, `counter`, `zeta` | `luby` |
//! | `unit`: iterations of a run of length 1 | 1, 2, … 10¹² | 1000 |
//!
//! and those of the planner that is restarted. By name it is `restart-` and the name of that, as in
//! `restart-rrt-connect`; [`build_from`](crate::build_from) makes it.
//!
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Resolution, Rn, Rng, Straight};
//! use mp_tree::{Problem, Restarts, RrtConnect, Schedule, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.02;
//! let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.1), Vector2::new(0.9, 0.1));
//! let attempt = |_| {
//!     let problem = Problem::new(&space, local.clone(), verifier.clone(), start, goal)?;
//!     RrtConnect::new(problem, Tuning::default())
//! };
//! let mut planner = Restarts::new(Schedule::Luby, 50, attempt)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{BuildError, Parameter, Settings};
use mp_cspace::{Event, Observer, Path, Planner, Progress, Rng};
use rand::RngExt;
use std::fmt;

/// Which schedule.
pub const SCHEDULE: Parameter = Parameter {
    name: "schedule",
    range: "luby, counter or zeta",
    default: "luby",
    doc: "how long the runs are, in units",
};

/// How long a unit is.
pub const UNIT: Parameter = Parameter {
    name: "unit",
    range: "a whole number from 1 to 10^12",
    default: "1000",
    doc: "iterations of a run of length 1",
};

/// The schedule of run lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Schedule {
    /// 1, 1, 2, 1, 1, 2, 4, … (Luby, Sinclair and Zuckerman 1993).
    #[default]
    Luby,
    /// At the count n = 1, 2, 3, … every length whose square divides n, the shortest first.
    Counter,
    /// Length t with probability 6/(π·t)².
    Zeta,
}

impl Schedule {
    /// The schedule that is set, [`SCHEDULE`] by default.
    ///
    /// # Errors
    /// When the value is not the name of a schedule.
    pub fn of(settings: &Settings) -> Result<Self, BuildError> {
        let named = |name: &str| match name {
            "luby" => Some(Self::Luby),
            "counter" => Some(Self::Counter),
            "zeta" => Some(Self::Zeta),
            _ => None,
        };
        Ok(settings.choice(SCHEDULE.name, SCHEDULE.range, named)?.unwrap_or_default())
    }

    /// The run lengths, in units; `rng` is used by [`Zeta`](Self::Zeta) alone.
    ///
    /// ```
    /// use mp_cspace::Rng;
    /// use mp_tree::Schedule;
    /// let first = |schedule: Schedule| -> Vec<u64> { schedule.lengths(Rng::seed(1)).take(12).collect() };
    /// assert_eq!(first(Schedule::Luby), [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1]);
    /// assert_eq!(first(Schedule::Counter), [1, 1, 1, 1, 2, 1, 1, 1, 1, 2, 1, 3]);
    /// ```
    #[must_use]
    pub fn lengths(self, rng: Rng) -> Lengths {
        Lengths { schedule: self, rng, count: 1, length: 0 }
    }
}

/// The run lengths of a [`Schedule`], an infinite sequence.
#[derive(Clone, Debug)]
pub struct Lengths {
    schedule: Schedule,
    rng: Rng,
    count: u64,
    length: u64,
}

impl Iterator for Lengths {
    type Item = u64;

    fn next(&mut self) -> Option<u64> {
        Some(match self.schedule {
            Schedule::Luby => {
                // The length doubles as long as it divides the count of runs of length 1.
                let again = self.length > 0 && self.count.is_multiple_of(2 * self.length);
                self.count += u64::from(!again && self.length > 0);
                self.length = if again { 2 * self.length } else { 1 };
                self.length
            }
            Schedule::Counter => loop {
                self.length += 1;
                let square = self.length.saturating_mul(self.length);
                if square > self.count {
                    (self.count, self.length) = (self.count + 1, 0);
                } else if self.count.is_multiple_of(square) {
                    break self.length;
                }
            },
            // Rejection sampling from ⌊1/u⌋, which is t with probability 1/(t(t + 1)).
            Schedule::Zeta => loop {
                let t = (1.0 / (1.0 - self.rng.random::<f64>())).floor();
                if self.rng.random::<f64>() * 2.0 * t <= t + 1.0 {
                    break t as u64;
                }
            },
        })
    }
}

/// Restarts: see the [module](self).
pub struct Restarts<'c, P> {
    make: Box<dyn FnMut(u64) -> Result<P, BuildError> + Send + 'c>,
    schedule: Schedule,
    unit: u64,
    begun: Option<(u64, Lengths)>,
    planner: P,
    rng: Rng,
    attempt: u64,
    /// How many iterations the attempt may take.
    allowed: u64,
    /// The progress of earlier attempts.
    past: Progress,
}

impl<'c, P> Restarts<'c, P> {
    /// Restarts of the planner that `make` makes, given the number of the attempt from 1 on; run lengths are in units of
    /// `unit` iterations.
    ///
    /// # Errors
    /// When the unit is out of range, or the first planner cannot be made. Where a later planner cannot be made, the
    /// attempt before continues.
    pub fn new(
        schedule: Schedule,
        unit: u64,
        mut make: impl FnMut(u64) -> Result<P, BuildError> + Send + 'c,
    ) -> Result<Self, BuildError> {
        if !(1..=1_000_000_000_000).contains(&unit) {
            let range = UNIT.range.to_owned();
            return Err(BuildError::OutOfRange { name: UNIT.name, value: unit as f64, range });
        }
        let planner = make(1)?;
        Ok(Self {
            make: Box::new(make),
            schedule,
            unit,
            begun: None,
            planner,
            rng: Rng::seed(0),
            attempt: 1,
            allowed: 0,
            past: Progress::default(),
        })
    }

    /// The number of the current attempt, from 1.
    #[must_use]
    pub fn attempt(&self) -> u64 {
        self.attempt
    }

    /// The planner of the current attempt.
    #[must_use]
    pub fn planner(&self) -> &P {
        &self.planner
    }
}

impl<S, P: Planner<S>> Planner<S> for Restarts<'_, P> {
    type Edge = P::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S, P::Edge>> {
        let (seed, lengths) = self.begun.get_or_insert_with(|| {
            let seed = rng.random();
            (seed, self.schedule.lengths(Rng::stream(seed, 0)))
        });
        let done = self.planner.progress();
        if self.allowed == 0 {
            self.rng = Rng::stream(*seed, 1);
            self.allowed = lengths.next().unwrap_or(1).saturating_mul(self.unit);
        } else if done.iterations >= self.allowed {
            // If no new planner can be made, the present one runs as long again.
            match (self.make)(self.attempt + 1) {
                Err(_) => self.allowed = self.allowed.saturating_mul(2),
                Ok(planner) => {
                    self.planner = planner;
                    self.attempt += 1;
                    self.rng = Rng::stream(*seed, self.attempt);
                    self.allowed = lengths.next().unwrap_or(1).saturating_mul(self.unit);
                    self.past.iterations += done.iterations;
                    self.past.motions += done.motions;
                    self.past.rejected += done.rejected;
                    for tree in 0..2 {
                        observer.on(Event::Pruned { tree, survivors: &[] });
                    }
                }
            }
        }
        self.planner.step(&mut self.rng, observer)
    }

    /// Nodes are those of the current attempt; the rest are sums over all attempts.
    fn progress(&self) -> Progress {
        let mut progress = self.planner.progress();
        progress.iterations += self.past.iterations;
        progress.motions += self.past.motions;
        progress.rejected += self.past.rejected;
        progress
    }
}

impl<P: fmt::Debug> fmt::Debug for Restarts<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Restarts")
            .field("schedule", &self.schedule)
            .field("unit", &self.unit)
            .field("attempt", &self.attempt)
            .field("planner", &self.planner)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn luby_is_the_known_sequence() {
        // t(i) = 2^(k-1) if i = 2^k - 1, else t(i - 2^(k-1) + 1) for 2^(k-1) <= i < 2^k - 1.
        fn luby(i: u64) -> u64 {
            let k = (i + 1).next_power_of_two();
            if k == i + 1 { k / 2 } else { luby(i - k / 2 + 1) }
        }
        let lengths: Vec<u64> = Schedule::Luby.lengths(Rng::seed(0)).take(2000).collect();
        assert_eq!(lengths, (1..=2000).map(luby).collect::<Vec<_>>());
    }

    #[test]
    fn shares_of_the_lengths_fall_with_the_square() {
        for schedule in [Schedule::Counter, Schedule::Zeta] {
            let lengths: Vec<u64> = schedule.lengths(Rng::seed(1)).take(100_000).collect();
            let ones = lengths.iter().filter(|t| **t == 1).count() as f64;
            for t in 2..6 {
                let share = lengths.iter().filter(|s| **s == t).count() as f64 / ones;
                assert!((share * (t * t) as f64 - 1.0).abs() < 0.1, "{schedule:?} {t}: {share}");
            }
        }
    }
}
