//! One run of a planner.

use super::metrics;
use super::mover::Mover;
use super::options::Options;
use super::progress::Line;
use super::setting::Setting;
use crate::cli::{Length, Motion};
use miette::{IntoDiagnostic, Result};
use mp::cspace::{
    Cancel, Certified, Deadline, DefaultNn, Discrete, Euclidean, Iterations, KdTree, Manhattan, MetricOn,
    MetricTree, MotionValidity, NearestNeighbors, Outcome, Path, Progress, Resolution, Rng, Space, Stop,
    StopReason, Straight, Validity, WithMetric,
};
use mp::tree::{Goals, Problem, build_with, improve};
use std::time::{Duration, Instant};

/// What a planner came back with.
#[derive(Clone, Debug)]
pub(crate) struct Search<S> {
    pub(crate) outcome: Outcome<Path<S>>,
    pub(crate) progress: Progress,
    /// Collision queries asked.
    pub(crate) queries: u64,
    pub(crate) time: Duration,
    /// When the first path was found and how long it was in the metric, of a planner that goes on for better ones.
    pub(crate) first: Option<(Duration, f64)>,
}

/// Plans from start to goal of `setting` with `seed`.
pub(crate) fn search<M: Mover>(
    setting: &Setting<M>,
    options: &Options,
    seed: u64,
    cancel: &Cancel,
    line: &mut Line,
) -> Result<Search<M::State>> {
    let run = Run { setting, options, seed, cancel };
    let space = &setting.space;
    match options.metric {
        metrics::Kind::Default => run.on(space, <M::Space as DefaultNn>::Nn::default(), line),
        metrics::Kind::Euclidean => run.on(&with(space, Euclidean), <KdTree>::default(), line),
        metrics::Kind::Manhattan => run.on(&with(space, Manhattan), <KdTree>::default(), line),
        metrics::Kind::Scaled => {
            run.on(&with(space, M::scaled(space, setting.radius)?), <KdTree>::default(), line)
        }
        metrics::Kind::MaxDisplacement => {
            let metric = M::displacement(&setting.problem.robot.mesh)?;
            run.on(&with(space, metric), MetricTree::default(), line)
        }
    }
}

fn with<C: Space + Clone, D: MetricOn<C>>(space: &C, metric: D) -> WithMetric<C, D> {
    WithMetric::new(space.clone(), metric)
}

/// A robot used for a while: its counters are looked at afterwards.
struct Lent<'a, R>(&'a mut R);

impl<S, R: Validity<S>> Validity<S> for Lent<'_, R> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.0.is_valid(q)
    }
    fn first_invalid(&mut self, states: &[S]) -> Option<usize> {
        self.0.first_invalid(states)
    }
    fn batch_size(&self) -> usize {
        self.0.batch_size()
    }
}

struct Run<'a, M: Mover> {
    setting: &'a Setting<M>,
    options: &'a Options,
    seed: u64,
    cancel: &'a Cancel,
}

impl<M: Mover> Run<'_, M> {
    /// Plans in `space`, which differs from that of the setting in its metric only.
    fn on<C, N>(&self, space: &C, index: N, line: &mut Line) -> Result<Search<M::State>>
    where
        C: Space<State = M::State>,
        N: NearestNeighbors<C> + Clone + Send + 'static,
    {
        let Self { setting, options, .. } = self;
        let (mut robot, verifier) = (setting.robot.clone(), setting.verifier()?);
        let began = Instant::now();
        let (outcome, progress, first) = {
            let check: Box<dyn MotionValidity<M::State> + Send> = match options.motion {
                Motion::Certified => {
                    Box::new(Certified::new(&setting.space, &mut robot, setting.tolerance).into_diagnostic()?)
                }
                Motion::Discrete(length) => {
                    let resolution = match length {
                        Length::Absolute(v) => Resolution::Length(v),
                        Length::Fraction(f) => Resolution::Fraction(f),
                    };
                    Box::new(Discrete::new(space, Lent(&mut robot), resolution).into_diagnostic()?)
                }
            };
            let goal = Goals::states([setting.goal.clone()]);
            let local = Straight::new(space, check);
            let problem =
                Problem::new(space, local, verifier, setting.start.clone(), goal).into_diagnostic()?;
            let mut planner =
                build_with(options.planner.name, problem, index, &options.settings).into_diagnostic()?;
            let mut stop = self
                .cancel
                .clone()
                .or(options.iterations.map(Iterations))
                .or(Deadline::at(began + options.time))
                .or(line);
            let mut first = None;
            let improves = planner.improves();
            let (best, reason) =
                improve(&mut *planner, &mut Rng::seed(self.seed), &mut stop, &mut (), |path, _| {
                    first = first.or_else(|| improves.then(|| (began.elapsed(), path.length(space))));
                });
            let outcome = match (best, reason) {
                (Some(path), _) => Outcome::Solved(path),
                (None, reason) => Outcome::Stopped(reason.unwrap_or(StopReason::Cancelled)),
            };
            (outcome, planner.progress(), first)
        };
        let counters = robot.counters();
        Ok(Search {
            outcome,
            progress,
            queries: counters.collision_checks + counters.clearance_checks,
            time: began.elapsed(),
            first,
        })
    }
}

/// The reason in a word.
pub(crate) fn word(reason: StopReason) -> &'static str {
    match reason {
        StopReason::Iterations => "iterations",
        StopReason::Deadline => "time",
        StopReason::Cancelled => "interrupted",
        _ => "budget",
    }
}
