//! One run in a shipped scene.

use crate::clock::processor_clock;
use crate::error::Result;
use mp_cspace::Cancel;
use mp_experiments::clutter::Run;
use mp_plan::{Control, Request, Scene, StoppedBy};

/// Plans in a shipped scene, by name. `None` when it was cancelled. The time is that of the planner, which
/// verifies its candidates; the path is neither shortened nor timed beyond that.
pub(super) fn in_scene(scene: &Scene, request: &Request, cancel: &Cancel) -> Result<Option<Run>> {
    let mut control = Control { cancel: cancel.clone(), clock: processor_clock(), ..Control::default() };
    let report = scene.plan_with(request, &mut control)?;
    if report.stopped_by == Some(StoppedBy::Interrupted) {
        return Ok(None);
    }
    Ok(Some(Run {
        solved: report.solved,
        seconds: report.time_s,
        iterations: report.iterations,
        nodes: report.nodes,
        checks: report.collision_checks,
        expansions: report.motion_checks,
        rejected: report.rejected,
        edges: report.path.map_or(0, |path| path.len().saturating_sub(1)),
    }))
}
