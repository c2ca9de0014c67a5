//! What is in a scene file.

use super::mesh::Shape;
use super::{brief, count};
use crate::plan::setting::Ready;
use miette::Result;
use mp::geom::six_from_pose;
use mp::io::Problem;
use serde::Serialize;
use std::fmt;
use std::path::Path;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Facts {
    kind: &'static str,
    file: String,
    name: String,
    space: String,
    units: &'static str,
    robot: Body,
    obstacles: Vec<Body>,
    /// Of all obstacles together.
    triangles: usize,
    start: [f64; 6],
    goal: [f64; 6],
    bounds: Option<[[f64; 3]; 2]>,
    warnings: Vec<String>,
}

#[derive(Clone, Debug, Serialize)]
struct Body {
    name: String,
    file: String,
    pose: Option<[f64; 6]>,
    mesh: Shape,
}

impl Facts {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let problem = Problem::load(file)?;
        let robot = Body {
            name: problem.robot.name.clone(),
            file: problem.robot.file.display().to_string(),
            pose: None,
            mesh: Shape::of(&problem.robot.mesh),
        };
        let obstacles: Vec<Body> = problem
            .obstacles
            .iter()
            .map(|o| Body {
                name: o.name.clone(),
                file: o.file.display().to_string(),
                pose: Some(six_from_pose(&o.pose)),
                mesh: Shape::of(&o.mesh),
            })
            .collect();
        let mut warnings = Vec::new();
        for body in std::iter::once(&robot).chain(&obstacles) {
            // One line for each body: surfaces of drawing programs have every one of these faults.
            if !body.mesh.warnings.is_empty() {
                warnings.push(format!("{} ({}): {}", body.name, body.file, body.mesh.warnings.join("; ")));
            }
        }
        if obstacles.is_empty() {
            warnings.push("there are no obstacles".into());
        }
        if problem.start == problem.goal {
            warnings.push("start and goal are the same".into());
        }
        let (name, space) = (problem.name.clone(), problem.space.to_string());
        let (start, goal) = (six_from_pose(&problem.start), six_from_pose(&problem.goal));
        let bounds = problem.bounds.map(|b| [b.min.coords.into(), b.max.coords.into()]);
        warnings.extend(Ready::of(problem)?.overlaps());
        Ok(Self {
            kind: "scene",
            file: file.display().to_string(),
            name,
            space,
            units: "metres and radians",
            triangles: obstacles.iter().map(|o| o.mesh.triangles).sum(),
            robot,
            obstacles,
            start,
            goal,
            bounds,
            warnings,
        })
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |v: &[f64]| v.iter().map(|v| brief(*v)).collect::<Vec<_>>().join(" ");
        writeln!(f, "{}: a scene in {}", self.file, self.space)?;
        writeln!(f, "  start     {}", row(&self.start))?;
        writeln!(f, "  goal      {}", row(&self.goal))?;
        match &self.bounds {
            Some([lo, hi]) => writeln!(f, "  bounds    ({}) to ({})", row(lo), row(hi))?,
            None => writeln!(f, "  bounds    none in the file")?,
        }
        writeln!(f, "  robot     {}: {}", self.robot.file, self.robot.mesh.summary())?;
        let (bodies, triangles) =
            (count(self.obstacles.len(), "obstacle"), count(self.triangles, "triangle"));
        writeln!(f, "  {bodies}, {triangles}")?;
        for o in &self.obstacles {
            let at = o.pose.map(|p| row(&p)).unwrap_or_default();
            writeln!(f, "    {} at {at}, {}: {}", o.name, o.file, o.mesh.summary())?;
        }
        self.warnings.iter().try_for_each(|w| writeln!(f, "  warning   {w}"))
    }
}
