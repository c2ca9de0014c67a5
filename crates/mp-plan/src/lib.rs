//! Motion planning from a scene to a verified path.
//!
//! This crate is the base for programs with a window, scripts and clusters. It takes scenes and names of planners, and
//! returns plain data.
//!
//! ```
//! use mp_geom::primitives::cuboid;
//! use mp_io::{Body, PlacedBody, RigidProblem, SpaceKind};
//! use mp_plan::{Request, Scene};
//! use nalgebra::Isometry3;
//!
//! // A stick goes around a post.
//! let robot = Body { name: "stick".into(), file: "".into(), mesh: cuboid(0.5, 0.1, 0.1)? };
//! let post = cuboid(0.2, 1.0, 4.0)?;
//! let post = PlacedBody { name: "post".into(), file: "".into(), mesh: post, pose: Isometry3::identity() };
//! let scene = Scene::from_problem(RigidProblem {
//!     name: "post".into(),
//!     space: SpaceKind::Se3,
//!     robot,
//!     obstacles: vec![post],
//!     start: Isometry3::translation(-1.0, 0.0, 0.0),
//!     goal: Isometry3::translation(1.0, 0.0, 0.0),
//!     bounds: None,
//! })?;
//!
//! let report = scene.plan(&Request::new("rrt-connect").seed(7).iterations(10_000))?;
//! assert!(report.solved && report.clearance > Some(0.0));
//! for row in report.path.iter().flatten() {
//!     assert_eq!(row.len(), 6); // x y z α β γ: see report.columns
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | load a scene, or make one in code | [`Scene::find`], [`Scene::load`], [`Scene::parse`], [`Scene::from_problem`], [`Scene::from_world`], [`ArmScene`], [`Scene::new`] |
//! | say how to plan | [`Request`]: planner, settings, metric, motion check, budgets, seed, what is done to the path found |
//! | plan | [`Scene::plan`]; with progress reports and a stop: [`Scene::plan_with`], [`Control`], [`Watch`] |
//! | plan thousands of problems, on all cores or on the ranks of a cluster, and race many runs of a hard one | the crate `mp-batch` |
//! | plan in pieces, between the events of a program | [`Scene::prepare`], [`Run`] |
//! | move start and goal | [`Scene::with_ends`] |
//! | build a roadmap once for many queries | [`Scene::roadmap`], [`SceneRoadmap`] |
//! | build a roadmap by regions, in pieces that may be made anywhere | `Scene::regions`, `RegionalWork` (feature `roadmaps`) |
//! | read the result | [`Report`], with a documented JSON form |
//! | shorten a path from elsewhere | [`Scene::finish`] |
//! | prove a path free | [`Scene::check`], [`Verdict`] |
//! | give a path times, and prove the curve that a controller runs | [`Scene::time`], [`TimedPath`], [`Pace`] |
//! | read, check and write trajectories | [`Scene::read_trajectory`], [`Scene::check_trajectory`], [`Scene::trajectory_bytes`] |
//! | give others the means to prove it again | [`Scene::certificate`], [`Certificate`] |
//! | find out why a configuration is not free | [`Scene::explain`] |
//! | find out what is odd about a scene | [`Scene::lint`] |
//! | find out what is in a file | [`info::Info`] |
//! | find out which links of a robot may touch | [`RobotPairs`] |
//! | decide by what an error is about | [`Error::kind`], [`ErrorKind`] |
//! | draw | `Scene::picture`, `Scene::film` (feature `pictures`), [`Scene::bodies`], [`Scene::poses`], [`Scene::sweep`] |
//! | add your own kind of robot | [`Robot`] |
//! | work with states instead of rows of numbers | [`search`], [`shorten`] with a [`Robot`] |
//!
//! Units are metres, radians and seconds. The crate prints nothing. It reports through `tracing`, with the spans `load`,
//! `build`, `plan`, `roadmap`, `query`, `relax`, `shorten`, `verify`, `check` and `certificate`.

mod explain;
mod files;
mod finish;
#[cfg(all(feature = "pictures", feature = "roadmaps"))]
pub mod fuzz;
mod links;
mod output;
mod parallel;
mod path;
#[cfg(feature = "pictures")]
mod picture;
mod portfolio_counts;
mod report;
mod request;
mod run;
mod scene;
mod sweep;
mod trajectory;
mod watch;

pub use explain::Explanation;
pub use files::editing::SceneProblem;
pub use files::find::{SceneFiles, find_problem, shipped_files};
pub use files::info;
pub use files::inputs::RobotsRead;
pub use files::robot_pairs::RobotPairs;
pub use finish::Finished;
pub use finish::certificate::Certificate;
pub use finish::check::Verdict;
pub use finish::trajectory::{LeastAlong, LimitFault, Pace, TightCorner, TimedPath, TrajectoryVerdict};
pub use output::{Claims, is_standard, make_folder, write_file};
pub use parallel::in_parallel;
pub use path::{PathFileKind, PathRows};
#[cfg(feature = "pictures")]
pub use picture::film::{Film, FilmKind};
#[cfg(feature = "pictures")]
pub use picture::{Look, PICTURE_SIZE, PictureKind};
pub use portfolio_counts::{PortfolioCounts, PortfolioSchedule};
pub use report::{REPORT_VERSION, Report, RunStage, StageTime, StoppedBy};
pub use request::{Budget, Finish, MotionValidator, Request};
pub use run::planners::{meta_planners, planners, roadmap_planners};
#[cfg(feature = "roadmaps")]
pub use run::regions::{RegionalTally, RegionalWork};
pub use run::roadmaps::Roadmap;
pub use run::runs::{Medians, Runs, median, medians};
#[cfg(feature = "roadmaps")]
pub use run::scene_roadmap::SceneRoadmap;
pub use run::search::{Search, search};
pub use run::{FoundRun, PreparedRun, Run};
pub use scene::{EditedScene, Scene};
pub use sweep::{Sweep, Track};
pub use trajectory::MOMENTS;
pub use watch::{Control, GrownRoadmap, SearchEvent, Stage, Watch};

#[cfg(feature = "pictures")]
pub use mp_render::{Mode, View};

pub use mp_kinds::motion::{AnyChecker, AnyMotion, AnyVerifier, Counting, TypedMotion};
pub use mp_kinds::{
    Appearance, ArmScene, Body, BodyShape, Checker, Column, Constraint, Contact, Counted, Description,
    Deviation, Drivable, Drive, DriveModel, DrivenScene, End, Error, ErrorKind, FieldImage, FloatingScene,
    GoalPart, LinkedScene, LinkedSpace, Measured, MetricName, ModelBody, ModelFrame, ModelPair, ModelPart,
    Motion, MotionModel, MovingScene, ObjectiveName, PathFormat, PlanarBody, PlanarScene, Queries, Reached,
    RelaxField, RigidScene, RigidSpace, Robot, SpeedBound, Step, VERIFIED_FINER, WithMoving, as_text,
    at_least, brief, count, plain, positive_number, shorten,
};

pub use mp_io::{FoundRobot, FreeTurns, PoseEntry, ProblemChanges, RobotPath, TrajectoryKind};
pub use mp_robot::{SampledPair, SampledPairs, TouchReason};
pub use mp_time::{Interpolation, Knots, Trajectory};

pub use mp_cspace::{
    Cancel, Clock, Interrupt, Length, Progress, StopReason,
    registry::{Parameter, PlannerInfo},
};
