//! One run of a planner.

use super::chosen::Chosen;
use super::counted::{AnyRoadmap, Asked, Counted, Knows, Queries};
use super::options::Options;
use super::progress::Line;
use crate::bench::{Processor, nanoseconds};
use crate::cli::{Length, Motion};
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::{
    Cancel, Certified, Clearance, Deadline, Discrete, Iterations, MetricOn, MotionBound, MotionValidity,
    NearestNeighbors, Numbers, ObstacleHints, Outcome, ParameterError, Path, Planner, Progress, Resolution,
    Rng, Space, Stop, StopReason, Straight, Validity, WithMetric,
};
use mp::cspace::{ClearanceGradient, shorten::reduce, verify_path};
use mp::roadmap::{HasRoadmap, Roadmap, Team, build_with};
use mp::snake::{Params, Repulsion, relax};
use mp::tree::{AnyPlanner, BuildError, Goals, Problem, build_from, improve};
use std::sync::atomic::AtomicU64;
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
    /// Seconds of processor time.
    pub(crate) processor: f64,
    /// When the first path was found and how long it was in the metric, of a planner that goes on for better ones.
    pub(crate) first: Option<(Duration, f64)>,
    /// Of a planner that builds a roadmap.
    pub(crate) map: Option<Map>,
    /// The roadmap itself, of a bare search.
    pub(crate) roadmap: Option<Roadmap<S>>,
}

/// What there is in a roadmap.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Map {
    pub(crate) edges: usize,
    pub(crate) components: usize,
}

pub(crate) fn with<C: Space + Clone, D: MetricOn<C>>(space: &C, metric: D) -> WithMetric<C, D> {
    WithMetric::new(space.clone(), metric)
}

/// A planner made by name.
enum Grower<'p, S> {
    Tree(AnyPlanner<'p, S, ()>),
    Roadmap(AnyRoadmap<'p, S>),
}

impl<'p, S> Grower<'p, S> {
    fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        match self {
            Self::Tree(planner) => &mut **planner,
            Self::Roadmap(planner) => &mut **planner,
        }
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
    /// Of scene, robot and metric, where a roadmap is kept.
    pub(crate) fingerprint: Option<u64>,
    /// Of certified motions, metres.
    pub(crate) tolerance: f64,
    pub(crate) options: &'a Options,
    pub(crate) seed: u64,
    pub(crate) cancel: &'a Cancel,
}

impl<'a, B, R, V> Run<'a, B, R, V>
where
    B: Space<State: Numbers>,
    R: Validity<B::State> + Clearance<B::State> + MotionBound<B::State> + ObstacleHints<B::State>,
    R: ClearanceGradient<B::State> + Queries + Knows<B::State> + Clone + Send + Sync,
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
        let robot = Counted::new(self.robot.clone(), queries);
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

    /// A planner that goes on with the roadmap that is kept, if there is one.
    fn resumed<'p>(&self, mut planner: AnyRoadmap<'p, B::State>) -> Result<AnyRoadmap<'p, B::State>> {
        if let (Some(file), Some(fingerprint)) = (&self.options.roadmap, self.fingerprint)
            && file.exists()
        {
            let help = "name another file, or delete it to begin anew";
            let map = Roadmap::load(file, fingerprint).map_err(|e| miette!(help = help, "{e}"))?;
            planner.resume(map).into_diagnostic()?;
        }
        Ok(planner)
    }

    /// Writes the roadmap where it is to be kept, and says what is in it.
    fn keep(&self, planner: &mut dyn HasRoadmap<B::State, ()>) -> Result<Map> {
        if let (Some(file), Some(fingerprint)) = (&self.options.roadmap, self.fingerprint) {
            crate::output::write(file, &planner.map().to_bytes(fingerprint))?;
        }
        Ok(Map { edges: planner.map().edges(), components: planner.map_mut().components() })
    }

    /// Plans in `space`, which differs from that of the run in its metric only.
    pub(crate) fn on<C, N>(&self, space: &C, index: N, line: &mut Line) -> Result<Search<B::State>>
    where
        C: Space<State = B::State> + Clone,
        N: NearestNeighbors<C> + Clone + Send + Sync + 'static,
    {
        let options = self.options;
        let queries = AtomicU64::new(0);
        let (began, used) = (Instant::now(), nanoseconds());
        let (outcome, progress, first, map, roadmap, time, processor) = {
            let problem = || {
                let unmade = |e: ParameterError| BuildError::Unmade { reason: e.to_string() };
                let check = self.check(space, &queries).map_err(unmade)?;
                let goal = Goals::states(self.goals.iter().cloned());
                let (local, verifier) = (Straight::new(space, check), self.verifier.clone());
                let problem = Problem::new(space, local, verifier, self.start.clone(), goal)?;
                Ok(problem.with_obstacles(self.robot.knowledge(&queries)))
            };
            let mut planner = match &options.planner {
                Chosen::Tree(named) => {
                    let (name, settings) = (named.to_string(), &options.settings);
                    let tree = build_from(&name, problem, index, settings, &options.workers);
                    Grower::Tree(tree.into_diagnostic()?)
                }
                Chosen::Roadmap(info) => {
                    let team =
                        Team::new(options.workers.clone(), options.threads, problem).into_diagnostic()?;
                    let made = build_with(info.name, team, index, &options.settings);
                    Grower::Roadmap(self.resumed(made.into_diagnostic()?)?)
                }
            };
            let mut stop = self
                .cancel
                .clone()
                .or(options.iterations.map(Iterations))
                .or(began.checked_add(options.time).map(Deadline::at))
                .or(options.processor.map(|s| Processor { until: used + s * 1e9 }))
                .or(options.queries.map(|most| Asked { queries: &queries, most }))
                .or(line);
            let mut first = None;
            let improves = planner.planner().improves();
            let mut rng = Rng::seed(self.seed);
            let (best, reason) = match options.bare {
                true => match planner.planner().solve(&mut rng, &mut stop, &mut ()) {
                    Outcome::Solved(path) => (Some(path), None),
                    Outcome::Stopped(reason) => (None, Some(reason)),
                },
                false => improve(planner.planner(), &mut rng, &mut stop, &mut (), |path, _| {
                    first = first.or_else(|| improves.then(|| (began.elapsed(), path.length(space))));
                }),
            };
            let outcome = match (best, reason) {
                (Some(path), _) if options.relax => Outcome::Solved(self.relaxed(path)?),
                (Some(path), _) => Outcome::Solved(path),
                (None, reason) => Outcome::Stopped(reason.unwrap_or(StopReason::Cancelled)),
            };
            let (time, processor) = (began.elapsed(), (nanoseconds() - used) * 1e-9);
            let progress = planner.planner().progress();
            let (map, roadmap) = match &mut planner {
                Grower::Tree(_) => (None, None),
                Grower::Roadmap(planner) => {
                    (Some(self.keep(&mut **planner)?), options.bare.then(|| planner.map().clone()))
                }
            };
            (outcome, progress, first, map, roadmap, time, processor)
        };
        Ok(Search { outcome, progress, queries: queries.into_inner(), time, processor, first, map, roadmap })
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
