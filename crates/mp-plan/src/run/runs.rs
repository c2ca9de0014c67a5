//! Several runs and their medians.

use crate::{REPORT_VERSION, Report};
use serde::{Deserialize, Serialize};

/// A summary of the runs on one scene. Medians are over the solved runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Medians {
    /// The name of the scene that these runs are of.
    pub scene: String,
    /// Its file: scenes of several folders may have one name.
    pub scene_file: Option<String>,
    /// Runs made, solved or not.
    pub runs: usize,
    /// How many found a path.
    pub solved: usize,
    /// The time of planning alone, seconds.
    pub time_s: Option<f64>,
    /// Iterations of the planner, by its own measure.
    pub iterations: Option<f64>,
    /// Nodes of all trees, or of the roadmap.
    pub nodes: Option<f64>,
    /// The number of collision and clearance queries.
    pub collision_checks: Option<f64>,
    /// The length of the path, in the metric of the space.
    pub path_length: Option<f64>,
    /// A lower bound on the clearance, metres.
    pub clearance: Option<f64>,
}

/// Several runs, as `mp plan --json` prints them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Runs {
    /// [`REPORT_VERSION`].
    pub version: u32,
    /// How many found a path.
    pub solved: usize,
    /// One for each scene, in order of appearance.
    pub medians: Vec<Medians>,
    /// The report of each run, in the order of the runs.
    pub runs: Vec<Report>,
}

impl Runs {
    /// Computes the medians of the runs.
    #[must_use]
    pub fn new(runs: Vec<Report>) -> Self {
        let solved = runs.iter().filter(|r| r.solved).count();
        Self { version: REPORT_VERSION, solved, medians: medians(&runs), runs }
    }
}

impl Report {
    fn is_of_scene_of(&self, other: &Self) -> bool {
        (&self.scene, &self.scene_file) == (&other.scene, &other.scene_file)
    }
}

/// The middle value, or the mean of the two middle values of an even number of values. `None` if there are no values.
#[must_use]
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let n = values.len();
    match (n, n % 2) {
        (0, _) => None,
        (_, 1) => Some(values[n / 2]),
        _ => Some(0.5 * (values[n / 2 - 1] + values[n / 2])),
    }
}

/// The medians of each scene, in order of appearance.
#[must_use]
pub fn medians(reports: &[Report]) -> Vec<Medians> {
    let mut scenes: Vec<&Report> = Vec::new();
    for r in reports {
        if !scenes.iter().any(|first| first.is_of_scene_of(r)) {
            scenes.push(r);
        }
    }
    let of = |first: &Report| {
        let all: Vec<&Report> = reports.iter().filter(|r| r.is_of_scene_of(first)).collect();
        let (runs, scene, scene_file) = (all.len(), first.scene.clone(), first.scene_file.clone());
        let solved: Vec<&Report> = all.into_iter().filter(|r| r.solved).collect();
        let over = |f: fn(&Report) -> Option<f64>| median(solved.iter().filter_map(|r| f(r)));
        Medians {
            scene,
            scene_file,
            runs,
            solved: solved.len(),
            time_s: over(|r| Some(r.time_s)),
            iterations: over(|r| Some(r.iterations as f64)),
            nodes: over(|r| Some(r.nodes as f64)),
            collision_checks: over(|r| Some(r.collision_checks as f64)),
            path_length: over(|r| r.path_length),
            clearance: over(|r| r.clearance),
        }
    };
    scenes.into_iter().map(of).collect()
}
