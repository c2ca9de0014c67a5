//! A request prepared for a robot: the space, an index, a verifier, and the problems, planners and stops made from them.

use crate::counted::{Counted, QueryBudget};
use crate::goals;
use crate::planners::PlannerKind;
use crate::roadmaps::{GrowingFile, PlannerParts, RoadmapPlanner};
use crate::watch::{Events, WatchAdapter};
use crate::{Control, Error, Length, Measured, MotionValidator, Request, RobotKind};
use mp_cspace::erased::{AnyCheck, AnyIndex, AnySpace};
use mp_cspace::{
    AnyProblem, BuildError, Cancel, Certified, Clock, Deadline, Discrete, Iterations, KnownFree, MotionCheck,
    MotionValidity, Nodes, ParameterError, Problem, Resolution, Stop, Straight, Workers,
    registry::PlannerInfo,
};
use mp_tree::TreeState;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::time::Duration;

/// What the problems and planners of one request are made from.
pub(crate) struct Prepared<'k, K: RobotKind> {
    pub(crate) kind: &'k K,
    pub(crate) request: &'k Request,
    /// The space under the metric of the request.
    pub(crate) space: AnySpace<'k, K::State>,
    /// An empty index of it.
    pub(crate) index: AnyIndex<K::State>,
    verifier: K::Verifier<'k>,
    /// The common count of the queries of all checkers.
    pub(crate) queries: AtomicU64,
    /// Planners of roadmaps tell on several threads which queries are not to be counted: see `QueryMeter` of mp-roadmap.
    counts_exactly: bool,
}

impl<'k, K: RobotKind> Prepared<'k, K> {
    pub(crate) fn new(kind: &'k K, request: &'k Request) -> Result<Self, Error> {
        let planner = PlannerKind::new(&request.planner)?;
        planner.meets(kind)?;
        crate::relax::check(kind, request)?;
        let Measured { space, index } = kind.measured(request.metric)?;
        let (verifier, queries) = (kind.verifier()?, AtomicU64::new(0));
        let counts_exactly = matches!(planner, PlannerKind::Roadmap(_));
        Ok(Self { kind, request, space, index, verifier, queries, counts_exactly })
    }

    /// The problem of the scene. Each thread makes its own.
    pub(crate) fn problem(&self) -> Result<AnyProblem<'_, K::State>, BuildError> {
        let kind = self.kind;
        let counted = || {
            let counted = Counted::new(kind.checker().clone(), &self.queries);
            if self.counts_exactly { counted.exactly() } else { counted }
        };
        let check: AnyCheck<'_, K::State> = match self.request.motion {
            MotionValidator::Certified => {
                Box::new(build_error(Certified::new(kind.space(), counted(), kind.tolerance()))?)
            }
            MotionValidator::Discrete(length) => {
                Box::new(build_error(Discrete::new(&self.space, counted(), resolution(length)))?)
            }
        };
        let check: AnyCheck<'_, K::State> = Box::new(Possible { kind, check });
        let local = Straight::new(&self.space, check);
        let verifier: AnyCheck<'_, K::State> = Box::new(self.verifier.clone());
        let problem = Problem::new(&self.space, local, verifier, kind.start().clone(), goals::of_kind(kind))?;
        let problem = problem.with_obstacles(kind.obstacles(&counted));
        Ok(match kind.input_system() {
            Some(system) => problem.with_inputs(system),
            None => problem,
        })
    }

    /// The planner of trees called `name`.
    pub(crate) fn tree_planner(
        &self,
        name: &str,
        workers: &Workers,
    ) -> Result<mp_tree::AnyPlanner<'_, K::State, ()>, Error> {
        let (index, settings) = (self.index.clone(), self.request.settings());
        Ok(TreeState::tree_planner(name, Arc::new(|| self.problem()), index, &settings, workers)?)
    }

    /// A planner of roadmaps. It begins with the roadmap in `file`, if there is one.
    pub(crate) fn roadmap_planner(
        &self,
        info: &PlannerInfo,
        workers: Workers,
        file: Option<&GrowingFile<'_>>,
    ) -> Result<RoadmapPlanner<'_, K::State>, Error> {
        let parts = PlannerParts {
            problem: &|| self.problem(),
            index: self.index.clone(),
            settings: self.request.settings(),
            workers,
            threads: self.request.threads,
            queries: &self.queries,
        };
        RoadmapPlanner::new(info, parts, file)
    }

    /// Calls `run` with the stop and the observer of a run that has taken the time `spent`. It is stopped by the budget of
    /// the request and by the flag of `control`, and reported to the watch of `control`.
    pub(crate) fn watched<T>(
        &self,
        control: &mut Control<'_>,
        spent: Duration,
        run: impl FnOnce(&mut dyn Stop, &mut Events<'_, '_, '_, K::State>) -> T,
    ) -> T {
        let wanted = control.watch.as_ref().is_some_and(|watch| watch.wants_events());
        let adapter = WatchAdapter::new(control.watch.as_deref_mut(), control.clock);
        let stop = self.stop(spent, control.clock, control.cancel.clone());
        let mut stop = stop.or(control.stop.as_deref_mut()).or(&adapter);
        let (row, rows) = (&|q: &_| self.kind.row(q), &|path: &_| self.kind.rows(path));
        run(&mut stop, &mut Events { row, rows, adapter: &adapter, wanted })
    }

    /// When a run that has taken the time `spent` stops: by `cancel`, or by the budget of the request.
    fn stop(&self, spent: Duration, clock: Clock, cancel: Cancel) -> impl Stop {
        let budget = &self.request.budget;
        let time = budget.time_s.and_then(|s| Duration::try_from_secs_f64(s).ok());
        cancel
            .or(budget.iterations.map(Iterations))
            .or(budget.nodes.map(Nodes))
            .or(time.map(|time| Deadline::by(clock, time.saturating_sub(spent))))
            .or(budget.queries.map(|most| QueryBudget { queries: &self.queries, most }))
    }
}

/// A check that finds no motion free that the robot cannot make.
pub(crate) struct Possible<'k, K, M> {
    pub(crate) kind: &'k K,
    pub(crate) check: M,
}

impl<K: RobotKind, M: MotionValidity<K::State>> MotionValidity<K::State> for Possible<'_, K, M> {
    fn check_motion(&mut self, from: &K::State, to: &K::State) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }
    fn check_extension(&mut self, from: &K::State, to: &K::State, known: KnownFree) -> MotionCheck {
        match self.kind.can_move(from, to) {
            true => self.check.check_extension(from, to, known),
            false => MotionCheck::Unproven { at: 0.0 },
        }
    }
}

fn build_error<T>(made: Result<T, ParameterError>) -> Result<T, BuildError> {
    made.map_err(|e| BuildError::Unmade { reason: e.to_string() })
}

fn resolution(length: Length) -> Resolution {
    match length {
        Length::Absolute(v) => Resolution::Length(v),
        Length::Fraction(f) => Resolution::Fraction(f),
    }
}
