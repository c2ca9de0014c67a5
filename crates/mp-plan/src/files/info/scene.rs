//! What is in a scene.

use super::Surface;
use crate::{BodyShape, Scene, brief, count, plain};
use mp_geom::six_from_pose;
use mp_kinds::numbers::plain_row;
use serde::Serialize;
use std::fmt;

/// What is in a scene of any kind. Metres and radians.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SceneInfo {
    /// The path of its file; `None` for a scene that was made in the program.
    pub file: Option<String>,
    /// What messages and pictures call the scene.
    pub name: String,
    /// The configuration space: `SE3`, `SE2`, `R2`, `6 joints`.
    pub space: String,
    /// The kind of robot, as [`Scene::kind`] says: `space`, `arms`, ….
    pub robot: Option<&'static str>,
    /// The meaning of each number of a configuration.
    pub columns: Vec<ColumnInfo>,
    /// The start configuration.
    pub start: Vec<f64>,
    /// The goal configurations.
    pub goals: Vec<Vec<f64>>,
    /// The bodies, those of the robot first.
    pub bodies: Vec<BodyInfo>,
    /// The number of triangles of all obstacles.
    pub triangles: usize,
    /// The fraction of the space that is free, estimated from samples.
    pub free: f64,
    /// Further facts about the robot: name and text.
    pub details: Vec<(String, String)>,
    /// What is wrong or odd about it.
    pub warnings: Vec<String>,
}

/// The meaning of one number of a configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColumnInfo {
    /// The name of the joint or coordinate.
    pub name: String,
    /// The unit of the number: `m`, `rad`, ….
    pub unit: String,
    /// The least and the largest value; none for an angle without limits.
    pub limits: Option<[f64; 2]>,
}

/// The properties of a body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyInfo {
    /// What messages call the body.
    pub name: String,
    /// Whether it belongs to the robot.
    pub moves: bool,
    /// The pose of a body that stands still: x y z α β γ.
    pub pose: Option<[f64; 6]>,
    /// Its surface; `None` for an area in the plane.
    pub mesh: Option<Surface>,
    /// The number of corners, for an area in the plane.
    pub corners: Option<usize>,
}

impl SceneInfo {
    /// The properties of a scene. Takes some thousands of collision queries.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let bodies: Vec<BodyInfo> = scene.bodies().iter().map(BodyInfo::of).collect();
        let mut warnings: Vec<String> = Vec::new();
        for body in &bodies {
            // One line for each body: meshes from drawing programs often have all of these defects.
            let defects = body.mesh.as_ref().map(|mesh| mesh.warnings.join("; ")).unwrap_or_default();
            warnings.extend((!defects.is_empty()).then(|| format!("{}: {defects}", body.name)));
        }
        warnings.extend(scene.lint());
        let limits = scene.limits();
        let columns = scene.columns().into_iter().enumerate();
        let still = bodies.iter().filter(|body| !body.moves);
        Self {
            file: scene.file().map(|file| file.display().to_string()),
            name: scene.name().to_owned(),
            space: scene.space(),
            robot: scene.kind(),
            columns: columns
                .map(|(i, c)| ColumnInfo {
                    name: c.name,
                    unit: c.unit,
                    limits: limits.get(i).copied().flatten(),
                })
                .collect(),
            start: scene.start(),
            goals: scene.goals(),
            triangles: still.filter_map(|body| Some(body.mesh.as_ref()?.triangles)).sum(),
            free: scene.free_share(10_000),
            details: graded(scene).into_iter().chain(scene.details()).collect(),
            bodies,
            warnings,
        }
    }
}

/// How hard a shipped scene is, if it is graded.
#[cfg(feature = "scenes")]
fn graded(scene: &Scene) -> Option<(String, String)> {
    let known = mp_scenes::puzzle(scene.name()).filter(|_| scene.files.shipped)?;
    let room = plain((1e4 * known.room).round() / 100.0);
    let text = format!(
        "{}: {}; a way is known with a clearance of {room}% of the robot's radius",
        known.grade, known.about
    );
    Some(("grade".to_owned(), text))
}

#[cfg(not(feature = "scenes"))]
fn graded(_: &Scene) -> Option<(String, String)> {
    None
}

impl BodyInfo {
    fn of(body: &crate::Body) -> Self {
        let (mesh, corners) = match &body.shape {
            BodyShape::Mesh(mesh) => (Some(Surface::of(mesh)), None),
            BodyShape::Area(rings) | BodyShape::Lines(rings) => {
                (None, Some(rings.iter().map(Vec::len).sum()))
            }
        };
        let pose = body.pose.map(|pose| six_from_pose(&pose));
        Self { name: body.name.clone(), moves: body.pose.is_none(), pose, mesh, corners }
    }

    fn summary(&self) -> String {
        match (&self.mesh, self.corners) {
            (Some(mesh), _) => mesh.summary(),
            (None, corners) => count(corners.unwrap_or(0), "corner"),
        }
    }
}

/// How many bodies are listed. The others are only counted.
const LISTED: usize = 40;
/// How many goals are listed.
const GOALS: usize = 4;

impl fmt::Display for SceneInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = plain_row;
        let name = self.file.as_ref().unwrap_or(&self.name);
        writeln!(f, "{name}: a scene in {}", self.space)?;
        for c in &self.columns {
            match c.limits {
                Some([low, high]) => {
                    writeln!(f, "    {} from {} to {} {}", c.name, plain(low), plain(high), c.unit)?;
                }
                None => writeln!(f, "    {} turns without end", c.name)?,
            }
        }
        writeln!(f, "  start     {}", row(&self.start))?;
        self.goals.iter().take(GOALS).try_for_each(|goal| writeln!(f, "  goal      {}", row(goal)))?;
        if self.goals.len() > GOALS {
            writeln!(f, "  goal      or {} others", self.goals.len() - GOALS)?;
        }
        for body in self.bodies.iter().filter(|body| body.moves) {
            writeln!(f, "  robot     {}: {}", body.name, body.summary())?;
        }
        self.details.iter().try_for_each(|(name, text)| writeln!(f, "  {name:<10}{text}"))?;
        writeln!(f, "  free      {}% of the space", brief(100.0 * self.free))?;
        let still: Vec<_> = self.bodies.iter().filter(|body| !body.moves).collect();
        match self.triangles {
            0 => writeln!(f, "  {}", count(still.len(), "obstacle"))?,
            n => writeln!(f, "  {}, {}", count(still.len(), "obstacle"), count(n, "triangle"))?,
        }
        for body in still.iter().take(LISTED) {
            let at = body.pose.map(|p| row(&p)).unwrap_or_default();
            writeln!(f, "    {} at {at}: {}", body.name, body.summary())?;
        }
        if still.len() > LISTED {
            writeln!(f, "    and {} more", still.len() - LISTED)?;
        }
        self.warnings.iter().try_for_each(|w| writeln!(f, "  warning   {w}"))
    }
}
