//! Kinds of robots: the interface between a scene and the rest of this crate.

pub mod counted;
pub mod motion;

mod arm;
mod constrained;
mod driven;
mod model;
mod moving;
mod planar;
mod rigid;

pub use arm::{ArmScene, FloatingScene, LinkedScene, LinkedSpace, Reached};
pub use arm::{model_of, read_robots};
pub use constrained::{Constrained, Constraint};
pub use driven::greatest_speed;
pub use driven::{Drivable, DrivenScene, SpeedBound};
pub use model::{Drive, DriveModel, ModelBody, ModelFrame, ModelPair, ModelPart, MotionModel, Step};
pub use moving::{MovingScene, WithMoving};
pub use planar::{PlanarBody, PlanarScene};
pub use rigid::{RigidScene, RigidSpace};

use crate::numbers::plain;
use crate::robot::motion::AnyMotion;
use crate::turns::continued;
use crate::turns::turning;
use crate::{Error, Length, MetricName};
use mp_cspace::erased::{AnyIndex, AnySpace, CompiledIndex};
use mp_cspace::{
    Configuration, DefaultNn, Demand, Factored as _, InputSystem, Interrupt, Interrupted, MotionClearance,
    MotionValidity, ObstacleKnowledge, OnVectors, Space as _, Validity,
    nn::Embed,
    obstacles::{ClearanceGradient, ObstacleHints},
};
use mp_geom::{Aabb, TriMesh};
pub use mp_io::Column;
use mp_io::{Follower, PlacedBody};
use nalgebra::{Isometry3, Point2, Point3, Vector3};
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::collections::HashMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A joint that is beyond a limit by no more than this (rad or m) is taken to be at the limit: encoders, numbers of single precision, and
/// limits with five decimals, as 3.14159 is for half a turn, are as far off.
const HAIR: f64 = 1e-5;

/// A number, or the limit that it is beyond by at most `hair`.
fn at_limit(x: f64, [low, high]: [f64; 2], hair: f64) -> f64 {
    let near = x.max(low).min(high);
    if (x - near).abs() <= hair { near } else { x }
}

/// The numbers of a row, at their [limits](Description::limits) where they are a hair beyond: as robots take it.
#[must_use]
pub fn at_limits(row: &[f64], limits: &[Option<[f64; 2]>]) -> Vec<f64> {
    let limits = limits.iter().copied().chain(std::iter::repeat(None));
    row.iter().zip(limits).map(|(x, limits)| limits.map_or(*x, |limits| at_limit(*x, limits, HAIR))).collect()
}

/// A coordinate, or the side of its bounds that it is a [`HAIR`] beyond: of bounds less than a metre wide, that share of their width.
fn at_side(x: f64, [low, high]: [f64; 2]) -> f64 {
    at_limit(x, [low, high], HAIR * (high - low).min(1.0))
}

/// A pose with its position [at the side](at_side) of the bounds where it is a hair outside.
fn at_sides(pose: Isometry3<f64>, [low, high]: [&Vector3<f64>; 2]) -> Isometry3<f64> {
    let position = pose.translation.vector.zip_zip_map(low, high, |x, low, high| at_side(x, [low, high]));
    Isometry3::from_parts(position.into(), pose.rotation)
}

/// The text form of the paths of a robot: docs/formats/path.md describes both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PathFormat {
    /// A GEMPA configuration file: a count, then six-tuples x y z α β γ.
    Poses,
    /// Two counts, then one configuration on each line.
    #[default]
    Joints,
}

/// A body of a scene, for pictures and viewers.
#[derive(Clone, Debug)]
pub struct Body {
    /// The name that messages give it.
    pub name: String,
    /// Its shape, in its own frame, metres.
    pub shape: BodyShape,
    /// Its pose in the world; `None` for a body of the robot, whose pose [`poses`](Appearance::poses) gives.
    pub pose: Option<Isometry3<f64>>,
}

impl Body {
    /// Obstacles: meshes that stand still, in a picture of `together` balls. Equal ones share their memory.
    pub(crate) fn obstacles(bodies: &[PlacedBody], together: usize) -> Vec<Self> {
        let mut drawn = HashMap::new();
        let obstacle = |body: &PlacedBody| {
            let memory = [body.mesh.vertices().as_ptr().addr(), body.mesh.balls().as_ptr().addr()];
            let mesh = match body.mesh.is_balls() {
                true => drawn.entry(memory).or_insert_with(|| body.mesh.drawn(together)).clone(),
                false => body.mesh.drawn(together),
            };
            Self { name: body.name.clone(), shape: BodyShape::Mesh(mesh), pose: Some(body.pose) }
        };
        bodies.iter().map(obstacle).collect()
    }
}

/// What is drawn of a body, in the frame of the body.
#[derive(Clone, Debug)]
pub enum BodyShape {
    /// Triangles in space.
    Mesh(TriMesh),
    /// Rings around an area of the plane z = 0, the outer ring first. The last point of a ring is joined to its first.
    Area(Vec<Vec<Point2<f64>>>),
    /// Lines in the plane z = 0, such as walls.
    Lines(Vec<Vec<Point2<f64>>>),
}

/// A contact of the robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// The part of the robot that touches, if the robot has several.
    pub part: Option<String>,
    /// What it touches: an obstacle, or another part of the robot.
    pub other: String,
    /// Whether `other` is a part of the robot.
    pub with_itself: bool,
    /// An estimate of the depth, metres, if there is one.
    pub depth: Option<f64>,
}

impl fmt::Display for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(part) = &self.part {
            write!(f, "{part} in ")?;
        }
        f.write_str(&self.other)?;
        if self.with_itself {
            f.write_str(" of the robot")?;
        }
        match self.depth {
            Some(depth) => write!(f, " ({} m deep)", crate::brief(depth)),
            None => Ok(()),
        }
    }
}

/// The start or a goal of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// The start of the problem.
    Start,
    /// The goal with this index.
    Goal(usize),
}

/// What planners check configurations and motions with. It counts its queries.
///
/// Clones share large data. Each clone has its own counters and scratch memory.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot check configurations of type `{S}`",
    note = "a checker is `Validity + MotionClearance + Queries + Clone + Send + Sync`"
)]
pub trait Checker<S>: Validity<S> + MotionClearance<S> + Queries + Clone + Send + Sync {}
impl<S, R: Validity<S> + MotionClearance<S> + Queries + Clone + Send + Sync> Checker<S> for R {}

/// A count of queries.
pub trait Queries {
    /// How many collision and clearance queries this clone has answered so far.
    fn queries(&self) -> u64;
}

impl<A: Queries, S> Queries for OnVectors<A, S> {
    fn queries(&self) -> u64 {
        self.inner().queries()
    }
}

/// A space under a metric chosen at run time, with a nearest-neighbour index for it: see [`Motion::measured`].
#[derive(Clone, Debug)]
pub struct Measured<'c> {
    /// The space under the metric.
    pub space: AnySpace<'c, Configuration>,
    /// An empty index of it.
    pub index: AnyIndex<Configuration>,
}

impl Measured<'_> {
    /// A copy of `space` with the default index for it.
    pub fn new<C>(space: &C) -> Self
    where
        C: DefaultNn<State = Configuration, Nn: 'static> + Clone + Send + 'static,
    {
        Self { space: AnySpace::new(space), index: AnyIndex::of(space) }
    }

    /// As [`new`](Self::new), for a space whose index is compiled in mp-cspace.
    pub fn compiled<C: CompiledIndex<State = Configuration>>(space: &C) -> Self {
        Self { space: AnySpace::new(space), index: space.compiled_index() }
    }

    /// A copy of `space` with an index over coordinates, which is compiled once for all spaces.
    pub fn by_coordinates<C: Embed<State = Configuration> + Clone + Send + 'static>(space: &C) -> Self {
        Self { space: AnySpace::new(space), index: AnyIndex::by_coordinates(space) }
    }
}

/// How many times finer than planners the verifiers of robots that are [sampled](Motion::sampled) test motions.
pub const VERIFIED_FINER: f64 = 20.0;

/// A robot of some kind among its obstacles, with start and goals: a scene to plan in. What it is asked is cut in three by who asks:
/// planners its [`Motion`], messages and files its [`Description`], pictures its [`Appearance`].
///
/// Rigid bodies ([`RigidScene`]), arms ([`ArmScene`], [`FloatingScene`]) and robots of the plane ([`PlanarScene`]) are robots. To add a
/// kind, implement [`TypedMotion`](crate::TypedMotion) and the three parts; `Scene::new` of mp-plan makes a scene of it, and
/// the rest of this crate works with it: planning by name, checking, explaining, shortening, relaxing, roadmaps. docs/own-robot.md is
/// a guide.
pub trait Robot: Motion + Description + Appearance + Any + fmt::Debug + Send + Sync {}
impl<K: Motion + Description + Appearance + Any + fmt::Debug + Send + Sync> Robot for K {}

/// What planners ask of a robot, beside its [typed motions](crate::TypedMotion).
pub trait Motion: AnyMotion {
    /// Where paths begin.
    fn start(&self) -> &Configuration;

    /// The goal configurations, at least one.
    fn goals(&self) -> &[Configuration];

    /// What each goal asks of each number of a configuration, if that is not to be one of the configurations
    /// [`goals`](Self::goals), which are then examples.
    fn goal_parts(&self) -> Option<&[Vec<mp_io::GoalPart>]> {
        None
    }

    /// Whether the robot can make the motion at all, obstacles aside. By default it can make any.
    fn can_move(&self, _from: &Configuration, _to: &Configuration) -> bool {
        true
    }

    /// What planners must be able to do to plan for it. By default nothing special.
    fn demands(&self) -> &'static [Demand] {
        &[]
    }

    /// Whether joints move it. The planner `auto` has other searches then.
    fn has_joints(&self) -> bool {
        false
    }

    /// How the robot moves by inputs, if it can move in no other way.
    fn input_system(&self) -> Option<InputSystem<'_, Configuration>> {
        None
    }

    /// The planner that is taken when none is named.
    fn default_planner(&self) -> &'static str {
        "auto"
    }

    /// How much work shortening puts into a path.
    fn effort(&self) -> mp_cspace::shorten::Effort {
        mp_cspace::shorten::Effort::default()
    }

    /// The path made shorter, for robots that straight motions do not suit, as those moved by inputs; `None`, the default, where
    /// shortcuts can be straight. `check` says which motions are free. The same random numbers give the same path.
    fn shortened(
        &self,
        _path: &mp_cspace::Path<Configuration>,
        _check: &mut dyn MotionValidity<Configuration>,
        _effort: mp_cspace::shorten::Effort,
        _rng: &mut mp_cspace::Rng,
    ) -> Option<mp_cspace::Path<Configuration>> {
        None
    }

    /// Makes what the first [verifier](AnyMotion::any_verifier) would make otherwise, if that takes long, unless `interrupt` says to end: it is a
    /// part of loading. By default nothing.
    ///
    /// # Errors
    /// When it was interrupted.
    fn make_ready(&self, _interrupt: &Interrupt) -> Result<(), Interrupted> {
        Ok(())
    }

    /// The clearance (m) that certified checks resolve: a motion that comes nearer to contact is not free.
    fn tolerance(&self) -> f64;

    /// The clearance (m) that it [keeps](crate::TypedMotion::keeping) from obstacles: by default none.
    fn kept(&self) -> f64 {
        0.0
    }

    /// How far apart configurations are tested along motions, where no clearance is known that could certify them: then only
    /// [`Validity`] is asked, a request for `certified` motions means this, and reports give no clearance. The verifier should cut a motion into the
    /// fewest equal parts that are [`VERIFIED_FINER`] times shorter: shortening tests some of the same configurations. By default motions are
    /// certified.
    fn sampled(&self) -> Option<Length> {
        None
    }

    /// The same robot, which remembers of which configurations it has said that they are free, and of which that they are not, as long as it lives: for
    /// robots that take long to answer. Shortening and verifying a path ask about many configurations more than once. By default there is none.
    fn remembering(&self) -> Option<Arc<dyn Robot>> {
        None
    }

    /// The accuracy of the clearance reported for a path, metres.
    fn accuracy(&self) -> f64 {
        self.tolerance()
    }

    /// The clearance (m) that shortcuts keep where there is room, unless a clearance was asked for ([`kept`](Self::kept)). For the robots
    /// of this crate it is a fiftieth of their size, because a path that grazes every corner is of no use. In narrower passages
    /// shortcuts keep a tenth of it.
    fn shortcut_clearance(&self) -> f64 {
        200.0 * self.tolerance()
    }

    /// The space under a metric, with an index for it.
    ///
    /// # Errors
    /// When the robot does not support the metric.
    fn measured(&self, metric: MetricName) -> Result<Measured<'_>, Error>;

    /// A free configuration near one that is not.
    fn nearest_free(&self, q: &Configuration) -> Option<Configuration>;

    /// A hash of everything that a roadmap depends on: scene, robot and metric. `None` if roadmaps of such robots cannot
    /// be saved.
    fn fingerprint(&self, _metric: MetricName) -> Option<u64> {
        None
    }
}

/// What messages and files ask of a robot: what its numbers mean, and what is wrong with them.
pub trait Description: Motion {
    /// The name of the scene.
    fn name(&self) -> &str;

    /// The name of the space in reports: `SE3`, `6 joints`.
    fn space_name(&self) -> String;

    /// The pairs of bodies in contact at a configuration; none if it is free.
    fn touching(&self, q: &Configuration) -> Vec<Contact>;

    /// What is nearest to contact at a configuration, as messages name it, such as `tool and table`, and how far apart that is (m). By
    /// default it is not known.
    fn closest(&self, _q: &Configuration) -> Option<(String, f64)> {
        None
    }

    /// The joints that follow others, which are no numbers of a configuration. By default there are none.
    fn followers(&self) -> Vec<Follower> {
        Vec::new()
    }

    /// The joints that the scene holds, where (rad or m), and whether whole turns make no difference to them. By default there are none.
    fn held(&self) -> Vec<(String, f64, bool)> {
        Vec::new()
    }

    /// What to do about contacts at the start or a goal, besides moving it. By default there is nothing else.
    fn remedy(&self, _touching: &[Contact]) -> Option<String> {
        None
    }

    /// The [constraint](crate::Constraint) that does not hold at a configuration. By default there is none.
    fn broken(&self, _q: &Configuration) -> Option<String> {
        None
    }

    /// What is wholly inside of a closed surface at a configuration that is free: pairs of names, the inner one first. By default
    /// nothing.
    fn enclosures(&self, _q: &Configuration) -> Vec<[String; 2]> {
        Vec::new()
    }

    /// What is odd about the scene apart from its ends, such as obstacles that overlap.
    fn lint(&self) -> Vec<String> {
        Vec::new()
    }

    /// What is odd about start and goal together without being an error, such as being inside of different solids.
    fn ends_error(&self) -> Option<String> {
        None
    }

    /// What to do about a configuration that is out of bounds.
    fn bounds_remedy(&self, _q: &Configuration) -> String {
        "move it, or widen the bounds".to_owned()
    }

    /// Why a configuration is out of bounds, to follow the words "the start is". By default it lists all of its numbers, and says what the first one
    /// that is beyond its limits may be.
    fn out_of_bounds(&self, q: &Configuration) -> String {
        let numbers = self.columns().into_iter().zip(self.limits()).zip(self.row(q));
        let mut beyond = numbers.filter_map(|((column, limits), x)| {
            let [low, high] = limits.filter(|[low, high]| !(*low..=*high).contains(&x))?;
            Some(format!("; {} may be from {} to {}", column.name, plain(low), plain(high)))
        });
        format!("out of bounds: {}{}", self.in_words(q), beyond.next().unwrap_or_default())
    }

    /// An error about one end of the problem. A scene from a file adds the line; the default does not.
    fn end_error(&self, _end: End, message: String, help: String) -> Error {
        Error::new(message).help(help)
    }

    /// The meaning of each number of a configuration.
    fn columns(&self) -> Vec<Column>;

    /// The least and the largest value of each number, in the order of the columns; `None` for an angle without limits.
    fn limits(&self) -> Vec<Option<[f64; 2]>>;

    /// The limits of velocity (rad/s or m/s), acceleration (per s²) and jerk (per s³) of each number, where they are known. `None`, the default, if
    /// there are no [trajectories](mp_time::Trajectory) of the robot: then its numbers are not joints that move by themselves.
    fn rates(&self) -> Option<Vec<[Option<f64>; 3]>> {
        None
    }

    /// Further facts about the robot, for people: name and text.
    fn details(&self) -> Vec<(String, String)> {
        Vec::new()
    }

    /// The format in which paths are written as text.
    fn path_format(&self) -> PathFormat {
        PathFormat::Joints
    }

    /// The numbers of one configuration.
    fn row(&self, q: &Configuration) -> Vec<f64>;

    /// The configuration of a row that has as many numbers as there are columns.
    fn state(&self, row: &[f64]) -> Configuration;

    /// The rows of a path: by default one for each state, in which angles without limits go on from row to row by the shorter way,
    /// beginning at the [given start](Self::given_start). Rows may be added for readers that interpolate the numbers.
    fn rows(&self, path: &mp_cspace::Path<Configuration>) -> Vec<Vec<f64>> {
        let rows = path.states.iter().map(|q| self.row(q)).collect();
        continued(&turning(self), &self.given_start(), rows)
    }

    /// The row of the start, with its angles as they were given. These may differ by whole turns from those of [`row`](Self::row),
    /// which is the default.
    fn given_start(&self) -> Vec<f64> {
        self.row(self.start())
    }

    /// Writes the problem to `folder` for other planners, as docs/formats/export.md describes. Returns the main file.
    ///
    /// # Errors
    /// When such robots cannot be exported, or a file cannot be written.
    fn export(&self, _folder: &Path) -> Result<PathBuf, Error> {
        Err(Error::new(format!("{} is no rigid body among meshes: only those are exported", self.name()))
            .help("its files are text already"))
    }

    /// Everything that decides whether a path is free, as numbers, for certificates: see docs/formats/certificate.md.
    ///
    /// # Errors
    /// When there is no model of such robots. By default there is none.
    fn motion_model(&self) -> Result<MotionModel, Error> {
        Err(Error::new("there are no certificates for this kind of robot")
            .help("implement `Robot::motion_model` for it"))
    }

    /// What a row says that no configuration has, such as a height in the plane; words to follow "the start". None by default.
    fn row_fault(&self, _row: &[f64]) -> Option<&'static str> {
        None
    }

    /// What is wrong with rows from a file apart from their length, such as leaving the plane.
    fn row_error(&self, rows: &[Vec<f64>]) -> Option<String> {
        let fault =
            |(i, row): (usize, &Vec<f64>)| Some(format!("configuration {} {}", i + 1, self.row_fault(row)?));
        rows.iter().enumerate().find_map(fault)
    }

    /// How far a configuration is from the one that it should be, and how far it may be. Files often have only four digits, so
    /// it may be 1e-3; where the range of a number is below 0.1, that number may be a hundredth of its range off.
    fn deviation(&self, q: &Configuration, wanted: &Configuration) -> Deviation {
        let space = self.any_space();
        let mut near = true;
        space.each_factor(q, wanted, &mut |i, off| near &= off <= 0.01 * space.factor_extent(i));
        let allowed = if near { 1e-3 } else { 0.0 };
        Deviation { off: space.distance(q, wanted), allowed, unit: "" }
    }

    /// Whether a link is where a goal that is a place wants it: [`goals`](Motion::goals) has only some of the configurations that reach it.
    fn reaches_place(&self, _q: &Configuration) -> bool {
        false
    }

    /// A configuration as text for messages.
    fn in_words(&self, q: &Configuration) -> String {
        format!("[{}]", self.row(q).into_iter().map(plain).collect::<Vec<_>>().join(", "))
    }
}

/// What pictures, films and viewers ask of a robot.
pub trait Appearance {
    /// The bodies of the scene: those of the robot first, then the obstacles.
    fn bodies(&self) -> Vec<Body>;

    /// How many of the last bodies of the robot are obstacles that move.
    fn moving_obstacles(&self) -> usize {
        0
    }

    /// The poses of the bodies of the robot, in the order of [`bodies`](Self::bodies).
    fn poses(&self, q: &Configuration) -> Vec<Isometry3<f64>>;

    /// The point whose curve a picture shows: by default the origin of the last body of the robot.
    fn traced(&self, q: &Configuration) -> Point3<f64> {
        self.poses(q).last().map_or(Point3::origin(), |pose| Point3::from(pose.translation.vector))
    }

    /// How long a motion takes, seconds, if its states say so: films then run in time, and else at even speed.
    fn seconds(&self, _from: &Configuration, _to: &Configuration) -> Option<f64> {
        None
    }

    /// The distance between two copies of the robot along a path in a picture: about how far its points move, metres.
    fn picture_spacing(&self) -> f64;

    /// The bounds of the robot's origin, for pictures that show them.
    fn picture_bounds(&self) -> Option<Aabb> {
        None
    }

    /// Whether the scene is best seen from above.
    fn is_planar(&self) -> bool {
        false
    }

    /// The problem, if the robot is a rigid body among meshes: front ends edit such scenes.
    fn rigid_problem(&self) -> Option<&mp_io::RigidProblem> {
        None
    }
}

/// How far a configuration is from the one that it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// How far it is.
    pub off: f64,
    /// How far it may be.
    pub allowed: f64,
    /// The unit, such as ` m`; empty if the numbers have no common unit.
    pub unit: &'static str,
}

impl Deviation {
    /// Whether it is at most as far off as allowed; false for NaN.
    #[must_use]
    pub fn is_near(&self) -> bool {
        self.off <= self.allowed
    }
}

pub use crate::robot::counted::Counted;

/// What checkers that `counted` makes know of obstacles: hints, and the clearance gradient.
pub(crate) fn hints_and_gradient<'c, R>(
    counted: &dyn Fn() -> Counted<'c, R>,
) -> ObstacleKnowledge<'c, Configuration>
where
    R: ObstacleHints<Configuration> + ClearanceGradient<Configuration> + Queries + Send + 'c,
{
    let mut checker = counted();
    let gradient = move |q: &Configuration, reach: f64, gradient: &mut [f64]| {
        checker.clearance_gradient(q, reach, gradient)
    };
    ObstacleKnowledge {
        hints: Some(Box::new(counted())),
        gradient: Some(Box::new(gradient)),
        ..ObstacleKnowledge::default()
    }
}

/// An error for a metric that a robot does not support.
pub(crate) fn no_metric(metric: MetricName, robot: &str, has: &[MetricName]) -> Error {
    let names: Vec<_> = has.iter().map(|m| m.name()).collect();
    Error::new(format!("{robot} cannot be measured by the metric `{metric}`"))
        .help(format!("take one of: {}", names.join(", ")))
}
