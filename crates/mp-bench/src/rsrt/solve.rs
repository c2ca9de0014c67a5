//! One run of one planner on one problem.

use super::robots::{Six, TestRobot};
use crate::clock::{ProcessorTime, nanoseconds, processor_clock, seconds_since};
use crate::error::{IntoError, Result};
use mp_control::{
    Accept, DiscreteFlowCheck, DoubleIntegrator, InputPlanner, InputSet, Kinematic, LocalFlowCheck,
    OnPosition, Order, ReplayFinely,
};
use mp_cspace::{
    Cancel, Discrete, Exactly, Metric, MotionValidity, Outcome, Planner, Product, Resolution, Rn, Rng, Space,
    Stop, StopReason, Straight, Validity, WithMetric,
};
use mp_plan::{Control, Error, Request, Scene, StoppedBy};
use mp_tree::{BuildError, Goals, Problem, RrtConnect, RrtInputs, Rsrt, Step, Tuning};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) solved: bool,
    /// Processor time, including the verification of candidate paths.
    pub(super) seconds: f64,
    pub(super) iterations: u64,
    pub(super) nodes: usize,
    /// Configurations tested by the collision checker.
    pub(super) checks: u64,
    /// Expansions of nodes: motions asked of the local planner.
    pub(super) expansions: u64,
    /// Candidate paths that failed verification.
    pub(super) rejected: u64,
    /// Time along the path, in steps of the inputs (positions: number of edges).
    pub(super) edges: usize,
}

/// The planners compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ComparedPlanner {
    /// A tree that moves by inputs: ALG. 4, RSRT, or what is between them.
    Inputs(Order, Accept),
    /// RRT-Connect with straight motions, for comparison.
    Connect,
}

impl ComparedPlanner {
    /// ALG. 4.
    pub(super) const RRT: Self = Self::Inputs(Order::TestAll, Accept::Nearer);
    pub(super) const RSRT: Self = Self::Inputs(Order::SortFirst, Accept::Any);
}

/// The settings of a run.
#[derive(Clone, Debug)]
pub(super) struct RunSettings {
    pub(super) planner: ComparedPlanner,
    /// The number of inputs: [`InputSet::directions`].
    pub(super) inputs: usize,
    pub(super) seed: u64,
    /// The limit of processor time, seconds.
    pub(super) cap: f64,
    pub(super) cancel: Cancel,
}

/// How long an input is applied: a velocity, and an acceleration, seconds.
const MOVED: f64 = 1.0;
const ACCELERATED: f64 = 0.5;

type State<M> = <<M as TestRobot>::Space as Space>::State;
/// A configuration and its velocity.
type Moving<M> = (State<M>, Six);

/// Counts the states tested.
#[derive(Clone, Debug)]
struct CountingValidity<V> {
    valid: V,
    count: Arc<AtomicU64>,
}

impl<S, V: Validity<S>> Validity<S> for CountingValidity<V> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.valid.is_valid(q)
    }
}

/// Runs a planner until it has a path, its time is up, or it is cancelled (`None`).
fn run<S, E: Clone>(
    planner: std::result::Result<impl Planner<S, Edge = E>, BuildError>,
    settings: &RunSettings,
    began: f64,
) -> Result<Option<Run>> {
    let mut planner = planner.into_error()?;
    let mut stop = ProcessorTime { until: began + settings.cap * 1e9 }.or(settings.cancel.clone());
    let outcome = planner.solve(&mut Rng::seed(settings.seed), &mut stop, &mut ());
    let seconds = seconds_since(began);
    let progress = planner.progress();
    let (solved, edges) = match outcome {
        Outcome::Solved(path) => (true, path.edges.len()),
        Outcome::Stopped(StopReason::Cancelled) => return Ok(None),
        Outcome::Stopped(_) => (false, 0),
    };
    Ok(Some(Run {
        solved,
        seconds,
        iterations: progress.iterations,
        nodes: progress.nodes,
        checks: 0,
        expansions: progress.motions,
        rejected: progress.rejected,
        edges,
    }))
}

/// Plans in a shipped scene, by name. `None` when it was cancelled. The time is that of the planner, which verifies its
/// candidates; the path is neither shortened nor timed beyond that.
pub(super) fn in_scene(scene: &Scene, request: &Request, cancel: &Cancel) -> Result<Option<Run>> {
    let mut control = Control { cancel: cancel.clone(), clock: processor_clock(), ..Control::default() };
    let report = scene.plan_with(request, &mut control)?;
    if report.stopped_by == Some(StoppedBy::Interrupted) {
        return Ok(None);
    }
    Ok(Some(Run {
        solved: report.solved,
        seconds: report.time_s,
        iterations: report.iterations,
        nodes: report.nodes,
        checks: report.collision_checks,
        expansions: report.motion_checks,
        rejected: report.rejected,
        edges: report.path.map_or(0, |path| path.len().saturating_sub(1)),
    }))
}

/// Plans with states that are positions, under `metric`. `None` when it was cancelled.
pub(super) fn positions<M, D>(
    test_robot: &M,
    robot: M::Robot,
    metric: D,
    settings: &RunSettings,
) -> Result<Option<Run>>
where
    M: TestRobot,
    D: Metric<M::Space>,
{
    let space = WithMetric::new(test_robot.space().clone(), metric);
    let verifier = test_robot.verifier(&robot)?;
    let count = Arc::new(AtomicU64::new(0));
    let began = nanoseconds();
    let valid = CountingValidity { valid: robot, count: count.clone() };
    let resolution = Resolution::Length(test_robot.resolution());
    let check = Discrete::new(test_robot.space(), valid, resolution).into_error()?;
    let straight = Straight::new(&space, check);
    let (start, goal, tuning) = (test_robot.start().clone(), test_robot.goal().clone(), tuning());
    let done = match settings.planner {
        ComparedPlanner::Connect => {
            let problem = Problem::new(&space, straight, verifier, start, goal).into_error()?;
            run(RrtConnect::new(problem, tuning), settings, began)
        }
        ComparedPlanner::Inputs(order, accept) => {
            let flow = Kinematic::new(&space).into_error()?;
            let inputs = InputSet::directions(test_robot.speeds(), settings.inputs).into_error()?;
            let local =
                InputPlanner::new(&space, flow, inputs, MOVED, LocalFlowCheck(straight)).into_error()?;
            let near = |q: &State<M>| test_robot.arrived(q, false);
            let goals = Goals::region(near).with_sampler(Exactly(goal));
            let problem = Problem::new(&space, local.ordered(order), verifier, start, goals).into_error()?;
            match accept {
                Accept::Nearer => run(RrtInputs::new(problem, tuning), settings, began),
                Accept::Any => run(Rsrt::new(problem, tuning), settings, began),
            }
        }
    }?;
    Ok(done.map(|run| Run { checks: count.load(Ordering::Relaxed), ..run }))
}

/// The longest step is a fifth of the extent: for connections of inputs to a goal, and for RRT-Connect's edges.
fn tuning() -> Tuning {
    Tuning { step: Step::Fraction(0.2), ..Tuning::default() }
}

/// Plans with states that are positions and velocities, under `metric`; the
/// goal is a position, at any velocity. `None` when it was cancelled.
pub(super) fn velocities<M, D>(
    test_robot: &M,
    robot: M::Robot,
    metric: D,
    settings: &RunSettings,
) -> Result<Option<Run>>
where
    M: TestRobot,
    D: Metric<Product<M::Space, Rn<6>>>,
{
    let (most, accelerations) = test_robot.limits();
    let moving = Product::with_velocity(test_robot.space().clone(), most).into_error()?;
    // The length of a motion is measured by positions, not by velocities.
    let speeds = Rn::new(-most, most).into_error()?;
    let places = Product::new(test_robot.space().clone(), 1.0, speeds, 1e-6).into_error()?;
    let flow = DoubleIntegrator::new(test_robot.space()).into_error()?;
    let space = WithMetric::new(moving.clone(), metric);
    let mut proof = test_robot.verifier(&robot)?;
    let proved = OnPosition(move |q: &State<M>| proof.check_motion(q, q).is_free());
    let fine = Resolution::Length(0.1 * test_robot.resolution());
    let verifier = ReplayFinely::new(&places, flow, proved, fine).into_error()?;
    let count = Arc::new(AtomicU64::new(0));
    let began = nanoseconds();
    let valid = OnPosition(CountingValidity { valid: robot, count: count.clone() });
    let resolution = Resolution::Length(test_robot.resolution());
    let check = DiscreteFlowCheck::new(&places, valid, resolution).into_error()?;
    let ComparedPlanner::Inputs(order, accept) = settings.planner else {
        return Err(Error::new("two trees grown by accelerations do not meet"));
    };
    let inputs = InputSet::directions(accelerations, settings.inputs).into_error()?;
    let local = InputPlanner::new(&space, flow, inputs, ACCELERATED, check).into_error()?.ordered(order);
    let rest = Six::zeros();
    let goals = Goals::region(|q: &Moving<M>| test_robot.arrived(&q.0, true))
        .with_sampler(Exactly((test_robot.goal().clone(), rest)));
    let start = (test_robot.start().clone(), rest);
    let problem = Problem::new(&space, local, verifier, start, goals).into_error()?;
    let tuning = tuning();
    let done = match accept {
        Accept::Nearer => run(RrtInputs::new(problem, tuning), settings, began),
        Accept::Any => run(Rsrt::new(problem, tuning), settings, began),
    }?;
    Ok(done.map(|run| Run { checks: count.load(Ordering::Relaxed), ..run }))
}
