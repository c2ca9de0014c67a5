//! A scene of any kind, and what can be done with it.

use crate::explain::{check_ends, explain, fault, lint, wrong_ends};
use crate::finish::certificate::certificate;
use crate::finish::check::check;
use crate::finish::finish_given;
use crate::path::{state, states};
use crate::run::plan::plan;
use crate::run::planners::{demands, reason_against};
use crate::run::prepare;
#[cfg(feature = "roadmaps")]
use crate::run::{regions::RegionalWork, scene_roadmap::SceneRoadmap};
use crate::sweep::{resample, sweep, track};
use crate::{
    Body, Certificate, Column, Constraint, Control, Error, Explanation, Finished, FoundRun, Length,
    ObjectiveName, PathFileKind, PathFormat, PathRows, PreparedRun, RelaxField, Report, Request, Robot,
    SceneFiles, Sweep, Track, Verdict,
};
use mp_cspace::registry::Settings;
use mp_cspace::{Configuration, Interrupt, Interrupted, Rng, Space, Validity};
use mp_geom::{Aabb, TriMesh, short_six_from_pose};
use mp_io::{DocumentShape, SceneDocument};
use mp_kinds::Constrained;
use mp_kinds::build::Built;
use mp_tree::algo::rrs::RANGE;
use nalgebra::{Isometry3, Point3};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// A scene to plan in: a robot of any kind among its obstacles, with a start and goals. Clones share the data.
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
    pub(crate) robot: Arc<dyn Robot>,
    file: Option<PathBuf>,
    pub(crate) files: Arc<SceneFiles>,
    /// What it was made from, if that is a document of an editor.
    document: Option<Arc<EditedScene>>,
    notes: Arc<[String]>,
    /// What readers of its files remarked.
    pub(crate) remarks: Arc<[String]>,
    kind: Option<&'static str>,
}

/// Refuses a clearance that is no length.
pub(crate) fn check_clearance(clearance: f64) -> Result<(), Error> {
    match clearance >= 0.0 && clearance.is_finite() {
        true => Ok(()),
        false => Err(Error::new(format!("the clearance to keep is {clearance} m"))
            .help("give a finite number of metres, zero or more")),
    }
}

/// A scene as an editor keeps it: its document, and the meshes that are not written into the document.
#[derive(Clone, Debug)]
pub struct EditedScene {
    /// The document. Its meshes have names only.
    pub document: SceneDocument,
    /// The mesh of each body, the robot's first, without the scale that the document gives; `None` for figures.
    pub meshes: Vec<Option<TriMesh>>,
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Scene").field("name", &self.name()).field("file", &self.file).finish_non_exhaustive()
    }
}

impl Scene {
    /// A scene with a robot of your own kind, or of one of the kinds of this crate: [`RigidScene`](crate::RigidScene),
    /// [`ArmScene`](crate::ArmScene), [`PlanarScene`](crate::PlanarScene).
    pub fn new(robot: impl Robot + 'static) -> Self {
        Self::of_shared(Arc::new(robot))
    }

    fn of_shared(robot: Arc<dyn Robot>) -> Self {
        Self {
            robot,
            file: None,
            files: Arc::default(),
            document: None,
            notes: Arc::default(),
            remarks: Arc::default(),
            kind: None,
        }
    }

    /// A scene of the document of an editor. `mesh` gives the meshes that are not written into it, by the names of their
    /// files.
    ///
    /// # Errors
    /// When the document is not valid, or a mesh is missing.
    pub fn from_document(
        document: SceneDocument,
        mesh: &dyn Fn(&str) -> Result<TriMesh, mp_io::Error>,
    ) -> Result<Self, Error> {
        Self::of_document(None, document, mesh, &Interrupt::never())
    }

    /// The scene of `document`, which is an edited document of this scene. What did not change is shared with this scene, so
    /// that an edit among large meshes takes little time. Otherwise as [`from_document`](Self::from_document).
    ///
    /// # Errors
    /// As [`from_document`](Self::from_document).
    pub fn edited(
        &self,
        document: SceneDocument,
        mesh: &dyn Fn(&str) -> Result<TriMesh, mp_io::Error>,
    ) -> Result<Self, Error> {
        Self::of_document(Some(self), document, mesh, &Interrupt::never())
    }

    pub(crate) fn of_document(
        before: Option<&Self>,
        mut document: SceneDocument,
        mesh: &dyn Fn(&str) -> Result<TriMesh, mp_io::Error>,
        interrupt: &Interrupt,
    ) -> Result<Self, Error> {
        let meshes = document.meshes(mesh)?;
        for body in document.bodies_mut() {
            if let DocumentShape::Mesh { off, .. } = &mut body.shape {
                *off = None;
            }
        }
        let problem = document.problem_among(&document.name, &meshes)?;
        let scene = Self::of_problem_until(before, problem, interrupt)?;
        Ok(Self { document: Some(Arc::new(EditedScene { document, meshes })), ..scene })
    }

    /// The scene as an editor keeps it. `None` unless the robot is a rigid body among meshes.
    #[must_use]
    pub fn document(&self) -> Option<EditedScene> {
        let problem = self.rigid_problem()?;
        let mut edited = match &self.document {
            Some(edited) => EditedScene::clone(edited),
            None => {
                let obstacles = problem.obstacles.iter().map(|o| Some(o.mesh.clone()));
                let meshes = std::iter::once(Some(problem.robot.mesh.clone())).chain(obstacles).collect();
                EditedScene { document: SceneDocument::of_problem(problem), meshes }
            }
        };
        let document = &mut edited.document;
        (document.start, document.goal) =
            (short_six_from_pose(&problem.start), short_six_from_pose(&problem.goal));
        Some(edited)
    }

    /// The problem of a rigid body among meshes, if it is one.
    pub(crate) fn rigid_problem(&self) -> Option<&mp_io::RigidProblem> {
        self.robot.rigid_problem()
    }

    pub(crate) fn robot<K: 'static>(&self) -> Option<&K> {
        mp_kinds::build::of_kind(&*self.robot)
    }

    pub(crate) fn built(built: Built) -> Self {
        let Built { robot, kind, notes } = built;
        Self { kind: Some(kind), notes: notes.into(), ..Self::of_shared(robot) }
    }

    /// Sets the file that reports name as the source of the scene.
    #[must_use]
    pub fn with_file(self, file: impl Into<PathBuf>) -> Self {
        Self { file: Some(file.into()), ..self }
    }

    /// The same with another robot.
    pub(crate) fn of_robot(self, robot: Arc<dyn Robot>) -> Self {
        Self { robot, ..self }
    }

    pub(crate) fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes: notes.into(), ..self }
    }

    /// Notes, as sentences: what was chosen for a scene whose file is only a robot or a map, and what decides which links of an arm
    /// may touch where the scene does not say.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The kind of robot: `space`, `arms`, …; `None` for a [`Robot`] of one's own.
    #[must_use]
    pub fn kind(&self) -> Option<&'static str> {
        self.kind
    }

    /// What messages and files call the scene.
    #[must_use]
    pub fn name(&self) -> &str {
        self.robot.name()
    }

    /// The file that the scene was read from.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The configuration space: `SE3`, `SE2`, `R2`, `6 joints`.
    #[must_use]
    pub fn space(&self) -> String {
        self.robot.space_name()
    }

    /// The meaning of each number of a configuration.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        self.robot.columns()
    }

    /// Reads a path of the robot from a file, as [`PathRows::read`] does.
    ///
    /// # Errors
    /// When the file cannot be read, or does not hold a path of the robot: with file, line and column.
    pub fn read_path(&self, file: impl AsRef<Path>) -> Result<PathRows, Error> {
        PathRows::read(file, self.path_format(), &self.columns())
    }

    /// As [`read_path`](Self::read_path), from the content of a file that errors call `name`.
    ///
    /// # Errors
    /// When the content is not a path of the robot: with line and column.
    pub fn parse_path(&self, name: &str, bytes: &[u8], kind: PathFileKind) -> Result<PathRows, Error> {
        PathRows::parse(name, bytes, kind, self.path_format(), &self.columns())
    }

    /// The rows of a table whose columns have these `names`, as rows of numbers of the robot: columns are matched by name, and their units,
    /// as in `elbow [deg]`, converted. Errors call the table `what`.
    ///
    /// # Errors
    /// When a name is unknown, missing or there twice, or a unit does not fit.
    pub fn named_rows(
        &self,
        what: &str,
        names: &[String],
        rows: &[Vec<f64>],
    ) -> Result<Vec<Vec<f64>>, Error> {
        Ok(mp_io::matched(what, names, rows, &self.columns())?)
    }

    /// The least and the largest value of each number of a configuration; `None` for an angle without limits.
    #[must_use]
    pub fn limits(&self) -> Vec<Option<[f64; 2]>> {
        self.robot.limits()
    }

    /// Further facts about the scene, for people: name and text. The [notes](Self::notes), and what was remarked about its files,
    /// are among them.
    #[must_use]
    pub fn details(&self) -> Vec<(String, String)> {
        let notes = self.remarks.iter().chain(&*self.notes).map(|note| ("note".to_owned(), note.clone()));
        self.robot.details().into_iter().chain(notes).collect()
    }

    /// The fraction of the space in which the robot is free, estimated from `samples` samples. The same scene gives the same
    /// fraction.
    #[must_use]
    pub fn free_share(&self, samples: u32) -> f64 {
        self.free_share_until(samples, &Interrupt::never())
    }

    /// As [`free_share`](Self::free_share), unless `interrupt` says to end: then it means nothing.
    #[must_use]
    pub fn free_share_until(&self, samples: u32, interrupt: &Interrupt) -> f64 {
        let (mut rng, mut checker) = (Rng::seed(1), self.robot.any_checker());
        let (space, mut interrupt) = (self.robot.any_space(), interrupt.clone());
        let tried = (0..samples).take_while(|_| !interrupt.ask());
        let free = tried.filter(|_| checker.is_valid(&space.sample_uniform(&mut rng))).count();
        free as f64 / f64::from(samples.max(1))
    }

    /// The format in which its paths are written as text.
    #[must_use]
    pub fn path_format(&self) -> PathFormat {
        self.robot.path_format()
    }

    /// The start configuration.
    #[must_use]
    pub fn start(&self) -> Vec<f64> {
        self.robot.given_start()
    }

    /// The goal configurations.
    #[must_use]
    pub fn goals(&self) -> Vec<Vec<f64>> {
        self.robot.goals().iter().map(|goal| self.robot.row(goal)).collect()
    }

    /// The same scene with another start and other goals, as rows. They need not be free: planning and
    /// [`check_ends`](Self::check_ends) refuse them then.
    ///
    /// # Errors
    /// When there is no goal, a row does not have as many numbers as the robot's configurations, or the kind of robot is your
    /// own and does not support it.
    pub fn with_ends(&self, start: &[f64], goals: &[Vec<f64>]) -> Result<Self, Error> {
        if goals.is_empty() {
            return Err(Error::new("there is no goal").help("give at least one configuration as a goal"));
        }
        let end = |which: &str, row: &[f64]| {
            let q = self.state(row)?;
            match self.robot.row_fault(row) {
                Some(fault) => Err(Error::new(format!("{which} {fault}")).help("give these numbers as 0")),
                None => Ok(q),
            }
        };
        let given = end("the start", start)?;
        let goals = goals.iter().map(|goal| end("the goal", goal)).collect::<Result<_, _>>()?;
        Ok(Self { robot: self.robot.any_with_ends(given, goals, start)?, ..self.clone() })
    }

    /// The same scene, in which paths keep the clearance `clearance` (m) from obstacles, in place of the one kept before. All methods mind
    /// it: planning, shortening, relaxing, checking, explaining, roadmaps and certificates. The links of an arm may be nearer to each
    /// other than that.
    ///
    /// ```
    /// use mp_plan::{Request, Scene};
    /// let scene = Scene::find("cubicles")?.keeping(0.5)?;
    /// let report = scene.plan(&Request::default())?;
    /// assert!(report.clearance >= Some(0.5));
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the clearance is not a finite number from zero on, or the kind of robot is your own and cannot keep one.
    pub fn keeping(&self, clearance: f64) -> Result<Self, Error> {
        check_clearance(clearance)?;
        match clearance == self.clearance_kept() {
            true => Ok(self.clone()),
            false => {
                Ok(Self { robot: self.robot.any_keeping(clearance)?, ..self.clone() }.with_free_places())
            }
        }
    }

    /// The same scene without the configurations that reach a place of a link, but are not free here. They stay where no goal would be left.
    pub(crate) fn with_free_places(self) -> Self {
        let robot = &*self.robot;
        let kept = |q| !robot.reaches_place(q) || fault(robot, q).is_none();
        let kept: Vec<bool> = robot.goals().iter().map(kept).collect();
        match robot.any_with_goals(&kept).filter(|_| kept.contains(&true) && kept.contains(&false)) {
            Some(robot) => Self { robot, ..self },
            None => self,
        }
    }

    /// The same scene, in which a constraint of yours must hold too, all along every path: whatever the robot is, and in every use of
    /// the scene. It is sampled, where collisions are certified.
    ///
    /// ```
    /// use mp_plan::{Constraint, Request, Scene};
    /// use mp_cspace::Length;
    ///
    /// // A body that must stay below a ceiling.
    /// let low = Constraint::new("below 1.5 m", Length::Fraction(0.005), |row| row[2] <= 1.5);
    /// let report = Scene::find("easy")?.under(low)?.plan(&Request::default())?;
    /// assert!(report.path.iter().flatten().all(|row| row[2] <= 1.5));
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the distance between tested states is not above zero, or below 10⁻⁹ of the extent of the space.
    pub fn under(&self, constraint: Constraint) -> Result<Self, Error> {
        let robot = Arc::new(Constrained::new(Arc::clone(&self.robot), constraint)?);
        Ok(Self { robot, document: None, ..self.clone() }.with_free_places())
    }

    /// The clearance (m) that paths keep from obstacles: zero by default; [`keeping`](Self::keeping) sets it.
    #[must_use]
    pub fn clearance_kept(&self) -> f64 {
        self.robot.kept()
    }

    /// The scene that a request is about: this one, keeping the clearance of the request if it has one.
    ///
    /// # Errors
    /// As [`keeping`](Self::keeping).
    pub fn for_request(&self, request: &Request) -> Result<Self, Error> {
        self.keeping(if request.clearance == 0.0 { self.clearance_kept() } else { request.clearance })
    }

    pub(crate) fn state(&self, row: &[f64]) -> Result<Configuration, Error> {
        state(&*self.robot, row)
    }

    /// The robot that a request is about.
    fn robot_for(&self, request: &Request) -> Result<Arc<dyn Robot>, Error> {
        Ok(self.for_request(request)?.robot)
    }

    /// Refuses a request whose clearance the scene does not keep.
    fn keeps(&self, request: &Request) -> Result<(), Error> {
        match [0.0, self.clearance_kept()].contains(&request.clearance) {
            true => Ok(()),
            false => Err(Error::new(format!("the scene keeps no clearance of {} m", request.clearance))
                .help("take the scene that `Scene::for_request` gives")),
        }
    }

    /// The planner that is taken when none is named: one that suits the robot.
    #[must_use]
    pub fn default_planner(&self) -> &'static str {
        self.robot.default_planner()
    }

    /// The names of the planners that cannot plan for the robot, each with the reason. An [objective](Request::objective) may help one of them,
    /// which its reason says.
    #[must_use]
    pub fn planners_that_cannot(&self) -> Vec<(&'static str, &'static str)> {
        let demands = demands(&*self.robot, false);
        crate::planners().filter_map(|info| Some((info.name, reason_against(info, &demands)?))).collect()
    }

    /// How many of the bodies without a pose, the last of them, are obstacles that move.
    #[must_use]
    pub fn moving_obstacles(&self) -> usize {
        self.robot.moving_obstacles()
    }

    /// Plans a path: searches for it, shortens it, and verifies it as it will be written. The same scene and request give
    /// the same report except for its times, on any number of threads.
    ///
    /// # Errors
    /// When start or goal is not free (the error says what touches, how deep, and the nearest free configuration), or the
    /// request is not valid. Not finding a path is not an error: see [`Report::stopped_by`].
    pub fn plan(&self, request: &Request) -> Result<Report, Error> {
        self.plan_with(request, &mut Control::default())
    }

    /// As [`plan`](Self::plan), with progress reports and a stop.
    ///
    /// # Errors
    /// As [`plan`](Self::plan).
    pub fn plan_with(&self, request: &Request, control: &mut Control<'_>) -> Result<Report, Error> {
        let mut report = plan(&*self.robot_for(request)?, request, control)?;
        report.scene_file = self.file.as_ref().map(|file| file.display().to_string());
        Ok(report)
    }

    /// Plans at most `count` routes, the shortest as found first: verified paths, each of which is somewhere farther than `apart`, in the
    /// metric of the space, from all before it. Routes are those of the graph that the planner grows, without detours (Abraham,
    /// Delling, Goldberg and Werneck, *Alternative routes in road networks*, 2013): the planner must be `cyclic-rrt` or build
    /// roadmaps with cycles. It grows until there are as many routes, or its budget is used up. Each is shortened by itself; one that
    /// shortening would bring within half of `apart` of another stays as it was found. Without any route there is one report,
    /// which says why.
    ///
    /// # Errors
    /// As [`plan`](Self::plan), and when the planner finds one path only.
    pub fn routes(
        &self,
        request: &Request,
        count: usize,
        apart: Length,
        control: &mut Control<'_>,
    ) -> Result<Vec<Report>, Error> {
        let (began, robot) = (control.time_if_limited(request), self.robot_for(request)?);
        check_ends(&*robot)?;
        control.spend_since(began);
        let mut reports = crate::run::routes::routes(&*robot, request, count.max(1), apart, control)?;
        for report in &mut reports {
            report.scene_file = self.file.as_ref().map(|file| file.display().to_string());
        }
        Ok(reports)
    }

    /// Prepares a run that is advanced in pieces. A request with a clearance needs the scene that [`for_request`](Self::for_request) gives.
    ///
    /// # Errors
    /// As [`plan`](Self::plan), and when the scene does not keep the clearance of the request.
    pub fn prepare<'s>(&'s self, request: &'s Request) -> Result<PreparedRun<'s>, Error> {
        self.keeps(request)?;
        self.check_ends()?;
        let file = self.file.as_ref().map(|file| file.display().to_string());
        Ok(PreparedRun { prepared: prepare(&*self.robot, request)?, file })
    }

    /// The report of a run that made none itself ([`Run::into_found`](crate::Run::into_found)), maybe on another machine, and took the time
    /// `time`. Its path is finished and verified here.
    ///
    /// # Errors
    /// When the path is of another robot, or the robot refuses to relax it.
    pub fn found_report(
        &self,
        request: &Request,
        found: FoundRun,
        time: Duration,
        control: &mut Control<'_>,
    ) -> Result<Report, Error> {
        let mut report =
            crate::run::plan::found_report(&*self.robot_for(request)?, request, found, time, control)?;
        report.scene_file = self.file.as_ref().map(|file| file.display().to_string());
        Ok(report)
    }

    /// Builds a roadmap for many queries, with the planner of the request, which must build roadmaps, until its budget is
    /// used up. Start and goal of the scene are not used. If the request names a file with a roadmap, building continues
    /// with that roadmap, and the file is written at the end.
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
    /// When the planner does not build roadmaps, the request is not valid, or the file cannot be read or written.
    #[cfg(feature = "roadmaps")]
    pub fn roadmap(&self, request: &Request) -> Result<SceneRoadmap, Error> {
        self.roadmap_with(request, &mut Control::default())
    }

    /// As [`roadmap`](Self::roadmap), with progress reports and a stop.
    ///
    /// # Errors
    /// As [`roadmap`](Self::roadmap).
    #[cfg(feature = "roadmaps")]
    pub fn roadmap_with(&self, request: &Request, control: &mut Control<'_>) -> Result<SceneRoadmap, Error> {
        let roadmap = crate::run::scene_roadmap::build(self.robot_for(request)?, request, control)?;
        Ok(SceneRoadmap { roadmap, file: self.file.as_ref().map(|file| file.display().to_string()) })
    }

    /// The work on a roadmap by regions, in items that may be done anywhere: one round of the planner `regional-prm`. Its parameters say how large
    /// the roadmap is. The request has no budget but that of time, which is for the caller to watch. A request with a clearance needs the
    /// scene that [`for_request`](Self::for_request) gives.
    ///
    /// # Errors
    /// When the request is not valid, for this scene or for such work.
    #[cfg(feature = "roadmaps")]
    pub fn regions<'s>(&'s self, request: &'s Request) -> Result<RegionalWork<'s>, Error> {
        self.keeps(request)?;
        self.check_ends()?;
        let file = self.file.as_ref().map(|file| file.display().to_string());
        RegionalWork::new(&self.robot, file, request)
    }

    /// Finishes a path from elsewhere, between any two configurations: verifies it, shortens or relaxes it as the request says, and
    /// verifies the result as it will be written. Only these parts of the request are used: finish, field, clearance, seed and budget of
    /// time.
    ///
    /// ```
    /// use mp_plan::{Control, Finish, PathRows, Request, Scene};
    /// let scene = Scene::find("easy")?;
    /// let found = scene.plan(&Request::new("rrt-connect").finish(Finish::AsFound))?;
    /// let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows: found.path.unwrap_or_default() };
    /// let finished = scene.finish(&path, &Request::default(), &mut Control::default())?;
    /// assert!(finished.shortened && Some(finished.length) < found.path_length);
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the path is of another robot or not free: what it hits, and where; and when it was not verified in time.
    pub fn finish(
        &self,
        path: &PathRows,
        request: &Request,
        control: &mut Control<'_>,
    ) -> Result<Finished, Error> {
        finish_given(&*self.robot_for(request)?, path, request, control)
    }

    /// What a path costs by an objective.
    ///
    /// # Errors
    /// When the path is of another robot, or the clearance of this one is not known.
    pub fn path_cost(&self, path: &PathRows, objective: ObjectiveName) -> Result<f64, Error> {
        objective.cost(&*self.robot, &mp_cspace::Path::straight(states(&*self.robot, path)?))
    }

    /// Verifies a path from the start to a goal, with a verifier that shares no code with the planners' checks.
    ///
    /// # Errors
    /// When the path is of another robot. A path that is not free is not an error: see [`Verdict::free`].
    pub fn check(&self, path: &PathRows) -> Result<Verdict, Error> {
        self.check_until(path, &Interrupt::never())
    }

    /// As [`check`](Self::check), until `interrupt` says to end: then the verdict names a fault where the path is not verified yet.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn check_until(&self, path: &PathRows, interrupt: &Interrupt) -> Result<Verdict, Error> {
        check(&*self.robot, path, interrupt)
    }

    /// The certificate of a path: a file with which another program proves again that it is free. `clearance` (m) is that of the path, 0 if
    /// it is not known; the certificate proves half of it.
    ///
    /// ```
    /// use mp_plan::{Interrupt, PathRows, Request, Scene};
    /// let scene = Scene::find("easy")?;
    /// let report = scene.plan(&Request::new("rrt-connect"))?;
    /// let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap_or_default() };
    /// let certificate = scene.certificate(&path, report.clearance.unwrap_or(0.0), &Interrupt::never())?;
    /// assert!(certificate.clearance() > Some(0.0) && certificate.intervals() >= certificate.edges());
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the path is of another robot, is not free, or turns exactly half way round in one edge; when the kind of robot is your own and
    /// has no model; and when `interrupt` says to end.
    pub fn certificate(
        &self,
        path: &PathRows,
        clearance: f64,
        interrupt: &Interrupt,
    ) -> Result<Certificate, Error> {
        certificate(&*self.robot, path, None, clearance, interrupt)
    }

    /// The differences between a certificate and this scene, each as a sentence; none if the certificate is about this scene. This compares the
    /// numbers of a configuration and how they move the robot; all bodies, their radii, shapes and solids, to the last bit; where they stand and
    /// what moves them; and which bodies are kept apart. The path must lead from the start to a goal within the bounds, by motions that the robot
    /// can make. This does not check the proof itself: `mp-verify-certificate` does.
    ///
    /// ```
    /// use mp_plan::{Interrupt, PathRows, Request, Scene};
    /// let (scene, other) = (Scene::find("rrs-low")?, Scene::find("rrs-high")?);
    /// let report = scene.plan(&Request::new("rrt-connect"))?;
    /// let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows: report.path.unwrap_or_default() };
    /// let certificate = scene.certificate(&path, report.clearance.unwrap_or(0.0), &Interrupt::never())?;
    /// assert_eq!(scene.certificate_differences(certificate.to_json())?, Vec::<String>::new());
    /// assert!(!other.certificate_differences(certificate.to_json())?.is_empty());
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the text is no certificate of this version; when the kind of robot is your own and has no model.
    pub fn certificate_differences(&self, certificate: &str) -> Result<Vec<String>, Error> {
        crate::finish::certificate::differences(&*self.robot, certificate)
    }

    /// Explains a configuration: whether it is free, how near to contact, what touches, and where it would be free.
    ///
    /// # Errors
    /// When the row does not have as many numbers as the robot's configurations.
    pub fn explain(&self, row: &[f64]) -> Result<Explanation, Error> {
        let q = self.state(row)?;
        let found = explain(&*self.robot, &q);
        let Some(beside) = self.robot.row_fault(row) else { return Ok(found) };
        Ok(Explanation {
            free: false,
            in_bounds: false,
            clearance: 0.0,
            touching: Vec::new(),
            warnings: Vec::new(),
            fault: Some(format!("out of bounds: it {beside}")),
            nearest_free: if found.free { Some(self.robot.row(&q)) } else { found.nearest_free },
        })
    }

    /// Checks that start and goals are free. Returns what is odd about them.
    ///
    /// # Errors
    /// When one is not free: what touches, how deep, and the nearest free configuration.
    pub fn check_ends(&self) -> Result<Vec<String>, Error> {
        check_ends(&*self.robot)
    }

    /// Prepares what planning among large meshes needs, which a run would otherwise do first, unless `interrupt` says to end. Clones share it.
    ///
    /// # Errors
    /// When it was interrupted.
    pub fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        self.robot.make_ready(interrupt)
    }

    /// Which of start and goals are not free, and why, in sentences; [`lint`](Self::lint) says them too.
    #[must_use]
    pub fn wrong_ends(&self) -> Vec<String> {
        wrong_ends(&*self.robot)
    }

    /// What is wrong or odd about the scene, in sentences. Empty when nothing is.
    #[must_use]
    pub fn lint(&self) -> Vec<String> {
        lint(&*self.robot)
    }

    /// The bodies: those of the robot first, then the obstacles.
    #[must_use]
    pub fn bodies(&self) -> Vec<Body> {
        self.robot.bodies()
    }

    /// The poses of the bodies of the robot at a configuration, in the order of [`bodies`](Self::bodies).
    ///
    /// # Errors
    /// When the row does not have as many numbers as the robot's configurations.
    pub fn poses(&self, row: &[f64]) -> Result<Vec<Isometry3<f64>>, Error> {
        Ok(self.robot.poses(&self.state(row)?))
    }

    /// The point (m) whose curve pictures show, at a configuration.
    ///
    /// # Errors
    /// When the row does not have as many numbers as the robot's configurations.
    pub fn traced(&self, row: &[f64]) -> Result<Point3<f64>, Error> {
        Ok(self.robot.traced(&self.state(row)?))
    }

    /// Poses of the robot along a path; without a path, at start and goal only.
    ///
    /// # Errors
    /// When the path is of another robot.
    pub fn sweep(&self, path: Option<&PathRows>) -> Result<Sweep, Error> {
        sweep(&*self.robot, path)
    }

    /// A path sampled for an animation, with the clearance along it.
    ///
    /// # Errors
    /// When the path is of another robot, or has no configurations.
    pub fn track(&self, path: &PathRows) -> Result<Track, Error> {
        track(&*self.robot, path)
    }

    /// Resamples a path: `count` configurations as rows, at equal distances in the metric of the space, from its first to its last. All are
    /// on the path; its corners need not be among them. Angles without limits go on from row to row.
    ///
    /// ```
    /// use mp_plan::{PathRows, Scene};
    /// let scene = Scene::find("easy")?;
    /// let rows = vec![scene.start(), scene.goals().remove(0)];
    /// let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    /// let rows = scene.resample(&path, 5)?;
    /// assert!(rows.len() == 5 && rows[0] == scene.start());
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the path is of another robot; when the robot moves by inputs, as what is between its rows is no straight motion; when `count` is
    /// less than two, or such that there were more than 10⁷ numbers.
    pub fn resample(&self, path: &PathRows, count: usize) -> Result<Vec<Vec<f64>>, Error> {
        match self.kind {
            Some("driven" | "driven-moving") => {
                Err(Error::new(format!("the path of {} is not resampled: it moves by inputs", self.name()))
                    .help("its rows have the inputs and how long each is held"))
            }
            _ => resample(&*self.robot, path, count),
        }
    }

    /// An image of a field that pushes snakes, in a world of the plane. Each cell is a position of the robot; its other numbers are
    /// those of `row`. [`RelaxField::Risk`] shows the risk along `path`. `range` is the parameter of the planner `rrs`, whose default
    /// it has by default. The image has `cells` cells along its longer side, 4,096 at most.
    ///
    /// # Errors
    /// When the scene is no world of the plane, the field does not suit its robot, the row is not one of its configurations, there
    /// is no path for the risk, or the range is no length.
    pub fn field(
        &self,
        field: &RelaxField,
        row: &[f64],
        path: Option<&PathRows>,
        range: Option<&str>,
        cells: usize,
    ) -> Result<crate::FieldImage, Error> {
        if self.is_planar_world() {
            let mut settings = Settings::default();
            if let Some(range) = range {
                settings.set(RANGE.name, range);
            }
            let range = settings.length_of(&RANGE, &self.robot.any_space())?;
            let path =
                path.map(|path| Ok::<_, Error>(mp_cspace::Path::straight(states(&*self.robot, path)?)));
            self.state(row)?;
            return mp_kinds::field::field(
                &*self.robot,
                field,
                row,
                path.transpose()?.as_ref(),
                range,
                cells,
            );
        }
        Err(Error::new(format!("the field of {} is not drawn", self.name()))
            .help("only that of a world of the plane is"))
    }

    /// Writes the problem to `folder` as one JSON file and two OFF files for other planners. Returns the JSON file.
    ///
    /// # Errors
    /// When the robot is not a rigid body among meshes, or a file cannot be written.
    pub fn export(&self, folder: &Path) -> Result<PathBuf, Error> {
        self.robot.export(folder)
    }

    /// Whether the scene is a world of areas in the plane, which can be drawn as SVG.
    #[must_use]
    pub fn is_planar_world(&self) -> bool {
        self.bodies().iter().any(|body| matches!(body.shape, crate::BodyShape::Area(_)))
    }

    /// Whether the scene is best seen from above.
    #[must_use]
    pub fn is_planar(&self) -> bool {
        self.robot.is_planar()
    }

    /// The bounds of the robot's origin, for pictures that show them.
    #[must_use]
    pub fn picture_bounds(&self) -> Option<Aabb> {
        self.robot.picture_bounds()
    }
}
