//! Robot problems: an arm, obstacles, a start and goals, in TOML.

mod entry;
mod joint_limits;
mod parts;
mod problem;
mod srdf_near;
#[cfg(test)]
mod tests;
mod urdf_mesh;

pub use entry::{MovingJoints, RobotEntry, RobotPart};
use entry::{RobotTables, robots_of};
pub(crate) use joint_limits::parse as limits_of_joints;
pub use joint_limits::{JointLimits, LimitsOfJoint};
pub use parts::{PartChange, PartEntry};
use parts::{PartTable, part_of};
pub use problem::{DescribedRobot, RobotProblem, read_robot_text};
pub use srdf_near::{FoundSrdf, robot_name};

use crate::shape::{ShapeEntry, Shaped};
use crate::toml_problem::{Exactly, GoalEntry, MotionPlaces, MotionTable, StartEntry, TomlText};
use mp_formats::error::Error;
use mp_formats::files::decode;
use serde::Deserialize;
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

/// Something that a link carries, of a [`RobotFile`].
#[derive(Clone, Debug, PartialEq)]
pub struct AttachedEntry {
    /// Its name: that of a link of its own.
    pub name: String,
    /// The link that carries it.
    pub link: String,
    /// Its shape, and where it is in the text.
    pub(crate) shape: (ShapeEntry, Range<usize>),
    /// x, y, z, α, β, γ in the frame of the link.
    pub pose: [f64; 6],
    /// The links that it may touch, besides those that never move relative to it.
    pub may_touch: Vec<String>,
    place: Range<usize>,
}

/// The content of a robot problem file; the files that it names are not yet read.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotFile {
    /// The robots, at least one.
    pub robots: Vec<RobotEntry>,
    /// The joint values at the start; first the numbers of the pose of the base, if it moves. For a robot with accelerations, its velocities may follow.
    pub start: StartEntry,
    /// The goals, at least one.
    pub goals: Vec<GoalEntry>,
    /// How far from the goal a number of the last configuration may be; 0 when it is not given.
    pub tolerance: f64,
    /// The obstacles, in the order of the file.
    pub obstacles: Vec<ObstacleEntry>,
    /// What links carry.
    pub attached: Vec<AttachedEntry>,
    /// Which part of the motion this is, from 1.
    pub part: usize,
    /// The parts of the motion after this one.
    pub parts: Vec<PartEntry>,
    places: MotionPlaces,
    text: String,
    file: String,
}

/// A part of a [`RobotFile`] that an error can point at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotFilePart {
    /// A part of the robot of this index.
    Robot(usize, RobotPart),
    /// The start configuration.
    Start,
    /// The goal of this index.
    Goal(usize),
    /// What is attached, of this index.
    Attached(usize),
    /// The next part of the motion.
    Next,
    /// What is left out of the obstacle of this index.
    SelfFilter(usize),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    robot: Spanned<RobotTables>,
    motion: MotionTable<StartEntry>,
    #[serde(default)]
    obstacle: Vec<Spanned<Shaped<ObstacleTable>>>,
    #[serde(default)]
    attached: Vec<Spanned<Shaped<AttachedTable>>>,
    #[serde(default)]
    then: Vec<Spanned<PartTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ObstacleTable {
    name: Option<String>,
    pose: Option<Spanned<Exactly<f64, 6>>>,
    at: Option<Spanned<Exactly<f64, 3>>>,
    self_filter: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AttachedTable {
    name: Option<String>,
    link: String,
    pose: Option<Spanned<Exactly<f64, 6>>>,
    #[serde(default)]
    may_touch: Vec<String>,
}

impl RobotFile {
    /// Reads `bytes`, the content of a robot problem that errors call `file`. No other file is read.
    ///
    /// # Errors
    /// [`Error`] when it is not a robot problem, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let source = TomlText { file, text, guide: GUIDE };
        let File { robot, motion, obstacle, attached, then } = source.read()?;
        let robots = robots_of(&source, robot)?;
        let state =
            |what: &str, q: &Spanned<StartEntry>| source.check(what, &q.get_ref().numbers(), &q.span());
        let motion = motion.read(&source, false, state)?;
        if let (true, Some(place)) =
            (robots.iter().all(|robot| robot.driven.is_none()), &motion.places.tolerance)
        {
            let message = "only robots that move by inputs need a tolerance";
            let expected = "intervals in the goal: { joint = [1.0, 1.2] }, or no tolerance";
            return Err(source.error(place, message).expected(expected));
        }
        if let Some(place) = &motion.places.speed {
            let message = "nothing moves around this robot, so that it needs no speed";
            return Err(source.error(place, message).expected("no `speed` in [motion]"));
        }
        let obstacles = obstacle.iter().enumerate().map(|(i, table)| entry(&source, i, table));
        let attached = attached.iter().enumerate().map(|(i, table)| attached_entry(&source, i, table));
        Ok(Self {
            robots,
            start: motion.start,
            goals: motion.goals,
            tolerance: motion.tolerance,
            obstacles: obstacles.collect::<Result<_, _>>()?,
            attached: attached.collect::<Result<_, _>>()?,
            part: 1,
            parts: then.into_iter().map(|table| part_of(&source, table)).collect::<Result<_, _>>()?,
            places: motion.places,
            text: text.to_owned(),
            file: file.to_owned(),
        })
    }

    /// What the names of links and joints of the robot number `i` begin with: nothing if it is the only one.
    #[must_use]
    pub fn prefix(&self, i: usize) -> String {
        let name = self.robots.get(i).filter(|_| self.robots.len() > 1).and_then(|robot| robot.name.as_ref());
        name.map_or_else(String::new, |name| format!("{name}/"))
    }

    /// An error about a part of the file, for faults that are found only when the robot is made.
    #[must_use]
    pub fn fault(&self, part: RobotFilePart, message: &str, help: &str) -> Error {
        let span = match part {
            RobotFilePart::Robot(i, part) => {
                self.robots.get(i).map_or(&self.places.start, |robot| robot.places.of(part))
            }
            RobotFilePart::Start => &self.places.start,
            RobotFilePart::Goal(i) => self.places.goal(i),
            RobotFilePart::Next => self.parts.first().map_or(&self.places.start, |part| &part.place),
            RobotFilePart::Attached(i) => {
                self.attached.get(i).map_or(&self.places.start, |entry| &entry.place)
            }
            RobotFilePart::SelfFilter(i) => {
                let near = self.obstacles.get(i).and_then(|obstacle| obstacle.self_filter.as_ref());
                let span = near.map_or(0..0, Spanned::span);
                return self.source().error(&span, message).help(help);
            }
        };
        self.source().error(span, message).help(help)
    }

    /// The text, for errors.
    fn source(&self) -> TomlText<'_> {
        TomlText { file: &self.file, text: &self.text, guide: GUIDE }
    }
}

/// What is attached by the table at `span`.
fn attached_entry(
    source: &TomlText<'_>,
    index: usize,
    table: &Spanned<Shaped<AttachedTable>>,
) -> Result<AttachedEntry, Error> {
    let own = &table.get_ref().own;
    let name = own.name.clone().unwrap_or_else(|| format!("attached {}", index + 1));
    let shape = table.get_ref().shape(source, &name, &table.span())?;
    let pose = source.six("the pose", own.pose.clone())?;
    let (link, may_touch, place) = (own.link.clone(), own.may_touch.clone(), table.span());
    Ok(AttachedEntry { name, link, shape, pose, may_touch, place })
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
    let pose = match (&own.pose, &own.at) {
        (Some(_), Some(at)) => {
            let message = format!("{} has a pose, and a position", mp_formats::text::clipped(&name));
            return Err(source.error(&at.span(), message).expected("`pose` or `at`, not both"));
        }
        (None, Some(at)) => {
            let Exactly([x, y, z]) = *at.get_ref();
            source.check("the position", &[x, y, z], &at.span())?;
            [x, y, z, 0.0, 0.0, 0.0]
        }
        (pose, None) => source.six("the pose", pose.clone())?,
    };
    let self_filter = own.self_filter.clone();
    if let Some(near) = &self_filter {
        source.check("the distance", &[*near.get_ref()], &near.span())?;
        let points =
            matches!(shape.0, ShapeEntry::PointFile(..) | ShapeEntry::Whole(mp_geom::Shape::Points(_)));
        if !points || *near.get_ref() < 0.0 {
            let message = format!(
                "{} cannot leave out what is {} m from the robot",
                mp_formats::text::clipped(&name),
                near.get_ref()
            );
            return Err(source
                .error(&near.span(), message)
                .expected("`self_filter = DISTANCE` beside `points`: 0 or more, in metres"));
        }
    }
    Ok(ObstacleEntry { name, shape, pose, self_filter })
}
