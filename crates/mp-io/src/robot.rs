//! Robot problems: an arm, obstacles, a start and goals, in TOML.

mod problem;
mod srdf_near;
#[cfg(test)]
mod tests;
mod urdf_mesh;

pub use problem::{RobotProblem, read_robot_text};
pub use srdf_near::{FoundSrdf, robot_name};

use crate::drive::{DriveTable, Driven};
use crate::error::Error;
use crate::files::decode;
use crate::shape::{ShapeEntry, Shaped};
use crate::toml_problem::{GoalEntry, MotionPlaces, MotionTable, TomlText};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::Spanned;

/// The page that describes the format.
const GUIDE: &str = "the format is described in docs/formats/robot-problem.md";

/// An obstacle of a [`RobotFile`].
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleEntry {
    /// Its name in messages.
    pub name: String,
    /// Its shape, and where it is in the text.
    pub(crate) shape: (ShapeEntry, Range<usize>),
    /// x, y, z, α, β, γ.
    pub pose: [f64; 6],
    /// Points this near (m) to the robot at the start are left out, and where it says so.
    pub self_filter: Option<Spanned<f64>>,
}

/// The content of a robot problem file; the files that it names are not yet read.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// The name of the URDF file.
    pub urdf: String,
    /// The name of the SRDF file.
    pub srdf: Option<String>,
    /// Whether there is to be none, so that none is looked for.
    pub without_srdf: bool,
    /// The folder that `package://` means.
    pub packages: Option<String>,
    /// The pose of the root link, six numbers; zeros if the base floats.
    pub base: [f64; 6],
    /// The lower and the upper corner (m) of the box in which the origin of the root link moves, if the base floats.
    pub floating: Option<[[f64; 3]; 2]>,
    /// Whether the meshes of the robot are solids; other shapes always are.
    pub solid: bool,
    /// Limits that replace those of the URDF, by joint. Equal ones hold the joint.
    pub limits: Vec<(String, [f64; 2])>,
    /// How far (rad or m) the start may be beyond a limit; 0 when it is not given.
    pub limit_tolerance: f64,
    /// How the robot moves, if it moves by inputs.
    pub driven: Option<Driven>,
    /// The joint values at the start; first the six numbers of the pose of the base, if it floats. For a robot with accelerations, its velocities may follow.
    pub start: Vec<f64>,
    /// The goals, at least one.
    pub goals: Vec<GoalEntry>,
    /// How far from the goal a number of the last configuration may be; 0 when it is not given.
    pub tolerance: f64,
    /// The obstacles.
    pub obstacles: Vec<ObstacleEntry>,
    places: Places,
    text: String,
    file: String,
}

/// Where things are in the text.
#[derive(Clone, Debug, PartialEq)]
struct Places {
    urdf: Range<usize>,
    srdf: Range<usize>,
    robot: Range<usize>,
    base: Range<usize>,
    motion: MotionPlaces,
    limits: Vec<Range<usize>>,
}

/// A part of a [`RobotFile`] that an error can point at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotPart {
    /// The name of the URDF.
    Urdf,
    /// The name of the SRDF.
    Srdf,
    /// The table `robot`.
    Robot,
    /// The base.
    Base,
    /// The start.
    Start,
    /// The goal of this index.
    Goal(usize),
    /// The limits of this index.
    Limits(usize),
    /// What is left out of the obstacle of this index.
    SelfFilter(usize),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    robot: Spanned<RobotTable>,
    motion: MotionTable,
    #[serde(default)]
    obstacle: Vec<Spanned<Shaped<ObstacleTable>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotTable {
    urdf: Spanned<String>,
    srdf: Option<Spanned<SrdfEntry>>,
    packages: Option<String>,
    #[serde(default)]
    solid: bool,
    base: Option<Spanned<BaseEntry>>,
    bounds: Option<Spanned<Corners>>,
    #[serde(default)]
    limits: BTreeMap<String, Spanned<[f64; 2]>>,
    limit_tolerance: Option<Spanned<f64>>,
    kind: Option<Spanned<String>>,
    duration: Option<Spanned<f64>>,
    speeds: Option<Spanned<Vec<f64>>>,
    accelerations: Option<Spanned<Vec<f64>>>,
}

/// The name of an SRDF, or that there is to be none.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected the name of an SRDF, or `false` for none")]
enum SrdfEntry {
    Name(String),
    Is(bool),
}

/// The lower and the upper corner of a box.
type Corners = [[f64; 3]; 2];

/// Where the base stands, or that it floats.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected six numbers, `[x, y, z, α, β, γ]`, or \"floating\"")]
enum BaseEntry {
    Pose([f64; 6]),
    Word(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObstacleTable {
    name: Option<String>,
    pose: Option<Spanned<[f64; 6]>>,
    self_filter: Option<Spanned<f64>>,
}

impl RobotFile {
    /// Reads `bytes`, the content of a robot problem that errors call `file`. No other file is read.
    ///
    /// # Errors
    /// [`Error`] when it is not a robot problem, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let source = TomlText { file, text, guide: GUIDE };
        let File { robot, motion, obstacle } = source.read()?;
        let robot_span = robot.span();
        let robot = robot.into_inner();
        let table = DriveTable {
            kind: robot.kind,
            duration: robot.duration,
            speeds: robot.speeds,
            accelerations: robot.accelerations,
            ..DriveTable::default()
        };
        let driven = table.read(&source, &robot_span, &["velocities", "accelerations"])?;
        let base_span = robot.base.as_ref().map_or(0..0, Spanned::span);
        let (base, floating) = base_of(&source, robot.base, robot.bounds)?;
        let srdf_span = robot.srdf.as_ref().map_or(0..0, Spanned::span);
        let (srdf, without_srdf) = match robot.srdf.map(Spanned::into_inner) {
            Some(SrdfEntry::Name(name)) => (Some(name), false),
            Some(SrdfEntry::Is(false)) => (None, true),
            Some(SrdfEntry::Is(true)) => {
                return Err(source.error(&srdf_span, "`srdf = true` names no file").expected(
                    "the name of an SRDF; without `srdf` one near the URDF is taken, if there is one, and with `false` none",
                ));
            }
            None => (None, false),
        };
        let (mut limits, mut places_of_limits) = (Vec::new(), Vec::new());
        for (joint, range) in robot.limits {
            let (what, span) = (format!("the limits of {}", crate::text::clipped(&joint)), range.span());
            let [low, high] = *range.get_ref();
            source.check(&what, &[low, high], &span)?;
            if low > high {
                let message = format!("{what} are {low} to {high}");
                let expected = "the lower one first, below the upper, or equal ones, which hold the joint";
                return Err(source.error(&span, message).expected(expected));
            }
            places_of_limits.push(span);
            limits.push((joint, [low, high]));
        }
        let limit_tolerance = robot.limit_tolerance.as_ref().map_or(0.0, |spanned| *spanned.get_ref());
        if let Some(spanned) = &robot.limit_tolerance {
            source.check("the tolerance of limits", &[limit_tolerance], &spanned.span())?;
            if limit_tolerance < 0.0 {
                let message = format!("the tolerance of limits is {limit_tolerance}");
                let expected = "a number of at least zero: radians, or metres for joints that slide";
                return Err(source.error(&spanned.span(), message).expected(expected));
            }
        }
        let state = |what: &str, q: &Spanned<Vec<f64>>| source.check(what, q.get_ref(), &q.span());
        let motion = motion.read(&source, false, state)?;
        if let (None, Some(place)) = (&driven, &motion.places.tolerance) {
            let message = "only robots that move by inputs need a tolerance";
            let expected = "intervals in the goal: { joint = [1.0, 1.2] }, or no tolerance";
            return Err(source.error(place, message).expected(expected));
        }
        if let Some(place) = &motion.places.speed {
            let message = "nothing moves around this robot, so that it needs no speed";
            return Err(source.error(place, message).expected("no `speed` in [motion]"));
        }
        let obstacles = obstacle.iter().enumerate().map(|(i, table)| entry(&source, i, table));
        let places = Places {
            urdf: robot.urdf.span(),
            srdf: srdf_span,
            robot: robot_span,
            base: base_span,
            motion: motion.places,
            limits: places_of_limits,
        };
        Ok(Self {
            urdf: robot.urdf.into_inner(),
            srdf,
            without_srdf,
            packages: robot.packages,
            solid: robot.solid,
            base,
            floating,
            limits,
            limit_tolerance,
            driven,
            start: motion.start,
            goals: motion.goals,
            tolerance: motion.tolerance,
            obstacles: obstacles.collect::<Result<_, _>>()?,
            places,
            text: text.to_owned(),
            file: file.to_owned(),
        })
    }

    /// An error about a part of the file, for faults that are found only when the robot is made.
    #[must_use]
    pub fn fault(&self, part: RobotPart, message: &str, help: &str) -> Error {
        let span = match part {
            RobotPart::Urdf => &self.places.urdf,
            RobotPart::Srdf => &self.places.srdf,
            RobotPart::Robot => &self.places.robot,
            RobotPart::Base => &self.places.base,
            RobotPart::Start => &self.places.motion.start,
            RobotPart::Goal(i) => self.places.motion.goal(i),
            RobotPart::SelfFilter(i) => {
                let near = self.obstacles.get(i).and_then(|obstacle| obstacle.self_filter.as_ref());
                return self.fault_at(&near.map_or(0..0, Spanned::span), message, help);
            }
            RobotPart::Limits(i) => self.places.limits.get(i).unwrap_or(&self.places.urdf),
        };
        self.fault_at(span, message, help)
    }

    /// The text, for errors.
    fn source(&self) -> TomlText<'_> {
        TomlText { file: &self.file, text: &self.text, guide: GUIDE }
    }

    fn fault_at(&self, span: &Range<usize>, message: &str, help: &str) -> Error {
        self.source().error(span, message).help(help)
    }
}

/// The pose of the base, and its bounds if it floats.
fn base_of(
    source: &TomlText<'_>,
    base: Option<Spanned<BaseEntry>>,
    bounds: Option<Spanned<Corners>>,
) -> Result<([f64; 6], Option<Corners>), Error> {
    let span = base.as_ref().map_or(0..0, Spanned::span);
    let floats = match base.map(Spanned::into_inner) {
        Some(BaseEntry::Word(word)) if word == "floating" => true,
        Some(BaseEntry::Word(word)) => {
            let message = format!("the base is `{}`", crate::text::clipped(&word));
            return Err(source
                .error(&span, message)
                .expected("six numbers, `[x, y, z, α, β, γ]`, or \"floating\""));
        }
        Some(BaseEntry::Pose(pose)) => {
            source.check("the base", &pose, &span)?;
            if let Some(bounds) = bounds {
                let message = "the base stands still, but has bounds";
                return Err(source
                    .error(&bounds.span(), message)
                    .expected("`base = \"floating\"` beside them"));
            }
            return Ok((pose, None));
        }
        None => false,
    };
    match (floats, bounds) {
        (true, Some(bounds)) => {
            let ([low, high], span) = (*bounds.get_ref(), bounds.span());
            source.check("the bounds of the base", &[low, high].concat(), &span)?;
            if (0..3).all(|i| low[i] < high[i]) {
                return Ok(([0.0; 6], Some([low, high])));
            }
            let message = "the bounds of the base enclose nothing";
            Err(source
                .error(&span, message)
                .expected("the lower corner, then the upper: `[[x, y, z], [x, y, z]]`"))
        }
        (true, None) => {
            let message = "the base floats without bounds";
            Err(source.error(&span, message).expected(
                "`bounds = [[x, y, z], [x, y, z]]` beside it: the box in which the origin of the root link moves",
            ))
        }
        (false, Some(bounds)) => {
            let message = "there are bounds of a base that stands still";
            Err(source.error(&bounds.span(), message).expected("`base = \"floating\"` beside them"))
        }
        (false, None) => Ok(([0.0; 6], None)),
    }
}

/// The obstacle of the table at `span`.
pub(crate) fn entry(
    source: &TomlText<'_>,
    index: usize,
    table: &Spanned<Shaped<ObstacleTable>>,
) -> Result<ObstacleEntry, Error> {
    let own = &table.get_ref().own;
    let name = own.name.clone().unwrap_or_else(|| format!("obstacle {}", index + 1));
    let shape = table.get_ref().shape(source, &name, &table.span())?;
    let pose = source.six("the pose", own.pose.clone())?;
    let self_filter = own.self_filter.clone();
    if let Some(near) = &self_filter {
        source.check("the distance", &[*near.get_ref()], &near.span())?;
        let points =
            matches!(shape.0, ShapeEntry::PointFile(..) | ShapeEntry::Whole(mp_geom::Shape::Points(_)));
        if !points || *near.get_ref() < 0.0 {
            let message = format!(
                "{} cannot leave out what is {} m from the robot",
                crate::text::clipped(&name),
                near.get_ref()
            );
            return Err(source
                .error(&near.span(), message)
                .expected("`self_filter = DISTANCE` beside `points`: 0 or more, in metres"));
        }
    }
    Ok(ObstacleEntry { name, shape, pose, self_filter })
}
