//! Robots in the plane among polygons: a disc, or a polygon that turns.

use super::model::{ModelBody, ModelFrame, MotionModel, Step};
use super::{
    Appearance, Body, BodyShape, Checker, Column, Contact, Counted, Description, DrivenScene, End, Measured,
    Motion, MovingScene, Queries, SpeedBound, WithMoving, at_side, greatest_speed, hints_and_gradient,
    no_metric,
};
use crate::goals::{GoalPart, examples, rows};
use crate::robot::motion::TypedMotion;
use crate::{Error, MetricName};
use mp_cspace::space_time::SpaceTime;
use mp_cspace::{
    AsVectors, Configuration, Embed, Factored, Interrupt, MotionValidity, ObstacleKnowledge, OnVectors, Rn,
    Se2, Se2State, Space, StateVector,
    obstacles::{ClearanceGradient, ObstacleHints},
};
use mp_geom::Aabb;
use mp_geom::planar::PlanarWorld;
use mp_io::{Driven, PlanarPart, PlanarProblem, PlanarShape};
use mp_robot::{
    AmongMovingAreas, DiscRobot, DiscVerifier, MovingAreasVerifier, PlanarConfiguration, PlanarRobot,
    PolygonRobot, PolygonVerifier, Trajectory,
};
use nalgebra::{Isometry2, Isometry3, Point2, Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use std::f64::consts::TAU;
use std::fmt::Debug;
use std::sync::Arc;

/// The clearance that shortcuts keep, as a fraction of the robot's radius.
const SHORTCUT_CLEARANCE: f64 = 0.02;
/// Between two copies of the robot in a picture its origin moves about this many radii.
const PICTURE_SPACING: f64 = 1.5;
/// Corners of the ring that a disc is drawn as.
const CORNERS: u32 = 48;

/// A robot in the plane: [`DiscRobot`] or [`PolygonRobot`].
pub trait PlanarBody:
    PlanarRobot<Configuration = <Self as PlanarBody>::State>
    + Checker<<Self as PlanarBody>::State>
    + ObstacleHints<Self::State>
    + ClearanceGradient<Self::State>
    + Debug
    + 'static
{
    /// A configuration: a position, with an angle if the robot turns.
    type State: StateVector + Clone + Debug + PartialEq + Send + Sync + PlanarConfiguration + 'static;
    /// The space of configurations.
    type Space: Factored + Space<State = <Self as PlanarBody>::State> + Embed + Clone + Send + Debug + 'static;
    /// The independent check of finished paths.
    type Verifier<'c>: MotionValidity<Self::State> + Clone + Send + Sync
    where
        Self: 'c;
    /// The name of the space in reports.
    const SPACE: &'static str;
    /// The name and the unit of each number of a configuration.
    const COLUMNS: &'static [(&'static str, &'static str)];

    /// The robot with the shape `body` in a world.
    ///
    /// # Errors
    /// When the shape is that of the other kind of robot, or its size is not valid.
    fn among(world: Arc<PlanarWorld>, body: &PlanarShape) -> Result<Self, Error>;
    /// The space within the box between two corners, metres.
    ///
    /// # Errors
    /// When the box is empty.
    fn space(bounds: [[f64; 2]; 2]) -> Result<Self::Space, Error>;
    /// The space under its own metric.
    fn measured(space: &AsVectors<Self::Space>) -> Measured<'static>;
    /// The verifier of the motions of this robot in `space`.
    fn verifier<'c>(&self, space: &'c Self::Space) -> Self::Verifier<'c>;
    /// A verifier among areas that move.
    fn moving_verifier<'c>(
        space: &'c SpaceTime<Self::Space>,
        among: &AmongMovingAreas<Self>,
    ) -> MovingAreasVerifier<'c, Self::Space, Self::Verifier<'c>>;
    /// The world in which it moves.
    fn world(&self) -> &Arc<PlanarWorld>;
    /// The clearance (m) that certified checks resolve.
    fn tolerance(&self) -> f64;
    /// The largest distance of a point of the robot from its origin, metres.
    fn radius(&self) -> f64;
    /// The configuration of a row.
    fn state(row: &[f64]) -> <Self as PlanarBody>::State;
    /// The rings around it, in its own frame, metres.
    fn rings(&self) -> Vec<Vec<Point2<f64>>>;
    /// The pose of a configuration.
    fn pose(q: &Self::State) -> Isometry2<f64>;
    /// The configuration at the origin, not turned.
    fn origin() -> <Self as PlanarBody>::State;
    /// `q` moved by the vector `by`, with the same rotation.
    fn moved(q: &Self::State, by: Vector2<f64>) -> Self::State;
}

impl<B: PlanarBody> SpeedBound for PlanarScene<B> {
    fn speed_bound(&self, rates: &[f64]) -> f64 {
        let rate = |i: usize| rates.get(i).copied().unwrap_or(0.0);
        mp_math::hypot(rate(0), rate(1)) + PlanarBody::radius(self.robot()) * rate(2)
    }
}

impl<B: PlanarBody> WithMoving for PlanarScene<B> {
    type Place = <B as PlanarBody>::State;
    type Places = B::Space;
    type Among = AmongMovingAreas<B>;
    type AmongVerifier<'c> = MovingAreasVerifier<'c, B::Space, B::Verifier<'c>>;

    fn places(&self) -> &B::Space {
        &self.space.0
    }
    fn among_verifier<'c>(
        &'c self,
        space: &'c SpaceTime<B::Space>,
        among: &AmongMovingAreas<B>,
    ) -> Result<Self::AmongVerifier<'c>, Error> {
        Ok(B::moving_verifier(space, among))
    }
    fn among_keeping(among: &AmongMovingAreas<B>, kept: f64) -> AmongMovingAreas<B> {
        among.clone().keeping(kept)
    }
    fn obstacle_speed(among: &AmongMovingAreas<B>) -> f64 {
        among.greatest_speed()
    }
    fn trajectories(among: &AmongMovingAreas<B>) -> Vec<&Trajectory> {
        among.trajectories().collect()
    }
    fn obstacle_poses(among: &AmongMovingAreas<B>, time: f64) -> Vec<Isometry3<f64>> {
        among.poses(time).collect()
    }
    fn touched(among: &mut AmongMovingAreas<B>, q: &(<B as PlanarBody>::State, f64)) -> Vec<usize> {
        among.touching(q)
    }
}

impl<R: PlanarRobot> Queries for AmongMovingAreas<R> {
    fn queries(&self) -> u64 {
        self.counters().queries()
    }
}

impl Queries for DiscRobot {
    fn queries(&self) -> u64 {
        self.counters().queries()
    }
}

impl Queries for PolygonRobot {
    fn queries(&self) -> u64 {
        self.counters().queries()
    }
}

impl PlanarBody for DiscRobot {
    type State = Vector2<f64>;
    type Space = Rn<2>;
    type Verifier<'c> = DiscVerifier;
    const SPACE: &'static str = "R2";
    const COLUMNS: &'static [(&'static str, &'static str)] = &[("x", "m"), ("y", "m")];

    fn among(world: Arc<PlanarWorld>, body: &PlanarShape) -> Result<Self, Error> {
        match body {
            PlanarShape::Disc(radius) => Ok(Self::new(world, *radius)?),
            PlanarShape::Polygon(_) => Err(Error::new("the robot is a polygon, not a disc")),
        }
    }
    fn space([low, high]: [[f64; 2]; 2]) -> Result<Rn<2>, Error> {
        Ok(Rn::new(low, high)?)
    }
    fn measured(space: &AsVectors<Rn<2>>) -> Measured<'static> {
        Measured::compiled(space)
    }
    fn verifier(&self, _: &Rn<2>) -> DiscVerifier {
        DiscVerifier::new(self)
    }
    fn moving_verifier<'c>(
        space: &'c SpaceTime<Rn<2>>,
        among: &AmongMovingAreas<Self>,
    ) -> MovingAreasVerifier<'c, Rn<2>, DiscVerifier> {
        MovingAreasVerifier::of_disc(space, among)
    }
    fn world(&self) -> &Arc<PlanarWorld> {
        self.world()
    }
    fn tolerance(&self) -> f64 {
        self.tolerance()
    }
    fn radius(&self) -> f64 {
        self.radius()
    }
    fn rings(&self) -> Vec<Vec<Point2<f64>>> {
        let corner = |i: u32| {
            let (s, c) = mp_math::sin_cos(f64::from(i) * TAU / f64::from(CORNERS));
            Point2::new(c, s) * self.radius()
        };
        vec![(0..CORNERS).map(corner).collect()]
    }
    fn pose(q: &Vector2<f64>) -> Isometry2<f64> {
        Isometry2::new(*q, 0.0)
    }
    fn state(row: &[f64]) -> Vector2<f64> {
        Vector2::new(row[0], row[1])
    }
    fn origin() -> Vector2<f64> {
        Vector2::zeros()
    }
    fn moved(q: &Vector2<f64>, by: Vector2<f64>) -> Vector2<f64> {
        q + by
    }
}

impl PlanarBody for PolygonRobot {
    type State = Se2State;
    type Space = Se2;
    type Verifier<'c> = PolygonVerifier<'c, Se2>;
    const SPACE: &'static str = "SE2";
    const COLUMNS: &'static [(&'static str, &'static str)] = &[("x", "m"), ("y", "m"), ("yaw", "rad")];

    fn among(world: Arc<PlanarWorld>, body: &PlanarShape) -> Result<Self, Error> {
        match body {
            PlanarShape::Polygon(polygon) => Ok(Self::new(world, polygon.clone())),
            PlanarShape::Disc(_) => Err(Error::new("the robot is a disc, not a polygon")),
        }
    }
    fn space([low, high]: [[f64; 2]; 2]) -> Result<Se2, Error> {
        Ok(Se2::new(low, high)?)
    }
    fn measured(space: &AsVectors<Se2>) -> Measured<'static> {
        Measured::compiled(space)
    }
    fn verifier<'c>(&self, space: &'c Se2) -> PolygonVerifier<'c, Se2> {
        PolygonVerifier::new(space, self)
    }
    fn moving_verifier<'c>(
        space: &'c SpaceTime<Se2>,
        among: &AmongMovingAreas<Self>,
    ) -> MovingAreasVerifier<'c, Se2, PolygonVerifier<'c, Se2>> {
        MovingAreasVerifier::of_polygon(space, among)
    }
    fn world(&self) -> &Arc<PlanarWorld> {
        self.world()
    }
    fn tolerance(&self) -> f64 {
        self.tolerance()
    }
    fn radius(&self) -> f64 {
        self.radius()
    }
    fn rings(&self) -> Vec<Vec<Point2<f64>>> {
        self.body().rings().to_vec()
    }
    fn pose(q: &Se2State) -> Isometry2<f64> {
        Isometry2::new(q.translation, q.angle)
    }
    fn state(row: &[f64]) -> Se2State {
        Se2State::new(row[0], row[1], row[2])
    }
    fn origin() -> Se2State {
        Se2State::new(0.0, 0.0, 0.0)
    }
    fn moved(q: &Se2State, by: Vector2<f64>) -> Se2State {
        Se2State { translation: q.translation + by, ..*q }
    }
}

/// A robot in the plane among polygons, with a start and goals.
#[derive(Clone, Debug)]
pub struct PlanarScene<B: PlanarBody> {
    problem: PlanarProblem,
    robot: OnVectors<B, <B as PlanarBody>::State>,
    space: AsVectors<B::Space>,
    start: Configuration,
    goals: Vec<Configuration>,
    /// What the goals ask of each number, if they are not configurations.
    goal_parts: Option<Vec<Vec<GoalPart>>>,
    /// Whether start and goals are others than those of the file, about which its lines say nothing.
    moved: bool,
}

impl<B: PlanarBody> PlanarScene<B> {
    /// The scene of `problem`.
    ///
    /// # Errors
    /// When the robot is of the other kind, or world, robot or bounds are not valid.
    pub fn new(problem: PlanarProblem) -> Result<Self, Error> {
        Self::new_until(problem, &Interrupt::never())
    }

    /// As [`new`](Self::new), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when it was interrupted.
    pub fn new_until(problem: PlanarProblem, interrupt: &Interrupt) -> Result<Self, Error> {
        let polygons = problem.obstacles.iter().map(|o| o.polygon.clone()).collect();
        let world = PlanarWorld::new_until(polygons, problem.walls, interrupt)
            .map_err(|e| Error::new(e.to_string()))?;
        let robot = OnVectors::new(B::among(Arc::new(world), &problem.file.robot)?);
        let space = AsVectors(B::space(problem.bounds)?);
        let numbers = B::COLUMNS.len();
        let bounds = problem.bounds;
        let start = at::<B>(&problem.file.start[..numbers], bounds);
        // A robot with accelerations may have goals of its velocities too, which are not those of this scene.
        let parts = problem.file.goals.iter().map(|goal| goal[..numbers.min(goal.len())].to_vec());
        let parts: Vec<Vec<GoalPart>> = parts.collect();
        let (mut goals, mut goal_parts) = (vec![start.clone()], None);
        match rows(&parts) {
            Some(rows) => goals = rows.iter().map(|row| at::<B>(row, bounds)).collect(),
            None => goal_parts = Some(parts),
        }
        let mut scene = Self { problem, robot, space, start, goals, goal_parts, moved: false };
        if let Some(parts) = &scene.goal_parts {
            scene.goals = examples(&scene, parts);
        }
        Ok(scene)
    }

    /// The same robot, also among the obstacles of the problem that move.
    ///
    /// # Errors
    /// When the problem does not say how fast the robot is, or a shape or a time is not valid.
    pub fn among_moving(self) -> Result<MovingScene<Self>, Error> {
        let Some(mut timing) = self.problem.file.timing.clone() else {
            return Err(Error::new("obstacles move, and the robot has no speed").help("say how fast it is"));
        };
        if let Some(driven) = &self.problem.file.driven {
            timing.speed = Some(greatest_speed(&self.space.0, driven));
        }
        let moving = self.problem.file.moving.clone();
        let pose = |[x, y, angle]: [f64; 3]| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            Isometry3::from_parts(Translation3::new(x, y, 0.0), turn)
        };
        let areas = moving.iter().map(|m| {
            let poses = m.path.iter().map(|&[time, x, y, angle]| (time, pose([x, y, angle])));
            let trajectory =
                Trajectory::new(poses).map_err(|e| Error::new(format!("the path of {}: {e}", m.name)))?;
            Ok((m.polygon.clone(), trajectory))
        });
        let areas: Vec<_> = areas.collect::<Result<_, Error>>()?;
        let last = moving.iter().filter_map(|m| m.path.last()).map(|row| row[0]).fold(0.0, f64::max);
        let among = AmongMovingAreas::new(self.robot().clone(), areas)?;
        let body = |m: &mp_io::PlanarMoving| Body {
            name: m.name.clone(),
            shape: BodyShape::Area(m.polygon.rings().to_vec()),
            pose: None,
        };
        MovingScene::new(self, among, moving.iter().map(body).collect(), &timing, last)
    }

    /// The problem that it was made from.
    #[must_use]
    pub fn problem(&self) -> &PlanarProblem {
        &self.problem
    }

    /// The robot in its world.
    #[must_use]
    pub fn robot(&self) -> &B {
        self.robot.inner()
    }

    /// The same robot, moved by inputs.
    ///
    /// # Errors
    /// When the robot cannot move so.
    pub fn driven(self, driven: &Driven) -> Result<DrivenScene, Error> {
        let (velocity, goals) = self.driven_ends();
        DrivenScene::new(self, driven, &velocity, goals)
    }

    /// The same robot, moved by inputs, also among the obstacles of the problem that move.
    ///
    /// # Errors
    /// When the robot cannot move so, or a shape or a time is not valid.
    pub fn driven_among_moving(self, driven: &Driven) -> Result<DrivenScene, Error> {
        let (velocity, goals) = self.driven_ends();
        self.among_moving()?.driven(driven, &velocity, goals)
    }

    /// The velocity at the start, and the goals with their velocities.
    fn driven_ends(&self) -> (Vec<f64>, Vec<Vec<GoalPart>>) {
        let file = &self.problem.file;
        (file.start[B::COLUMNS.len()..].to_vec(), file.goals.clone())
    }

    /// The rings around the robot at `q`, in the world, metres.
    fn rings_at(&self, q: &Configuration) -> Vec<Vec<Point2<f64>>> {
        let pose = B::pose(&placed::<B>(q));
        self.robot().rings().into_iter().map(|ring| ring.iter().map(|p| pose * p).collect()).collect()
    }
}

/// The configuration of a row. A position that is a hair outside of the bounds is at their side.
fn at<B: PlanarBody>(row: &[f64], [low, high]: [[f64; 2]; 2]) -> Configuration {
    let mut row = row.to_vec();
    row.iter_mut().zip(low).zip(high).for_each(|((x, low), high)| *x = at_side(*x, [low, high]));
    Configuration::of(&B::state(&row))
}

/// The place that a configuration stands for; the origin if `q` does not have the numbers of a place.
fn placed<B: PlanarBody>(q: &Configuration) -> <B as PlanarBody>::State {
    q.to().unwrap_or_else(|| B::origin())
}

impl<B: PlanarBody> TypedMotion for PlanarScene<B> {
    type Space = AsVectors<B::Space>;
    type Checker = OnVectors<B, <B as PlanarBody>::State>;
    type Verifier<'c> = OnVectors<B::Verifier<'c>, <B as PlanarBody>::State>;
    fn space(&self) -> &Self::Space {
        &self.space
    }
    fn with_ends(&self, start: Configuration, goals: Vec<Configuration>) -> Result<Self, Error> {
        let mut scene = self.clone();
        scene.problem.file.start = start.to_vec();
        let exactly = |q: &Configuration| q.iter().copied().map(GoalPart::Exactly).collect();
        scene.problem.file.goals = goals.iter().map(exactly).collect();
        (scene.start, scene.goals, scene.goal_parts, scene.moved) = (start, goals, None, true);
        Ok(scene)
    }
    fn checker(&self) -> &Self::Checker {
        &self.robot
    }
    fn verifier(&self) -> Result<Self::Verifier<'_>, Error> {
        Ok(OnVectors::new(self.robot().verifier(&self.space.0)))
    }
    fn obstacles<'c>(
        &'c self,
        counted: &dyn Fn() -> Counted<'c, Self::Checker>,
    ) -> ObstacleKnowledge<'c, Configuration> {
        hints_and_gradient(counted)
    }
    fn starting_as(mut self, row: &[f64]) -> Self {
        self.problem.file.start = row.to_vec();
        self
    }
    fn keeping(&self, kept: f64) -> Result<Self, Error> {
        Ok(Self { robot: OnVectors::new(self.robot().clone().keeping_clearance(kept)), ..self.clone() })
    }
    fn checker_keeping(&self, kept: f64) -> Option<Self::Checker> {
        Some(OnVectors::new(self.robot().clone().keeping_clearance(kept)))
    }
}

impl<B: PlanarBody> Motion for PlanarScene<B> {
    fn start(&self) -> &Configuration {
        &self.start
    }
    fn goals(&self) -> &[Configuration] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        self.goal_parts.as_deref()
    }
    fn tolerance(&self) -> f64 {
        self.robot().tolerance()
    }
    fn kept(&self) -> f64 {
        self.robot().clearance_kept()
    }
    fn accuracy(&self) -> f64 {
        self.tolerance().max(1e-4 * self.robot().radius())
    }
    fn shortcut_clearance(&self) -> f64 {
        (SHORTCUT_CLEARANCE * self.robot().radius()).max(self.tolerance())
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error> {
        match metric {
            MetricName::Default => Ok(B::measured(&self.space)),
            _ => Err(no_metric(metric, "a robot of the plane", &[MetricName::Default])),
        }
    }
    /// A free configuration with the same rotation, on the smallest of growing circles around `q` that has one.
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        let (mut robot, q) = (self.robot().clone(), placed::<B>(q));
        let mut reach = 0.01 * self.robot().radius().max(1e-3 * self.space.extent());
        while reach < self.space.extent() {
            let around = (0..64).map(|i| {
                let (s, c) = mp_math::sin_cos(TAU * f64::from(i) / 64.0);
                B::moved(&q, Vector2::new(c, s) * reach)
            });
            let mut free = around.filter(|p| {
                self.space.0.contains(p) && robot.clearance(p, f64::INFINITY) > 2.0 * self.tolerance()
            });
            if let Some(found) = free.next() {
                return Some(Configuration::of(&found));
            }
            reach *= 1.2;
        }
        None
    }
}

impl<B: PlanarBody> Description for PlanarScene<B> {
    fn name(&self) -> &str {
        &self.problem.name
    }
    fn space_name(&self) -> String {
        B::SPACE.to_owned()
    }
    fn touching(&self, q: &Configuration) -> Vec<Contact> {
        let rings = self.rings_at(q);
        let mut touches: Vec<Contact> = Vec::new();
        let mut note = |obstacle: Option<usize>| {
            let other = match obstacle {
                Some(i) => self.problem.obstacles.get(i).map_or("?", |o| o.name.as_str()),
                None if self.problem.walls == self.problem.file.walls => "the walls",
                None => "the edge of the map",
            };
            if !touches.iter().any(|touch| touch.other == other) {
                touches.push(Contact {
                    part: None,
                    other: other.to_owned(),
                    with_itself: false,
                    depth: None,
                });
            }
        };
        if self.robot().clone().keeping_clearance(0.0).clearance(&placed::<B>(q), f64::MIN_POSITIVE) > 0.0 {
            return Vec::new();
        }
        for ring in &rings {
            for (a, b) in ring.iter().zip(ring.iter().skip(1).chain(ring.first())) {
                if let Some(near) = self.robot().world().nearest_to_segment(a, b, self.tolerance()) {
                    note(near.obstacle);
                }
            }
        }
        let inside = |p: &Point2<f64>| self.problem.obstacles.iter().position(|o| o.polygon.contains(p));
        for obstacle in rings.iter().flatten().filter_map(inside) {
            note(Some(obstacle));
        }
        if let PlanarShape::Polygon(robot) = &self.problem.file.robot {
            let pose = B::pose(&placed::<B>(q));
            let within = |p: &Point2<f64>| robot.contains(&pose.inverse_transform_point(p));
            for (i, obstacle) in self.problem.obstacles.iter().enumerate() {
                // One point is enough: the borders do not cross, or it is noted above.
                if obstacle.polygon.rings().iter().flatten().take(1).any(within) {
                    note(Some(i));
                }
            }
        }
        touches
    }
    fn end_error(&self, end: End, message: String, help: String) -> Error {
        let part = match end {
            End::Start => PlanarPart::Start,
            End::Goal(i) => PlanarPart::Goal(i),
        };
        let error = match self.moved {
            true => Error::new(message).help(help),
            false => self.problem.file.fault(part, &message, &help).into(),
        };
        error.context(format!("cannot plan in {}", self.problem.name))
    }
    fn motion_model(&self) -> Result<MotionModel, Error> {
        let yaw = (B::COLUMNS.len() > 2).then_some(2);
        let robot = match &self.problem.file.robot {
            PlanarShape::Disc(radius) => ModelBody::disc("robot", 0, *radius),
            PlanarShape::Polygon(polygon) => ModelBody::rings("robot", 0, true, polygon.rings()),
        };
        let mut model = MotionModel {
            steps: [Step::Line(0), Step::Line(1)].into_iter().chain(yaw.map(Step::Circle)).collect(),
            frames: vec![ModelFrame::Plane { first: 0, yaw }],
            bodies: vec![robot.robot()],
            ..MotionModel::default()
        };
        let world = model.still_frame(&Isometry3::identity());
        let area = |o: &mp_io::PlanarObstacle| ModelBody::rings(&o.name, world, true, o.polygon.rings());
        let walls = self.robot().world().walls().map(|[l, h]| {
            let ring = vec![l, Point2::new(h.x, l.y), h, Point2::new(l.x, h.y)];
            ModelBody::rings("the walls", world, false, [&ring])
        });
        model.add_obstacles(self.problem.obstacles.iter().map(area).chain(walls).collect(), [0]);
        Ok(model)
    }
    fn columns(&self) -> Vec<Column> {
        B::COLUMNS.iter().map(|(name, unit)| Column::new(*name, *unit)).collect()
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        let [low, high] = self.problem.bounds;
        (0..B::COLUMNS.len()).map(|i| (i < 2).then(|| [low[i], high[i]])).collect()
    }
    fn details(&self) -> Vec<(String, String)> {
        let goals = self.goal_parts.iter().flatten().map(|goal| crate::goals::written(self, goal));
        goals.map(|goal| ("goal is".to_owned(), goal)).collect()
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        q.to_vec()
    }
    fn state(&self, row: &[f64]) -> Configuration {
        at::<B>(row, self.problem.bounds)
    }
    fn given_start(&self) -> Vec<f64> {
        self.problem.file.start[..B::COLUMNS.len()].to_vec()
    }
}

impl<B: PlanarBody> Appearance for PlanarScene<B> {
    fn bodies(&self) -> Vec<Body> {
        let robot =
            Body { name: "robot".to_owned(), shape: BodyShape::Area(self.robot().rings()), pose: None };
        let still = self.problem.obstacles.iter().map(|o| Body {
            name: o.name.clone(),
            shape: BodyShape::Area(o.polygon.rings().to_vec()),
            pose: Some(Isometry3::identity()),
        });
        let walls = self.robot().world().walls().map(|[l, h]| Body {
            name: "the walls".to_owned(),
            shape: BodyShape::Lines(vec![vec![l, Point2::new(h.x, l.y), h, Point2::new(l.x, h.y), l]]),
            pose: Some(Isometry3::identity()),
        });
        std::iter::once(robot).chain(still).chain(walls).collect()
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        let pose = B::pose(&placed::<B>(q));
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), pose.rotation.angle());
        let place = pose.translation.vector;
        vec![Isometry3::from_parts(Translation3::new(place.x, place.y, 0.0), turn)]
    }
    fn picture_spacing(&self) -> f64 {
        PICTURE_SPACING * self.robot().radius().max(1e-3 * self.space.extent())
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        let corner = |[x, y]: [f64; 2]| Point3::new(x, y, 0.0);
        Some(Aabb::new(corner(self.problem.bounds[0]), corner(self.problem.bounds[1])))
    }
    fn is_planar(&self) -> bool {
        true
    }
}
