//! Planning for an arm, and what becomes of the path.

use super::task::{State, Task};
use crate::plan::Options;
use crate::plan::finish::{ROOM, STREAM, Until};
use crate::plan::metrics::Kind;
use crate::plan::progress::Line;
use crate::plan::search::{Run, Search, with};
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::shorten::{Effort, simplify};
use mp::cspace::{Cancel, Certified, KdTree, Manhattan, Path, Rng, least_clearance, verify_path};
use mp::io::JointPath;

/// Plans from start to goals of `task` with `seed`.
pub(crate) fn search(
    task: &Task,
    options: &Options,
    seed: u64,
    cancel: &Cancel,
    line: &mut Line,
) -> Result<Search<State>> {
    let space = &task.space;
    if options.roadmap.is_some() {
        return Err(miette!(help = "leave --roadmap out", "roadmaps are kept of rigid bodies only"));
    }
    let run = Run {
        space,
        robot: &task.arm,
        verifier: task.verifier()?,
        start: &task.start,
        goals: task.goals.clone(),
        fingerprint: None,
        tolerance: task.tolerance,
        options,
        seed,
        cancel,
    };
    match options.metric {
        // The metric of the space is the Euclidean one.
        Kind::Default | Kind::Euclidean => run.on(space, <KdTree>::default(), line),
        Kind::Manhattan => run.on(&with(space, Manhattan), <KdTree>::default(), line),
        Kind::Scaled | Kind::MaxDisplacement | Kind::SweptVolume => Err(miette!(
            help = "arms have --metric default, euclidean or manhattan",
            "the metric `{}` is one of rigid bodies",
            options.metric_name
        )),
    }
}

/// A path that the verifier passed as it will be read.
#[derive(Clone, Debug)]
pub(crate) struct Finished {
    pub(crate) file: JointPath,
    /// In the metric of the space.
    pub(crate) length: f64,
    /// A lower bound all along, metres.
    pub(crate) clearance: f64,
    pub(crate) shortened: bool,
}

/// Shortens `found` if asked to, and verifies what will be written. Falls back to `found` itself; `None` when
/// not even that is free after it has been through its text.
pub(crate) fn finish(
    task: &Task,
    found: &Path<State>,
    shorten: bool,
    seed: u64,
    cancel: &Cancel,
) -> Result<Option<Finished>> {
    if shorten {
        let certified =
            Certified::new(&task.space, task.arm.clone(), ROOM * task.tolerance).into_diagnostic()?;
        let mut check = Until(certified, cancel);
        let mut rng = Rng::stream(seed, STREAM);
        let short = simplify(&task.space, &mut check, found, Effort::default(), &mut rng);
        if let Some(finished) = written(task, &short, true)? {
            return Ok(Some(finished));
        }
        tracing::info!("the shortened path does not pass the verifier: the path as found is written");
    }
    written(task, found, false)
}

/// `path` as it reads back from its text, if the verifier passes that.
fn written(task: &Task, path: &Path<State>, shortened: bool) -> Result<Option<Finished>> {
    let configurations = path.states.iter().map(|q| q.as_slice().to_vec()).collect();
    let text = JointPath { configurations }.to_text();
    let file = JointPath::parse("the path", text.as_bytes())?;
    let read = Path::straight(task.states(&file));
    let report = verify_path(&task.space, &read, &mut task.verifier()?);
    if let Some(fault) = report.fault {
        tracing::info!("{fault}");
        return Ok(None);
    }
    let tightest = least_clearance(&task.space, &mut task.arm.clone(), &read, task.tolerance);
    let clearance = tightest.map_or(report.clearance, |t| t.clearance.max(report.clearance));
    Ok(Some(Finished { file, length: report.length, clearance, shortened }))
}
