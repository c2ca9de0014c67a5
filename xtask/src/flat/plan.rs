//! Planning in the plane, and what becomes of the path.

use super::{FlatMover, Task};
use crate::plan::Options;
use crate::plan::finish::{STREAM, Until};
use crate::plan::metrics::Kind;
use crate::plan::progress::Line;
use crate::plan::search::{Run, Search};
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::shorten::{Effort, simplify};
use mp::cspace::{Cancel, Certified, DefaultNn, Path, Rng, least_clearance, verify_path};
use mp::io::JointPath;

/// Shortcuts keep this share of the robot's radius away from obstacles: a path that grazes every corner is of no
/// use to anybody.
const ROOM: f64 = 0.002;

/// Plans from start to goals of `task` with `seed`.
pub(crate) fn search<M: FlatMover>(
    task: &Task<M>,
    options: &Options,
    seed: u64,
    cancel: &Cancel,
    line: &mut Line,
) -> Result<Search<M::State>> {
    if options.metric != Kind::Default {
        return Err(miette!(
            help = "leave --metric out",
            "worlds in the plane have the metric of their space only, not `{}`",
            options.metric_name
        ));
    }
    if options.roadmap.is_some() {
        return Err(miette!(help = "leave --roadmap out", "roadmaps are kept of rigid bodies only"));
    }
    let run = Run {
        space: &task.space,
        robot: &task.robot,
        verifier: task.robot.verifier(&task.space),
        start: &task.start,
        goals: task.goals.clone(),
        fingerprint: None,
        tolerance: task.tolerance,
        options,
        seed,
        cancel,
    };
    run.on(&task.space, <M::Space as DefaultNn>::Nn::default(), line)
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
pub(crate) fn finish<M: FlatMover>(
    task: &Task<M>,
    found: &Path<M::State>,
    shorten: bool,
    seed: u64,
    cancel: &Cancel,
) -> Result<Option<Finished>> {
    if shorten {
        let room = (ROOM * task.robot.radius()).max(task.tolerance);
        let certified = Certified::new(&task.space, task.robot.clone(), room).into_diagnostic()?;
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
fn written<M: FlatMover>(task: &Task<M>, path: &Path<M::State>, shortened: bool) -> Result<Option<Finished>> {
    let text = JointPath { configurations: path.states.iter().map(M::row).collect() }.to_text();
    let file = JointPath::parse("the path", text.as_bytes())?;
    let read = Path::straight(task.path(&file)?);
    let report = verify_path(&task.space, &read, &mut task.robot.verifier(&task.space));
    if let Some(fault) = report.fault {
        tracing::info!("{fault}");
        return Ok(None);
    }
    let accuracy = task.tolerance.max(1e-4 * task.robot.radius());
    let tightest = least_clearance(&task.space, &mut task.robot.clone(), &read, accuracy);
    let clearance = tightest.map_or(report.clearance, |t| t.clearance.max(report.clearance));
    Ok(Some(Finished { file, length: report.length, clearance, shortened }))
}
