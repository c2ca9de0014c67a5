//! OR-parallel planning: independent runs of one planner; the first to find a path wins.
//!
//! S. Carpin and E. Pagello, *On parallel RRTs for multi-robot systems*, Proc. 8th Conf. of the
//! Italian Association for Artificial Intelligence, 2002. There the fastest processor wins; here
//! the run with the fewest iterations does, so that the answer does not depend on the machine.
//!
//! With n planners for the same problem, run i drawing from stream (seed, i):
//! 1. a round: each run makes `slice` iterations, or fewer if it finds a path; the runs are shared
//!    out to the threads;
//! 2. when runs have found a path, the one with the fewest iterations wins, of those the lowest i;
//! 3. otherwise the next round. So no run goes more than one slice beyond the winner, as it could not win any
//!    more.
//!
//! The seed is the first number drawn from the generator of the first step. One step is one round.
//!
//! **When to use it.** On several cores, for problems where the time of a run varies much: then the shortest
//! of n runs is far shorter than the mean. It helps on a single core too where the times have a heavy tail;
//! [restarts](super::restarts) do that with one tree in memory at a time.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `runs`: how many independent runs, for any number of threads | 1, 2, … 1024 | 8 |
//! | `slice`: iterations of each run per round; budgets of iterations, nodes and motions are kept to within one slice | 1, 2, … 10⁶ | 32 |
//!
//! and those of the planner that is run. By name it is `or-` and the name of that, as in
//! `or-rrt-connect`; [`build_from`](crate::build_from) makes it.
//!
//! Observers see only the events of [`solve`](Planner::solve), not those of the runs. A run in which the
//! user's code panics loses that iteration, which is [counted](OrParallel::panics), and goes on. When all
//! runs panic in one round, the step panics in the calling thread, with the message of the first.
//!
//! Eight runs on two threads:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{OrParallel, Problem, RrtConnect, Tuning, Workers};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.02;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.1), Vector2::new(0.9, 0.1));
//! let run = |_| {
//!     let problem = Problem::new(&space, local.clone(), verifier.clone(), start, goal)?;
//!     RrtConnect::new(problem, Tuning::default())
//! };
//! let solve = |threads| {
//!     let mut planner = OrParallel::new(8, 32, Workers::new(threads)?, run)?;
//!     Ok::<_, mp_tree::BuildError>(planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ()))
//! };
//! let outcome = solve(2)?;
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! assert_eq!(outcome, solve(1)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::{BuildError, Parameter, Workers, trace};
use mp_cspace::{Interrupt, Observer, Path, Planner, Progress, Rng};
use rand::RngExt;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// The setting `runs`: the result depends on it, not on the number of threads.
pub const RUNS: Parameter = Parameter {
    name: "runs",
    range: "a whole number from 1 to 1024",
    default: "8",
    doc: "independent runs, for any number of threads; the one with the fewest iterations wins",
};

/// How long a round is.
pub const SLICE: Parameter = Parameter {
    name: "slice",
    range: "a whole number from 1 to 1000000",
    default: "32",
    doc: "iterations of each run per round",
};

/// A planner with random numbers of its own.
#[derive(Debug)]
struct Run<P, F> {
    planner: P,
    rng: Rng,
    found: Option<F>,
    panicked: Option<Box<dyn Any + Send>>,
}

/// OR-parallel planning: see the [module](self).
#[derive(Debug)]
pub struct OrParallel<S, P: Planner<S>> {
    runs: Vec<Run<P, Path<S, P::Edge>>>,
    slice: u64,
    workers: Workers,
    begun: bool,
    winner: Option<usize>,
    panics: u64,
    interrupt: Interrupt,
}

impl<S, P: Planner<S>> OrParallel<S, P> {
    /// `runs` planners, run `i` made by `make(i)`, in rounds of `slice` iterations.
    ///
    /// # Errors
    /// When a number is out of range, or a planner cannot be made.
    pub fn new(
        runs: u64,
        slice: u64,
        workers: Workers,
        make: impl FnMut(u64) -> Result<P, BuildError>,
    ) -> Result<Self, BuildError> {
        let check = |name, value: u64, most: u64| match (1..=most).contains(&value) {
            true => Ok(()),
            false => {
                let range = format!("a whole number from 1 to {most}");
                Err(BuildError::OutOfRange { name, value: value as f64, range })
            }
        };
        check(RUNS.name, runs, 1024)?;
        check(SLICE.name, slice, 1_000_000)?;
        let planners = (0..runs).map(make).collect::<Result<Vec<P>, BuildError>>()?;
        let run = |planner| Run { planner, rng: Rng::seed(0), found: None, panicked: None };
        let runs = planners.into_iter().map(run).collect();
        let interrupt = Interrupt::never();
        Ok(Self { runs, slice, workers, begun: false, winner: None, panics: 0, interrupt })
    }

    /// Ends a round early when `interrupt` says so. The problems of the planners have clones of it:
    /// [`Problem::with_interrupt`](crate::Problem::with_interrupt).
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt) -> Self {
        Self { interrupt, ..self }
    }

    /// The run that found the path returned last.
    #[must_use]
    pub fn winner(&self) -> Option<usize> {
        self.winner
    }

    /// How often a run has panicked in a round in which not all did.
    #[must_use]
    pub fn panics(&self) -> u64 {
        self.panics
    }

    /// The planner of each run, in the order of the runs.
    pub fn planners(&self) -> impl Iterator<Item = &P> {
        self.runs.iter().map(|run| &run.planner)
    }
}

impl<S: Send, P: Planner<S, Edge: Send> + Send> Planner<S> for OrParallel<S, P> {
    type Edge = P::Edge;

    fn step(&mut self, rng: &mut Rng, _: &mut dyn Observer<S>) -> Option<Path<S, P::Edge>> {
        if !self.begun {
            let seed = rng.random();
            for (i, run) in self.runs.iter_mut().enumerate() {
                run.rng = Rng::stream(seed, i as u64);
            }
            self.begun = true;
        }
        let (slice, interrupt) = (self.slice, &self.interrupt);
        self.workers.each(&mut self.runs, |run| {
            let mut interrupt = interrupt.clone();
            for _ in 0..slice {
                if interrupt.ask() {
                    return;
                }
                let step = catch_unwind(AssertUnwindSafe(|| run.planner.step(&mut run.rng, &mut ())));
                match step {
                    Ok(None) => {}
                    Ok(path) => return run.found = path,
                    Err(panic) => return run.panicked = Some(panic),
                }
            }
        });
        let mut panic = None;
        let mut all = true;
        for run in &mut self.runs {
            let panicked = run.panicked.take();
            self.panics += u64::from(panicked.is_some());
            all &= panicked.is_some();
            panic = panic.or(panicked);
        }
        if let (true, Some(panic)) = (all, panic) {
            resume_unwind(panic);
        }
        let ended = self.runs.iter().enumerate().filter(|(_, run)| run.found.is_some());
        let iterations = |run: &Run<P, _>| run.planner.progress().iterations;
        let winner = ended.map(|(i, run)| (iterations(run), i)).min();
        let (iterations, winner) = winner?;
        trace::won(winner, iterations);
        self.winner = Some(winner);
        let mut found = self.runs.iter_mut().map(|run| run.found.take()).collect::<Vec<_>>();
        found.swap_remove(winner)
    }

    /// Iterations are those of the run that made most; the rest are sums over all runs.
    fn progress(&self) -> Progress {
        let mut sum = Progress::default();
        for progress in self.planners().map(Planner::progress) {
            sum.iterations = sum.iterations.max(progress.iterations);
            sum.nodes += progress.nodes;
            sum.motions += progress.motions;
            sum.rejected += progress.rejected;
        }
        sum
    }
}
