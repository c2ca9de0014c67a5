//! Motions of several parts, between which things are attached to links and put down again.

use super::{AttachedEntry, RobotFile, RobotProblem};
use crate::problem::PlacedBody;
use crate::toml_problem::{GoalEntry, GoalText, Goals, StartEntry, TomlText};
use mp_formats::error::Error;
use mp_geom::six_from_pose;
use nalgebra::Isometry3;
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;

/// What changes before a part of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum PartChange {
    /// An obstacle is attached to a link, as it is where it is.
    Attach {
        /// The obstacle that is attached, by its name.
        obstacle: String,
        /// The link that carries it from then on.
        link: String,
        /// The links that it may touch from then on.
        may_touch: Vec<String>,
    },
    /// What was attached is an obstacle from then on, where it is.
    Detach(String),
}

/// A part of a motion, which begins where the one before it has ended.
#[derive(Clone, Debug, PartialEq)]
pub struct PartEntry {
    /// What changes before it, if anything does.
    pub change: Option<PartChange>,
    /// Its goals, at least one.
    pub goals: Vec<GoalEntry>,
    goal_places: Vec<Range<usize>>,
    pub(super) place: Range<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PartTable {
    attach: Option<String>,
    to: Option<String>,
    may_touch: Option<Vec<String>>,
    detach: Option<String>,
    goal: Option<Spanned<GoalText>>,
    goals: Option<Spanned<Vec<Spanned<GoalText>>>>,
}

pub(super) fn part_of(source: &TomlText<'_>, table: Spanned<PartTable>) -> Result<PartEntry, Error> {
    let place = table.span();
    let PartTable { attach, to, may_touch, detach, goal, goals } = table.into_inner();
    let wrong = |message: &str, expected: &str| Err(source.error(&place, message).expected(expected));
    let change = match (attach, to, detach) {
        (Some(_), _, Some(_)) => {
            return wrong("a part attaches and detaches something", "two parts: one of them may be short");
        }
        (Some(obstacle), Some(link), None) => {
            Some(PartChange::Attach { obstacle, link, may_touch: may_touch.unwrap_or_default() })
        }
        (Some(_), None, None) => {
            return wrong("something is attached to no link", "`to = \"LINK\"` beside `attach`");
        }
        (None, None, detach) if may_touch.is_none() => detach.map(PartChange::Detach),
        (None, ..) => {
            return wrong(
                "`to` and `may_touch` are given, and nothing is attached",
                "`attach = \"OBSTACLE\"` beside them",
            );
        }
    };
    let (goals, goal_places) = Goals { goal, goals }.read(source, &place)?.into_iter().unzip();
    Ok(PartEntry { change, goals, goal_places, place })
}

impl RobotFile {
    /// The file without its first part: what comes next is the motion, from `start`.
    fn after_this_part(&self, start: &[f64]) -> Option<Self> {
        let (next, parts) = self.parts.split_first()?;
        let mut file = Self {
            start: StartEntry::All(start.to_vec()),
            goals: next.goals.clone(),
            part: self.part + 1,
            parts: parts.to_vec(),
            ..self.clone()
        };
        file.places.goals.clone_from(&next.goal_places);
        Some(file)
    }
}

impl RobotProblem {
    /// The problem of the next part of the motion, when this one has ended at `end`; `None` when this is the last part. `pose` has the
    /// pose of a link in the world at `end`.
    ///
    /// # Errors
    /// What is wrong and what is expected: there is no such obstacle or link, or nothing of that name is attached.
    pub fn next_part(
        &self,
        end: &[f64],
        pose: impl Fn(&str) -> Option<Isometry3<f64>>,
    ) -> Result<Option<Self>, [String; 2]> {
        let Some(file) = self.file.after_this_part(end) else { return Ok(None) };
        let part = &self.file.parts[0];
        let whole = self.name.strip_suffix(&format!("-{}", self.file.part)).unwrap_or(&self.name);
        let mut next = Self { name: format!("{whole}-{}", file.part), file, ..self.clone() };
        let names = |bodies: &[PlacedBody]| match bodies {
            [] => "there are none".to_owned(),
            bodies => bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>().join(", "),
        };
        let find = |bodies: &[PlacedBody], what: &str, name: &str| {
            let mut found = (0..bodies.len()).filter(|i| bodies[*i].name == name);
            match (found.next(), found.next()) {
                (Some(only), None) => Ok(only),
                (Some(_), Some(_)) => Err([
                    format!("there are several bodies \"{name}\""),
                    "a name that only one of them has: rename the others".to_owned(),
                ]),
                (None, _) => Err([format!("{what} \"{name}\""), names(bodies)]),
            }
        };
        let at = |link: &str| {
            pose(link)
                .ok_or_else(|| [format!("there is no link \"{link}\""), "a link of the robot".to_owned()])
        };
        match &part.change {
            None => {}
            Some(PartChange::Attach { obstacle, link, may_touch }) => {
                let i = find(&next.obstacles, "there is no obstacle", obstacle)?;
                let body = next.obstacles.remove(i);
                let shape = next.file.obstacles.remove(i).shape;
                let pose = at(link)?.inverse() * body.pose;
                let (name, link, may_touch) = (body.name.clone(), link.clone(), may_touch.clone());
                let place = part.place.clone();
                next.file.attached.push(AttachedEntry {
                    name,
                    link,
                    shape,
                    pose: six_from_pose(&pose),
                    may_touch,
                    place,
                });
                next.attached.push(PlacedBody { pose, ..body });
            }
            Some(PartChange::Detach(name)) => {
                let i = find(&next.attached, "nothing is attached that is called", name)?;
                let (entry, body) = (next.file.attached.remove(i), next.attached.remove(i));
                if let Some(on) = next.file.attached.iter().find(|other| other.link == entry.name) {
                    let (name, on) = (&entry.name, &on.name);
                    return Err([
                        format!("\"{name}\" is put down, and carries \"{on}\""),
                        format!("a part with `detach = \"{on}\"` before this one"),
                    ]);
                }
                let pose = at(&entry.link)? * body.pose;
                let six = six_from_pose(&pose);
                let obstacle = super::ObstacleEntry {
                    name: entry.name,
                    shape: entry.shape,
                    pose: six,
                    self_filter: None,
                };
                next.file.obstacles.push(obstacle);
                next.obstacles.push(PlacedBody { pose, ..body });
            }
        }
        Ok(Some(next))
    }
}
