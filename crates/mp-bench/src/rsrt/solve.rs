//! One run of one planner on one problem.

use super::movers::{Mover, Six};
use crate::clock::{Processor, nanoseconds, seconds_since};
use crate::error::{IntoError, Result};
use mp_control::{
    Between, DiscreteFlowCheck, DoubleIntegrator, InputPlanner, InputSet, Kinematic, OnPosition, ReplayFinely,
};
use mp_cspace::{
    Cancel, Discrete, Exactly, Metric, MotionValidity, Outcome, Planner, Product, Resolution, Rn, Rng, Space,
    Stop, StopReason, Straight, Validity, WithMetric,
};
use mp_tree::{BuildError, Goals, Problem, RrtConnect, RrtInputs, Rsrt, Step, Tuning};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) solved: bool,
    /// Processor time, with the verification of candidate paths.
    pub(super) seconds: f64,
    pub(super) iterations: u64,
    pub(super) nodes: usize,
    /// Configurations asked of the collision checker.
    pub(super) checks: u64,
    /// Times a node was expanded: motions asked of the local planner.
    pub(super) expansions: u64,
    /// Candidate paths that failed verification.
    pub(super) rejected: u64,
    /// Time along the path, in steps of the inputs (positions: number of edges).
    pub(super) edges: usize,
}

/// The planners compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// ALG. 4.
    Rrt,
    Rsrt,
    /// With motions of any kind, beside them.
    Connect,
}

/// How to run.
#[derive(Clone, Debug)]
pub(super) struct How {
    pub(super) kind: Kind,
    pub(super) seed: u64,
    /// Seconds of processor time.
    pub(super) cap: f64,
    pub(super) cancel: Cancel,
}

type State<M> = <<M as Mover>::Space as Space>::State;
/// A configuration and its velocity.
type Moving<M> = (State<M>, Six);

/// Counts the states tested.
#[derive(Clone, Debug)]
struct Counted<V> {
    valid: V,
    count: Arc<AtomicU64>,
}

impl<S, V: Validity<S>> Validity<S> for Counted<V> {
    fn is_valid(&mut self, q: &S) -> bool {
        self.count.fetch_add(1, Ordering::Relaxed);
        self.valid.is_valid(q)
    }
}

/// Steps of a path that runs out of time are no path: what was found until then.
fn run<S, E: Clone>(
    planner: std::result::Result<impl Planner<S, Edge = E>, BuildError>,
    how: &How,
    began: f64,
) -> Result<Option<Run>> {
    let mut planner = planner.into_error()?;
    let mut stop = Processor { until: began + how.cap * 1e9 }.or(how.cancel.clone());
    let outcome = planner.solve(&mut Rng::seed(how.seed), &mut stop, &mut ());
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

/// The trajectory as a list of positions, under `metric`. `None` when it was cancelled.
pub(super) fn positions<M, D>(mover: &M, robot: M::Robot, metric: D, how: &How) -> Result<Option<Run>>
where
    M: Mover,
    D: Metric<M::Space>,
{
    let space = WithMetric::new(mover.space().clone(), metric);
    let verifier = mover.verifier(&robot)?;
    let count = Arc::new(AtomicU64::new(0));
    let began = nanoseconds();
    let valid = Counted { valid: robot, count: count.clone() };
    let resolution = Resolution::Length(mover.resolution());
    let check = Discrete::new(mover.space(), valid, resolution).into_error()?;
    let straight = Straight::new(&space, check);
    let (start, goal, tuning) = (mover.start().clone(), mover.goal().clone(), tuning());
    let done = if how.kind == Kind::Connect {
        let problem = Problem::new(&space, straight, verifier, start, goal).into_error()?;
        run(RrtConnect::new(problem, tuning), how, began)
    } else {
        let flow = Kinematic::new(&space).into_error()?;
        let inputs = InputSet::axes(mover.speeds()).into_error()?;
        let local = InputPlanner::new(&space, flow, inputs, 1.0, Between(straight)).into_error()?;
        let near = |q: &State<M>| mover.arrived(q);
        let goals = Goals::region(near).with_sampler(Exactly(goal));
        let problem = Problem::new(&space, local, verifier, start, goals).into_error()?;
        match how.kind {
            Kind::Rrt => run(RrtInputs::new(problem, tuning), how, began),
            _ => run(Rsrt::new(problem, tuning), how, began),
        }
    }?;
    Ok(done.map(|run| Run { checks: count.load(Ordering::Relaxed), ..run }))
}

/// Inputs connect to a goal within a fifth of the extent, and RRT-Connect's edges are no longer than that.
fn tuning() -> Tuning {
    Tuning { step: Step::Fraction(0.2), ..Tuning::default() }
}

/// The trajectory as a list of positions with a velocity for each degree of freedom, under `metric`; the
/// goal is a place, at any velocity.
pub(super) fn velocities<M, D>(mover: &M, robot: M::Robot, metric: D, how: &How) -> Result<Option<Run>>
where
    M: Mover,
    D: Metric<Product<M::Space, Rn<6>>>,
{
    let (most, accelerations) = mover.limits();
    let moving = Product::with_velocity(mover.space().clone(), most).into_error()?;
    // Motions are measured by where they lead, not by how velocities change.
    let speeds = Rn::new(-most, most).into_error()?;
    let places = Product::new(mover.space().clone(), 1.0, speeds, 1e-6).into_error()?;
    let flow = DoubleIntegrator::new(mover.space()).into_error()?;
    let space = WithMetric::new(moving.clone(), metric);
    let mut proof = mover.verifier(&robot)?;
    let proved = OnPosition(move |q: &State<M>| proof.check_motion(q, q).is_free());
    let fine = Resolution::Length(0.1 * mover.resolution());
    let verifier = ReplayFinely::new(&places, flow, proved, fine).into_error()?;
    let count = Arc::new(AtomicU64::new(0));
    let began = nanoseconds();
    let valid = OnPosition(Counted { valid: robot, count: count.clone() });
    let resolution = Resolution::Length(mover.resolution());
    let check = DiscreteFlowCheck::new(&places, valid, resolution).into_error()?;
    let inputs = InputSet::axes(accelerations).into_error()?;
    let local = InputPlanner::new(&space, flow, inputs, 1.0, check).into_error()?;
    let rest = Six::zeros();
    let goals = Goals::region(|q: &Moving<M>| mover.arrived(&q.0))
        .with_sampler(Exactly((mover.goal().clone(), rest)));
    let start = (mover.start().clone(), rest);
    let problem = Problem::new(&space, local, verifier, start, goals).into_error()?;
    let tuning = tuning();
    let done = match how.kind {
        Kind::Rrt => run(RrtInputs::new(problem, tuning), how, began),
        _ => run(Rsrt::new(problem, tuning), how, began),
    }?;
    Ok(done.map(|run| Run { checks: count.load(Ordering::Relaxed), ..run }))
}
