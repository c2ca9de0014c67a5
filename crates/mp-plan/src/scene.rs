//! A scene of any kind, and everything one does with it.

use crate::check::{check, check_ends, explain, lint, states};
use crate::inputs::Recording;
use crate::plan::plan;
use crate::robot::{ArmScene, PlanarScene, RigidScene};
#[cfg(feature = "roadmaps")]
use crate::scene_roadmap::{Answering, SceneRoadmap};
use crate::{
    Body, Column, Control, Error, Explanation, PathFormat, PathRows, Report, Request, RobotKind, Verdict,
};
use mp_cspace::{MotionClearance, Rng, Space, Validity};
use mp_geom::{Aabb, evenly};
use mp_io::{Disk, Files, PlanarProblem, PlanarShape, RigidProblem, RobotProblem, SpaceKind};
use mp_robot::{DiscRobot, Planar, PolygonRobot, Spatial};
use nalgebra::{Isometry3, Point3};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

/// A scene made ready to plan in: a robot of any kind among its obstacles, with a start and goals. Clones share it.
///
/// ```no_run
/// use mp_plan::{Request, Scene};
/// let scene = Scene::load("office.env")?;
/// let report = scene.plan(&Request::new("rrt-connect").seed(7))?;
/// if let Some(path) = &report.path {
///     println!("{} configurations, clearance {:?} m", path.len(), report.clearance);
/// }
/// # Ok::<(), mp_plan::Error>(())
/// ```
#[derive(Clone)]
pub struct Scene {
    robot: Arc<dyn AnyRobot>,
    file: Option<PathBuf>,
    pub(crate) inputs: Arc<[PathBuf]>,
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Scene").field("name", &self.name()).field("file", &self.file).finish_non_exhaustive()
    }
}

/// What a path came to as pictures need it: poses of the moving bodies along it.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Poses of the robot's bodies at the start of the path, or of the scene.
    pub start: Vec<Isometry3<f64>>,
    /// The same at its end, or at the first goal.
    pub goal: Vec<Isometry3<f64>>,
    /// Poses between, spread evenly by how far the robot moves.
    pub between: Vec<Vec<Isometry3<f64>>>,
    /// The way of one point of the robot.
    pub trace: Vec<Point3<f64>>,
}

impl Scene {
    /// A scene of a robot of your own kind, or of one of this crate's: [`RigidScene`], [`ArmScene`], [`PlanarScene`].
    pub fn new(robot: impl RobotKind + 'static) -> Self {
        Self { robot: Arc::new(robot), file: None, inputs: Arc::default() }
    }

    /// Reads a scene: a GEMPA environment (`.env`, `.txt`), an OMPL.app problem (`.cfg`), a robot problem or a world
    /// in the plane (`.toml`).
    ///
    /// # Errors
    /// When a file cannot be read or makes no sense: with file, line, column and remedy.
    pub fn load(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_from(&Disk, file.as_ref())
    }

    /// The same of files from elsewhere, such as from memory.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_from(files: &dyn Files, file: &Path) -> Result<Self, Error> {
        let _span = tracing::info_span!("load", file = %file.display()).entered();
        let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        if ["urdf", "xacro", "srdf", "yaml", "yml"].contains(&ending.as_str()) {
            return Err(foreign(file));
        }
        let of = |e: Error| match e.file() {
            Some(_) => e,
            None => e.context(format!("cannot plan in {}", file.display())),
        };
        let recording = Recording { files, read: Mutex::default() };
        let files: &dyn Files = &recording;
        let mut named = Vec::new();
        let scene = match RobotProblem::is_named(file) {
            true if PlanarProblem::is_planar_world_in(files, file) => {
                Self::from_world(PlanarProblem::load_from(files, file)?).map_err(of)?
            }
            true => {
                let arm = ArmScene::from_problem(RobotProblem::load_from(files, file)?)?;
                named.extend(arm.mesh_files().iter().cloned());
                Self::new(arm)
            }
            false => Self::from_problem(RigidProblem::load_from(files, file)?).map_err(of)?,
        };
        tracing::info!(name = scene.name(), space = %scene.space(), "loaded");
        let mut inputs = recording.read.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        inputs.extend(named);
        Ok(Self { file: Some(file.to_owned()), inputs: inputs.into(), ..scene })
    }

    /// Reads a scene from the text of a file of any kind: which, is seen by how it begins. Other files that it names are
    /// looked for in `folder`; reports call it `name`.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(name: &str, text: &str, folder: &Path) -> Result<Self, Error> {
        let begins = |what: &str| text.lines().any(|line| line.trim_start().starts_with(what));
        let first = text.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default();
        let ending = match first {
            _ if begins("[problem]") => "cfg",
            _ if first.eq_ignore_ascii_case("robot") => "env",
            _ if first.starts_with(['[', '#']) || first.contains('=') => "toml",
            _ => "env",
        };
        let file = folder.join(format!("{name}.{ending}"));
        Self::load_from(&OneText { file: &file, text }, &file)
    }

    /// A rigid body among meshes.
    ///
    /// # Errors
    /// When the bounds of the position are empty, or a mesh or pose makes no sense.
    pub fn from_problem(problem: RigidProblem) -> Result<Self, Error> {
        let _span = tracing::info_span!("build", scene = %problem.name).entered();
        Ok(match problem.space {
            SpaceKind::Se3 => Self::new(RigidScene::<Spatial>::new(problem)?),
            SpaceKind::Se2 => Self::new(RigidScene::<Planar>::new(problem)?),
        })
    }

    /// A robot of the plane among polygons.
    ///
    /// # Errors
    /// When world, robot or bounds make no sense.
    pub fn from_world(problem: PlanarProblem) -> Result<Self, Error> {
        let _span = tracing::info_span!("build", scene = %problem.name).entered();
        Ok(match problem.file.robot {
            PlanarShape::Disc(_) => Self::new(PlanarScene::<DiscRobot>::new(problem)?),
            PlanarShape::Polygon(_) => Self::new(PlanarScene::<PolygonRobot>::new(problem)?),
        })
    }

    /// The same, said by reports to come from this file.
    #[must_use]
    pub fn with_file(self, file: impl Into<PathBuf>) -> Self {
        Self { file: Some(file.into()), ..self }
    }

    /// The name of the scene.
    #[must_use]
    pub fn name(&self) -> &str {
        self.robot.name()
    }

    /// The file it came from.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The space: `SE3`, `SE2`, `R2`, `6 joints`.
    #[must_use]
    pub fn space(&self) -> String {
        self.robot.space_name()
    }

    /// What the numbers of a configuration are.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        self.robot.columns()
    }

    /// The least and the largest value of each number of a configuration; `None` where it turns without end.
    #[must_use]
    pub fn limits(&self) -> Vec<Option<[f64; 2]>> {
        self.robot.limits()
    }

    /// What there is to say of the robot beside, for people: name and text.
    #[must_use]
    pub fn details(&self) -> Vec<(String, String)> {
        self.robot.details()
    }

    /// The share of the space in which the robot is free, by so many samples: the same for the same scene.
    #[must_use]
    pub fn free_share(&self, samples: u32) -> f64 {
        self.robot.free_share(samples)
    }

    /// How its paths are written as text.
    #[must_use]
    pub fn path_format(&self) -> PathFormat {
        self.robot.path_format()
    }

    /// Where paths begin.
    #[must_use]
    pub fn start(&self) -> Vec<f64> {
        self.robot.start()
    }

    /// Where they may end.
    #[must_use]
    pub fn goals(&self) -> Vec<Vec<f64>> {
        self.robot.goals()
    }

    /// Plans: looks for a path, shortens it, verifies it as it will be written. The same scene and request give the
    /// same report but for its times, on any number of threads.
    ///
    /// # Errors
    /// When start or goal is not free (with what is in the way, how deep, and the nearest free configuration), or the
    /// request makes no sense. Not finding a path is no error: see [`Report::stopped_by`].
    pub fn plan(&self, request: &Request) -> Result<Report, Error> {
        self.plan_with(request, &mut Control::default())
    }

    /// The same, watched and stopped from outside.
    ///
    /// # Errors
    /// As [`plan`](Self::plan).
    pub fn plan_with(&self, request: &Request, control: &mut Control<'_>) -> Result<Report, Error> {
        self.check_ends()?;
        let mut report = self.robot.plan(request, control)?;
        report.scene_file = self.file.as_ref().map(|file| file.display().to_string());
        Ok(report)
    }

    /// Builds a roadmap, for many queries: with the planner of the request, which must be one of roadmaps, until its
    /// budget is spent. Start and goal of the scene are not looked at. Where the request names a file with a roadmap, that
    /// one is gone on with, and the file is written in the end.
    ///
    /// ```
    /// use mp_plan::{Request, Scene};
    /// let scene = Scene::find("easy")?;
    /// let mut roadmap = scene.roadmap(&Request::new("prm").seed(3).nodes(3_000))?;
    /// let (start, goal) = (scene.start(), scene.goals().remove(0));
    /// for (from, to) in [(&start, &goal), (&goal, &start)] {
    ///     let report = roadmap.query(from, to)?;
    ///     assert!(report.solved, "{:?}", report.why);
    /// }
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the planner builds no roadmap, the request makes no sense, or the file cannot be read or written.
    #[cfg(feature = "roadmaps")]
    pub fn roadmap(&self, request: &Request) -> Result<SceneRoadmap, Error> {
        self.roadmap_with(request, &mut Control::default())
    }

    /// The same, watched and stopped from outside.
    ///
    /// # Errors
    /// As [`roadmap`](Self::roadmap).
    #[cfg(feature = "roadmaps")]
    pub fn roadmap_with(&self, request: &Request, control: &mut Control<'_>) -> Result<SceneRoadmap, Error> {
        let roadmap = Arc::clone(&self.robot).roadmap(request, control)?;
        Ok(SceneRoadmap { roadmap, file: self.file.as_ref().map(|file| file.display().to_string()) })
    }

    /// Verifies a path from the start to a goal, by a checker that shares no code with the planners'.
    ///
    /// # Errors
    /// When the path is one of another robot. Not being free is no error: see [`Verdict::free`].
    pub fn check(&self, path: &PathRows) -> Result<Verdict, Error> {
        self.robot.check(path)
    }

    /// Says what is to be said about a configuration: free or not, how near to contact, what touches, and where it
    /// would be free.
    ///
    /// # Errors
    /// When it has another number of numbers than the robot.
    pub fn explain(&self, row: &[f64]) -> Result<Explanation, Error> {
        self.robot.explain(row)
    }

    /// Refuses a scene whose start or goal is not free. Otherwise says what is odd about them.
    ///
    /// # Errors
    /// When one is not free: what is in the way, how deep, and the nearest free configuration.
    pub fn check_ends(&self) -> Result<Vec<String>, Error> {
        self.robot.check_ends()
    }

    /// What is wrong or odd about the scene, in sentences; nothing when all is well.
    #[must_use]
    pub fn lint(&self) -> Vec<String> {
        self.robot.lint()
    }

    /// The bodies: those of the robot first, then what stands still.
    #[must_use]
    pub fn bodies(&self) -> Vec<Body> {
        self.robot.bodies()
    }

    /// Where the bodies of the robot are at a configuration, in the order of [`bodies`](Self::bodies).
    ///
    /// # Errors
    /// When it has another number of numbers than the robot.
    pub fn poses(&self, row: &[f64]) -> Result<Vec<Isometry3<f64>>, Error> {
        self.robot.poses(row)
    }

    /// Poses of the robot along a path, or at start and goal alone without one.
    ///
    /// # Errors
    /// When the path is one of another robot.
    pub fn sweep(&self, path: Option<&PathRows>) -> Result<Sweep, Error> {
        self.robot.sweep(path)
    }

    /// Writes the problem to `folder` as one JSON and two OFF files for other planners; returns the former.
    ///
    /// # Errors
    /// When it is no rigid body among meshes, or a file cannot be written.
    pub fn export(&self, folder: &Path) -> Result<PathBuf, Error> {
        self.robot.export(folder)
    }

    /// Whether the scene is best seen from above.
    #[must_use]
    pub fn is_planar(&self) -> bool {
        self.robot.is_planar()
    }

    /// Where the origin of the robot may be, for pictures that show it.
    #[must_use]
    pub fn picture_bounds(&self) -> Option<Aabb> {
        self.robot.picture_bounds()
    }
}

/// A text that is no file, among the files of the disk.
#[derive(Debug)]
struct OneText<'a> {
    file: &'a Path,
    text: &'a str,
}

impl Files for OneText<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, mp_io::Error> {
        if path == self.file { Ok(self.text.as_bytes().to_vec()) } else { Disk.read(path, limit) }
    }
}

/// A [`RobotKind`] behind a pointer.
trait AnyRobot: Send + Sync {
    fn name(&self) -> &str;
    fn space_name(&self) -> String;
    fn columns(&self) -> Vec<Column>;
    fn limits(&self) -> Vec<Option<[f64; 2]>>;
    fn details(&self) -> Vec<(String, String)>;
    fn free_share(&self, samples: u32) -> f64;
    fn path_format(&self) -> PathFormat;
    fn start(&self) -> Vec<f64>;
    fn goals(&self) -> Vec<Vec<f64>>;
    fn plan(&self, request: &Request, control: &mut Control<'_>) -> Result<Report, Error>;
    #[cfg(feature = "roadmaps")]
    fn roadmap(
        self: Arc<Self>,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Box<dyn Answering>, Error>;
    fn check(&self, path: &PathRows) -> Result<Verdict, Error>;
    fn explain(&self, row: &[f64]) -> Result<Explanation, Error>;
    fn check_ends(&self) -> Result<Vec<String>, Error>;
    fn lint(&self) -> Vec<String>;
    fn bodies(&self) -> Vec<Body>;
    fn poses(&self, row: &[f64]) -> Result<Vec<Isometry3<f64>>, Error>;
    fn sweep(&self, path: Option<&PathRows>) -> Result<Sweep, Error>;
    fn export(&self, folder: &Path) -> Result<PathBuf, Error>;
    fn is_planar(&self) -> bool;
    fn picture_bounds(&self) -> Option<Aabb>;
}

impl<K: RobotKind + 'static> AnyRobot for K {
    fn name(&self) -> &str {
        RobotKind::name(self)
    }
    fn space_name(&self) -> String {
        RobotKind::space_name(self)
    }
    fn columns(&self) -> Vec<Column> {
        RobotKind::columns(self)
    }
    fn limits(&self) -> Vec<Option<[f64; 2]>> {
        RobotKind::limits(self)
    }
    fn details(&self) -> Vec<(String, String)> {
        RobotKind::details(self)
    }
    fn free_share(&self, samples: u32) -> f64 {
        let (mut rng, mut checker) = (Rng::seed(1), self.checker().clone());
        let free = (0..samples).filter(|_| checker.is_valid(&self.space().sample_uniform(&mut rng))).count();
        free as f64 / f64::from(samples.max(1))
    }
    fn path_format(&self) -> PathFormat {
        RobotKind::path_format(self)
    }
    fn start(&self) -> Vec<f64> {
        self.row(RobotKind::start(self))
    }
    fn goals(&self) -> Vec<Vec<f64>> {
        RobotKind::goals(self).iter().map(|goal| self.row(goal)).collect()
    }
    fn plan(&self, request: &Request, control: &mut Control<'_>) -> Result<Report, Error> {
        plan(self, request, control)
    }
    #[cfg(feature = "roadmaps")]
    fn roadmap(
        self: Arc<Self>,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Box<dyn Answering>, Error> {
        crate::scene_roadmap::build(self, request, control)
    }
    fn check(&self, path: &PathRows) -> Result<Verdict, Error> {
        check(self, path)
    }
    fn explain(&self, row: &[f64]) -> Result<Explanation, Error> {
        Ok(explain(self, &state(self, row)?))
    }
    fn check_ends(&self) -> Result<Vec<String>, Error> {
        check_ends(self)
    }
    fn lint(&self) -> Vec<String> {
        lint(self)
    }
    fn bodies(&self) -> Vec<Body> {
        RobotKind::bodies(self)
    }
    fn poses(&self, row: &[f64]) -> Result<Vec<Isometry3<f64>>, Error> {
        Ok(RobotKind::poses(self, &state(self, row)?))
    }
    fn sweep(&self, path: Option<&PathRows>) -> Result<Sweep, Error> {
        sweep(self, path)
    }
    fn export(&self, folder: &Path) -> Result<PathBuf, Error> {
        RobotKind::export(self, folder)
    }
    fn is_planar(&self) -> bool {
        RobotKind::is_planar(self)
    }
    fn picture_bounds(&self) -> Option<Aabb> {
        RobotKind::picture_bounds(self)
    }
}

/// An error for a file that names a robot or a map, but is no scene: which format to write around it.
pub(crate) fn foreign(file: &Path) -> Error {
    let name = file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let ending = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let error = |what: &str, help: String| {
        Error::new(format!("{} is {what}, not a scene", file.display())).help(help)
    };
    match ending.as_str() {
        "urdf" | "xacro" => error(
            "a robot description",
            format!(
                "write a robot problem around it, a file `problem.toml` beside it:\n    [robot]\n    urdf = \"{name}\"\n    \
                 [motion]\n    start = [0, 0, …]   # one number for each joint that moves\n    goal = [1, 0, …]\n  \
                 docs/formats/robot-problem.md has all of it"
            ),
        ),
        "srdf" => error("an SRDF", "name it in a robot problem: docs/formats/robot-problem.md".to_owned()),
        "yaml" | "yml" => error(
            "a map of ROS",
            format!(
                "write a world around it, a file `world.toml` beside it:\n    [world]\n    map = \"{name}\"\n    \
                 [robot]\n    disc = 0.2          # radius, metres\n    [motion]\n    start = [0, 0]\n    \
                 goal = [1, 0]\n  docs/formats/planar-world.md has all of it"
            ),
        ),
        _ => error("an XML file", "name a scene: .env, .cfg or .toml".to_owned()),
    }
}

/// The configuration of one row.
pub(crate) fn state<K: RobotKind>(kind: &K, row: &[f64]) -> Result<K::State, Error> {
    let columns = RobotKind::columns(kind);
    if row.len() == columns.len() && row.iter().all(|v| v.is_finite()) {
        return Ok(kind.state(row));
    }
    let names: Vec<_> = columns.iter().map(|c| format!("{} [{}]", c.name, c.unit)).collect();
    Err(Error::new(format!(
        "a configuration of {} has {} finite numbers",
        RobotKind::name(kind),
        columns.len()
    ))
    .help(format!("give in order: {}", names.join(", "))))
}

/// Poses along a path.
fn sweep<K: RobotKind>(kind: &K, path: Option<&PathRows>) -> Result<Sweep, Error> {
    let states = path.map(|path| states(kind, path)).transpose()?.unwrap_or_default();
    let robot = kind.checker();
    let lengths: Vec<f64> = states.windows(2).map(|w| robot.motion_bound(&w[0], &w[1])).collect();
    let at = |edge: usize, t: f64| kind.space().interpolate(&states[edge], &states[edge + 1], t);
    let places = evenly(&lengths, kind.picture_spacing());
    let fine = |edge: usize| (0..=16).map(move |k| (edge, f64::from(k) / 16.0));
    let trace = (0..lengths.len()).flat_map(fine);
    let (start, goal) = (states.first().unwrap_or(kind.start()), states.last().unwrap_or(&kind.goals()[0]));
    Ok(Sweep {
        start: kind.poses(start),
        goal: kind.poses(goal),
        between: places.into_iter().map(|(edge, t)| kind.poses(&at(edge, t))).collect(),
        trace: trace.map(|(edge, t)| kind.traced(&at(edge, t))).collect(),
    })
}
