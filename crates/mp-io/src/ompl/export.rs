//! A problem as one JSON and two OFF files, for running other planners on the same problem.

use crate::problem::{RigidProblem, SpaceKind};
use mp_formats::error::{Error, ErrorKind};
use mp_formats::formats::off::off_text;
use mp_geom::TriMesh;
use nalgebra::Isometry3;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// The settings of an export.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OmplExport {
    /// A state within this distance of the goal counts as the goal, in the metric of the space.
    pub goal_threshold: f64,
    /// The resolution of motion checks, as a fraction of the extent of the space.
    pub resolution_fraction: f64,
}

impl Default for OmplExport {
    /// The defaults of OMPL.app: 1e-6, and 1% of the extent.
    fn default() -> Self {
        Self { goal_threshold: 1e-6, resolution_fraction: 0.01 }
    }
}

#[derive(Serialize)]
struct JsonProblem<'a> {
    name: &'a str,
    space: String,
    start: JsonState,
    goal: JsonState,
    bounds: JsonBounds,
    goal_threshold: f64,
    resolution_fraction: f64,
    robot: JsonMesh,
    env: JsonMesh,
}

#[derive(Serialize)]
struct JsonState {
    position: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    quaternion: Option<JsonQuaternion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    yaw: Option<f64>,
}

#[derive(Serialize)]
struct JsonQuaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Serialize)]
struct JsonBounds {
    low: Vec<f64>,
    high: Vec<f64>,
}

#[derive(Serialize)]
struct JsonMesh {
    mesh: String,
}

/// The names of the files that [`export_ompl`] writes: the problem, the mesh of the robot and that of the obstacles.
#[must_use]
pub fn exported_files(name: &str) -> [String; 3] {
    [format!("{name}.json"), format!("{name}_robot.off"), format!("{name}_env.off")]
}

/// Writes `problem` into `folder`: `NAME.json`, `NAME_robot.off` and `NAME_env.off` (all obstacles, placed in
/// the world), where NAME is `name`. Returns the path of the JSON file.
///
/// # Errors
/// [`Error`] when a file cannot be written, or there is no obstacle.
pub fn export_ompl(
    problem: &RigidProblem,
    folder: impl AsRef<Path>,
    name: &str,
    options: &OmplExport,
) -> Result<PathBuf, Error> {
    let folder = folder.as_ref();
    let [json, meshes @ ..] = exported_files(name);
    let json = folder.join(json);
    if ![options.goal_threshold, options.resolution_fraction].iter().all(|v| v.is_finite()) {
        return Err(Error::new(
            ErrorKind::Content,
            json.display(),
            "threshold and resolution must be finite",
        ));
    }
    let placed: Vec<_> = problem.obstacles.iter().map(|o| o.mesh.transformed(&o.pose)).collect();
    let env = TriMesh::merged(&placed).ok_or_else(|| {
        Error::new(ErrorKind::Content, json.display(), "a problem without obstacles cannot be exported")
            .help("add an obstacle far from the path")
    })?;
    let dimensions = if problem.space == SpaceKind::Se2 { 2 } else { 3 };
    let state = |pose: &Isometry3<f64>| {
        let position = pose.translation.vector.as_slice()[..dimensions].to_vec();
        match problem.space {
            SpaceKind::Se3 => {
                let q = pose.rotation;
                let quaternion = JsonQuaternion { x: q.i, y: q.j, z: q.k, w: q.w };
                JsonState { position, quaternion: Some(quaternion), yaw: None }
            }
            SpaceKind::Se2 => {
                let yaw = mp_geom::six_from_pose(pose)[3];
                JsonState { position, quaternion: None, yaw: Some(yaw) }
            }
        }
    };
    let bounds = problem.position_bounds();
    let exported = JsonProblem {
        name: &problem.name,
        space: problem.space.to_string(),
        start: state(&problem.start),
        goal: state(&problem.goal),
        bounds: JsonBounds {
            low: bounds.min.coords.as_slice()[..dimensions].to_vec(),
            high: bounds.max.coords.as_slice()[..dimensions].to_vec(),
        },
        goal_threshold: options.goal_threshold,
        resolution_fraction: options.resolution_fraction,
        robot: JsonMesh { mesh: meshes[0].clone() },
        env: JsonMesh { mesh: meshes[1].clone() },
    };
    let text = serde_json::to_string_pretty(&exported).map_err(|e| {
        Error::new(ErrorKind::Content, json.display(), format!("cannot write the problem: {e}"))
    })?;
    mp_store::write(&folder.join(&meshes[0]), off_text(&problem.robot.mesh).as_bytes())?;
    mp_store::write(&folder.join(&meshes[1]), off_text(&env).as_bytes())?;
    mp_store::write(&json, (text + "\n").as_bytes())?;
    Ok(json)
}
