//! The result of a run: plain data.

use crate::{Column, Error, PortfolioCounts};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::time::Duration;

/// The version of the JSON form of a [`Report`]. It grows when a member changes its meaning or is removed. New members do
/// not change it.
pub const REPORT_VERSION: u32 = 1;

/// The result of one run. `mp plan --json` prints its JSON form, which docs/formats/report.md describes.
///
/// Lengths of paths are in the metric of the space, clearances in metres, times in seconds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// The version of the format: [`REPORT_VERSION`].
    pub version: u32,
    /// The name of the scene that was planned in.
    pub scene: String,
    /// The file of the scene, if there is one.
    pub scene_file: Option<String>,
    /// The configuration space: `SE3`, `SE2`, `R2`, `6 joints`.
    pub space: String,
    /// Whether a path was found and `path` passed the verifier.
    pub solved: bool,
    /// Whether the path, as it is written, passed the independent verifier. Always the same as `solved`.
    pub verified: bool,
    /// What ended a run without a path.
    pub stopped_by: Option<StoppedBy>,
    /// `stopped_by` in a sentence.
    pub why: Option<String>,
    /// The name of the planner, as `--planner` takes it.
    pub planner: String,
    /// The name of the metric, as `--metric` takes it.
    pub metric: String,
    /// How motions were checked while planning.
    pub motion: String,
    /// The seed of all random numbers: the same one gives the same path.
    pub seed: u64,
    /// The number of iterations of the planner's loop.
    pub iterations: u64,
    /// The number of nodes of its trees or roadmap.
    pub nodes: usize,
    /// The number of edges of a roadmap.
    pub edges: Option<usize>,
    /// The number of connected components of a roadmap.
    pub components: Option<usize>,
    /// The number of motions that the local planner checked.
    pub motion_checks: u64,
    /// The number of collision and clearance queries.
    pub collision_checks: u64,
    /// The number of candidate paths that the verifier did not pass.
    pub rejected: u64,
    /// The time of planning alone.
    pub time_s: f64,
    /// The time of shortening and verifying.
    pub finish_s: f64,
    /// What was done when, in order. Empty in reports of earlier versions of this program.
    #[serde(default)]
    pub stages: Vec<StageTime>,
    /// When an anytime planner found its first path.
    pub first_s: Option<f64>,
    /// The length of the first path.
    pub first_length: Option<f64>,
    /// The first path, as rows like `path`. The planner verified it before its numbers were written.
    pub first_path: Option<Vec<Vec<f64>>>,
    /// The length of the path as the planner found it; for an anytime planner, of the last path.
    pub path_length_found: Option<f64>,
    /// The length of `path`, in the metric of the space; `None` without a path.
    pub path_length: Option<f64>,
    /// A lower bound on the clearance along `path`; `None` where there was no time left to compute one.
    pub clearance: Option<f64>,
    /// The clearance (m) from obstacles that was asked for; left out where none was.
    #[serde(default, skip_serializing_if = "crate::request::is_zero")]
    pub clearance_kept: f64,
    /// What `path` costs, where the objective of the request was not its length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
    /// Whether `path` was shortened.
    pub shortened: bool,
    /// A hash of the numbers of `path`. Two runs with the same hash found the same path, to the bit.
    pub fingerprint: Option<String>,
    /// The file to which a front end wrote the path.
    pub path_file: Option<String>,
    /// The file to which a front end wrote a picture.
    pub picture_file: Option<String>,
    /// The file to which a front end wrote the certificate of the path.
    #[serde(default)]
    pub certificate_file: Option<String>,
    /// Why the file of the roadmap was not written at the end of the run. The path is not concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roadmap_error: Option<String>,
    /// The meaning of each number of a configuration, in order.
    pub columns: Vec<Column>,
    /// The path, one configuration in each row, start first.
    pub path: Option<Vec<Vec<f64>>>,
    /// Of the planner `auto`, the search that has found the path: its planner, with the settings that differ from those of the request.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub won: Option<String>,
    /// Of a portfolio (`mp-batch`), its runs; the other members are then those of the winner.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub portfolio: Option<PortfolioCounts>,
}

/// A stage of a run, and how long it took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageTime {
    /// What the run did in this time.
    pub stage: RunStage,
    /// How long it took.
    pub time_s: f64,
    /// What ended it before it was done, also where there is a path.
    pub ended_by: Option<StoppedBy>,
}

impl StageTime {
    pub(crate) fn new(stage: RunStage, time: Duration, ended_by: Option<mp_cspace::StopReason>) -> Self {
        Self { stage, time_s: time.as_secs_f64(), ended_by: ended_by.map(StoppedBy::from) }
    }
}

/// What a run does, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RunStage {
    /// Reading the scene and checking its start and goals.
    Loading,
    /// Searching for a path.
    Planning,
    /// Relaxing the path found with a snake.
    Relaxing,
    /// Shortening the path.
    Shortening,
    /// Verifying what will be written.
    Verifying,
}

impl fmt::Display for RunStage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Loading => "loading",
            Self::Planning => "planning",
            Self::Relaxing => "relaxing",
            Self::Shortening => "shortening",
            Self::Verifying => "verifying",
        })
    }
}

/// What ended a run without a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoppedBy {
    /// The budget of time.
    Time,
    /// The budget of iterations.
    Iterations,
    /// The budget of nodes.
    Nodes,
    /// The budget of collision queries.
    Queries,
    /// The budget of memory.
    Memory,
    /// The schedule of a portfolio: all of its runs have made as many iterations as it gives them.
    Schedule,
    /// Another budget.
    Budget,
    /// It was cancelled from outside.
    Interrupted,
    /// The planner itself: it has tried everything at its resolution, or stops by its own rule.
    Exhausted,
    /// The path found, written as text and read again, did not pass the verifier.
    Verification,
    /// A path was found, but there was no time left to verify it.
    Unverified,
    /// The roadmap has no path between the given configurations.
    Unanswered,
}

impl StoppedBy {
    /// The word for it in JSON.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Iterations => "iterations",
            Self::Nodes => "nodes",
            Self::Queries => "queries",
            Self::Memory => "memory",
            Self::Schedule => "schedule",
            Self::Budget => "budget",
            Self::Interrupted => "interrupted",
            Self::Exhausted => "exhausted",
            Self::Verification => "verification",
            Self::Unverified => "unverified",
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
            Self::Nodes => "the nodes are used up",
            Self::Queries => "the collision queries are used up",
            Self::Memory => "the memory is used up",
            Self::Schedule => {
                "all runs have made the iterations that the schedule of the portfolio gives them"
            }
            Self::Budget => "the budget is used up",
            Self::Interrupted => "interrupted",
            Self::Exhausted => "the planner has tried all it can by its own rule",
            Self::Verification => "the path found touches something when written down: try another seed",
            Self::Unverified => "a path was found, but not verified in time: give more time",
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
            Why::Nodes => Self::Nodes,
            Why::Motions => Self::Queries,
            Why::Memory => Self::Memory,
            _ => Self::Budget,
        }
    }
}

impl Report {
    /// The report without what the clock says: the same on every machine, unless a budget of time has ended a stage. All times are 0,
    /// `first_s` is `None`, and there is no stage of loading.
    #[must_use]
    pub fn without_times(mut self) -> Self {
        (self.time_s, self.finish_s, self.first_s) = (0.0, 0.0, None);
        self.stages.retain(|stage| stage.stage != RunStage::Loading);
        self.stages.iter_mut().for_each(|stage| stage.time_s = 0.0);
        self
    }

    /// Whether it has what [`without_times`](Self::without_times) takes away.
    #[must_use]
    pub fn has_times(&self) -> bool {
        let times = [self.time_s, self.finish_s];
        let timed = |stage: &StageTime| stage.stage == RunStage::Loading || stage.time_s != 0.0;
        times != [0.0; 2] || self.first_s.is_some() || self.stages.iter().any(timed)
    }

    /// Whether the run did not begin: its budget was used up, or it was interrupted, while its scene was loaded.
    #[must_use]
    pub fn is_not_begun(&self) -> bool {
        matches!(self.stages.as_slice(), [only] if only.stage == RunStage::Loading)
    }

    /// The report as one line of JSON.
    ///
    /// # Errors
    /// Only if a number is not finite.
    pub fn to_json(&self) -> Result<String, Error> {
        serde_json::to_string(self)
            .map_err(|e| Error::new(format!("the report cannot be written as JSON: {e}")))
    }

    /// Reads a report back.
    ///
    /// # Errors
    /// When the text is not a report, or a report of a later version.
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
