//! Planning: runs a request, finishes the path and makes the report.

use crate::explain::check_ends;
use crate::finish::relax::{Relaxing, relax_if_requested};
use crate::finish::{Proposed, finish};
use crate::report::{RunStage, StageTime};
use crate::run::FoundRun;
use crate::run::PLANNING_PART;
use crate::run::more_paths::find_more_paths;
use crate::run::nearer_goal::nearer_goal;
use crate::run::planners::PlannerKind;
use crate::run::search::{Search, search_within};
use crate::{Column, Control, Error, REPORT_VERSION, Report, Request, Robot, StoppedBy};
use mp_cspace::{Configuration, Path};
use mp_cspace::{Outcome, StopReason};
use std::time::Duration;

/// Plans, finishes the path, and makes the report.
pub(crate) fn plan(kind: &dyn Robot, request: &Request, control: &mut Control<'_>) -> Result<Report, Error> {
    let began = control.time_if_limited(request);
    let interrupt = control.interrupt_of(request);
    request.check()?;
    PlannerKind::new(&request.planner)?;
    // Whether it was interrupted is asked below.
    let _ = kind.make_ready(&interrupt);
    check_ends(kind)?;
    control.spend_since(began);
    let nothing_left = || (control.left_of(request)? == Duration::ZERO).then_some(StopReason::Deadline);
    if let Some(reason) = interrupt.raised().or_else(nothing_left) {
        let space = (kind.space_name(), kind.columns());
        return Ok(Report::not_begun(kind.name(), Some(space), request, reason, control.spent));
    }
    let mut once = |proves_later| {
        let began = control.time_if_limited(request);
        let mut found = search_within(kind, request, control, PLANNING_PART, proves_later)?;
        find_more_paths(kind, request, control, &mut found)?;
        let (left, proved) = (left(request, control, &found), found.proved);
        let report = reported(kind, request, found, None, control, left)?;
        if let (false, Some(length), Some(rows), Some(watch)) =
            (proved, report.path_length, &report.path, control.watch.as_deref_mut())
        {
            watch.found(length, &|| rows.clone());
        }
        let again = proves_later && report.stopped_by == Some(StoppedBy::Verification);
        if again {
            control.spend_since(began);
        }
        Ok::<_, Error>((report, again))
    };
    match once(true)? {
        // The same search, which now goes on behind what the verifier rejects.
        (_, true) => Ok(once(false)?.0),
        (report, false) => Ok(report),
    }
}

impl Report {
    /// The report of a run that did not begin: `reason` ended the loading of the scene called `scene`, which took the time `spent`. Of a
    /// scene that was not loaded, space and columns are not known; they are empty then.
    #[must_use]
    pub fn not_loaded(scene: &str, request: &Request, reason: StopReason, spent: Duration) -> Self {
        Self::not_begun(scene, None, request, reason, spent)
    }

    fn not_begun(
        scene: &str,
        space: Option<(String, Vec<Column>)>,
        request: &Request,
        reason: StopReason,
        spent: Duration,
    ) -> Self {
        let (by, (space, columns)) = (StoppedBy::from(reason), space.unwrap_or_default());
        Self {
            scene: scene.to_owned(),
            space,
            columns,
            stopped_by: Some(by),
            why: Some(match by {
                StoppedBy::Time => format!("{by}: loading took all of it"),
                _ => format!("{by} while the scene was loaded"),
            }),
            planner: request.planner.clone(),
            metric: request.metric.to_string(),
            motion: request.motion.to_string(),
            clearance_kept: request.clearance,
            seed: request.seed,
            stages: vec![StageTime::new(RunStage::Loading, spent, Some(reason))],
            ..Self::empty()
        }
    }

    /// Of nothing.
    fn empty() -> Self {
        Self {
            version: REPORT_VERSION,
            scene: String::new(),
            scene_file: None,
            space: String::new(),
            solved: false,
            verified: false,
            stopped_by: None,
            why: None,
            planner: String::new(),
            metric: String::new(),
            motion: String::new(),
            seed: 0,
            iterations: 0,
            nodes: 0,
            edges: None,
            components: None,
            motion_checks: 0,
            collision_checks: 0,
            rejected: 0,
            time_s: 0.0,
            finish_s: 0.0,
            stages: Vec::new(),
            first_s: None,
            first_length: None,
            first_path: None,
            path_length_found: None,
            path_length: None,
            clearance: None,
            clearance_kept: 0.0,
            cost: None,
            shortened: false,
            fingerprint: None,
            path_file: None,
            picture_file: None,
            certificate_file: None,
            roadmap_error: None,
            columns: Vec::new(),
            path: None,
            portfolio: None,
            won: None,
        }
    }
}

/// What is left of the budget of time after a search.
pub(crate) fn left(request: &Request, control: &Control<'_>, found: &Search) -> Option<Duration> {
    Some(control.left_of(request)?.saturating_sub(found.time))
}

/// Finishes the path of a search, if there is one, and makes the report. `why` is a better reason than the outcome gives
/// why there is no path. Finishing may take the time `left`.
pub(crate) fn reported(
    kind: &dyn Robot,
    request: &Request,
    found: Search,
    why: Option<String>,
    control: &mut Control<'_>,
    left: Option<Duration>,
) -> Result<Report, Error> {
    let mut report = Report {
        scene: kind.name().to_owned(),
        space: kind.space_name(),
        planner: PlannerKind::new(&request.planner)?.to_string(),
        metric: request.metric.to_string(),
        motion: crate::run::prepared::motion(kind, request).to_string(),
        clearance_kept: kind.kept(),
        seed: request.seed,
        iterations: found.progress.iterations,
        nodes: found.progress.nodes,
        edges: found.map.map(|[edges, _]| edges),
        components: found.map.map(|[_, components]| components),
        motion_checks: found.progress.motions,
        collision_checks: found.queries,
        rejected: found.progress.rejected,
        time_s: found.time.as_secs_f64(),
        stages: stages(&found, control),
        first_s: found.first.as_ref().map(|(time, ..)| time.as_secs_f64()),
        first_length: found.first.as_ref().map(|(_, length, _)| *length),
        first_path: found.first.as_ref().map(|(.., path)| kind.rows(path)),
        columns: kind.columns(),
        won: found.won,
        roadmap_error: found.roadmap_error,
        ..Report::empty()
    };
    let path = match found.outcome {
        Outcome::Stopped(reason) => {
            let by = match reason {
                _ if why.is_some() => StoppedBy::Unanswered,
                StopReason::Deadline | StopReason::Cancelled if found.found_unverified => {
                    StoppedBy::Unverified
                }
                reason => reason.into(),
            };
            (report.stopped_by, report.why) = (Some(by), why.or(Some(by.to_string())));
            return Ok(report);
        }
        Outcome::Solved(path) => path,
    };
    report.path_length_found = Some(path.length(&kind.any_space()));
    let began = control.clock.now();
    let mut others = found.others;
    let nearer = [(&path, request.seed)].into_iter().chain(others.iter().map(|(path, seed)| (path, *seed)));
    let nearer = nearer.filter_map(|(path, seed)| {
        Some((nearer_goal(kind, &Request { seed, ..request.clone() }, path, control, left)?, seed))
    });
    others.extend(nearer.collect::<Vec<_>>());
    let left = left.map(|left| left.saturating_sub(control.clock.now().saturating_sub(began)));
    let found = Proposed { path: &path, others: &others, proved: found.proved, time: found.time, began };
    let finished = finish(kind, &found, request, control, left, &mut report.stages)?;
    report.finish_s = control.clock.now().saturating_sub(began).as_secs_f64();
    let finished = match finished {
        Ok(finished) => finished,
        Err(by) => {
            (report.stopped_by, report.why) = (Some(by), Some(by.to_string()));
            return Ok(report);
        }
    };
    (report.solved, report.verified, report.shortened) = (true, true, finished.shortened);
    report.path_length = Some(finished.length);
    report.clearance = finished.clearance;
    if !request.objective.is_length() {
        let states = finished.path.rows.iter().map(|row| kind.state(row)).collect();
        report.cost = Some(request.objective.cost(kind, &Path::straight(states))?);
    }
    let numbers = finished.path.rows.iter().flatten().copied();
    report.fingerprint = Some(format!("{:016x}", mp_kinds::numbers::fingerprint(numbers)));
    report.path = Some(finished.path.rows);
    Ok(report)
}

/// Finishes the path of a run that took the time `time`, if there is one, and makes the report.
pub(crate) fn found_report(
    kind: &dyn Robot,
    request: &Request,
    found: FoundRun,
    time: Duration,
    control: &mut Control<'_>,
) -> Result<Report, Error> {
    let FoundRun { progress, queries, map, path, ended_by } = found;
    let mut relaxing = Relaxing::default();
    let outcome = match path {
        Some(rows) => {
            if rows.iter().any(|row| row.len() != kind.start().len()) {
                return Err(Error::new("the path of a run has a configuration that is none of the robot")
                    .help("do all processes run the same program with the same scene?"));
            }
            let states: Vec<Configuration> = rows.into_iter().map(Configuration::from).collect();
            let budget = request.budget.time_s.and_then(|s| Duration::try_from_secs_f64(s).ok());
            let left = budget.map(|budget| budget.saturating_sub(control.spent).saturating_sub(time));
            let (path, work) = relax_if_requested(kind, request, Path::straight(states), control, left)?;
            relaxing = work;
            Outcome::Solved(path)
        }
        None => Outcome::Stopped(ended_by.unwrap_or(StopReason::Cancelled)),
    };
    let found = Search {
        outcome,
        progress,
        queries,
        time: time + relaxing.time,
        relaxing,
        ended_by,
        proved: true,
        found_unverified: false,
        first: None,
        others: Vec::new(),
        map,
        roadmap: None,
        roadmap_error: None,
        won: None,
    };
    let left = left(request, control, &found);
    reported(kind, request, found, None, control, left)
}

/// The stages up to the path found.
fn stages(found: &Search, control: &Control<'_>) -> Vec<StageTime> {
    let planning = found.time.saturating_sub(found.relaxing.time);
    let mut stages = vec![StageTime::new(RunStage::Planning, planning, found.ended_by)];
    if !control.spent.is_zero() {
        stages.insert(0, StageTime::new(RunStage::Loading, control.spent, None));
    }
    let Relaxing { time, ended_by } = found.relaxing;
    if !time.is_zero() || ended_by.is_some() {
        stages.push(StageTime::new(RunStage::Relaxing, time, ended_by));
    }
    stages
}
