//! What is in a world in the plane.

use super::task::either;
use super::{AnyTask, FlatMover, Task};
use crate::info::{brief, count};
use miette::Result;
use mp::io::{FlatBody, FlatMap};
use serde::Serialize;
use std::fmt;
use std::path::Path;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Facts {
    kind: &'static str,
    file: String,
    name: String,
    units: &'static str,
    space: &'static str,
    robot: String,
    bounds: [[f64; 2]; 2],
    /// Corners of the walls, if there are any.
    walls: Option<[[f64; 2]; 2]>,
    /// The image or map, if there is one.
    map: Option<String>,
    obstacles: usize,
    edges: usize,
    /// The share of the space between the bounds at which the origin of the robot may be, whatever its turn: by
    /// 10,000 samples.
    free: f64,
    start: Vec<f64>,
    goals: Vec<Vec<f64>>,
    warnings: Vec<String>,
}

/// Samples for the share that is free.
const SAMPLES: u32 = 10_000;

impl Facts {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let task = AnyTask::load(file)?;
        Ok(either!(&task, task => Self::of(file, task)))
    }

    fn of<M: FlatMover>(file: &Path, task: &Task<M>) -> Self {
        use mp::cspace::{Rng, Space};
        let (problem, mut robot) = (&task.problem, task.robot.clone());
        let mut rng = Rng::seed(1);
        let free = (0..SAMPLES).filter(|_| robot.is_valid(&task.space.sample_uniform(&mut rng))).count();
        let mut warnings = task.overlaps();
        if problem.obstacles.is_empty() {
            warnings.push("there are no obstacles".into());
        }
        if task.goals.contains(&task.start) {
            warnings.push("start and goal are the same".into());
        }
        Self {
            kind: "world in the plane",
            file: file.display().to_string(),
            name: problem.name.clone(),
            units: "metres and radians",
            space: M::SPACE,
            robot: match &problem.file.robot {
                FlatBody::Disc(radius) => format!("a disc of radius {} m", brief(*radius)),
                FlatBody::Polygon(p) => {
                    let corners = p.edges().count();
                    format!(
                        "a polygon of {}, {} m from its origin at most",
                        count(corners, "corner"),
                        brief(robot.radius())
                    )
                }
            },
            bounds: problem.bounds,
            walls: problem.file.walls,
            map: problem.file.map.as_ref().map(|map| match map {
                FlatMap::Image { file, .. } | FlatMap::Ros(file) => file.clone(),
            }),
            obstacles: problem.obstacles.len(),
            edges: robot.world().edges(),
            free: free as f64 / f64::from(SAMPLES),
            start: problem.file.start.clone(),
            goals: problem.file.goals.clone(),
            warnings,
        }
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |v: &[f64]| v.iter().map(|v| brief(*v)).collect::<Vec<_>>().join(" ");
        let corners = |[low, high]: &[[f64; 2]; 2]| format!("({}) to ({})", row(low), row(high));
        writeln!(f, "{}: a world in the plane", self.file)?;
        writeln!(f, "  robot     {}", self.robot)?;
        writeln!(
            f,
            "  bounds    {}{}",
            corners(&self.bounds),
            if self.walls.is_some() { ", walled" } else { "" }
        )?;
        writeln!(f, "  start     {}", row(&self.start))?;
        self.goals.iter().try_for_each(|goal| writeln!(f, "  goal      {}", row(goal)))?;
        if let Some(map) = &self.map {
            writeln!(f, "  map       {map}")?;
        }
        writeln!(f, "  obstacles {} with {}", self.obstacles, count(self.edges, "edge"))?;
        writeln!(f, "  free      {:.0}% of the configurations", 100.0 * self.free)?;
        self.warnings.iter().try_for_each(|w| writeln!(f, "  warning   {w}"))
    }
}
