//! Restarts: a planner that takes too long is started again, with other random numbers.
//!
//! The time to a path varies with the random numbers, and its distribution often has a heavy tail: a tree
//! that begins badly continues badly. A restart after a fixed number of iterations cuts the tail, but the
//! best number is not known. Without knowing the distribution, these schedules come within a logarithmic
//! factor of the best:
//!
//! - `luby`: M. Luby, A. Sinclair and D. Zuckerman, *Optimal speedup of Las Vegas algorithms*,
//!   Information Processing Letters 47, 1993. Run lengths 1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8, …:
//!   whenever two runs of one length have been made, one of twice that follows.
//! - `counter`: in the manner of the counter search of N. Amato, S. Ashur and S. Har-Peled, *Faster motion
//!   planning via restarts*, 2025, and S. Ashur and S. Har-Peled, *Quickly avoiding a random
//!   catastrophe*, 2025. A counter goes up 1, 2, 3, …; at each count n there is a run of every length t for
//!   which t² divides n. So all lengths are swept at once, length t in one of t² counts: the same shares as
//!   `zeta`, but deterministic.
//! - `zeta`: the ζ(2) search of the same two papers. Each run length t is drawn with probability
//!   6/(π·t)².
//! - `wide`: in the manner of the wide search of the second paper. No run is ever dropped: all are paused and
//!   continued, the k-th run at 1/k of the speed of the first. At each count n = 1, 2, 3, … every run k that
//!   divides n makes one unit more, and run n begins. It keeps the trees of all its runs, n of them after
//!   about n·ln n units.
//!
//! Repeat:
//! 1. make a planner for attempt k = 1, 2, …, which draws from stream (seed, k);
//! 2. let it make as many iterations as the schedule says, times `unit`;
//! 3. when it finds a path, return the path; otherwise drop the planner (`wide`: pause it).
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
//! With steps of 20% no unit is better than no restarts, as resampling those 100 runs shows. All four
//! schedules on three problems with heavy tails are measured in `docs/results/rsrt.md`: `counter` and `luby`
//! are the best on each.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `schedule`: which run lengths | `luby`, `counter`, `zeta`, `wide` | `luby` |
//! | `unit`: iterations of a run of length 1 | 1, 2, … 10¹² | 1000 |
//!
//! and those of the planner that is restarted. By name it is `restart-` and the name of that, as in
//! `restart-rrt-connect`; [`build_from`](crate::build_from) makes it.
//!
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, Restarts, RrtConnect, Schedule, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.02;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
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

use crate::{BuildError, Parameter, Settings, trace};
use mp_cspace::{Event, Observer, Path, Planner, Progress, Rng};
use rand::RngExt;
use std::fmt;

/// The setting `schedule`: a [`Schedule`] by name.
pub const SCHEDULE: Parameter = Parameter {
    name: "schedule",
    range: "luby, counter, zeta or wide",
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
    /// All runs by turns of one unit, run k in one of k rounds; none is dropped.
    Wide,
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
            "wide" => Some(Self::Wide),
            _ => None,
        };
        Ok(settings.choice(SCHEDULE.name, SCHEDULE.range, named)?.unwrap_or_default())
    }

    /// The run lengths, in units; `rng` is used by [`Zeta`](Self::Zeta) alone. For [`Wide`](Self::Wide) these
    /// are the turns, one unit each; [`Lengths::run`] says whose turn it is.
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

impl Lengths {
    /// Which run, counted from 1, the last length belongs to, where runs take turns ([`Schedule::Wide`]).
    /// `None` where each length is that of a new run.
    #[must_use]
    pub fn run(&self) -> Option<u64> {
        (self.schedule == Schedule::Wide).then_some(self.length)
    }
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
            Schedule::Wide => {
                // `length` is the run: the divisors of the count, ascending; the count itself is the new run.
                loop {
                    (self.count, self.length) = match self.length >= self.count {
                        true => (self.count + 1, 1),
                        false => (self.count, self.length + 1),
                    };
                    if self.count.is_multiple_of(self.length) {
                        break 1;
                    }
                }
            }
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

/// A planner under way, with its random numbers.
#[derive(Debug)]
struct Attempt<P> {
    number: u64,
    planner: P,
    rng: Rng,
    /// How many iterations it may have made at the end of its turn.
    allowed: u64,
}

/// Restarts: see the [module](self).
pub struct Restarts<'c, P> {
    make: Box<dyn FnMut(u64) -> Result<P, BuildError> + Send + 'c>,
    schedule: Schedule,
    unit: u64,
    begun: Option<(u64, Lengths)>,
    current: Attempt<P>,
    /// Where attempts take turns, those that wait.
    paused: Vec<Attempt<P>>,
    /// How many attempts were made.
    made: u64,
    /// The progress of attempts that were dropped.
    past: Progress,
}

impl<'c, P> Restarts<'c, P> {
    /// Restarts of the planner that `make` makes, given the number of the attempt from 1 on; run lengths are
    /// in units of `unit` iterations.
    ///
    /// # Errors
    /// When the unit is out of range, or the first planner cannot be made. Where a later planner cannot be
    /// made, the attempt before continues.
    pub fn new(
        schedule: Schedule,
        unit: u64,
        mut make: impl FnMut(u64) -> Result<P, BuildError> + Send + 'c,
    ) -> Result<Self, BuildError> {
        if !(1..=1_000_000_000_000).contains(&unit) {
            let range = UNIT.range.to_owned();
            return Err(BuildError::OutOfRange { name: UNIT.name, value: unit as f64, range });
        }
        let current = Attempt { number: 1, planner: make(1)?, rng: Rng::seed(0), allowed: 0 };
        Ok(Self {
            make: Box::new(make),
            schedule,
            unit,
            begun: None,
            current,
            paused: Vec::new(),
            made: 1,
            past: Progress::default(),
        })
    }

    /// The number of the current attempt, from 1.
    #[must_use]
    pub fn attempt(&self) -> u64 {
        self.current.number
    }

    /// The planner of the current attempt.
    #[must_use]
    pub fn planner(&self) -> &P {
        &self.current.planner
    }
}

impl<P> Restarts<'_, P> {
    /// Gives the turn to the attempt whose it is, a new one or a paused one.
    fn next_turn<S>(&mut self, observer: &mut dyn Observer<S>)
    where
        P: Planner<S>,
    {
        let Some((seed, lengths)) = &mut self.begun else { return };
        let units = lengths.next().unwrap_or(1).saturating_mul(self.unit);
        let run = lengths.run();
        if let Some(waiting) = self.paused.iter().position(|attempt| Some(attempt.number) == run) {
            std::mem::swap(&mut self.current, &mut self.paused[waiting]);
        } else if run.is_none_or(|run| run > self.made) {
            match (self.make)(self.made + 1) {
                // The present attempt goes on for the length of the new one.
                Err(_) => {}
                Ok(planner) => {
                    self.made += 1;
                    let rng = Rng::stream(*seed, self.made);
                    let new = Attempt { number: self.made, planner, rng, allowed: 0 };
                    let before = std::mem::replace(&mut self.current, new);
                    let iterations = self.past.iterations + before.planner.progress().iterations;
                    trace::restarted(self.made, iterations);
                    if run.is_some() {
                        self.paused.push(before);
                    } else {
                        let done = before.planner.progress();
                        self.past.iterations += done.iterations;
                        self.past.motions += done.motions;
                        self.past.rejected += done.rejected;
                        (0..2).for_each(|tree| observer.on(Event::Pruned { tree, survivors: &[] }));
                    }
                }
            }
        }
        self.current.allowed = self.current.planner.progress().iterations.saturating_add(units);
    }
}

impl<S, P: Planner<S>> Planner<S> for Restarts<'_, P> {
    type Edge = P::Edge;

    /// With [`Schedule::Wide`] the observer sees the first attempt alone, which is under way all the time.
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S, P::Edge>> {
        if self.begun.is_none() {
            let seed = rng.random();
            let mut lengths = self.schedule.lengths(Rng::stream(seed, 0));
            self.current.allowed = lengths.next().unwrap_or(1).saturating_mul(self.unit);
            self.current.rng = Rng::stream(seed, 1);
            self.begun = Some((seed, lengths));
        } else if self.current.planner.progress().iterations >= self.current.allowed {
            self.next_turn(observer);
        }
        let seen = self.schedule != Schedule::Wide || self.current.number == 1;
        let observer: &mut dyn Observer<S> = if seen { observer } else { &mut () };
        self.current.planner.step(&mut self.current.rng, observer)
    }

    /// Nodes are those of the attempts that are kept; the rest are sums over all attempts.
    fn progress(&self) -> Progress {
        let mut progress = self.current.planner.progress();
        progress.iterations += self.past.iterations;
        progress.motions += self.past.motions;
        progress.rejected += self.past.rejected;
        for attempt in &self.paused {
            let paused = attempt.planner.progress();
            progress.iterations += paused.iterations;
            progress.motions += paused.motions;
            progress.rejected += paused.rejected;
            progress.nodes += paused.nodes;
        }
        progress
    }
}

impl<P: fmt::Debug> fmt::Debug for Restarts<'_, P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Restarts")
            .field("schedule", &self.schedule)
            .field("unit", &self.unit)
            .field("current", &self.current)
            .field("paused", &self.paused.len())
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

    /// Run k has had ⌊n/k⌋ turns after count n, and is begun at count k.
    #[test]
    fn wide_runs_are_slower_by_their_number() {
        let mut lengths = Schedule::Wide.lengths(Rng::seed(0));
        let runs: Vec<u64> = std::iter::from_fn(|| (lengths.next(), lengths.run()).1).take(10).collect();
        assert_eq!(runs, [1, 1, 2, 1, 3, 1, 2, 4, 1, 5]);
        let mut turns = vec![0; 61];
        let mut lengths = Schedule::Wide.lengths(Rng::seed(0));
        loop {
            assert_eq!(lengths.next(), Some(1));
            let run = lengths.run().unwrap() as usize;
            turns[run] += 1;
            if run == 60 {
                break;
            }
        }
        (1..=60).for_each(|k| assert_eq!(turns[k], 60 / k, "run {k}"));
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
