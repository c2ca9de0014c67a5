//! What a run came to: plain data.

use crate::{Column, Error};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The version of the JSON form of a [`Report`]. It grows when a member changes its meaning or goes; new members do
/// not change it.
pub const REPORT_VERSION: u32 = 1;

/// The outcome of one run. Its JSON form is what `mp plan --json` prints; docs/formats/report.md describes it.
///
/// Lengths of paths are in the metric of the space, clearances in metres, times in seconds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// [`REPORT_VERSION`].
    pub version: u32,
    /// The name of the scene.
    pub scene: String,
    /// The file of the scene, where there is one.
    pub scene_file: Option<String>,
    /// The space: `SE3`, `SE2`, `R2`, `6 joints`.
    pub space: String,
    /// A path was found, and what is in `path` passed the verifier.
    pub solved: bool,
    /// The path passed the independent verifier, as it is written. The same as `solved`: there are no other paths.
    pub verified: bool,
    /// What ended a run without a path.
    pub stopped_by: Option<StoppedBy>,
    /// The same in a sentence.
    pub why: Option<String>,
    /// The name of the planner.
    pub planner: String,
    /// The name of the metric.
    pub metric: String,
    /// How motions were checked while planning.
    pub motion: String,
    /// The seed.
    pub seed: u64,
    /// Iterations of the planner's loop.
    pub iterations: u64,
    /// Nodes of its trees or roadmap.
    pub nodes: usize,
    /// Edges of a roadmap.
    pub edges: Option<usize>,
    /// Connected components of a roadmap.
    pub components: Option<usize>,
    /// Motions asked of the local planner.
    pub motion_checks: u64,
    /// Collision and clearance queries.
    pub collision_checks: u64,
    /// Candidate paths that the verifier did not pass.
    pub rejected: u64,
    /// Planning alone.
    pub time_s: f64,
    /// Shortening and verifying.
    pub finish_s: f64,
    /// When a planner that keeps improving found its first path.
    pub first_s: Option<f64>,
    /// The length of that path.
    pub first_length: Option<f64>,
    /// That path, as `path`; verified by the planner, before its numbers were written down.
    pub first_path: Option<Vec<Vec<f64>>>,
    /// The length of the path as the planner found it; the last, if it keeps improving.
    pub path_length_found: Option<f64>,
    /// The length of `path`.
    pub path_length: Option<f64>,
    /// A lower bound on the clearance all along `path`.
    pub clearance: Option<f64>,
    /// Whether `path` was shortened.
    pub shortened: bool,
    /// A hash of the numbers of `path`: two runs with the same one found the same path, to the bit.
    pub fingerprint: Option<String>,
    /// Where a front end wrote the path.
    pub path_file: Option<String>,
    /// Where a front end wrote a picture.
    pub picture_file: Option<String>,
    /// What the numbers of a configuration are, in order.
    pub columns: Vec<Column>,
    /// The path, one configuration a row, start first.
    pub path: Option<Vec<Vec<f64>>>,
}

/// What ended a run without a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoppedBy {
    /// The budget of time.
    Time,
    /// The budget of iterations.
    Iterations,
    /// Another budget.
    Budget,
    /// Somebody asked it to stop.
    Interrupted,
    /// The planner itself: it has tried all it can at its resolution, or by its own rule.
    Exhausted,
    /// The path found did not pass the verifier once its numbers were written down.
    Verification,
    /// The roadmap that was asked has no such path.
    Unanswered,
}

impl StoppedBy {
    /// Its word in JSON.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Iterations => "iterations",
            Self::Budget => "budget",
            Self::Interrupted => "interrupted",
            Self::Exhausted => "exhausted",
            Self::Verification => "verification",
            Self::Unanswered => "unanswered",
        }
    }
}

/// In a few words.
impl fmt::Display for StoppedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Time => "the time is up",
            Self::Iterations => "the iterations are used up",
            Self::Budget => "the budget is used up",
            Self::Interrupted => "interrupted",
            Self::Exhausted => "the planner has tried all it can by its own rule",
            Self::Verification => "the path found touches something when written down: try another seed",
            Self::Unanswered => "the roadmap has no such path",
        })
    }
}

impl From<mp_cspace::StopReason> for StoppedBy {
    fn from(reason: mp_cspace::StopReason) -> Self {
        use mp_cspace::StopReason as Why;
        match reason {
            Why::Iterations => Self::Iterations,
            Why::Deadline => Self::Time,
            Why::Cancelled => Self::Interrupted,
            Why::Exhausted => Self::Exhausted,
            _ => Self::Budget,
        }
    }
}

impl Report {
    /// The report as one line of JSON.
    ///
    /// # Errors
    /// Never, unless a number is not finite.
    pub fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string(self)
            .map_err(|e| Error::new(format!("the report cannot be written as JSON: {e}")))
    }

    /// Reads a report back.
    ///
    /// # Errors
    /// When the text is no report, or one of a later version.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let report: Self =
            serde_json::from_str(text).map_err(|e| Error::new(format!("not a report: {e}")))?;
        match report.version {
            0..=REPORT_VERSION => Ok(report),
            later => Err(Error::new(format!("the report has version {later}"))
                .help(format!("this program reads versions up to {REPORT_VERSION}"))),
        }
    }
}
