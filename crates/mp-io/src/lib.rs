//! File formats of motion planning: meshes, scenes, problems, paths.
//!
//! - [`RigidProblem::load`] reads a problem and its meshes, whatever the format.
//! - [`ProblemFile::load_from`] reads a problem in TOML, for any robot.
//! - [`RobotProblem::load`] reads a problem for an arm, [`JointPath`] its paths.
//! - [`PlanarProblem::load`] reads a world in the plane.
//! - [`SceneDocument`] is a scene as an editor keeps it.
//! - [`FORMATS`] is the table of all formats: what files with which endings hold.
//! - [`read_mesh`] reads a mesh, whatever the format.
//! - [`Environment`], [`PathFile`]: GEMPA environment and configuration files.
//! - [`OffDocument`], [`write_off`], [`write_gempa_mesh`], [`write_stl`]: single mesh formats.
//!
//! Every reader takes a path, or bytes and the name that errors call them. Errors ([`Error`]) say file, line,
//! column, what was expected and what to do; no input makes a reader panic, hang or use memory out of
//! proportion to its size. Files are written whole or not at all. Lengths are metres and
//! angles radians. The formats are documented in `docs/formats/`.

mod changes;
mod document;
mod drive;
mod environment;
pub mod fuzz;
mod mjcf;
mod ompl;
mod planar;
mod pose_goal;
mod problem;
mod problem_document;
mod problem_file;
mod rigid_toml;
mod robot;
mod robots;
mod shape;
mod toml_problem;
mod trace;
mod trajectory;
mod xacro;
mod yaml;

pub use changes::ProblemChanges;
pub use document::{DocumentBody, DocumentShape, SceneDocument};
pub use drive::{Drive, Driven};
pub use environment::{Environment, Obstacle};
pub use mp_formats::columns::{Column, matched};
pub use mp_formats::csv::{csv_text, parse_csv};
pub use mp_formats::error::{Error, ErrorKind, one_line, shortened};
pub use mp_formats::files::{Disk, Files, InMemory, MAX_MESH_BYTES, MAX_TEXT_BYTES, Until, read_text};
pub use mp_formats::formats::gempa::{gempa_mesh_text, write_gempa_mesh};
pub use mp_formats::formats::off::{OffColor, OffDocument, OffFace, off_text, write_off};
pub use mp_formats::formats::stl::{stl_text, write_stl};
pub use mp_formats::formats::{Content, FORMATS, Format};
pub use mp_formats::grid::GridMap;
pub use mp_formats::mesh::{
    Axes, MAX_COORDINATE, MAX_CORNERS, parse_mesh, read_mesh, read_mesh_of, read_mesh_with,
};
pub use mp_formats::path::{JointPath, PathFile};
pub use ompl::{OmplExport, OmplProblem, OmplState, export_ompl, exported_files};
pub use planar::{
    PlanarFile, PlanarMap, PlanarMoving, PlanarObstacle, PlanarPart, PlanarProblem, PlanarShape, RosMap,
};
pub use pose_goal::{FreeTurns, PoseEntry};
pub use problem::{Body, PlacedBody, RigidProblem, SpaceKind};
pub use problem_document::{OtherShape, ProblemDocument, ProblemObstacle, ProblemShape, with_file_names};
pub use problem_file::ProblemFile;
pub use rigid_toml::{RigidMoving, RigidTask};
pub use robot::{
    AttachedEntry, DescribedRobot, FoundSrdf, JointLimits, LimitsOfJoint, MovingJoints, ObstacleEntry,
    PartChange, PartEntry, RobotEntry, RobotFile, RobotFilePart, RobotPart, RobotProblem, read_robot_text,
    robot_name,
};
pub use robots::{FoundRobot, RobotPath};
pub use shape::ShapeEntry;
pub use toml_problem::{GoalEntry, GoalPart, NamedStart, StartEntry, Timing};
pub use trajectory::{
    Follower, KnownJoints, RecordedBody, RecordedShape, Recording, TrajectoryFile, TrajectoryKind,
};
pub use xacro::expand_xacro;
