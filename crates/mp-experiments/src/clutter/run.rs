//! One run of one planner on one problem.

use super::boxes::Obstacle;
use super::robots::{Six, TestRobot};
use crate::Result;
use mp_control::{
    Accept, DiscreteFlowCheck, DoubleIntegrator, InputPlanner, InputSet, Kinematic, LocalFlowCheck,
    OnPosition, Order, ReplayFinely,
};
use mp_cspace::{
    Cancel, Clock, Deadline, Discrete, Euclidean, Exactly, Length, Manhattan, Metric, MotionValidity,
    Outcome, Planner, Product, Rn, Rng, ScaledEuclidean, Space, Stop, StopReason, Straight, Validity,
    WithMetric,
};
use mp_tree::{BuildError, Goals, Problem, RrtConnect, RrtInputs, Rsrt, Tuning};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The result of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Whether it has found a path.
    pub solved: bool,
    /// Seconds by the clock of the settings, including the verification of candidate paths.
    pub seconds: f64,
    /// Iterations of the planner.
    pub iterations: u64,
    /// Nodes of its trees.
    pub nodes: usize,
    /// Configurations tested by the collision checker.
    pub checks: u64,
    /// Expansions of nodes: motions asked of the local planner.
    pub expansions: u64,
    /// Candidate paths that failed verification.
    pub rejected: u64,
    /// Time along the path, in steps of the inputs (positions: number of edges).
    pub edges: usize,
}

/// A planner of the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparedPlanner {
    /// A tree that moves by inputs: ALG. 4, RSRT, or what is between them.
    Inputs(Order, Accept),
    /// RRT-Connect with straight motions, for comparison.
    Connect,
}

impl ComparedPlanner {
    /// ALG. 4.
    pub const RRT: Self = Self::Inputs(Order::TestAll, Accept::Nearer);
    /// The rapidly-exploring sorted random tree.
    pub const RSRT: Self = Self::Inputs(Order::SortFirst, Accept::Any);
}

/// What a run of the comparison depends on, beside the problem.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// Who plans.
    pub planner: ComparedPlanner,
    /// The number of inputs: [`InputSet::directions`].
    pub inputs: usize,
    /// The seed of its samples.
    pub seed: u64,
    /// The limit of time, seconds of `clock`.
    pub cap: f64,
    /// What the limit and the seconds of the run are measured with.
    pub clock: Clock,
    /// Ends the run, which then has no result.
    pub cancel: Cancel,
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

/// When a run began, and when it ends at the latest.
struct Timer {
    at: Duration,
    deadline: Deadline,
}

impl Timer {
    fn start(settings: &RunSettings) -> Result<Self> {
        let limit = Duration::try_from_secs_f64(settings.cap)?;
        Ok(Self { at: settings.clock.now(), deadline: Deadline::by(settings.clock, limit) })
    }
}

/// Runs a planner until it has a path, its time is up, or it is cancelled (`None`).
fn run<S, E: Clone>(
    planner: std::result::Result<impl Planner<S, Edge = E>, BuildError>,
    settings: &RunSettings,
    timer: Timer,
) -> Result<Option<Run>> {
    let mut planner = planner?;
    let mut stop = timer.deadline.or(settings.cancel.clone());
    let outcome = planner.solve(&mut Rng::seed(settings.seed), &mut stop, &mut ());
    let seconds = settings.clock.now().saturating_sub(timer.at).as_secs_f64();
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

/// Plans among obstacles, with states of one of [`MODELS`](super::MODELS), under one of
/// [`METRICS`](super::METRICS). `None` when it was cancelled.
pub(super) fn among<M: TestRobot>(
    test_robot: &M,
    obstacles: &[Obstacle],
    model: &str,
    metric: &str,
    settings: &RunSettings,
) -> Result<Option<Run>> {
    let robot = test_robot.among(obstacles)?;
    let setup = test_robot.setup();
    match (model, metric) {
        ("positions", "euclidean") => positions(test_robot, robot, Euclidean, settings),
        ("positions", "manhattan") => positions(test_robot, robot, Manhattan, settings),
        ("positions", "scaled") => {
            let scaled = ScaledEuclidean::new(&setup.space, setup.weights.clone())?;
            positions(test_robot, robot, scaled, settings)
        }
        ("velocities", "euclidean") => velocities(test_robot, robot, Euclidean, settings),
        ("velocities", "manhattan") => velocities(test_robot, robot, Manhattan, settings),
        ("velocities", "scaled") => {
            let space = Product::with_velocity(setup.space.clone(), setup.velocities)?;
            let weights = &setup.weights;
            // A radian per second gets the weight of a radian; the rotation of a body has three velocities.
            let last = weights.last().copied().unwrap_or(1.0);
            let six = weights.iter().copied().chain(std::iter::repeat(last)).take(6);
            let moving: Vec<f64> = weights.iter().copied().chain(six).collect();
            let scaled = ScaledEuclidean::new(&space, moving)?;
            velocities(test_robot, robot, scaled, settings)
        }
        _ => Err(format!("there are no {model} under the metric `{metric}` here").into()),
    }
}

/// Plans with states that are positions, under `metric`. `None` when it was cancelled.
fn positions<M, D>(test_robot: &M, robot: M::Robot, metric: D, settings: &RunSettings) -> Result<Option<Run>>
where
    M: TestRobot,
    D: Metric<M::Space>,
{
    let setup = test_robot.setup();
    let space = WithMetric::new(setup.space.clone(), metric);
    let verifier = test_robot.verifier(&robot)?;
    let count = Arc::new(AtomicU64::new(0));
    let timer = Timer::start(settings)?;
    let valid = CountingValidity { valid: robot, count: count.clone() };
    let resolution = Length::Absolute(setup.resolution);
    let check = Discrete::new(&setup.space, valid, resolution)?;
    let straight = Straight::new(&space, check);
    let (start, goal, tuning) = (setup.start.clone(), setup.goal.clone(), tuning());
    let done = match settings.planner {
        ComparedPlanner::Connect => {
            let problem = Problem::new(&space, straight, verifier, start, goal)?;
            run(RrtConnect::new(problem, tuning), settings, timer)
        }
        ComparedPlanner::Inputs(order, accept) => {
            let flow = Kinematic::new(&space)?;
            let inputs = InputSet::directions(setup.speeds, settings.inputs)?;
            let local = InputPlanner::new(&space, flow, inputs, MOVED, LocalFlowCheck(straight))?;
            let near = |q: &State<M>| test_robot.arrived(q, false);
            let goals = Goals::region(near).with_sampler(Exactly(goal));
            let problem = Problem::new(&space, local.ordered(order), verifier, start, goals)?;
            match accept {
                Accept::Nearer => run(RrtInputs::new(problem, tuning), settings, timer),
                Accept::Any => run(Rsrt::new(problem, tuning), settings, timer),
            }
        }
    }?;
    Ok(done.map(|run| Run { checks: count.load(Ordering::Relaxed), ..run }))
}

/// The longest step is a fifth of the extent: for connections of inputs to a goal, and for RRT-Connect's
/// edges.
fn tuning() -> Tuning {
    Tuning { step: Length::Fraction(0.2), ..Tuning::default() }
}

/// Plans with states that are positions and velocities, under `metric`; the
/// goal is a position, at any velocity. `None` when it was cancelled.
fn velocities<M, D>(test_robot: &M, robot: M::Robot, metric: D, settings: &RunSettings) -> Result<Option<Run>>
where
    M: TestRobot,
    D: Metric<Product<M::Space, Rn<6>>>,
{
    let setup = test_robot.setup();
    let most = setup.velocities;
    let moving = Product::with_velocity(setup.space.clone(), most)?;
    // The length of a motion is measured by positions, not by velocities.
    let speeds = Rn::new(-most, most)?;
    let places = Product::new(setup.space.clone(), 1.0, speeds, 1e-6)?;
    let flow = DoubleIntegrator::new(&setup.space)?;
    let space = WithMetric::new(moving.clone(), metric);
    let mut proof = test_robot.verifier(&robot)?;
    let proved = OnPosition(move |q: &State<M>| proof.check_motion(q, q).is_free());
    let fine = Length::Absolute(0.1 * setup.resolution);
    let verifier = ReplayFinely::new(&places, flow, proved, fine)?;
    let count = Arc::new(AtomicU64::new(0));
    let timer = Timer::start(settings)?;
    let valid = OnPosition(CountingValidity { valid: robot, count: count.clone() });
    let resolution = Length::Absolute(setup.resolution);
    let check = DiscreteFlowCheck::new(&places, valid, resolution)?;
    let ComparedPlanner::Inputs(order, accept) = settings.planner else {
        return Err("two trees grown by accelerations do not meet".into());
    };
    let inputs = InputSet::directions(setup.accelerations, settings.inputs)?;
    let local = InputPlanner::new(&space, flow, inputs, ACCELERATED, check)?.ordered(order);
    let rest = Six::zeros();
    let goals = Goals::region(|q: &Moving<M>| test_robot.arrived(&q.0, true))
        .with_sampler(Exactly((setup.goal.clone(), rest)));
    let start = (setup.start.clone(), rest);
    let problem = Problem::new(&space, local, verifier, start, goals)?;
    let tuning = tuning();
    let done = match accept {
        Accept::Nearer => run(RrtInputs::new(problem, tuning), settings, timer),
        Accept::Any => run(Rsrt::new(problem, tuning), settings, timer),
    }?;
    Ok(done.map(|run| Run { checks: count.load(Ordering::Relaxed), ..run }))
}
