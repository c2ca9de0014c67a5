//! Kinds of robots: what a scene is made of, as the rest of this crate sees it.

mod arm;
mod planar;
mod rigid;
mod tuples;

pub use arm::ArmScene;
pub use planar::{PlanarBody, PlanarScene};
pub use rigid::{RigidScene, RigidSpace};

use crate::numbers::plain;
use crate::roadmaps::RoadmapState;
use crate::{Error, Metric};
use mp_cspace::erased::{AnyIndex, AnySpace, CompiledIndex, CoordinateState};
use mp_cspace::{
    DefaultNn, Factored, MotionClearance, MotionValidity, ObstacleKnowledge, Space as _, StateVector,
    Validity,
    nn::Embed,
    obstacles::{ClearanceGradient, ObstacleHints},
};
use mp_geom::{Aabb, TriMesh};
use mp_io::PlacedBody;
use mp_tree::TreeState;
use nalgebra::{Isometry3, Point2, Point3};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};

/// What one number of a configuration is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Its name: `x`, `yaw`, or that of a joint.
    pub name: String,
    /// `m` or `rad`.
    pub unit: String,
}

impl Column {
    /// A column.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
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
    /// What messages call it.
    pub name: String,
    /// What it looks like, in its own frame, metres.
    pub shape: BodyShape,
    /// Where it stands in the world; `None` for a body that moves with the robot:
    /// [`poses`](RobotKind::poses) tells where that is.
    pub pose: Option<Isometry3<f64>>,
}

impl Body {
    /// An obstacle: a mesh that stands still.
    pub(crate) fn obstacle(body: &PlacedBody) -> Self {
        Self { name: body.name.clone(), shape: BodyShape::Mesh(body.mesh.clone()), pose: Some(body.pose) }
    }
}

/// What a body looks like.
#[derive(Clone, Debug)]
pub enum BodyShape {
    /// A mesh.
    Mesh(TriMesh),
    /// Rings around an area of the plane z = 0, the outer one first; the last point of a ring is joined to its first.
    Area(Vec<Vec<Point2<f64>>>),
    /// Lines in the plane z = 0, such as walls.
    Lines(Vec<Vec<Point2<f64>>>),
}

/// Something that touches something else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// The part of the robot, where it has several.
    pub part: Option<String>,
    /// What it touches: an obstacle, or another part of the robot.
    pub other: String,
    /// Whether `other` is a part of the robot.
    pub with_itself: bool,
    /// An estimate of how deep, metres, where one is known.
    pub depth: Option<f64>,
}

impl fmt::Display for Touch {
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

/// Which end of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum End {
    /// Where paths begin.
    Start,
    /// Where they may end: which of the goals.
    Goal(usize),
}

/// What answers the questions of planners about a configuration, and counts them.
///
/// Clones share what is large; each has counters and scratch memory of its own.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot check configurations of type `{S}`",
    note = "a checker is `Validity + MotionClearance + Queries + Clone + Send + Sync`"
)]
pub trait Checker<S>: Validity<S> + MotionClearance<S> + Queries + Clone + Send + Sync {}
impl<S, R: Validity<S> + MotionClearance<S> + Queries + Clone + Send + Sync> Checker<S> for R {}

/// What counts its queries.
pub trait Queries {
    /// How many collision and clearance queries this clone was asked so far.
    fn queries(&self) -> u64;
}

/// A space chosen at run time with the index that suits it, for [`RobotKind::measured`].
#[derive(Clone, Debug)]
pub struct Measured<'c, S> {
    /// The space under some metric.
    pub space: AnySpace<'c, S>,
    /// An empty index of it.
    pub index: AnyIndex<S>,
}

impl<'c, S> Measured<'c, S> {
    /// A copy of `space` with the index that suits it.
    pub fn new<C: DefaultNn<State = S, Nn: 'static> + Clone + Send + 'static>(space: &C) -> Self {
        Self { space: AnySpace::new(space), index: AnyIndex::of(space) }
    }

    /// The same of a space whose index mp-cspace has compiled.
    pub fn compiled<C: CompiledIndex<State = S>>(space: &C) -> Self {
        Self { space: AnySpace::new(space), index: space.compiled_index() }
    }

    /// A copy of `space` with an index by coordinates that is compiled once for all spaces of these states.
    pub fn by_coordinates<C: Embed<State = S> + Clone + Send + 'static>(space: &C) -> Self
    where
        S: CoordinateState,
    {
        Self { space: AnySpace::new(space), index: AnyIndex::by_coordinates(space) }
    }
}

/// A kind of robot among its obstacles, with start and goals: a scene made ready to plan in.
///
/// Rigid bodies ([`RigidScene`]), arms ([`ArmScene`]) and robots of the plane ([`PlanarScene`]) are such. A new kind
/// is a type that implements this trait; [`Scene::new`](crate::Scene::new) makes a scene of it, and all the rest of
/// this crate works: planning by name, checking, explaining, shortening, relaxing, roadmaps. Its type of
/// configuration must be one of those that planners are compiled for, or be made one by
/// [`compile_for!`](mp_tree::compile_for) of mp-tree and mp-roadmap. docs/own-robot.md is a guide.
pub trait RobotKind: fmt::Debug + Send + Sync {
    /// A configuration.
    type State: TreeState + RoadmapState + StateVector + 'static;
    /// The space of configurations, under its own metric.
    type Space: Factored<State = Self::State> + Clone + Send + fmt::Debug;
    /// What checks configurations and motions while planning.
    type Checker: Checker<Self::State>;
    /// The independent check of finished paths: it shares no code with the checker.
    type Verifier<'c>: MotionValidity<Self::State> + Clone + Send + Sync
    where
        Self: 'c;

    /// The name of the scene.
    fn name(&self) -> &str;
    /// What reports call the space: `SE3`, `6 joints`.
    fn space_name(&self) -> String;
    /// The space.
    fn space(&self) -> &Self::Space;
    /// Where paths begin.
    fn start(&self) -> &Self::State;
    /// Where they may end, at least one.
    fn goals(&self) -> &[Self::State];

    /// What checks configurations. Clone it to ask.
    fn checker(&self) -> &Self::Checker;
    /// A verifier.
    ///
    /// # Errors
    /// When the robot cannot be verified.
    fn verifier(&self) -> Result<Self::Verifier<'_>, Error>;
    /// The clearance (m) that certified checks resolve: what comes nearer to contact is not free.
    fn tolerance(&self) -> f64;
    /// How well the clearance of a path is told, metres.
    fn accuracy(&self) -> f64 {
        self.tolerance()
    }
    /// The clearance (m) that shortcuts keep where planning may go as near as the tolerance: a path that grazes every
    /// corner is of no use to anybody.
    fn shortcut_clearance(&self) -> f64 {
        20.0 * self.tolerance()
    }
    /// What planners may know of the obstacles, asked of the checkers that `counted` makes: their queries are counted.
    /// By default nothing; planners that need more refuse the robot.
    fn obstacles<'c>(
        &'c self,
        _counted: &dyn Fn() -> Counted<'c, Self::Checker>,
    ) -> ObstacleKnowledge<'c, Self::State> {
        ObstacleKnowledge::default()
    }
    /// The space under a metric, with an index. By default the space knows only its own metric.
    ///
    /// # Errors
    /// When the robot has no such metric.
    fn measured(&self, metric: Metric) -> Result<Measured<'_, Self::State>, Error>;

    /// What touches what at a configuration.
    fn touching(&self, q: &Self::State) -> Vec<Touch>;
    /// A free configuration near one that is not.
    fn nearest_free(&self, q: &Self::State) -> Option<Self::State>;
    /// What is odd about the scene beside its ends: obstacles that overlap, no obstacles at all, …
    fn lint(&self) -> Vec<String> {
        Vec::new()
    }
    /// What is odd about start and goal together that is no error, such as being inside of different solids.
    fn odd_ends(&self) -> Option<String> {
        None
    }
    /// Why a configuration is out of bounds, after "the start is". By default with all of its numbers.
    fn out_of_bounds(&self, q: &Self::State) -> String {
        format!("out of bounds: {}", self.written(q))
    }
    /// An error about one end of the problem; a scene from a file adds the place. By default without one.
    fn fault(&self, _end: End, message: String, help: String) -> Error {
        Error::new(message).help(help)
    }

    /// What the numbers of a configuration are.
    fn columns(&self) -> Vec<Column>;
    /// The least and the largest value of each number, in the order of the columns; `None` where it turns without end.
    fn limits(&self) -> Vec<Option<[f64; 2]>>;
    /// What else there is to say of the robot, for people: name and text.
    fn details(&self) -> Vec<(String, String)> {
        Vec::new()
    }
    /// How paths are written as text.
    fn path_format(&self) -> PathFormat {
        PathFormat::Joints
    }
    /// The numbers of one configuration.
    fn row(&self, q: &Self::State) -> Vec<f64>;
    /// The configuration of a row, which has as many numbers as there are columns.
    fn state(&self, row: &[f64]) -> Self::State;
    /// The rows of a path: by default one for each state. May add rows for readers that interpolate numbers.
    fn rows(&self, path: &mp_cspace::Path<Self::State>) -> Vec<Vec<f64>> {
        path.states.iter().map(|q| self.row(q)).collect()
    }
    /// Writes the problem to `folder` for other planners, as docs/formats/export.md says; returns the file to begin with.
    ///
    /// # Errors
    /// When such robots are not exported, or a file cannot be written.
    fn export(&self, _folder: &Path) -> Result<PathBuf, Error> {
        Err(Error::new(format!("{} is no rigid body among meshes: only those are exported", self.name()))
            .help("its files are text already"))
    }
    /// What is wrong with rows that came from a file, beyond their length, such as leaving the plane.
    fn odd_rows(&self, _rows: &[Vec<f64>]) -> Option<String> {
        None
    }
    /// How far a configuration is from one that it should be, and how far it may be, as files often have four digits.
    fn mismatch(&self, q: &Self::State, wanted: &Self::State) -> Mismatch {
        Mismatch { off: self.space().distance(q, wanted), allowed: 1e-3, unit: "" }
    }
    /// A configuration for messages.
    fn written(&self, q: &Self::State) -> String {
        format!("[{}]", self.row(q).into_iter().map(plain).collect::<Vec<_>>().join(", "))
    }

    /// The bodies of the scene: those of the robot first, then what stands still.
    fn bodies(&self) -> Vec<Body>;
    /// Where the bodies of the robot are, in the order of [`bodies`](Self::bodies).
    fn poses(&self, q: &Self::State) -> Vec<Isometry3<f64>>;
    /// The point whose way a picture shows: by default the origin of the last body of the robot.
    fn traced(&self, q: &Self::State) -> Point3<f64> {
        self.poses(q).last().map_or(Point3::origin(), |pose| Point3::from(pose.translation.vector))
    }
    /// Between two pictures of the robot along a path no point of it moves much farther than this, metres.
    fn picture_spacing(&self) -> f64;
    /// Where the origin of the robot may be, for pictures that show it.
    fn picture_bounds(&self) -> Option<Aabb> {
        None
    }
    /// Whether the scene is best seen from above.
    fn is_planar(&self) -> bool {
        false
    }
    /// A hash of everything that a roadmap depends on: scene, robot and metric. `None` when roadmaps of such robots are
    /// not kept.
    fn fingerprint(&self, _metric: Metric) -> Option<u64> {
        None
    }
}

/// How far a configuration is from one that it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// How far it is.
    pub off: f64,
    /// How far it may be.
    pub allowed: f64,
    /// `m`, or nothing where the numbers have no common unit.
    pub unit: &'static str,
}

impl Mismatch {
    /// Whether it is no farther off than allowed; false for NaN.
    #[must_use]
    pub fn is_near(&self) -> bool {
        self.off <= self.allowed
    }
}

pub use crate::counted::Counted;

/// What checkers that `counted` makes know of obstacles: hints, and the clearance gradient.
pub(crate) fn hints_and_gradient<'c, S, R>(counted: &dyn Fn() -> Counted<'c, R>) -> ObstacleKnowledge<'c, S>
where
    S: 'c,
    R: ObstacleHints<S> + ClearanceGradient<S> + Queries + Send + 'c,
{
    let mut checker = counted();
    let gradient =
        move |q: &S, reach: f64, gradient: &mut [f64]| checker.clearance_gradient(q, reach, gradient);
    ObstacleKnowledge {
        hints: Some(Box::new(counted())),
        gradient: Some(Box::new(gradient)),
        ..ObstacleKnowledge::default()
    }
}

/// An error for a metric that a robot does not have.
pub(crate) fn no_metric(metric: Metric, robot: &str, has: &[Metric]) -> Error {
    let names: Vec<_> = has.iter().map(|m| m.name()).collect();
    Error::new(format!("{robot} cannot be measured by the metric `{metric}`"))
        .help(format!("take one of: {}", names.join(", ")))
}
