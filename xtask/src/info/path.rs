//! What is in a path file.

use super::{brief, count};
use miette::Result;
use mp::io::{JointPath, PathFile};
use serde::Serialize;
use std::fmt;
use std::path::Path;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Facts {
    kind: &'static str,
    file: String,
    units: &'static str,
    configurations: usize,
    start: [f64; 6],
    goal: [f64; 6],
    /// Length of the way of the robot's origin, metres.
    length: f64,
    /// Sum of the angles turned, radians.
    turned: f64,
    /// Corners of the box around the way of the origin.
    min: [f64; 3],
    max: [f64; 3],
    warnings: Vec<String>,
}

impl Facts {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let path = PathFile::read(file)?;
        let poses = path.poses();
        let (first, last) = (path.configurations[0], path.configurations[path.configurations.len() - 1]);
        let mut warnings = Vec::new();
        let steps = || poses.windows(2).map(|w| (&w[0], &w[1]));
        let still = steps().filter(|(a, b)| a == b).count();
        if still > 0 {
            warnings.push(format!("{} the same as the one before", count(still, "configuration")));
        }
        if poses.len() == 1 {
            warnings.push("a single configuration: nothing moves".into());
        }
        let fold = |pick: fn(f64, f64) -> f64| {
            path.configurations
                .iter()
                .fold([first[0], first[1], first[2]], |m, c| std::array::from_fn(|k| pick(m[k], c[k])))
        };
        Ok(Self {
            kind: "path",
            file: file.display().to_string(),
            units: "metres and radians",
            configurations: poses.len(),
            start: first,
            goal: last,
            length: steps().map(|(a, b)| (a.translation.vector - b.translation.vector).norm()).sum(),
            turned: steps().map(|(a, b)| a.rotation.angle_to(&b.rotation)).sum(),
            min: fold(f64::min),
            max: fold(f64::max),
            warnings,
        })
    }
}

impl fmt::Display for Facts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |v: &[f64]| v.iter().map(|v| brief(*v)).collect::<Vec<_>>().join(" ");
        writeln!(f, "{}: a path", self.file)?;
        writeln!(f, "  {}", count(self.configurations, "configuration"))?;
        writeln!(f, "  start     {}", row(&self.start))?;
        writeln!(f, "  goal      {}", row(&self.goal))?;
        writeln!(f, "  length    {} m, turning {} rad", brief(self.length), brief(self.turned))?;
        writeln!(f, "  within    ({}) to ({})", row(&self.min), row(&self.max))?;
        self.warnings.iter().try_for_each(|w| writeln!(f, "  warning   {w}"))
    }
}

/// What is in a path of joint values.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct JointFacts {
    kind: &'static str,
    file: String,
    units: &'static str,
    configurations: usize,
    joints: usize,
    start: Vec<f64>,
    goal: Vec<f64>,
    /// The least and the largest value of each joint.
    min: Vec<f64>,
    max: Vec<f64>,
}

impl JointFacts {
    pub(crate) fn read(file: &Path) -> Result<Self> {
        let all = JointPath::read(file)?.configurations;
        let (first, last) = (all[0].clone(), all[all.len() - 1].clone());
        let fold = |pick: fn(f64, f64) -> f64| {
            all.iter().fold(first.clone(), |m, q| m.iter().zip(q).map(|(a, b)| pick(*a, *b)).collect())
        };
        Ok(Self {
            kind: "joint path",
            file: file.display().to_string(),
            units: "metres and radians",
            configurations: all.len(),
            joints: first.len(),
            min: fold(f64::min),
            max: fold(f64::max),
            start: first,
            goal: last,
        })
    }
}

impl fmt::Display for JointFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = |v: &[f64]| v.iter().map(|v| brief(*v)).collect::<Vec<_>>().join(" ");
        writeln!(f, "{}: a path of {}", self.file, count(self.joints, "joint"))?;
        writeln!(f, "  {}", count(self.configurations, "configuration"))?;
        writeln!(f, "  start     {}", row(&self.start))?;
        writeln!(f, "  goal      {}", row(&self.goal))?;
        writeln!(f, "  within    ({}) to ({})", row(&self.min), row(&self.max))
    }
}
