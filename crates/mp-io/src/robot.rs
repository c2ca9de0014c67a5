//! Robot problems: an arm, obstacles, a start and goals, in TOML.

mod load;

use crate::error::Error;
use crate::problem::PlacedBody;
use crate::source::decode;
use crate::tables::Source;
use mp_geom::pose_from_six;
use nalgebra::Isometry3;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use toml::Spanned;

/// The page that describes the format.
const GUIDE: &str = "the format is described in docs/formats/robot-problem.md";

/// The shape of an obstacle, as the file says it: metres, about its own origin.
#[derive(Clone, Debug, PartialEq)]
pub enum ObstacleShape {
    /// The name of a mesh file.
    Mesh(String),
    /// The lengths of the sides.
    Box([f64; 3]),
    /// The radius.
    Sphere(f64),
    /// Radius and height, about Z.
    Cylinder([f64; 2]),
}

/// An obstacle of a [`RobotFile`].
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleEntry {
    /// What messages call it.
    pub name: String,
    /// Its shape.
    pub shape: ObstacleShape,
    /// x, y, z, α, β, γ.
    pub pose: [f64; 6],
    /// Where the shape is in the text.
    span: Range<usize>,
}

/// What a robot problem file says, other files not yet read.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// The name of the URDF file.
    pub urdf: String,
    /// The name of the SRDF file.
    pub srdf: Option<String>,
    /// The folder that `package://` means.
    pub packages: Option<String>,
    /// The pose of the root link, six numbers.
    pub base: [f64; 6],
    /// Limits in place of those of the URDF, by joint.
    pub limits: Vec<(String, [f64; 2])>,
    /// The joint values at the start.
    pub start: Vec<f64>,
    /// The joint values at the goals, at least one.
    pub goals: Vec<Vec<f64>>,
    /// The obstacles.
    pub obstacles: Vec<ObstacleEntry>,
    places: Places,
    text: String,
    file: String,
}

/// Where things are in the text.
#[derive(Clone, Debug, Default, PartialEq)]
struct Places {
    urdf: Range<usize>,
    srdf: Range<usize>,
    start: Range<usize>,
    goals: Vec<Range<usize>>,
    limits: Vec<Range<usize>>,
}

/// A part of a [`RobotFile`] that an error can point at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotPart {
    /// The name of the URDF.
    Urdf,
    /// The name of the SRDF.
    Srdf,
    /// The start.
    Start,
    /// The goal of this index.
    Goal(usize),
    /// The limits of this index.
    Limits(usize),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    robot: RobotTable,
    motion: MotionTable,
    #[serde(default)]
    obstacle: Vec<Spanned<ObstacleTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotTable {
    urdf: Spanned<String>,
    srdf: Option<Spanned<String>>,
    packages: Option<String>,
    base: Option<Spanned<[f64; 6]>>,
    #[serde(default)]
    limits: BTreeMap<String, Spanned<[f64; 2]>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MotionTable {
    start: Spanned<Vec<f64>>,
    goal: Option<Spanned<Vec<f64>>>,
    goals: Option<Spanned<Vec<Spanned<Vec<f64>>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObstacleTable {
    name: Option<String>,
    mesh: Option<Spanned<String>>,
    #[serde(rename = "box")]
    cuboid: Option<Spanned<[f64; 3]>>,
    sphere: Option<Spanned<f64>>,
    cylinder: Option<Spanned<[f64; 2]>>,
    pose: Option<Spanned<[f64; 6]>>,
}

impl RobotFile {
    /// Reads `bytes`, the content of a robot problem that errors call `file`. No other file is read.
    ///
    /// # Errors
    /// [`Error`] when it is not a robot problem, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let source = Source { file, text, guide: GUIDE };
        let read: File = source.read()?;
        let File { robot, motion, obstacle } = read;
        let mut places = Places { urdf: robot.urdf.span(), start: motion.start.span(), ..Places::default() };
        places.srdf = robot.srdf.as_ref().map_or(0..0, Spanned::span);

        let base = source.six("the base", robot.base)?;
        let mut limits = Vec::new();
        for (joint, range) in robot.limits {
            let (what, span) = (format!("the limits of {}", crate::text::clipped(&joint)), range.span());
            let [low, high] = *range.get_ref();
            source.check(&what, &[low, high], &span)?;
            if low >= high {
                let message = format!("{what} are {low} to {high}");
                return Err(source.error(&span, message).expected("the lower one first, below the upper"));
            }
            places.limits.push(span);
            limits.push((joint, [low, high]));
        }
        source.check("the start", motion.start.get_ref(), &motion.start.span())?;
        let goals = match (motion.goal, motion.goals) {
            (Some(goal), None) => vec![goal],
            (None, Some(goals)) if !goals.get_ref().is_empty() => goals.into_inner(),
            (None, Some(goals)) => {
                return Err(source.error(&goals.span(), "there are no goals").expected("at least one"));
            }
            (Some(_), Some(goals)) => {
                let message = "there is a goal and a list of goals";
                return Err(source.error(&goals.span(), message).expected("`goal` or `goals`, not both"));
            }
            (None, None) => {
                let message = "the motion has no goal";
                return Err(source.error(&places.start, message).expected("`goal = [...]` beside `start`"));
            }
        };
        for goal in &goals {
            source.check("the goal", goal.get_ref(), &goal.span())?;
            places.goals.push(goal.span());
        }
        let obstacles = obstacle.into_iter().enumerate().map(|(i, o)| entry(&source, i, o));
        Ok(Self {
            urdf: robot.urdf.into_inner(),
            srdf: robot.srdf.map(Spanned::into_inner),
            packages: robot.packages,
            base,
            limits,
            start: motion.start.into_inner(),
            goals: goals.into_iter().map(Spanned::into_inner).collect(),
            obstacles: obstacles.collect::<Result<_, _>>()?,
            places,
            text: text.to_owned(),
            file: file.to_owned(),
        })
    }

    /// An error about a part of the file, for faults that show only when the robot is made.
    #[must_use]
    pub fn fault(&self, part: RobotPart, message: &str, help: &str) -> Error {
        let span = match part {
            RobotPart::Urdf => &self.places.urdf,
            RobotPart::Srdf => &self.places.srdf,
            RobotPart::Start => &self.places.start,
            RobotPart::Goal(i) => self.places.goals.get(i).unwrap_or(&self.places.start),
            RobotPart::Limits(i) => self.places.limits.get(i).unwrap_or(&self.places.urdf),
        };
        Source { file: &self.file, text: &self.text, guide: GUIDE }.error(span, message).help(help)
    }
}

fn entry(source: &Source<'_>, index: usize, table: Spanned<ObstacleTable>) -> Result<ObstacleEntry, Error> {
    let span = table.span();
    let table = table.into_inner();
    let name = table.name.unwrap_or_else(|| format!("obstacle {}", index + 1));
    let mut shapes = Vec::new();
    if let Some(mesh) = table.mesh {
        shapes.push((mesh.span(), ObstacleShape::Mesh(mesh.into_inner())));
    }
    if let Some(sides) = table.cuboid {
        source.positive("a side of the box", sides.get_ref(), &sides.span())?;
        shapes.push((sides.span(), ObstacleShape::Box(sides.into_inner())));
    }
    if let Some(radius) = table.sphere {
        source.positive("the radius", &[*radius.get_ref()], &radius.span())?;
        shapes.push((radius.span(), ObstacleShape::Sphere(radius.into_inner())));
    }
    if let Some(sizes) = table.cylinder {
        source.positive("the radius or height of the cylinder", sizes.get_ref(), &sizes.span())?;
        shapes.push((sizes.span(), ObstacleShape::Cylinder(sizes.into_inner())));
    }
    let pose = source.six("the pose", table.pose)?;
    let count = shapes.len();
    match shapes.pop() {
        Some((span, shape)) if count == 1 => Ok(ObstacleEntry { name, shape, pose, span }),
        _ => {
            let message = format!("{} has {count} shapes", crate::text::clipped(&name));
            Err(source.error(&span, message).expected("one of `mesh`, `box`, `sphere`, `cylinder`"))
        }
    }
}

/// An arm, obstacles, a start and goals, with all files read but the meshes of the robot.
#[derive(Clone, Debug)]
pub struct RobotProblem {
    /// The name of the file, without extension.
    pub name: String,
    /// What the file says.
    pub file: RobotFile,
    /// Where the URDF is.
    pub urdf_file: PathBuf,
    /// What is in it.
    pub urdf: String,
    /// What is in the SRDF.
    pub srdf: Option<String>,
    /// The folder that `package://` means.
    pub packages: Option<PathBuf>,
    /// The obstacles. Round ones are meshes that contain them.
    pub obstacles: Vec<PlacedBody>,
}

impl RobotProblem {
    /// The pose of the root link in the world.
    #[must_use]
    pub fn base(&self) -> Isometry3<f64> {
        pose_from_six(self.file.base)
    }
}

#[cfg(test)]
mod tests;
