//! What is in a robot problem.

use super::task::Task;
use crate::info::{brief, count};
use miette::Result;
use mp::cspace::JointRange;
use mp::geom::six_from_pose;
use serde::Serialize;
use std::fmt;
use std::path::Path;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Facts {
    kind: &'static str,
    file: String,
    name: String,
    units: &'static str,
    urdf: String,
    base: [f64; 6],
    /// What a configuration consists of, in order.
    joints: Vec<Joint>,
    links: usize,
    /// Pairs of links that must not touch.
    checked_pairs: usize,
    /// No point of the robot is ever farther than this from its base, metres.
    reach: f64,
    obstacles: Vec<Obstacle>,
    start: Vec<f64>,
    goals: Vec<Vec<f64>>,
    /// What was left aside of the URDF.
    notes: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct Joint {
    name: String,
    /// Its limits; none when it turns without end.
    limits: Option<[f64; 2]>,
}

#[derive(Clone, Debug, Serialize)]
struct Obstacle {
    name: String,
    pose: [f64; 6],
    triangles: usize,
}

impl Facts {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let task = Task::load(file)?;
        let joints = task.arm.coordinates().iter().map(|c| Joint {
            name: c.name.clone(),
            limits: match c.range {
                JointRange::Interval { low, high } => Some([low, high]),
                JointRange::Circle => None,
            },
        });
        let obstacles = task.problem.obstacles.iter().map(|o| Obstacle {
            name: o.name.clone(),
            pose: six_from_pose(&o.pose),
            triangles: o.mesh.triangles().len(),
        });
        let mut warnings = task.overlaps();
        let bare = task.arm.model().links.iter().filter(|link| link.shapes.is_empty()).count();
        if bare == task.arm.model().links.len() {
            warnings.push("no link has a collision shape: nothing can be hit".into());
        }
        if task.problem.obstacles.is_empty() {
            warnings.push("there are no obstacles".into());
        }
        if task.goals.contains(&task.start) {
            warnings.push("start and goal are the same".into());
        }
        Ok(Self {
            kind: "robot problem",
            file: file.display().to_string(),
            name: task.name().to_owned(),
            units: "metres and radians",
            urdf: task.problem.urdf_file.display().to_string(),
            base: task.problem.file.base,
            joints: joints.collect(),
            links: task.arm.model().links.len(),
            checked_pairs: task.arm.checked_pairs().len(),
            reach: task.arm.reach(),
            obstacles: obstacles.collect(),
            start: task.problem.file.start.clone(),
            goals: task.problem.file.goals.clone(),
            notes: task.arm.model().notes.clone(),
            warnings,
        })
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |v: &[f64]| v.iter().map(|v| brief(*v)).collect::<Vec<_>>().join(" ");
        writeln!(f, "{}: a robot problem with {}", self.file, count(self.joints.len(), "joint"))?;
        writeln!(
            f,
            "  robot     {}: {}, at most {} m long",
            self.urdf,
            count(self.links, "link"),
            brief(self.reach)
        )?;
        writeln!(f, "  base      {}", row(&self.base))?;
        for joint in &self.joints {
            match &joint.limits {
                Some([low, high]) => {
                    writeln!(f, "    {} from {} to {}", joint.name, brief(*low), brief(*high))?;
                }
                None => writeln!(f, "    {} turns without end", joint.name)?,
            }
        }
        writeln!(f, "  {} of links must not touch", count(self.checked_pairs, "pair"))?;
        writeln!(f, "  start     {}", row(&self.start))?;
        self.goals.iter().try_for_each(|goal| writeln!(f, "  goal      {}", row(goal)))?;
        writeln!(f, "  {}", count(self.obstacles.len(), "obstacle"))?;
        for o in &self.obstacles {
            writeln!(f, "    {} at {}, {}", o.name, row(&o.pose), count(o.triangles, "triangle"))?;
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "  note      {note}"))?;
        self.warnings.iter().try_for_each(|w| writeln!(f, "  warning   {w}"))
    }
}
