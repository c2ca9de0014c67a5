//! One trial.

use crate::Result;
use mp_cspace::{
    Cancel, Clock, DefaultNn, Direction, Extension, Iterations, Length, LocalPlanner, Outcome, Path, Planner,
    PolylineEdge, Reach, Rn, Rng, Space, Stop, StopReason, Straight, Validity, least_clearance,
};
use mp_robot::{DiscRobot, DiscVerifier};
use mp_scenes::source::disc_scenes::DiscScene;
use mp_snake::plane::{occupancy, paper_energy, risk_energy};
use mp_snake::{Bending, Field, Grid, Params, Repulsion, SnakeCounters, SnakePlanner, With};
use mp_tree::{BuildError, Problem, Rrt, RrtConnect, Tuning};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};
use std::cell::Cell;

/// The most iterations of a trial (§4).
pub const ITERATIONS: u64 = 5000;
/// How far obstacles push snakes, metres.
pub const RANGE: f64 = 0.15;
/// The size of a cell of the clearance map, metres.
const CELL: f64 = 0.06;
/// The accuracy of the safety of a path, metres.
const ACCURACY: f64 = 1e-4;

/// A place in the world, metres.
pub type Point = Vector2<f64>;

/// A case: a planner in a world.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Case {
    /// The name of the world.
    pub world: String,
    /// The planner, by name: `rrt`, `rrt-upto`, `rrt-connect`, `rrs`, `rrs-upto`, `rrs-paper` and
    /// `rrs-risk` in the field of that name, or `rrs-` and how it bends
    /// if not by snakes, as the paper does.
    pub planner: String,
    /// Δq, centimetres.
    pub step: u32,
    /// The number of the trial, which is also its seed.
    pub trial: u64,
}

/// The result of a case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Whether it has found a path.
    pub solved: bool,
    /// Seconds by the clock of the trial, including the verification of candidate paths.
    pub seconds: f64,
    /// Iterations of the planner.
    pub iterations: u64,
    /// Nodes of its trees.
    pub nodes: usize,
    /// The length of the path, metres; zero when there is none.
    pub length: f64,
    /// Its least distance from an obstacle, metres.
    pub safety: f64,
    /// Edges of the tree that are straight.
    pub straight: u64,
    /// Edges that a bulge bent.
    pub bulged: u64,
    /// Edges that a snake relaxed from a bulge.
    pub relaxed: u64,
    /// Edges that only a snake bent.
    pub by_snake: u64,
    /// Edges that could not be bent.
    pub not_bent: u64,
}

/// Steps of Δq, as in NEW_CONF of the paper: exactly that long, whether the sample is nearer or farther,
/// except those toward the goal, which end at it; or at most that long, as is customary. No step is longer:
/// if a planner tried the whole motion from start to goal first, a single snake would solve the problem.
#[derive(Clone, Debug)]
pub struct Steps<'c, L> {
    space: &'c Rn<2>,
    goal: Point,
    step: f64,
    exactly: bool,
    local: L,
}

impl<L: LocalPlanner<Point>> LocalPlanner<Point> for Steps<'_, L> {
    type Edge = L::Edge;

    fn extend(
        &mut self,
        from: &Point,
        toward: &Point,
        direction: Direction,
        reach: Reach,
    ) -> Extension<Point, L::Edge> {
        let distance = (toward - from).norm();
        if reach == Reach::Full && distance > self.step {
            return Extension::Trapped;
        }
        if !self.exactly || reach == Reach::Full || *toward == self.goal || distance == 0.0 {
            return self.local.extend(from, toward, direction, reach);
        }
        let end = from + (toward - from) * (self.step / distance);
        if !self.space.contains(&end) {
            return Extension::Trapped;
        }
        match self.local.extend(from, &end, direction, Reach::Full) {
            Extension::Reached(motion) if end != *toward => Extension::Advanced(motion),
            other => other,
        }
    }

    fn admits(&mut self, q: &Point) -> bool {
        self.local.admits(q)
    }
}

/// A local planner whose counts are seen from outside.
#[derive(Clone, Debug)]
pub struct Counted<'c, L>(L, &'c Cell<SnakeCounters>);

impl<F: Field<Point>> LocalPlanner<Point> for Counted<'_, Snakes<'_, F>> {
    type Edge = PolylineEdge<Point>;

    fn extend(
        &mut self,
        from: &Point,
        toward: &Point,
        direction: Direction,
        reach: Reach,
    ) -> Extension<Point, Self::Edge> {
        let extension = self.0.extend(from, toward, direction, reach);
        self.1.set(self.0.counters());
        extension
    }

    fn admits(&mut self, q: &Point) -> bool {
        self.0.admits(q)
    }
}

type Snakes<'a, F> = SnakePlanner<'a, Rn<2>, DiscRobot, F>;

/// A world prepared for all its cases: the scene, the robot and the maps that guide snakes.
#[derive(Clone, Debug)]
pub struct PreparedWorld {
    /// The world: obstacles, the radius of the disc, start and goal.
    pub scene: DiscScene,
    /// The robot among its obstacles.
    pub robot: DiscRobot,
    /// The signed clearance of the robot, on a grid; it alone guides the snakes.
    pub map: Grid,
    /// The fields `paper` and `risk`, as `mp` makes them: eq. 3, and the risk of passing everywhere.
    pub fields: [Grid; 2],
}

impl PreparedWorld {
    /// The scene, with maps for its robot.
    ///
    /// # Errors
    /// When the scene is not valid.
    pub fn new(scene: DiscScene) -> Result<Self> {
        Self::with_margin(scene, 0.0)
    }

    /// The same for a robot whose radius is larger by `margin` metres.
    ///
    /// # Errors
    /// When the scene is not valid.
    pub fn with_margin(scene: DiscScene, margin: f64) -> Result<Self> {
        let robot = scene.robot()?;
        let robot = match margin > 0.0 {
            true => DiscRobot::new(robot.world().clone(), robot.radius() + margin)?,
            false => robot,
        };
        let cells = |cell: f64| scene.size.map(|s| (s / cell).round() as usize).into();
        let map = Grid::from_fn([0.0; 2], CELL, cells(CELL), |p| robot.signed_clearance(&p))?;
        let mut checker = robot.clone();
        let occupied = occupancy(scene.size.map(|size| [0.0, size]), RANGE, |p| !checker.is_valid(&p))?;
        let fields = [paper_energy(&occupied, RANGE)?, risk_energy(&occupied, RANGE, 1.0)?];
        Ok(Self { scene, robot, map, fields })
    }
}

/// The result of a case, and the path that was found.
pub type Planned = (Run, Option<Path<Point>>);

/// Runs `case` in its world, by a clock that measures its seconds. `None` when it was cancelled.
///
/// # Errors
/// When there is no such planner.
pub fn planned(world: &PreparedWorld, case: &Case, clock: Clock, cancel: &Cancel) -> Result<Option<Planned>> {
    let PreparedWorld { scene, robot, .. } = world;
    let space = Rn::<2>::new([0.0; 2], scene.size)?;
    let step = f64::from(case.step) / 100.0;
    let tuning = Tuning { step: Length::Absolute(step), ..Tuning::default() };
    let (start, goal) = (Point::from(scene.start), Point::from(scene.goal));
    let verifier = DiscVerifier::new(robot);
    let settings = TrialSettings { seed: case.trial + 1, clock, cancel, space: &space, robot };
    let exactly = !matches!(case.planner.as_str(), "rrt-upto" | "rrs-upto" | "rrt-connect");
    match case.planner.as_str() {
        "rrt" | "rrt-upto" | "rrt-connect" => {
            let local = Straight::new(&space, robot.clone());
            let local = Steps { space: &space, goal, step, exactly, local };
            let problem = Problem::new(&space, local, verifier, start, goal)?;
            match case.planner.as_str() {
                "rrt-connect" => settings.run(RrtConnect::new(problem, tuning), |path| path),
                _ => settings.run(Rrt::new(problem, tuning), |path| path),
            }
        }
        "rrs-paper" => {
            let (counters, field) = (Cell::default(), world.fields[0].clone());
            let planner = rrs(world, &space, step, exactly, field, Bending::Snake, &counters);
            Ok(settings.run(planner, |path| path.flattened())?.map(|run| counted(run, counters.get())))
        }
        "rrs-risk" => {
            let (counters, repulsion) = (Cell::default(), Repulsion::new(&world.map, RANGE)?);
            let field = With::new(repulsion, world.fields[1].clone(), 1.0)?;
            let planner = rrs(world, &space, step, exactly, field, Bending::Snake, &counters);
            Ok(settings.run(planner, |path| path.flattened())?.map(|run| counted(run, counters.get())))
        }
        name => {
            let bend = match name {
                "rrs" | "rrs-upto" => Bending::default(),
                other => match other.strip_prefix("rrs-").and_then(|bend| bend.parse().ok()) {
                    Some(bend) => bend,
                    None => return Err(format!("there is no planner `{other}` here").into()),
                },
            };
            let counters = Cell::default();
            let field = Repulsion::new(&world.map, RANGE)?;
            let planner = rrs(world, &space, step, exactly, field, bend, &counters);
            Ok(settings.run(planner, |path| path.flattened())?.map(|run| counted(run, counters.get())))
        }
    }
}

fn counted((run, path): Planned, counters: SnakeCounters) -> Planned {
    let SnakeCounters { straight, bulged, relaxed, by_snake, not_bent, .. } = counters;
    (Run { straight, bulged, relaxed, by_snake, not_bent, ..run }, path)
}

/// An RRS planner that is measured, with snakes in `field`, and steps of `step` metres, `exactly` or at most.
///
/// # Errors
/// When the start or the goal of the world is not free.
pub fn rrs<'a, F: Field<Point>>(
    world: &'a PreparedWorld,
    space: &'a Rn<2>,
    step: f64,
    exactly: bool,
    field: F,
    bend: Bending,
    counters: &'a Cell<SnakeCounters>,
) -> std::result::Result<Rrs<'a, F>, BuildError> {
    let PreparedWorld { scene, robot, .. } = world;
    let (start, goal) = (Point::from(scene.start), Point::from(scene.goal));
    let unmade = |reason: String| BuildError::Unmade { reason };
    let params = Params::for_edges(RANGE).map_err(|e| unmade(e.to_string()))?;
    let snakes = SnakePlanner::with_bend(space, robot.clone(), field, params, bend);
    let local = Counted(snakes.map_err(|e| unmade(e.to_string()))?, counters);
    let local = Steps { space, goal, step, exactly, local };
    let problem = Problem::new(space, local, DiscVerifier::new(robot), start, goal)?;
    Rrt::new(problem, Tuning { step: Length::Absolute(step), ..Tuning::default() })
}

/// A tree of RRS, with its counts.
pub type Rrs<'a, F> = Rrt<'a, Rn<2>, Steps<'a, Counted<'a, Snakes<'a, F>>>, <Rn<2> as DefaultNn>::Nn>;

struct TrialSettings<'a> {
    seed: u64,
    clock: Clock,
    cancel: &'a Cancel,
    space: &'a Rn<2>,
    robot: &'a DiscRobot,
}

impl TrialSettings<'_> {
    fn run<E: Clone>(
        &self,
        planner: std::result::Result<impl Planner<Point, Edge = E>, BuildError>,
        plain: impl Fn(Path<Point, E>) -> Path<Point>,
    ) -> Result<Option<Planned>> {
        let mut planner = planner?;
        let began = self.clock.now();
        let mut stop = Iterations(ITERATIONS).or(self.cancel.clone());
        let outcome = planner.solve(&mut Rng::seed(self.seed), &mut stop, &mut ());
        let seconds = self.clock.now().saturating_sub(began).as_secs_f64();
        let progress = planner.progress();
        let (iterations, nodes) = (progress.iterations, progress.nodes);
        let none = Run { seconds, iterations, nodes, ..Run::default() };
        let path = match outcome {
            Outcome::Solved(path) => plain(path),
            Outcome::Stopped(StopReason::Cancelled) => return Ok(None),
            Outcome::Stopped(_) => return Ok(Some((none, None))),
        };
        let safety = least_clearance(self.space, &mut self.robot.clone(), &path, ACCURACY);
        let safety = safety.map_or(0.0, |tightest| tightest.found);
        Ok(Some((Run { solved: true, length: path.length(self.space), safety, ..none }, Some(path))))
    }
}
