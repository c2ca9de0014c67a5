//! One run of a planner.

use super::measured::Measured;
use super::metrics;
use super::mover::Mover;
use super::options::Options;
use super::progress::Line;
use super::setting::Setting;
use crate::cli::{Length, Motion};
use miette::{IntoDiagnostic, Result};
use mp::cspace::{
    Cancel, Certified, Clearance, Deadline, DefaultNn, Discrete, Iterations, MetricOn, MotionBound,
    MotionValidity, NearestNeighbors, ObstacleHints, Outcome, ParameterError, Path, Progress, Resolution,
    Rng, Room, Space, Stop, StopReason, Straight, Stretch, Validity, WithMetric,
};
use mp::cspace::{ClearanceGradient, shorten::reduce, verify_path};
use mp::robot::{Arm, RigidBody};
use mp::snake::{Params, Repulsion, relax};
use mp::tree::{BuildError, Goals, Problem, build_from, build_snake, improve, snake_planners};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// From how far obstacles push a path that is relaxed, as a part of the extent.
const RELAX_RANGE: f64 = 0.03;
/// How much longer relaxing may make what is left after needless states.
const MOST_STRETCH: f64 = 1.15;

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
    let space = &setting.space;
    let run = Run {
        space,
        robot: &setting.robot,
        verifier: setting.verifier()?,
        start: &setting.start,
        goals: vec![setting.goal.clone()],
        tolerance: setting.tolerance,
        options,
        seed,
        cancel,
    };
    if options.metric == metrics::Kind::Default {
        return run.on(space, <M::Space as DefaultNn>::Nn::default(), line);
    }
    let scaled = || M::scaled(space, setting.radius);
    let displacement = || M::displacement(&setting.problem.robot.mesh);
    let measured = Measured::<M>::new(space, options.metric, scaled, displacement)?;
    run.on(&measured, measured.index(), line)
}

pub(crate) fn with<C: Space + Clone, D: MetricOn<C>>(space: &C, metric: D) -> WithMetric<C, D> {
    WithMetric::new(space.clone(), metric)
}

/// What counts collision queries.
pub(crate) trait Queries {
    /// How many were asked so far.
    fn queries(&self) -> u64;
}

impl<M: Mover> Queries for RigidBody<M> {
    fn queries(&self) -> u64 {
        let counters = self.counters();
        counters.collision_checks + counters.clearance_checks
    }
}

impl Queries for Arm {
    fn queries(&self) -> u64 {
        let counters = self.counters();
        counters.collision_checks + counters.clearance_checks
    }
}

/// A robot whose counters go into a common sum when it is dropped.
struct Counted<'a, R: Queries> {
    robot: R,
    queries: &'a AtomicU64,
}

impl<R: Queries> Drop for Counted<'_, R> {
    fn drop(&mut self) {
        self.queries.fetch_add(self.robot.queries(), Ordering::Relaxed);
    }
}
impl<S, R: Validity<S> + Queries> Validity<S> for Counted<'_, R> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.robot.is_valid(q)
    }
    fn first_invalid(&mut self, states: &[S]) -> Option<usize> {
        self.robot.first_invalid(states)
    }
    fn batch_size(&self) -> usize {
        self.robot.batch_size()
    }
}
impl<S, R: Clearance<S> + Queries> Clearance<S> for Counted<'_, R> {
    fn clearance(&mut self, q: &S, enough: f64) -> f64 {
        self.robot.clearance(q, enough)
    }
    fn in_contact(&mut self, q: &S) -> bool {
        self.robot.in_contact(q)
    }
    fn room(&mut self, stretch: &Stretch<'_, S>) -> Room {
        self.robot.room(stretch)
    }
}
impl<S, R: MotionBound<S> + Queries> MotionBound<S> for Counted<'_, R> {
    fn motion_bound(&self, from: &S, to: &S) -> f64 {
        self.robot.motion_bound(from, to)
    }
}

impl<S, R: ObstacleHints<S> + Queries> ObstacleHints<S> for Counted<'_, R> {
    fn touches(&mut self, q: &S) -> bool {
        self.robot.touches(q)
    }
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        self.robot.along(from, toward, hit, rng)
    }
    fn turned(&self, position: &S, rotation: &S) -> S {
        self.robot.turned(position, rotation)
    }
    fn carried(&self, q: &S, from: &S, to: &S) -> S {
        self.robot.carried(q, from, to)
    }
}

impl<S, R: ClearanceGradient<S> + Queries> ClearanceGradient<S> for Counted<'_, R> {
    fn clearance_gradient(&mut self, q: &S, reach: f64, gradient: &mut [f64]) -> f64 {
        self.robot.clearance_gradient(q, reach, gradient)
    }
}

/// One run: the same for robots of all kinds.
pub(crate) struct Run<'a, B: Space, R, V> {
    /// The space with its own metric.
    pub(crate) space: &'a B,
    pub(crate) robot: &'a R,
    pub(crate) verifier: V,
    pub(crate) start: &'a B::State,
    pub(crate) goals: Vec<B::State>,
    /// Of certified motions, metres.
    pub(crate) tolerance: f64,
    pub(crate) options: &'a Options,
    pub(crate) seed: u64,
    pub(crate) cancel: &'a Cancel,
}

impl<'a, B, R, V> Run<'a, B, R, V>
where
    B: Space,
    R: Validity<B::State> + Clearance<B::State> + MotionBound<B::State> + ObstacleHints<B::State>,
    R: ClearanceGradient<B::State> + Queries + Clone + Send + Sync,
    V: MotionValidity<B::State> + Clone + Send + Sync,
{
    /// The motion check that the options ask for.
    fn check<'c, C: Space<State = B::State>>(
        &self,
        space: &'c C,
        queries: &'c AtomicU64,
    ) -> Result<Box<dyn MotionValidity<B::State> + Send + 'c>, ParameterError>
    where
        'a: 'c,
        R: 'c,
    {
        let robot = Counted { robot: self.robot.clone(), queries };
        Ok(match self.options.motion {
            Motion::Certified => Box::new(Certified::new(self.space, robot, self.tolerance)?),
            Motion::Discrete(length) => {
                let resolution = match length {
                    Length::Absolute(v) => Resolution::Length(v),
                    Length::Fraction(f) => Resolution::Fraction(f),
                };
                Box::new(Discrete::new(space, robot, resolution)?)
            }
        })
    }

    /// The path without the states it does not need, relaxed by a snake: where that is not free by the verifier, the
    /// path itself. In the own metric of the space it is no longer than the path.
    fn relaxed(&self, path: Path<B::State>) -> Result<Path<B::State>> {
        let range = RELAX_RANGE * self.space.extent();
        let mut check = Certified::new(self.space, self.robot.clone(), self.tolerance).into_diagnostic()?;
        let mut field = Repulsion::new(self.robot.clone(), range).into_diagnostic()?;
        let short = reduce(self.space, &mut check, &path);
        let [found, least] = [&path, &short].map(|path| path.length(self.space));
        let params =
            Params { straighten: 0.5, iterations: 200, ..Params::for_range(range).into_diagnostic()? };
        // Safety may cost some length, of what was saved.
        let stretch = if least > 0.0 { (found / least).clamp(1.0, MOST_STRETCH) } else { 1.0 };
        let relaxed =
            relax(self.space, &mut check, &mut field, &short, params, stretch).into_diagnostic()?.path;
        let verified = verify_path(self.space, &relaxed, &mut self.verifier.clone());
        if let Some(fault) = verified.fault {
            tracing::info!("the relaxed path does not pass the verifier: {fault}");
            return Ok(path);
        }
        tracing::info!("relaxed: length {found} to {}", relaxed.length(self.space));
        Ok(relaxed)
    }

    /// Plans in `space`, which differs from that of the run in its metric only.
    pub(crate) fn on<C, N>(&self, space: &C, index: N, line: &mut Line) -> Result<Search<B::State>>
    where
        C: Space<State = B::State>,
        N: NearestNeighbors<C> + Clone + Send + Sync + 'static,
    {
        let options = self.options;
        let queries = AtomicU64::new(0);
        let began = Instant::now();
        let (outcome, progress, first) = {
            let problem = || {
                let unmade = |e: ParameterError| BuildError::Unmade { reason: e.to_string() };
                let check = self.check(space, &queries).map_err(unmade)?;
                let goal = Goals::states(self.goals.iter().cloned());
                let (local, verifier) = (Straight::new(space, check), self.verifier.clone());
                let problem = Problem::new(space, local, verifier, self.start.clone(), goal)?;
                Ok(problem.with_hints(Counted { robot: self.robot.clone(), queries: &queries }))
            };
            let name = options.planner.to_string();
            let bends = snake_planners().iter().any(|info| info.name == name);
            let mut planner = if bends {
                let field = Counted { robot: self.robot.clone(), queries: &queries };
                problem().and_then(|problem| build_snake(&name, problem, field, index, &options.settings))
            } else {
                build_from(&name, problem, index, &options.settings, &options.workers)
            }
            .into_diagnostic()?;
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
                (Some(path), _) if options.relax => Outcome::Solved(self.relaxed(path)?),
                (Some(path), _) => Outcome::Solved(path),
                (None, reason) => Outcome::Stopped(reason.unwrap_or(StopReason::Cancelled)),
            };
            (outcome, planner.progress(), first)
        };
        Ok(Search { outcome, progress, queries: queries.into_inner(), time: began.elapsed(), first })
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
