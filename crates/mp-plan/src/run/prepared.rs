//! A request prepared for a robot: the space, an index, a verifier, and the problems, planners and stops made from them.

use crate::run::auto;
use crate::run::planners::{PlannerKind, demands};
use crate::run::roadmaps::{GrowingFile, PlannerParts, RoadmapPlanner};
use crate::watch::{Events, WatchAdapter};
use crate::{Control, Error, Measured, MotionValidator, Request, Robot};
use mp_cspace::erased::{AnyCheck, AnyIndex, AnySpace};
use mp_cspace::{
    AnyProblem, BuildError, Configuration, Endpoint, Interrupt, Iterations, MotionCheck, MotionValidity,
    Nodes, ObstacleKnowledge, ParameterError, Problem, Stop, Straight, Workers, registry::PlannerInfo,
};
use mp_kinds::counted::QueryBudget;
use mp_kinds::field::TreeField;
use mp_kinds::goals;
use mp_kinds::motion::{AnyVerifier, By, Counting, motions};
use mp_kinds::possible::{Deadlines, Possible};
use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// What the problems and planners of one request are made from.
pub(crate) struct Prepared<'k> {
    pub(crate) kind: &'k dyn Robot,
    pub(crate) request: Cow<'k, Request>,
    /// The space under the metric of the request.
    pub(crate) space: AnySpace<'k, Configuration>,
    /// An empty index of it.
    pub(crate) index: AnyIndex<Configuration>,
    verifier: AnyVerifier<'k>,
    /// What pushes edges that bend, if it is not the clearance.
    field: Option<TreeField>,
    state: Arc<RunState>,
    /// Planners of roadmaps tell on several threads which queries are not to be counted: see `QueryMeter` of mp-roadmap.
    counts_exactly: bool,
    /// The searches of the portfolio [`auto`](super::auto), with their shares of a turn.
    pub(crate) members: Vec<(Prepared<'k>, f64)>,
}

/// What all problems of a run have in common.
#[derive(Default)]
struct RunState {
    /// The common count of the queries of all checkers.
    queries: AtomicU64,
    /// What the run asks whether to end.
    interrupt: Mutex<Interrupt>,
    deadlines: Deadlines,
    /// Whether the verification of a path was interrupted.
    unverified: AtomicBool,
    /// Whether paths are proved after the search instead of in it.
    proves_later: AtomicBool,
}

impl<'k> Prepared<'k> {
    pub(crate) fn new(kind: &'k dyn Robot, request: &'k Request) -> Result<Self, Error> {
        Self::with(kind, Cow::Borrowed(request))
    }

    /// The same once more.
    pub(crate) fn again(&self) -> Result<Self, Error> {
        Self::with(self.kind, self.request.clone())
    }

    fn with(kind: &'k dyn Robot, request: Cow<'k, Request>) -> Result<Self, Error> {
        let planner = PlannerKind::new(&request.planner)?;
        crate::finish::relax::check(kind, &request)?;
        request.objective.check(kind)?;
        planner.meets(kind, &demands(kind, !request.objective.is_length()))?;
        let state = Arc::<RunState>::default();
        let mut prepared = Self::of(kind, request, &planner, &state)?;
        if planner == PlannerKind::Auto {
            let members = auto::requests(kind, &prepared.request).into_iter();
            let members = members.map(|(member, share)| {
                let planner = PlannerKind::new(&member.planner)?;
                planner.meets(kind, kind.demands())?;
                Ok::<_, Error>((Self::of(kind, Cow::Owned(member), &planner, &state)?, share))
            });
            // What the robot cannot do is left out.
            prepared.members = members.filter_map(Result::ok).collect();
        }
        Ok(prepared)
    }

    fn of(
        kind: &'k dyn Robot,
        request: Cow<'k, Request>,
        planner: &PlannerKind,
        state: &Arc<RunState>,
    ) -> Result<Self, Error> {
        let Measured { space, index } = kind.measured(request.metric)?;
        let field = match planner.field(&request)? {
            None => None,
            Some(name) => {
                let range = request.settings().length_of(&mp_tree::algo::rrs::RANGE, &space)?;
                TreeField::new(kind, &name, range)?
            }
        };
        let (verifier, state) = (kind.any_verifier()?, Arc::clone(state));
        let counts_exactly = matches!(planner, PlannerKind::Roadmap(_));
        Ok(Self { kind, request, space, index, verifier, field, state, counts_exactly, members: Vec::new() })
    }

    /// The common count of the queries of all checkers.
    pub(crate) fn queries(&self) -> &AtomicU64 {
        &self.state.queries
    }

    /// Whether the path of a run may be proved after it, once, as it is written. Where motions are certified, the proof has nothing to reject,
    /// as a rule. Where a robot is sampled, a proof asks it more often than the search, and the path as found is hardly ever what is written. What a
    /// roadmap keeps is proved as it grows, and so is what `patience` says.
    pub(crate) fn can_prove_later(&self) -> bool {
        (motion(self.kind, &self.request) == MotionValidator::Certified || self.kind.sampled().is_some())
            && self.kind.input_system().is_none()
            && !self.counts_exactly
            && !self.request.settings.contains_key(mp_tree::PATIENCE.name)
    }

    /// Whether the verifier passes every motion from now on. Then whoever runs the search must prove its path.
    pub(crate) fn prove_later(&self, later: bool) {
        self.state.proves_later.store(later, Ordering::Relaxed);
    }

    /// Whether paths are proved after the search instead of in it.
    pub(crate) fn proves_later(&self) -> bool {
        self.state.proves_later.load(Ordering::Relaxed)
    }

    /// What the run asks whether to end. Problems made from now on do.
    pub(crate) fn interrupt_by(&self, interrupt: Interrupt) {
        *self.state.interrupt.lock().unwrap_or_else(PoisonError::into_inner) = interrupt;
    }

    pub(crate) fn interrupt(&self) -> Interrupt {
        self.state.interrupt.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Whether the run ended while a path that was found was verified.
    pub(crate) fn found_unverified(&self) -> bool {
        self.state.unverified.load(Ordering::Relaxed)
    }

    /// The problem of the scene. Each thread makes its own.
    pub(crate) fn problem(&self) -> Result<AnyProblem<'_, Configuration>, BuildError> {
        self.problem_until(self.interrupt())
    }

    /// The problem of the scene, which asks this token whether to end.
    pub(crate) fn problem_until(
        &self,
        interrupt: Interrupt,
    ) -> Result<AnyProblem<'_, Configuration>, BuildError> {
        let kind = self.kind;
        let counting = Counting::new(self.queries(), interrupt.clone()).exactly(self.counts_exactly);
        let by = match motion(kind, &self.request) {
            MotionValidator::Certified => By::Certificates(kind.tolerance()),
            MotionValidator::Discrete(length) => By::States(length),
        };
        let check = build_error(motions(kind, &self.space, by, &counting))?;
        let deadlines = Some(&self.state.deadlines);
        let check: AnyCheck<'_, Configuration> =
            Box::new(Possible { kind, check, interrupt: interrupt.clone(), deadlines });
        let local = Straight::new(&self.space, check);
        let mut verifier: AnyCheck<'_, Configuration> = Box::new(self.verifier.clone());
        verifier.interrupt_by(&interrupt);
        let verifier = Verifying { verifier, interrupt: interrupt.clone(), state: &self.state };
        let problem = Problem::new(&self.space, local, verifier, kind.start().clone(), goals::of_kind(kind));
        let problem = problem.map_err(|e| written(kind, e))?;
        let field = self.field.as_ref().map(TreeField::pushing);
        let known = ObstacleKnowledge { field, ..kind.any_obstacles(&counting) };
        let objective = self.request.objective.make(kind, &self.space, &counting);
        let problem = problem.with_obstacles(known).with_interrupt(interrupt);
        let problem = match objective.map_err(|e| BuildError::Unmade { reason: e.to_string() })? {
            Some(objective) => problem.with_objective(objective),
            None => problem,
        };
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
    ) -> Result<mp_tree::AnyPlanner<'_, Configuration, ()>, Error> {
        let (index, settings) = (self.index.clone(), self.request.settings());
        Ok(mp_tree::erased::build(name, Arc::new(|| self.problem()), index, &settings, workers)?)
    }

    /// A planner of roadmaps. It begins with the roadmap in `file`, if there is one.
    pub(crate) fn roadmap_planner(
        &self,
        info: &PlannerInfo,
        workers: Workers,
        file: Option<&GrowingFile<'_>>,
    ) -> Result<RoadmapPlanner<'_>, Error> {
        let parts = PlannerParts {
            problem: &|| self.problem(),
            index: self.index.clone(),
            settings: self.request.settings(),
            workers,
            threads: self.request.threads,
            queries: self.queries(),
        };
        RoadmapPlanner::new(info, parts, file)
    }

    /// A token for a run that takes the part `part` of the time of the request and ends when `control` is cancelled. What was spent
    /// before, by `control`, counts.
    pub(crate) fn interrupt_of(&self, control: &Control<'_>, part: f64) -> Interrupt {
        match self.time_left(control, part, Duration::ZERO) {
            None => Interrupt::new(control.cancel.clone()),
            Some(left) => control.interrupt_within(left),
        }
    }

    /// What is left of the part `part` of the time of the request after the time `spent`, if it has a budget of time.
    pub(crate) fn time_left(&self, control: &Control<'_>, part: f64, spent: Duration) -> Option<Duration> {
        let time = Duration::try_from_secs_f64(part * self.request.budget.time_s?).ok()?;
        Some(time.saturating_sub(control.spent).saturating_sub(spent))
    }

    /// Moves the deadlines of a run, which ends after the time `left`, if there is one; `whole` is for proving the path that it has found
    /// by then.
    pub(crate) fn move_deadlines(&self, now: Duration, left: Option<Duration>, whole: Option<Duration>) {
        if let (Some(left), Some(whole)) = (left, whole) {
            self.state.deadlines.set(now.saturating_add(left), now.saturating_add(whole));
            self.interrupt().move_deadline(now.saturating_add(left));
        }
    }

    /// Calls `run` with the stop and the observer of a run. It is stopped by the budget of the request, by its token and by the flag
    /// of `control`, and reported to the watch of `control`.
    pub(crate) fn watched<T>(
        &self,
        control: &mut Control<'_>,
        run: impl FnOnce(&mut dyn Stop, &mut Events<'_, '_, '_>) -> T,
    ) -> T {
        let wanted = control.watch.as_ref().is_some_and(|watch| watch.wants_events());
        let adapter = WatchAdapter::new(control.watch.as_deref_mut(), control.clock);
        let mut stop = control.cancel.clone().or(self.stop()).or(control.stop.as_deref_mut()).or(&adapter);
        let (row, rows) = (&|q: &_| self.kind.row(q), &|path: &_| self.kind.rows(path));
        run(&mut stop, &mut Events { row, rows, adapter: &adapter, wanted })
    }

    /// When a run stops: by its token, or by the budget of the request.
    fn stop(&self) -> impl Stop {
        let budget = &self.request.budget;
        self.interrupt()
            .or(budget.iterations.map(Iterations))
            .or(budget.nodes.map(Nodes))
            .or(budget.queries.map(|most| QueryBudget { queries: self.queries(), most }))
    }
}

/// The verifier of paths, which notes when it was interrupted. It passes every motion where paths are proved later.
struct Verifying<'a> {
    verifier: AnyCheck<'a, Configuration>,
    interrupt: Interrupt,
    state: &'a RunState,
}

impl MotionValidity<Configuration> for Verifying<'_> {
    fn check_motion(&mut self, from: &Configuration, to: &Configuration) -> MotionCheck {
        // A single state is a start or a goal, not a path.
        if from != to {
            if self.state.proves_later.load(Ordering::Relaxed) {
                return MotionCheck::Free { clearance: 0.0 };
            }
            self.state.deadlines.prove(&self.interrupt);
        }
        let check = self.verifier.check_motion(from, to);
        if !check.is_free() && from != to && self.interrupt.raised().is_some() {
            self.state.unverified.store(true, Ordering::Relaxed);
        }
        check
    }
}

/// The error, with the state as messages write it.
fn written(kind: &dyn Robot, mut error: BuildError) -> BuildError {
    if let BuildError::Outside { endpoint, state }
    | BuildError::NotFree { endpoint, state, .. }
    | BuildError::Refused { endpoint, state } = &mut error
    {
        let end = match endpoint {
            Endpoint::Start => Some(kind.start()),
            Endpoint::Goal(i) => kind.goals().get(*i),
        };
        if let Some(end) = end {
            *state = kind.in_words(end);
        }
    }
    error
}

/// How motions are checked while planning.
pub(crate) fn motion(kind: &dyn Robot, request: &Request) -> MotionValidator {
    match (request.motion, kind.sampled()) {
        (MotionValidator::Certified, Some(length)) => MotionValidator::Discrete(length),
        (motion, _) => motion,
    }
}

fn build_error<T>(made: Result<T, ParameterError>) -> Result<T, BuildError> {
    made.map_err(|e| BuildError::Unmade { reason: e.to_string() })
}
