//! One run of a planner by name, for robots of all kinds.

use crate::finish::relax::Relaxing;
use crate::run::RobotRun;
use crate::run::planners::PlannerKind;
use crate::run::prepared::Prepared;
use crate::run::roadmaps::Roadmap;
use crate::{Control, Error, Request, Robot};
use mp_cspace::{Configuration, Outcome, Path, Progress, Stop, StopReason};
use std::time::Duration;

/// The result of running a planner.
#[derive(Clone, Debug)]
pub struct Search {
    /// The path, or the reason why there is none.
    pub outcome: Outcome<Path<Configuration>>,
    /// The counts of what was done.
    pub progress: Progress,
    /// The number of collision and clearance queries.
    pub queries: u64,
    /// How long it took.
    pub time: Duration,
    /// How much of this went into relaxing the path, and what ended that.
    pub relaxing: Relaxing,
    /// What ended the search, also where it has found a path; `None` where the planner ended with its path.
    pub ended_by: Option<StopReason>,
    /// Whether the planner has verified the path. The path of [`search`] always is.
    pub proved: bool,
    /// Whether a path was found that could not be verified by then.
    pub found_unverified: bool,
    /// For an anytime planner: when it found its first path, the length of that path in the metric of the space, and the path.
    pub first: Option<(Duration, f64, Path<Configuration>)>,
    /// For a planner that builds a roadmap: the numbers of edges and of connected components.
    pub map: Option<[usize; 2]>,
    /// Paths of more searches and their seeds, if [requested](Request::hybridize).
    pub others: Vec<(Path<Configuration>, u64)>,
    /// Of the portfolio `auto`, the search that has found the path.
    pub won: Option<String>,
    /// The roadmap itself, if [requested](Control::keep_roadmap).
    pub roadmap: Option<Roadmap<Configuration>>,
    /// Why the file of the roadmap was not written.
    pub roadmap_error: Option<String>,
}

/// Runs the planner of a request, and relaxes the path if the request says so. The path is neither shortened nor written
/// as text.
///
/// # Errors
/// When the request is not valid for this robot, or a roadmap cannot be read or written.
pub fn search(kind: &dyn Robot, request: &Request, control: &mut Control<'_>) -> Result<Search, Error> {
    search_within(kind, request, control, 1.0, false)
}

/// [`search`] within the part `part` of the budget of time. Where it can be so, the path is not verified if `proves_later`.
pub(crate) fn search_within(
    kind: &dyn Robot,
    request: &Request,
    control: &mut Control<'_>,
    part: f64,
    proves_later: bool,
) -> Result<Search, Error> {
    let _span =
        tracing::info_span!("plan", scene = kind.name(), planner = %request.planner, seed = request.seed)
            .entered();
    let began = control.time_if_limited(request);
    request.check()?;
    PlannerKind::new(&request.planner)?;
    let prepared = Prepared::new(kind, request)?;
    prepared.prove_later(proves_later && prepared.can_prove_later());
    control.spend_since(began);
    let mut run = RobotRun::new(&prepared, control, part)?;
    run.advance(&mut Never, control);
    run.into_search(control)
}

/// Never stops.
struct Never;

impl Stop for Never {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        None
    }
}
