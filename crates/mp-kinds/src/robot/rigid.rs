//! Rigid bodies among meshes, in space or in the plane.

use super::model::{ModelBody, ModelFrame, MotionModel, Step};
use super::{
    Appearance, Body, BodyShape, Column, Contact, Counted, Description, Deviation, End, Measured, Motion,
    MovingScene, PathFormat, Queries, SpeedBound, WithMoving, at_sides, hints_and_gradient,
};
use crate::goals::{GoalPart, examples, rows};
use crate::numbers::{fingerprint, plain};
use crate::robot::motion::TypedMotion;
use crate::{Error, MetricName};
use mp_collide::Query;
use mp_cspace::erased::{AnyGeometry, AnyIndex, AnySpace};
use mp_cspace::space_time::SpaceTime;
use mp_cspace::{
    AsVectors, Configuration, Embed, Euclidean, Factored, Interrupt, Interrupted, Linear, Manhattan,
    MaxDisplacement, Metric, MotionCheck, ObstacleKnowledge, OnVectors, Path, ScaledEuclidean, Se2, Se3,
    Space, StateVector, SweptVolume, TrueMetric, WithMetric,
};
use mp_geom::{Aabb, TriMesh, displacement_bound, pose_from_six, six_from_pose, six_tuples};
use mp_io::{RigidMoving, RigidProblem, SpaceKind, Timing};
use mp_robot::{
    AmongMoving, MovingVerifier, Placement, Planar, RigidBody, Spatial, Trajectory, Verifier, is_solid,
};
use nalgebra::{Isometry3, Point2, Point3};
use std::fmt::Debug;

/// The ends of a path match start and goal if no point of the robot is farther off than this, in radii of the robot.
const END_TOLERANCE: f64 = 1e-3;
/// How far from zero a number of a planar path may be that must be zero.
const PLANE_TOLERANCE: f64 = 1e-9;
/// Between two copies of the robot in a picture its points move about this many radii.
const PICTURE_SPACING: f64 = 0.55;

/// How a rigid body moves: [`Spatial`], in SE(3), or [`Planar`], in SE(2).
pub trait RigidSpace:
    Placement<State: StateVector + Clone + Debug + PartialEq + Send + Sync> + 'static
{
    /// The space of its configurations.
    type Space: Factored + Space<State = Self::State> + Embed + TrueMetric + Clone + Send + Debug + 'static;
    /// The metric of the point that moves farthest.
    type Displacement: Metric<Self::Space, Nn: 'static> + TrueMetric<Self::Space> + Clone + Send + 'static;
    /// The metric of the swept volume.
    type Swept: Metric<Self::Space> + Clone + Send + 'static;

    /// Along how many axes it shifts.
    const AXES: usize;
    /// Name and unit of each degree of freedom: the shifts along axes, then the turns about the axes of the world.
    const DEGREES: &'static [(&'static str, &'static str)];

    /// The space of configurations with the origin within `bounds`.
    ///
    /// # Errors
    /// When the bounds are empty.
    fn space(bounds: &Aabb) -> Result<Self::Space, Error>;
    /// The space under its own metric.
    fn measured(space: &AsVectors<Self::Space>) -> Measured<'static>;
    /// The Euclidean metric in which radians count times `radius`.
    ///
    /// # Errors
    /// When the radius is zero.
    fn scaled(space: &Self::Space, radius: f64) -> Result<ScaledEuclidean, Error>;
    /// How far the point of the robot moves that moves farthest.
    ///
    /// # Errors
    /// When the robot has no points.
    fn displacement(robot: &TriMesh) -> Result<Self::Displacement, Error>;
    /// The approximate volume that the robot sweeps.
    ///
    /// # Errors
    /// When the robot has no triangles.
    fn swept(robot: &TriMesh) -> Result<Self::Swept, Error>;
}

impl RigidSpace for Spatial {
    type Space = Se3;
    type Displacement = MaxDisplacement<Point3<f64>>;
    type Swept = SweptVolume;
    const AXES: usize = 3;
    const DEGREES: &'static [(&'static str, &'static str)] =
        &[("x", "m"), ("y", "m"), ("z", "m"), ("turn_x", "rad"), ("turn_y", "rad"), ("turn_z", "rad")];

    fn space(bounds: &Aabb) -> Result<Se3, Error> {
        Ok(Se3::new(bounds.min.coords, bounds.max.coords)?)
    }
    fn measured(space: &AsVectors<Se3>) -> Measured<'static> {
        Measured::compiled(space)
    }
    fn scaled(space: &Se3, radius: f64) -> Result<ScaledEuclidean, Error> {
        Ok(ScaledEuclidean::new(space, [1.0, 1.0, 1.0, radius])?)
    }
    fn displacement(robot: &TriMesh) -> Result<Self::Displacement, Error> {
        Ok(MaxDisplacement::new(robot.vertices().to_vec())?)
    }
    fn swept(robot: &TriMesh) -> Result<SweptVolume, Error> {
        swept(robot)
    }
}

impl RigidSpace for Planar {
    type Space = Se2;
    type Displacement = MaxDisplacement<Point2<f64>>;
    type Swept = SweptVolume;
    const AXES: usize = 2;
    const DEGREES: &'static [(&'static str, &'static str)] = &[("x", "m"), ("y", "m"), ("alpha", "rad")];

    fn space(bounds: &Aabb) -> Result<Se2, Error> {
        Ok(Se2::new(bounds.min.coords.xy(), bounds.max.coords.xy())?)
    }
    fn measured(space: &AsVectors<Se2>) -> Measured<'static> {
        Measured::compiled(space)
    }
    fn scaled(space: &Se2, radius: f64) -> Result<ScaledEuclidean, Error> {
        Ok(ScaledEuclidean::new(space, [1.0, 1.0, radius])?)
    }
    fn displacement(robot: &TriMesh) -> Result<Self::Displacement, Error> {
        let points: Vec<_> = robot.vertices().iter().map(Point3::xy).collect();
        Ok(MaxDisplacement::planar(points)?)
    }
    fn swept(robot: &TriMesh) -> Result<SweptVolume, Error> {
        swept(robot)
    }
}

fn swept(robot: &TriMesh) -> Result<SweptVolume, Error> {
    Ok(SweptVolume::new((0..robot.triangles().len()).map(|i| robot.triangle(i)))?)
}

/// A rigid body among meshes, with a start and a goal.
#[derive(Clone, Debug)]
pub struct RigidScene<M: RigidSpace> {
    problem: RigidProblem,
    space: AsVectors<M::Space>,
    robot: OnVectors<RigidBody<M>, M::State>,
    start: Configuration,
    goals: Vec<Configuration>,
    /// What the goals ask of each number, if they are not configurations.
    goal_parts: Option<Vec<Vec<GoalPart>>>,
    radius: f64,
}

impl<M: RigidSpace> RigidScene<M> {
    /// The scene of `problem`.
    ///
    /// # Errors
    /// When the bounds of the position are empty, or a mesh or pose is not valid.
    pub fn new(problem: RigidProblem) -> Result<Self, Error> {
        Self::after(None, problem)
    }

    /// As [`new`](Self::new), after a small change of the problem: the collision trees of meshes that `before` has too are
    /// taken from there.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn after(before: Option<&Self>, problem: RigidProblem) -> Result<Self, Error> {
        Self::after_until(before, problem, &Interrupt::never())
    }

    /// As [`after`](Self::after), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when it was interrupted.
    pub fn after_until(
        before: Option<&Self>,
        problem: RigidProblem,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let bounds = problem.position_bounds();
        let space = AsVectors(M::space(&bounds)?);
        let obstacles = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        let before = before.map(|before| before.robot.inner());
        let robot = RigidBody::among_until(before, &problem.robot.mesh, obstacles, interrupt)?;
        let sides = [&bounds.min.coords, &bounds.max.coords];
        let [start, goal] = [problem.start, problem.goal].map(|pose| at::<M>(&at_sides(pose, sides)));
        let radius = if robot.radius() > 0.0 { robot.radius() } else { 1e-3 * space.extent() };
        let robot = OnVectors::new(robot);
        Ok(Self { problem, space, robot, start, goals: vec![goal], goal_parts: None, radius })
    }

    /// The same robot with these goals, at least one: what each asks of each of the six numbers.
    ///
    /// # Panics
    /// When there is no goal, or one says less than six numbers.
    #[must_use]
    pub fn with_goals(mut self, goals: Vec<Vec<GoalPart>>) -> Self {
        match rows(&goals) {
            Some(rows) => {
                self.goals = rows.iter().map(|row| self.state(row)).collect();
                self.goal_parts = None;
            }
            None => {
                self.goals = examples(&self, &goals);
                self.goal_parts = Some(goals);
            }
        }
        self
    }

    /// The same robot, also among obstacles that move.
    ///
    /// # Errors
    /// When a mesh is too large, or a path or a time is not valid.
    pub fn among_moving(self, moving: &[RigidMoving], timing: &Timing) -> Result<MovingScene<Self>, Error> {
        self.among_moving_until(moving, timing, &Interrupt::never())
    }

    /// As [`among_moving`](Self::among_moving), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`among_moving`](Self::among_moving), and when it was interrupted.
    pub fn among_moving_until(
        self,
        moving: &[RigidMoving],
        timing: &Timing,
        interrupt: &Interrupt,
    ) -> Result<MovingScene<Self>, Error> {
        let meshes = moving.iter().map(|m| {
            let pose = |row: &[f64; 7]| (row[0], pose_from_six(std::array::from_fn(|i| row[i + 1])));
            let trajectory = Trajectory::new(m.path.iter().map(pose))
                .map_err(|e| Error::new(format!("the path of {}: {e}", m.name)))?;
            Ok((m.name.clone(), m.mesh.clone(), trajectory))
        });
        let meshes: Vec<_> = meshes.collect::<Result<_, Error>>()?;
        let last = moving.iter().filter_map(|m| m.path.last()).map(|row| row[0]).fold(0.0, f64::max);
        let among = AmongMoving::new_until(self.robot().clone(), meshes, interrupt)?;
        let body = |m: &RigidMoving| Body {
            name: m.name.clone(),
            shape: BodyShape::Mesh(m.mesh.faceted()),
            pose: None,
        };
        MovingScene::new(self, among, moving.iter().map(body).collect(), timing, last)
    }

    /// The problem that it was made from.
    #[must_use]
    pub fn problem(&self) -> &RigidProblem {
        &self.problem
    }

    /// The robot among its obstacles.
    #[must_use]
    pub fn robot(&self) -> &RigidBody<M> {
        self.robot.inner()
    }

    /// The distance (m) of the robot's farthest point from its origin; for a point robot, 1e-3 of the extent of the space.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl<P: Placement> Queries for RigidBody<P> {
    fn queries(&self) -> u64 {
        self.counters().queries()
    }
}

/// The pose that a configuration stands for; the identity if `q` does not have the numbers of a pose.
fn placed<M: RigidSpace>(q: &Configuration) -> M::State {
    q.to().unwrap_or_else(|| M::configuration(&Isometry3::identity()))
}

fn pose<M: RigidSpace>(q: &Configuration) -> Isometry3<f64> {
    M::pose(&placed::<M>(q))
}

fn at<M: RigidSpace>(pose: &Isometry3<f64>) -> Configuration {
    Configuration::of(&M::configuration(pose))
}

impl<M: RigidSpace> WithMoving for RigidScene<M> {
    type Place = M::State;
    type Places = M::Space;
    type Among = AmongMoving<M>;
    type AmongVerifier<'c> = MovingVerifier<'c, M::Space, M>;

    fn places(&self) -> &M::Space {
        &self.space.0
    }
    fn among_verifier<'c>(
        &'c self,
        space: &'c SpaceTime<M::Space>,
        among: &AmongMoving<M>,
    ) -> Result<Self::AmongVerifier<'c>, Error> {
        Ok(MovingVerifier::new(space, among)?)
    }
    fn check_moment<'c>(
        verifier: &mut MovingVerifier<'c, M::Space, M>,
        q: &(M::State, f64),
        enough: f64,
    ) -> MotionCheck
    where
        Self: 'c,
    {
        verifier.check_state(q, enough)
    }
    fn among_keeping(among: &AmongMoving<M>, kept: f64) -> AmongMoving<M> {
        among.clone().keeping(kept)
    }
    fn obstacle_speed(among: &AmongMoving<M>) -> f64 {
        among.greatest_speed()
    }
    fn trajectories(among: &AmongMoving<M>) -> Vec<&Trajectory> {
        among.trajectories().collect()
    }
    fn obstacle_poses(among: &AmongMoving<M>, time: f64) -> Vec<Isometry3<f64>> {
        among.poses(time).collect()
    }
    fn touched(among: &mut AmongMoving<M>, q: &(M::State, f64)) -> Vec<usize> {
        among.touching(q)
    }
}

impl<M: RigidSpace> SpeedBound for RigidScene<M> {
    fn speed_bound(&self, rates: &[f64]) -> f64 {
        let (shift, turn) = rates.split_at(M::AXES.min(rates.len()));
        let norm = |rates: &[f64]| rates.iter().map(|r| r * r).sum::<f64>().sqrt();
        norm(shift) + self.robot().radius() * norm(turn)
    }
    fn check_state<'c>(verifier: &mut Self::Verifier<'c>, q: &Configuration, enough: f64) -> MotionCheck
    where
        Self: 'c,
    {
        verifier.inner_mut().check_state(&placed::<M>(q), enough)
    }
    fn degrees_of_freedom(&self) -> Vec<Column> {
        M::DEGREES.iter().map(|(name, unit)| Column::new(*name, *unit)).collect()
    }
}

impl<P: Placement> Queries for AmongMoving<P> {
    fn queries(&self) -> u64 {
        self.counters().queries()
    }
}

impl<M: RigidSpace> TypedMotion for RigidScene<M> {
    type Space = AsVectors<M::Space>;
    type Checker = OnVectors<RigidBody<M>, M::State>;
    type Verifier<'c> = OnVectors<Verifier<'c, M::Space, M>, M::State>;
    fn space(&self) -> &Self::Space {
        &self.space
    }
    fn with_ends(&self, start: Configuration, goals: Vec<Configuration>) -> Result<Self, Error> {
        let mut problem = self.problem.clone();
        problem.start = pose::<M>(&start);
        problem.goal = goals.first().map_or(problem.goal, pose::<M>);
        let space = AsVectors(M::space(&problem.position_bounds())?);
        let (robot, radius) = (self.robot.clone(), self.radius);
        Ok(Self { problem, space, robot, start, goals, goal_parts: None, radius })
    }
    fn keeping(&self, kept: f64) -> Result<Self, Error> {
        Ok(Self { robot: OnVectors::new(self.robot().clone().keeping(kept)), ..self.clone() })
    }
    fn checker_keeping(&self, kept: f64) -> Option<Self::Checker> {
        Some(OnVectors::new(self.robot().clone().keeping(kept)))
    }
    fn checker(&self) -> &Self::Checker {
        &self.robot
    }
    fn verifier(&self) -> Result<Self::Verifier<'_>, Error> {
        Ok(OnVectors::new(Verifier::new(&self.space.0, self.robot())?))
    }
    fn obstacles<'c>(
        &'c self,
        counted: &dyn Fn() -> Counted<'c, Self::Checker>,
    ) -> ObstacleKnowledge<'c, Configuration> {
        ObstacleKnowledge { geometry: Some(AnyGeometry::new(counted())), ..hints_and_gradient(counted) }
    }
}

impl<M: RigidSpace> Motion for RigidScene<M> {
    fn start(&self) -> &Configuration {
        &self.start
    }
    fn goals(&self) -> &[Configuration] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        self.goal_parts.as_deref()
    }
    fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        self.robot().make_ready(interrupt)
    }
    fn tolerance(&self) -> f64 {
        self.robot().tolerance()
    }
    fn kept(&self) -> f64 {
        self.robot().kept()
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error> {
        let space = self.space.0.clone();
        let robot = &self.problem.robot.mesh;
        Ok(match metric {
            MetricName::Default => M::measured(&self.space),
            MetricName::Euclidean => Measured::by_coordinates(&AsVectors(WithMetric::new(space, Euclidean))),
            MetricName::Manhattan => Measured::by_coordinates(&AsVectors(WithMetric::new(space, Manhattan))),
            MetricName::Scaled => {
                let metric = M::scaled(&space, self.radius)?;
                Measured::by_coordinates(&AsVectors(WithMetric::new(space, metric)))
            }
            MetricName::MaxDisplacement => {
                let space = AsVectors(WithMetric::new(space, M::displacement(robot)?));
                Measured { index: AnyIndex::by_metric(&space), space: AnySpace::new(&space) }
            }
            // Not a true metric: the index compares every state.
            MetricName::SweptVolume => {
                let space = AsVectors(WithMetric::new(space, M::swept(robot)?));
                Measured { index: AnyIndex::new(&space, Linear::default()), space: AnySpace::new(&space) }
            }
        })
    }
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        let free =
            self.robot().clone().nearest_free(&placed::<M>(q), &self.space.0, 2.0 * self.tolerance())?;
        Some(Configuration::of(&free))
    }
    fn fingerprint(&self, metric: MetricName) -> Option<u64> {
        let problem = &self.problem;
        let bounds = problem.position_bounds();
        let mut numbers: Vec<f64> = [bounds.min, bounds.max].iter().flat_map(|p| [p.x, p.y, p.z]).collect();
        numbers.push(f64::from(u8::from(problem.space == SpaceKind::Se2)));
        numbers.extend(metric.name().bytes().map(f64::from));
        let mut mesh = |mesh: &TriMesh, pose: &Isometry3<f64>| {
            numbers.push(mesh.vertices().len() as f64);
            numbers.extend(mesh.vertices().iter().flat_map(|p| [p.x, p.y, p.z]));
            numbers.extend(mesh.triangles().iter().flatten().map(|&i| f64::from(i)));
            numbers.extend(mesh.solids().iter().flat_map(|solid| [solid.start, solid.end]).map(f64::from));
            numbers.extend(
                mesh.balls().iter().flat_map(|(range, r)| [range.start.into(), range.end.into(), *r]),
            );
            numbers.extend(pose.to_homogeneous().iter());
        };
        mesh(&problem.robot.mesh, &Isometry3::identity());
        problem.obstacles.iter().for_each(|o| mesh(&o.mesh, &o.pose));
        // What is kept decides which edges are blocked for good.
        numbers.extend(Some(self.kept()).filter(|kept| *kept > 0.0));
        Some(fingerprint(numbers))
    }
}

impl<M: RigidSpace> Description for RigidScene<M> {
    fn name(&self) -> &str {
        &self.problem.name
    }
    fn space_name(&self) -> String {
        self.problem.space.to_string()
    }
    fn touching(&self, q: &Configuration) -> Vec<Contact> {
        let contacts = self.robot().clone().explain(&placed::<M>(q));
        let touch = |c: mp_collide::Contact| Contact {
            part: None,
            other: c.name,
            with_itself: false,
            depth: Some(c.depth),
        };
        contacts.into_iter().map(touch).collect()
    }
    fn closest(&self, q: &Configuration) -> Option<(String, f64)> {
        let (obstacle, distance) = self.robot().clone().closest(&placed::<M>(q))?;
        Some((format!("{} and {obstacle}", self.problem.robot.name), distance))
    }
    fn enclosures(&self, q: &Configuration) -> Vec<[String; 2]> {
        let robot = &self.problem.robot.name;
        let found = self.robot().clone().enclosures(&placed::<M>(q)).into_iter();
        found
            .map(|(other, around)| if around { [robot.clone(), other] } else { [other, robot.clone()] })
            .collect()
    }
    fn lint(&self) -> Vec<String> {
        let mut found = Vec::new();
        let scene = self.robot().scene();
        let name = |id| scene.body(id).map_or("?", |body| body.name());
        let pairs = scene.colliding_pairs(&mut Query::default());
        let named: Vec<String> =
            pairs.iter().take(5).map(|(a, b)| format!("{} and {}", name(*a), name(*b))).collect();
        if !named.is_empty() {
            let more = match pairs.len() {
                n if n > 5 => format!(" and {} more pairs", n - 5),
                _ => String::new(),
            };
            found.push(format!("obstacles touch each other: {}{more}", named.join(", ")));
        }
        found
    }
    fn ends_error(&self) -> Option<String> {
        let inside = [&self.start, &self.goals[0]].map(|q| self.robot().enclosing(&placed::<M>(q)));
        if inside[0] == inside[1] {
            return None;
        }
        let [start, goal] = inside.map(|names| match names.is_empty() {
            true => "outside of all solids".to_owned(),
            false => format!("inside of {}", names.join(", ")),
        });
        Some(format!("the start is {start}, the goal {goal}: there may be no way"))
    }
    fn bounds_remedy(&self, _: &Configuration) -> String {
        match self.problem.bounds {
            Some(_) => "move it, or widen the bounds".to_owned(),
            None => "move it, or give the problem bounds: without them it has those of a box around start, goals and obstacles".to_owned(),
        }
    }
    fn end_error(&self, _: End, message: String, help: String) -> Error {
        Error::new(message).help(help).context(format!("cannot plan in {}", self.problem.name))
    }
    fn columns(&self) -> Vec<Column> {
        Column::of_pose()
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        let b = self.problem.position_bounds();
        let planar = self.problem.space == SpaceKind::Se2;
        let still = |free: Option<[f64; 2]>| if planar { Some([0.0, 0.0]) } else { free };
        let side = |i: usize| Some([b.min[i], b.max[i]]);
        vec![side(0), side(1), still(side(2)), None, still(None), still(None)]
    }
    fn path_format(&self) -> PathFormat {
        PathFormat::Poses
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        six_from_pose(&pose::<M>(q)).map(|v| v + 0.0).to_vec()
    }
    fn state(&self, row: &[f64]) -> Configuration {
        let pose = pose_from_six(std::array::from_fn(|i| row[i]));
        // Bounds that are chosen leave room around the ends.
        let bounds = self.problem.bounds.as_ref();
        at::<M>(&bounds.map_or(pose, |b| at_sides(pose, [&b.min.coords, &b.max.coords])))
    }
    fn rows(&self, path: &Path<Configuration>) -> Vec<Vec<f64>> {
        let states = &path.states;
        if states.is_empty() {
            return Vec::new();
        }
        let at = |i: usize, t: f64| match states.get(i + 1) {
            Some(next) => pose::<M>(&self.space.interpolate(&states[i], next, t)),
            None => pose::<M>(&states[i]),
        };
        six_tuples(states.len() - 1, self.radius, at).iter().map(|six| six.to_vec()).collect()
    }
    fn details(&self) -> Vec<(String, String)> {
        let goals = self.goal_parts.iter().flatten().map(|goal| crate::goals::written(self, goal));
        goals.map(|goal| ("goal is".to_owned(), goal)).collect()
    }
    fn export(&self, folder: &std::path::Path) -> Result<std::path::PathBuf, Error> {
        Ok(mp_io::export_ompl(&self.problem, folder, &self.problem.name, &mp_io::OmplExport::default())?)
    }
    fn motion_model(&self) -> Result<MotionModel, Error> {
        let robot = &self.problem.robot;
        let mut model = MotionModel {
            steps: vec![Step::Pose(0)],
            frames: vec![ModelFrame::Pose { first: 0 }],
            bodies: vec![ModelBody::mesh(&robot.name, 0, &robot.mesh).robot()],
            ..MotionModel::default()
        };
        let is_point = self.robot().radius() == 0.0;
        let obstacles = self.problem.obstacles.iter().map(|o| {
            let frame = model.still_frame(&o.pose);
            ModelBody::mesh(&o.name, frame, &o.mesh).solid(is_point && is_solid(&o.mesh))
        });
        let obstacles = obstacles.collect();
        model.add_obstacles(obstacles, [0]);
        Ok(model)
    }
    fn row_fault(&self, row: &[f64]) -> Option<&'static str> {
        let off = || [row[2], row[4], row[5]].iter().any(|v| v.abs() > PLANE_TOLERANCE);
        (self.problem.space == SpaceKind::Se2 && off()).then_some("leaves the plane: z, β and γ must be 0")
    }
    fn deviation(&self, q: &Configuration, wanted: &Configuration) -> Deviation {
        let off = displacement_bound(&pose::<M>(q), &pose::<M>(wanted), self.radius);
        Deviation { off, allowed: END_TOLERANCE * self.radius, unit: " m" }
    }
    fn in_words(&self, q: &Configuration) -> String {
        self.row(q).into_iter().map(plain).collect::<Vec<_>>().join(" ")
    }
}

impl<M: RigidSpace> Appearance for RigidScene<M> {
    /// The editor knows one goal, all of whose numbers are given.
    fn rigid_problem(&self) -> Option<&RigidProblem> {
        (self.goal_parts.is_none() && self.goals.len() == 1).then_some(&self.problem)
    }
    fn bodies(&self) -> Vec<Body> {
        let robot = &self.problem.robot;
        let shape = BodyShape::Mesh(robot.mesh.clone());
        let moving = Body { name: robot.name.clone(), shape, pose: None };
        let obstacles = &self.problem.obstacles;
        let together = obstacles.iter().map(|o| o.mesh.count_of_balls()).sum();
        std::iter::once(moving).chain(Body::obstacles(obstacles, together)).collect()
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        vec![pose::<M>(q)]
    }
    fn picture_spacing(&self) -> f64 {
        PICTURE_SPACING * self.radius
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        self.problem.bounds
    }
    fn is_planar(&self) -> bool {
        self.problem.space == SpaceKind::Se2
    }
}
