//! What is in a path file.

use crate::{PathFormat, PathRows, brief, count};
use mp_geom::pose_from_six;
use mp_kinds::numbers::plain_row;
use nalgebra::Isometry3;
use serde::Serialize;
use std::fmt;
use std::path::Path;

/// What is in a path file. Metres and radians.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathInfo {
    /// The file, as it was named.
    pub file: String,
    /// Configurations, start and goal included.
    pub configurations: usize,
    /// How many numbers each configuration has.
    pub numbers: usize,
    /// The first configuration.
    pub start: Vec<f64>,
    /// The last configuration.
    pub goal: Vec<f64>,
    /// The least value of each number.
    pub min: Vec<f64>,
    /// The largest value of each number.
    pub max: Vec<f64>,
    /// For a rigid body: the length of the path of its origin, metres.
    pub length: Option<f64>,
    /// For a rigid body: the sum of the angles by which it turns, radians.
    pub turned: Option<f64>,
    /// What is odd about it.
    pub warnings: Vec<String>,
}

impl PathInfo {
    /// The properties of a path.
    #[must_use]
    pub fn of(file: &Path, path: &PathRows) -> Self {
        let all = &path.rows;
        let (first, last) = (all[0].clone(), all[all.len() - 1].clone());
        let fold = |pick: fn(f64, f64) -> f64| {
            all.iter().fold(first.clone(), |m, q| m.iter().zip(q).map(|(a, b)| pick(*a, *b)).collect())
        };
        let pose = |row: &Vec<f64>| pose_from_six(std::array::from_fn(|i| row[i]));
        let poses: Option<Vec<Isometry3<f64>>> =
            (path.format == PathFormat::Poses && first.len() == 6).then(|| all.iter().map(pose).collect());
        let sum = |of: fn(&Isometry3<f64>, &Isometry3<f64>) -> f64| {
            poses.as_ref().map(|poses| poses.windows(2).map(|w| of(&w[0], &w[1])).sum())
        };
        let mut warnings = Vec::new();
        let still = all.windows(2).filter(|w| w[0] == w[1]).count();
        if still > 0 {
            warnings.push(format!("{} the same as the one before", count(still, "configuration")));
        }
        if all.len() == 1 {
            warnings.push("a single configuration: nothing moves".into());
        }
        Self {
            file: file.display().to_string(),
            configurations: all.len(),
            numbers: first.len(),
            min: fold(f64::min),
            max: fold(f64::max),
            length: sum(|a, b| (a.translation.vector - b.translation.vector).norm()),
            turned: sum(|a, b| a.rotation.angle_to(&b.rotation)),
            start: first,
            goal: last,
            warnings,
        }
    }
}

impl fmt::Display for PathInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = plain_row;
        writeln!(f, "{}: a path", self.file)?;
        let each = count(self.numbers, "number");
        writeln!(f, "  {} of {each}", count(self.configurations, "configuration"))?;
        writeln!(f, "  start     {}", row(&self.start))?;
        writeln!(f, "  goal      {}", row(&self.goal))?;
        if let (Some(length), Some(turned)) = (self.length, self.turned) {
            writeln!(f, "  length    {} m, turning {} rad", brief(length), brief(turned))?;
        }
        writeln!(f, "  within    ({}) to ({})", row(&self.min), row(&self.max))?;
        self.warnings.iter().try_for_each(|w| writeln!(f, "  warning   {w}"))
    }
}
