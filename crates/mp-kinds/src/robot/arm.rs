//! Arms, and other trees of links, among meshes; their base stands still or floats.

mod choose_ends;
mod ends;
mod named;
mod parts;
mod pose_goals;
mod read;
mod self_filter;

use super::model::{ModelBody, ModelFrame, ModelPair, MotionModel, Step, seven};
use super::{
    Appearance, Body, BodyShape, Column, Contact, Counted, Description, End, HAIR, Measured, Motion, Queries,
    SpeedBound, at_limit, at_sides, hints_and_gradient, no_metric,
};
use crate::goals::{GoalPart, examples, rows};
use crate::numbers::plain_row;
use crate::robot::motion::TypedMotion;
use crate::turns::{continued, turning};
use crate::{Error, MetricName, brief, plain};
use ends::{Ends, wrong_count};
use mp_cspace::shorten::Effort;
use mp_cspace::{
    Configuration, Euclidean, Factored, FloatingJoints, Interrupt, Interrupted, JointRange, Joints,
    Manhattan, MotionClearance, ObstacleKnowledge, Path, ScaledEuclidean, Space, TrueMetric, WithMetric,
};
use mp_geom::{Aabb, TriMesh, continued_six, pose_from_six, six_from_pose};
use mp_io::{DescribedRobot, Disk, Files, Follower, PlacedBody, RobotEntry, RobotFilePart, RobotProblem};
use mp_robot::{Arm, ArmModel, ArmVerifier, Coordinate, Joint, JointKind, Mimic, PLANAR_NUMBERS};
use nalgebra::Isometry3;
use named::{NamedValues, Values};
pub use pose_goals::Reached;
pub use read::{model_of, read_robots};
use read::{srdf_help, what};
use std::collections::HashSet;
use std::fmt::Debug;

/// The space of a robot made of links and joints: [`Joints`] if its base stands still, [`FloatingJoints`] if it floats.
pub trait LinkedSpace: Factored<State = Configuration> + TrueMetric + Clone + Debug + Send + 'static {
    /// Name and unit of each number of the pose of the base in a row.
    const BASE: &'static [(&'static str, &'static str)];
    /// Between two copies of the robot in a picture no point moves farther than this fraction of its reach.
    const PICTURE_SPACING: f64;

    /// The space of a robot.
    ///
    /// # Errors
    /// When its base is of the other kind.
    fn of(arm: &Arm) -> Result<Self, Error>;
    /// The space under its own metric.
    fn measured(&self) -> Measured<'_>;
    /// The configuration whose numbers are in `row`, as paths have them.
    fn state(&self, row: &[f64]) -> Configuration;
    /// The numbers of a configuration, as paths have them.
    fn row(q: &Configuration) -> Vec<f64>;
    /// The pose of the base at a configuration, if it floats.
    fn base(q: &Configuration) -> Option<Isometry3<f64>>;
}

impl LinkedSpace for Joints<Configuration> {
    const BASE: &'static [(&'static str, &'static str)] = &[];
    const PICTURE_SPACING: f64 = 0.12;

    fn of(arm: &Arm) -> Result<Self, Error> {
        Ok(arm.space()?)
    }
    fn measured(&self) -> Measured<'_> {
        Measured::compiled(self)
    }
    fn state(&self, row: &[f64]) -> Configuration {
        self.wrapped(&within(self.ranges(), row).into())
    }
    fn row(q: &Configuration) -> Vec<f64> {
        q.as_slice().to_vec()
    }
    fn base(_: &Configuration) -> Option<Isometry3<f64>> {
        None
    }
}

impl LinkedSpace for FloatingJoints {
    const BASE: &'static [(&'static str, &'static str)] =
        &[("x", "m"), ("y", "m"), ("z", "m"), ("alpha", "rad"), ("beta", "rad"), ("gamma", "rad")];
    const PICTURE_SPACING: f64 = 0.4;

    fn of(arm: &Arm) -> Result<Self, Error> {
        Ok(arm.floating_space()?)
    }
    fn measured(&self) -> Measured<'_> {
        Measured::by_coordinates(self)
    }
    fn state(&self, row: &[f64]) -> Configuration {
        let (pose, joints) = row.split_at(Self::BASE.len().min(row.len()));
        let six = std::array::from_fn(|i| pose.get(i).copied().unwrap_or(0.0));
        let bounds = self.base().translations();
        let pose = at_sides(pose_from_six(six), [bounds.low(), bounds.high()]);
        FloatingJoints::state(self, &pose, &within(self.joints().ranges(), joints))
    }
    fn row(q: &Configuration) -> Vec<f64> {
        let Some((base, joints)) = Self::split(q.as_slice()) else { return Vec::new() };
        // Adding zero removes the sign of negative zeros.
        six_from_pose(&base).into_iter().map(|v| v + 0.0).chain(joints.iter().copied()).collect()
    }
    fn base(q: &Configuration) -> Option<Isometry3<f64>> {
        Self::split(q.as_slice()).map(|(base, _)| base)
    }
}

/// The values of joints, at the limit where they are a [`HAIR`] beyond it.
fn within(ranges: &[JointRange], joints: &[f64]) -> Vec<f64> {
    let ranges = ranges.iter().map(Some).chain(std::iter::repeat(None));
    let value = |(x, range): (&f64, Option<&JointRange>)| match range {
        Some(JointRange::Interval { low, high }) => at_limit(*x, [*low, *high], HAIR),
        _ => *x,
    };
    joints.iter().zip(ranges).map(value).collect()
}

/// An arm among meshes, with a start and goals.
pub type ArmScene = LinkedScene<Joints<Configuration>>;

/// A robot made of links and joints whose base moves freely, among meshes, with a start and goals.
pub type FloatingScene = LinkedScene<FloatingJoints>;

/// A robot made of links and joints among meshes, with a start and goals: [`ArmScene`] or [`FloatingScene`].
#[derive(Clone, Debug)]
pub struct LinkedScene<C> {
    name: String,
    arm: Arm,
    obstacles: Vec<PlacedBody>,
    space: C,
    start: Configuration,
    /// The row of the start as it was given.
    given_start: Vec<f64>,
    goals: Vec<Configuration>,
    /// What the goals ask of each number, if they are not configurations.
    goal_parts: Option<Vec<Vec<GoalPart>>>,
    /// For each goal, the one of the problem that it is from.
    entries: Vec<usize>,
    /// What decides which links may touch without being asked for, in sentences.
    said: Vec<String>,
    /// What numbers the ends have that the problem leaves out, and which configurations reach goals that are places of links, in sentences.
    of_ends: Vec<String>,
    /// Where the start of the problem says that joints are held.
    held: Values,
    /// The problem that it was made from, to locate errors in its file.
    source: Option<Box<RobotProblem>>,
}

impl<C: LinkedSpace> LinkedScene<C> {
    /// The robot of `model` among obstacles. Configurations have one number for each coordinate: radians, or metres for a
    /// prismatic joint. If the base floats, the six numbers of its pose come first: x, y, z, α, β, γ.
    ///
    /// # Errors
    /// When the model is not valid or its base is of the other kind, an obstacle cannot be placed, there is no goal, or the
    /// length of a configuration does not fit the robot.
    pub fn new(
        name: impl Into<String>,
        model: &ArmModel,
        obstacles: Vec<PlacedBody>,
        start: &[f64],
        goals: &[Vec<f64>],
    ) -> Result<Self, Error> {
        let arm = Self::among(model, &obstacles)?;
        let names = Self::names(&arm);
        let check = |what: &str, values: &Vec<f64>| match wrong_count(what, values, &names) {
            Some([message, help]) => Err(Error::new(message).help(help)),
            None => Ok(()),
        };
        check("the start", &start.to_vec())?;
        goals.iter().try_for_each(|goal| check("the goal", goal))?;
        Self::assembled(name.into(), arm, obstacles, start, goals)
    }

    /// The names of the numbers of a row.
    fn names(arm: &Arm) -> Vec<String> {
        let base = C::BASE.iter().map(|(name, _)| (*name).to_owned());
        base.chain(arm.coordinates().iter().map(|c| c.name.clone())).collect()
    }

    fn among(model: &ArmModel, obstacles: &[PlacedBody]) -> Result<Arm, Error> {
        let bodies = obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
        Ok(Arm::new(model, bodies)?)
    }

    /// The scene, from configurations whose length has been checked.
    fn assembled(
        name: String,
        arm: Arm,
        obstacles: Vec<PlacedBody>,
        start: &[f64],
        goals: &[Vec<f64>],
    ) -> Result<Self, Error> {
        let space = C::of(&arm)?;
        let state = |values: &[f64]| space.state(values);
        if goals.is_empty() {
            return Err(Error::new("there is no goal"));
        }
        let given_start = start.to_vec();
        let (start, goals) = (state(start), goals.iter().map(|goal| state(goal)).collect());
        Ok(Self {
            name,
            arm,
            obstacles,
            space,
            start,
            given_start,
            goals,
            goal_parts: None,
            entries: Vec::new(),
            said: Vec::new(),
            of_ends: Vec::new(),
            held: Values::new(),
            source: None,
        })
    }

    /// The scene of the problem of a file.
    ///
    /// # Errors
    /// When the URDF, the SRDF or the limits are not valid, or the length of a configuration does not fit the robot: with the
    /// line of the file.
    pub fn from_problem(problem: RobotProblem) -> Result<Self, Error> {
        Self::from_problem_in(&Disk, problem)
    }

    /// As [`from_problem`](Self::from_problem), with the meshes of the robot read through `files`, unless their token says to end.
    ///
    /// # Errors
    /// As [`from_problem`](Self::from_problem), and when it was interrupted.
    pub fn from_problem_in(files: &dyn Files, problem: RobotProblem) -> Result<Self, Error> {
        Self::from_problem_after(files, problem, None)
    }

    /// As [`from_problem_in`](Self::from_problem_in). The arm is that of the scene `before`, if that has the same among other obstacles.
    pub fn from_problem_after(
        files: &dyn Files,
        mut problem: RobotProblem,
        before: Option<&Self>,
    ) -> Result<Self, Error> {
        let is_same = |before: &&Self| {
            before.source.as_ref().is_some_and(|known| {
                let same_start = known.file.start.row() == problem.file.start.row();
                known.same_robots(&problem) && (same_start || !read::depends_on_start(before.arm.model()))
            })
        };
        let named = NamedValues::of(&problem)?;
        let is_held_the_same = |before: &&Self| before.held == named.beside(&Self::names(&before.arm));
        let (arm, said, of_ends) = match before.filter(is_same).filter(is_held_the_same) {
            Some(before) => {
                let (kinematics, model) = (before.arm.kinematics(), before.arm.model());
                let of_ends = named::resolve(&mut problem, &named, kinematics, model)?;
                let bodies = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
                (before.arm.among_until(bodies, &files.interrupt())?, before.said.clone(), of_ends)
            }
            None => Self::arm_of(files, &mut problem, &named)?,
        };
        let held = named.beside(&Self::names(&arm));
        let own = Self::names(&arm).len();
        let start = problem.file.start.row().get(..own).unwrap_or_default().to_vec();
        let start = C::of(&arm)?.state(&start);
        let (arm, said) = self_filter::filtered(arm, &mut problem, &start, said, &files.interrupt())?;
        Self::with_ends_of(problem, arm, [said, of_ends], held, &files.interrupt())
    }

    /// The scene of a problem, none of whose ends is given by a name any more, and of its arm, with what is said of the arm and of its ends, and
    /// where joints are held.
    fn with_ends_of(
        problem: RobotProblem,
        arm: Arm,
        [said, mut of_ends]: [Vec<String>; 2],
        held: Values,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let Ends { start, goals: parts, entries, said: of_goals } = Self::ends(&problem, &arm, interrupt)?;
        of_ends.extend(of_goals);
        let goals = rows(&parts);
        let first = vec![start.clone()];
        let given = goals.as_ref().unwrap_or(&first);
        let scene = Self::assembled(problem.name.clone(), arm, problem.obstacles.clone(), &start, given);
        let scene = scene.map_err(|e| e.context(what(&problem)))?;
        let mut scene = Self { source: Some(Box::new(problem)), entries, said, of_ends, held, ..scene };
        if goals.is_none() {
            scene.goals = examples(&scene, &parts);
            scene.goal_parts = Some(parts);
        }
        Ok(scene)
    }

    /// What decides which links may touch without being asked for, and what was made of start and goals, in sentences: what of an SRDF was not taken, and
    /// pairs that are left out for being close in every configuration.
    pub fn said(&self) -> Vec<String> {
        [&self.said[..], &self.of_ends].concat()
    }

    /// The arm among its obstacles.
    #[must_use]
    pub fn arm(&self) -> &Arm {
        &self.arm
    }

    /// The problem that it was made from, if it was made from a file.
    #[must_use]
    pub fn problem(&self) -> Option<&RobotProblem> {
        self.source.as_deref()
    }

    /// How far (m) a unit of each factor of the space moves a point of the robot at most.
    fn weights(&self) -> Vec<f64> {
        let length = if self.arm.length() > 0.0 { self.arm.length() } else { 1.0 };
        let base = if self.arm.kinematics().floats() { vec![1.0, 1.0, 1.0, length] } else { Vec::new() };
        // A joint that moves nothing solid still has a weight.
        let joints = self.arm.coordinate_reaches().into_iter().map(|r| r.max(1e-3 * length));
        base.into_iter().chain(joints).collect()
    }

    /// The first number of a configuration that is beyond its limits: its name, the limits, and the number.
    fn beyond(&self, q: &Configuration) -> Option<(String, [f64; 2], f64)> {
        let mut numbers = self.columns().into_iter().zip(self.limits()).zip(self.row(q));
        numbers.find_map(|((column, limits), x)| {
            let [low, high] = limits.filter(|[low, high]| !(low..=high).contains(&&x))?;
            Some((column.name, [low, high], x))
        })
    }

    /// The links that have a shape: index in the model, and mesh.
    fn solid_links(&self) -> impl Iterator<Item = (usize, TriMesh)> {
        let links = self.arm.model().links.iter().enumerate();
        links.filter_map(|(i, link)| Some((i, TriMesh::merged(link.shapes.iter())?)))
    }
}

/// Whether the joint of that name slides.
fn slides(arm: &Arm, name: &str) -> bool {
    let joint = arm.model().joints.iter().find(|joint| joint.name == name);
    joint.is_some_and(|joint| matches!(joint.kind, JointKind::Prismatic { .. }))
}

impl SpeedBound for ArmScene {
    /// The bounds on the motion of links are linear in how far the joints go, wherever they are.
    fn speed_bound(&self, rates: &[f64]) -> f64 {
        let from = self.space.unit_cube_to_state(&vec![0.5; self.arm.dof()]);
        let fastest = rates.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
        if fastest == 0.0 {
            return 0.0;
        }
        // Small enough for no joint to come round.
        let little = 1e-3 / fastest;
        let to = from.iter().zip(rates).map(|(x, rate)| x + rate.abs() * little).collect();
        self.arm.motion_bound(&from, &to) / little * (1.0 + 1e-9)
    }
}

impl Queries for Arm {
    fn queries(&self) -> u64 {
        self.counters().queries()
    }
}

impl<C: LinkedSpace> TypedMotion for LinkedScene<C> {
    type Space = C;
    type Checker = Arm;
    type Verifier<'c> = ArmVerifier<'c, C>;
    fn space(&self) -> &C {
        &self.space
    }
    fn with_ends(&self, start: Configuration, goals: Vec<Configuration>) -> Result<Self, Error> {
        // The lines of the file say nothing about these ends.
        let given_start = C::row(&start);
        Ok(Self { start, given_start, goals, goal_parts: None, source: None, ..self.clone() })
    }
    fn checker(&self) -> &Arm {
        &self.arm
    }
    fn verifier(&self) -> Result<Self::Verifier<'_>, Error> {
        Ok(ArmVerifier::new(&self.space, &self.arm)?)
    }
    fn obstacles<'c>(
        &'c self,
        counted: &dyn Fn() -> Counted<'c, Arm>,
    ) -> ObstacleKnowledge<'c, Configuration> {
        hints_and_gradient(counted)
    }
    fn starting_as(self, row: &[f64]) -> Self {
        Self { given_start: row.to_vec(), ..self }
    }
    fn with_goals(&self, kept: &[bool]) -> Option<Self> {
        fn of<T: Clone>(all: &[T], kept: &[bool]) -> Vec<T> {
            all.iter().zip(kept).filter(|(_, kept)| **kept).map(|(of, _)| of.clone()).collect()
        }
        let (goals, entries) = (of(&self.goals, kept), of(&self.entries, kept));
        let goal_parts = self.goal_parts.as_ref().map(|parts| of(parts, kept));
        Some(Self { goals, entries, goal_parts, ..self.clone() })
    }
    fn keeping(&self, kept: f64) -> Result<Self, Error> {
        Ok(Self { arm: self.arm.clone().keeping(kept), ..self.clone() })
    }
    fn checker_keeping(&self, kept: f64) -> Option<Arm> {
        Some(self.arm.clone().keeping(kept))
    }
}

impl<C: LinkedSpace> Motion for LinkedScene<C> {
    fn start(&self) -> &Configuration {
        &self.start
    }
    fn goals(&self) -> &[Configuration] {
        &self.goals
    }
    fn goal_parts(&self) -> Option<&[Vec<GoalPart>]> {
        self.goal_parts.as_deref()
    }
    fn has_joints(&self) -> bool {
        true
    }
    /// Half of the default: the other half shortens paths by another 1% to 2%, and takes longer than planning and proof together.
    fn effort(&self) -> Effort {
        Effort { attempts: 100, patience: 30, least_gain: 2e-3, taut: 1, rounds: 2 }
    }
    fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        self.arm.make_ready(interrupt)
    }
    fn tolerance(&self) -> f64 {
        self.arm.tolerance()
    }
    /// A five-hundredth of the length of the arm, 2 to 4 mm: its own links leave it little room, where it reaches round them. A fiftieth makes paths
    /// of the Fetch a fifth longer.
    fn shortcut_clearance(&self) -> f64 {
        20.0 * self.tolerance()
    }
    fn kept(&self) -> f64 {
        self.arm.kept()
    }
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error> {
        match metric {
            MetricName::Default => Ok(self.space.measured()),
            // That of the joints alone is their Euclidean metric already.
            MetricName::Euclidean if !self.arm.kinematics().floats() => Ok(self.space.measured()),
            MetricName::Euclidean => {
                Ok(Measured::by_coordinates(&WithMetric::new(self.space.clone(), Euclidean)))
            }
            MetricName::Scaled => {
                let metric = ScaledEuclidean::new(&self.space, self.weights())?;
                Ok(Measured::by_coordinates(&WithMetric::new(self.space.clone(), metric)))
            }
            MetricName::Manhattan => {
                Ok(Measured::by_coordinates(&WithMetric::new(self.space.clone(), Manhattan)))
            }
            _ => Err(no_metric(
                metric,
                "an arm",
                &[MetricName::Default, MetricName::Euclidean, MetricName::Scaled, MetricName::Manhattan],
            )),
        }
    }
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration> {
        self.arm.clone().nearest_free(q, &self.space, 2.0 * self.tolerance())
    }
}

impl<C: LinkedSpace> Description for LinkedScene<C> {
    fn name(&self) -> &str {
        &self.name
    }
    fn reaches_place(&self, q: &Configuration) -> bool {
        self.is_at_place(q)
    }
    fn space_name(&self) -> String {
        let joints = self.arm.coordinates().len();
        match self.arm.kinematics().floats() {
            true => format!("SE3 × {}", crate::count(joints, "joint")),
            false => format!("{joints} joints"),
        }
    }
    fn held(&self) -> Vec<(String, f64, bool)> {
        let joints = self.arm.model().joints.iter().filter(|joint| joint.mimic.is_none());
        let turns = |joint: &Joint| joint.described == Some(JointKind::Continuous);
        joints.filter_map(|joint| Some((joint.name.clone(), joint.kind.held()?, turns(joint)))).collect()
    }
    fn followers(&self) -> Vec<Follower> {
        let follower = |joint: &Joint| {
            let Mimic { joint: leader, multiplier, offset } = joint.mimic.clone()?;
            Some(Follower { name: joint.name.clone(), leader, multiplier, offset })
        };
        self.arm.model().joints.iter().filter_map(follower).collect()
    }
    fn touching(&self, q: &Configuration) -> Vec<Contact> {
        let contacts = self.arm.clone().explain(q.as_slice());
        let touch = |c: mp_robot::ArmContact| Contact {
            part: Some(c.link),
            other: c.other,
            with_itself: c.with_itself,
            depth: Some(c.depth),
        };
        contacts.into_iter().map(touch).collect()
    }
    fn closest(&self, q: &Configuration) -> Option<(String, f64)> {
        let gap = self.arm.clone().closest(q.as_slice())?;
        Some((format!("{} and {}", gap.link, gap.other), gap.distance))
    }
    fn remedy(&self, touching: &[Contact]) -> Option<String> {
        let with_obstacles = touching.iter().filter(|touch| !touch.with_itself);
        let mut links = with_obstacles.filter_map(|touch| touch.part.as_deref());
        if let Some(link) = links.find(|link| self.arm.held_links().any(|held| held == *link)) {
            return Some(format!(
                "no joint moves {link}: let one above it move, or hold it elsewhere (`hold` in the problem file)"
            ));
        }
        let own = touching.iter().filter(|touch| touch.with_itself);
        let pairs: Vec<_> =
            own.map(|touch| [touch.part.as_deref().unwrap_or_default(), &touch.other]).collect();
        self.source.as_deref().filter(|_| !pairs.is_empty()).map(|problem| srdf_help(problem, &pairs))
    }
    fn enclosures(&self, q: &Configuration) -> Vec<[String; 2]> {
        self.arm.clone().enclosures(q.as_slice())
    }
    fn out_of_bounds(&self, q: &Configuration) -> String {
        match self.beyond(q) {
            Some((name, [low, high], x)) => {
                let limits = format!("{name} may be from {} to {}", plain(low), plain(high));
                format!("out of the limits: {}, but {limits}", plain(x))
            }
            None => format!("out of the limits: {}", self.in_words(q)),
        }
    }
    fn bounds_remedy(&self, q: &Configuration) -> String {
        let joint = |name: &String| self.arm.coordinates().iter().any(|c| c.name == *name);
        let Some((name, [low, high], x)) = self.beyond(q).filter(|(name, ..)| joint(name)) else {
            return "move it, or widen the bounds".to_owned();
        };
        // The file names the joint in the table of its robot.
        let file = self.source.as_ref().map(|problem| &problem.file);
        let mut robots = file.into_iter().flat_map(|file| (0..).map(|i| file.prefix(i)).zip(&file.robots));
        let (prefix, entry) = robots.find(|(prefix, _)| name.starts_with(prefix)).unzip();
        let prefix = prefix.unwrap_or_default();
        let bare = name.strip_prefix(&prefix).unwrap_or(&name);
        let table = match prefix.strip_suffix('/') {
            Some(robot) => format!("the [[robot]] \"{robot}\""),
            None => "[robot]".to_owned(),
        };
        let of_base = |entry: &&RobotEntry| {
            let is_limited = entry.limits.iter().any(|(joint, _)| joint == bare);
            entry.planar.is_some() && PLANAR_NUMBERS.contains(&bare) && !is_limited
        };
        if entry.filter(of_base).is_some() {
            return format!("move it, or widen the `bounds` in {table}");
        }
        let is_key = bare.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
        let key = if is_key { bare.to_owned() } else { format!("\"{bare}\"") };
        let [low, high, off] = [low.min(x), high.max(x), (x - x.clamp(low, high)).abs()].map(plain);
        let mut help =
            format!("move it, or widen the limits in {table}: `limits = {{ {key} = [{low}, {high}] }}`");
        if *q == self.start {
            help += &format!(", or for a start that is only a little beyond `limit_tolerance = {off}`");
        }
        help
    }
    fn end_error(&self, end: End, message: String, help: String) -> Error {
        let error = match &self.source {
            Some(problem) => {
                let part = match end {
                    End::Start => RobotFilePart::Start,
                    End::Goal(i) => RobotFilePart::Goal(self.entries.get(i).copied().unwrap_or(i)),
                };
                problem.file.fault(part, &message, &help).into()
            }
            None => Error::new(message).help(help),
        };
        error.context(format!("cannot plan in {}", self.name))
    }
    fn lint(&self) -> Vec<String> {
        let mut found = Vec::new();
        if self.solid_links().next().is_none() {
            found.push("no link has a collision shape: nothing can be hit".to_owned());
        }
        found
    }
    fn columns(&self) -> Vec<Column> {
        let slides = |name: &str| slides(&self.arm, name);
        let names = self.arm.coordinates().iter().map(|c| c.name.as_str());
        let base = C::BASE.iter().map(|(name, unit)| Column::new(*name, *unit));
        base.chain(names.map(|name| Column::new(name, if slides(name) { "m" } else { "rad" }))).collect()
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        let limits = |range: JointRange| match range {
            JointRange::Interval { low, high } => Some([low, high]),
            JointRange::Circle => None,
        };
        let base = self.arm.model().floating.iter().flat_map(|bounds| {
            let side = |i: usize| (i < 3).then(|| [bounds.min[i], bounds.max[i]]);
            (0..C::BASE.len()).map(side)
        });
        base.chain(self.arm.coordinates().iter().map(|c| limits(c.range))).collect()
    }
    fn rates(&self) -> Option<Vec<[Option<f64>; 3]>> {
        let rates = || self.arm.coordinates().iter().map(|c| self.arm.model().rates(&c.name)).collect();
        C::BASE.is_empty().then(rates)
    }
    fn details(&self) -> Vec<(String, String)> {
        let links = crate::count(self.arm.model().links.len(), "link");
        let base = match self.arm.kinematics().floats() {
            true => "floats: its pose is part of a configuration".to_owned(),
            false => plain_row(&six_from_pose(&self.arm.model().base)),
        };
        let pairs = crate::count(self.arm.checked_pairs().len(), "pair");
        let mut details = vec![
            ("arm".to_owned(), format!("{links}, at most {} m long", brief(self.arm.length()))),
            ("base".to_owned(), base),
            ("pairs".to_owned(), format!("{pairs} of links must not touch")),
        ];
        let urdf = |robot: &DescribedRobot| ("urdf".to_owned(), robot.urdf_file.display().to_string());
        details.splice(0..0, self.source.iter().flat_map(|problem| problem.robots.iter().map(urdf)));
        let goals = self.goal_parts.iter().flatten().map(|goal| crate::goals::written(self, goal));
        details.extend(goals.map(|goal| ("goal is".to_owned(), goal)));
        // Those that are said are among the notes of the scene.
        let notes = self.arm.notes().filter(|note| !self.said.contains(note));
        details.extend(notes.map(|note| ("note".to_owned(), note.clone())));
        details
    }
    fn row(&self, q: &Configuration) -> Vec<f64> {
        C::row(q)
    }
    fn state(&self, row: &[f64]) -> Configuration {
        self.space.state(row)
    }
    fn given_start(&self) -> Vec<f64> {
        self.given_start.clone()
    }
    fn rows(&self, path: &Path<Configuration>) -> Vec<Vec<f64>> {
        let rows: Vec<_> = path.states.iter().map(|q| self.row(q)).collect();
        let mut rows = continued(&turning(self), &self.given_start, rows);
        // The angles of a pose depend on each other.
        let mut last = self.given_start.first_chunk::<6>().copied().filter(|_| !C::BASE.is_empty());
        for row in &mut rows {
            if let (Some(before), Some(six)) = (&last, row.first_chunk_mut::<6>()) {
                *six = continued_six(before, six);
                last = Some(*six);
            }
        }
        rows
    }
    fn motion_model(&self) -> Result<MotionModel, Error> {
        let kinematics = self.arm.kinematics();
        let base = C::BASE.len();
        let turns = |c: &Coordinate| c.range == JointRange::Circle;
        let joints = kinematics.coordinates().iter().enumerate();
        let joints =
            joints.map(|(i, c)| if turns(c) { Step::Circle(base + i) } else { Step::Line(base + i) });
        let mut model = MotionModel {
            steps: (base > 0).then_some(Step::Pose(0)).into_iter().chain(joints).collect(),
            ..MotionModel::default()
        };
        match base {
            0 => drop(model.still_frame(&self.arm.model().base)),
            _ => model.frames.push(ModelFrame::Pose { first: 0 }),
        }
        model.frames.extend(kinematics.joint_frames().iter().map(|joint| ModelFrame::Joint {
            parent: joint.parent,
            origin: seven(&joint.origin),
            axis: [joint.axis.x, joint.axis.y, joint.axis.z],
            slides: joint.slides,
            column: Some(base + joint.coordinate),
            factor: joint.scale,
            offset: joint.offset,
        }));
        let (mut moved, mut body_of) = (Vec::new(), Vec::new());
        let compared: HashSet<&str> = self.arm.compared_with_obstacles().collect();
        for (i, mesh) in self.solid_links() {
            let link = &kinematics.attached()[i];
            model.frames.push(ModelFrame::Fixed { parent: Some(link.frame), pose: seven(&link.pose) });
            if compared.contains(&*link.name) {
                moved.push(model.bodies.len());
            }
            body_of.push(link.name.as_str());
            model.bodies.push(ModelBody::mesh(&link.name, model.frames.len() - 1, &mesh).robot());
        }
        let find = |name: &str| body_of.iter().position(|link| *link == name);
        for [a, b] in self.arm.checked_pairs() {
            let (Some(body), Some(other)) = (find(a), find(b)) else {
                return Err(Error::new(format!("{a} and {b} have no shape, and must not touch")));
            };
            model.pairs.push(ModelPair { body, others: vec![other] });
        }
        let obstacles = self.obstacles.iter().map(|o| {
            let frame = model.still_frame(&o.pose);
            ModelBody::mesh(&o.name, frame, &o.mesh)
        });
        let obstacles = obstacles.collect();
        model.add_obstacles(obstacles, moved);
        Ok(model)
    }
}

impl<C: LinkedSpace> Appearance for LinkedScene<C> {
    fn bodies(&self) -> Vec<Body> {
        let name = |i: usize| self.arm.model().links[i].name.clone();
        let links: Vec<_> = self.solid_links().collect();
        let meshes = links.iter().map(|(_, mesh)| mesh).chain(self.obstacles.iter().map(|o| &o.mesh));
        let together = meshes.map(TriMesh::count_of_balls).sum();
        let obstacles = Body::obstacles(&self.obstacles, together);
        let link = |(i, mesh): (usize, TriMesh)| Body {
            name: name(i),
            shape: BodyShape::Mesh(mesh.drawn(together)),
            pose: None,
        };
        links.into_iter().map(link).chain(obstacles).collect()
    }
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>> {
        let all = self.arm.kinematics().link_poses(q.as_slice()).unwrap_or_default();
        self.solid_links().filter_map(|(i, _)| all.get(i).copied()).collect()
    }
    fn traced(&self, q: &Configuration) -> nalgebra::Point3<f64> {
        if let Some(base) = C::base(q) {
            return base.translation.vector.into();
        }
        // In most files the last link is the one farthest down the tree.
        let all = self.arm.kinematics().link_poses(q.as_slice()).unwrap_or_default();
        all.last().map_or(nalgebra::Point3::origin(), |pose| pose.translation.vector.into())
    }
    fn picture_spacing(&self) -> f64 {
        C::PICTURE_SPACING * self.arm.length()
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        self.arm.model().floating
    }
}
