//! A scene of any kind, and everything one does with it.

use crate::any_robot::AnyRobot;
use crate::robot::{PlanarScene, RigidScene};
#[cfg(feature = "roadmaps")]
use crate::scene_roadmap::SceneRoadmap;
use crate::{
    Body, Column, Control, Error, Explanation, PathFormat, PathRows, Report, Request, RobotKind, Sweep,
    Verdict,
};
use mp_geom::Aabb;
use mp_io::{PlanarProblem, PlanarShape, RigidProblem, SpaceKind};
use mp_robot::{DiscRobot, Planar, PolygonRobot, Spatial};
use nalgebra::Isometry3;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

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

impl Scene {
    /// A scene of a robot of your own kind, or of one of this crate's: [`RigidScene`], [`ArmScene`](crate::ArmScene), [`PlanarScene`].
    pub fn new(robot: impl RobotKind + 'static) -> Self {
        Self { robot: Arc::new(robot), file: None, inputs: Arc::default() }
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
