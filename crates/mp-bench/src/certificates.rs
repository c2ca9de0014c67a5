//! What proofs of paths cost: planning, certifying, and replaying by the program that shares no code with the
//! planner.

use crate::clock::{nanoseconds, seconds_since};
use crate::error::Result;
use crate::experiment::{Lab, Table};
use crate::options::Common;
use mp_plan::{Error, Interrupt, PathRows, Request, Scene};
use serde::{Deserialize, Serialize};

/// A case: the default planner in a scene.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    seed: u64,
}

/// The result of a case. Times are seconds of processor time, the shortest of several for those that are
/// repeated.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Run {
    edges: usize,
    parts: usize,
    bytes: usize,
    /// Searching, shortening and verifying.
    planning: f64,
    certifying: f64,
    replaying: f64,
}

/// Runs the suite. True when every path has a certificate that was replayed.
pub(crate) fn run(common: &Common) -> Result<bool> {
    let lab = Lab::one_at_a_time(common)?;
    let mut log = lab.log("certificates", common.time)?;
    let shipped: Vec<&str> = mp_scenes::without_solution().collect();
    let repeats = common.runs_or(1, 3);
    let cases: Vec<Case> =
        common.scenes_or(&shipped).into_iter().map(|scene| Case { scene, seed: 1 }).collect();
    let complete =
        lab.measure(&mut log, "certificates", &cases, |case| measure(case, repeats, common.time))?;
    if !complete {
        return Ok(false);
    }
    let table = Table::of(
        log.each(&cases),
        &[
            ("scene", &|(case, _)| case.scene.clone()),
            ("edges", &|(_, run)| run.edges.to_string()),
            ("parts", &|(_, run)| run.parts.to_string()),
            ("kB", &|(_, run)| (run.bytes / 1000).to_string()),
            ("planning ms", &|(_, run)| format!("{:.1}", 1e3 * run.planning)),
            ("certifying ms", &|(_, run)| format!("{:.1}", 1e3 * run.certifying)),
            ("replaying ms", &|(_, run)| format!("{:.1}", 1e3 * run.replaying)),
            ("edges replayed/s", &|(_, run)| format!("{:.0}", run.edges as f64 / run.replaying)),
        ],
    );
    lab.report("certificates", &table.markdown(), &table)?;
    Ok(log.each(&cases).count() == cases.len())
}

fn measure(case: &Case, repeats: u32, time: f64) -> Result<Option<Run>> {
    let scene = Scene::find(&case.scene)?;
    let mut request = Request::new(scene.default_planner()).seed(case.seed);
    request.budget.time_s = Some(time);
    let began = nanoseconds();
    let report = scene.plan(&request)?;
    let planning = seconds_since(began);
    let Some(rows) = report.path else { return Ok(None) };
    let path = PathRows { format: scene.path_format(), columns: scene.columns(), rows };
    let mut run = Run {
        edges: path.rows.len() - 1,
        parts: 0,
        bytes: 0,
        planning,
        certifying: f64::INFINITY,
        replaying: f64::INFINITY,
    };
    for _ in 0..repeats {
        let began = nanoseconds();
        let certificate = scene.certificate(&path, report.clearance.unwrap_or(0.0), &Interrupt::never())?;
        run.certifying = run.certifying.min(seconds_since(began));
        let began = nanoseconds();
        mp_verify_certificate::verify(certificate.to_json())
            .map_err(|why| Error::new(format!("the certificate of {} is refused: {why}", case.scene)))?;
        run.replaying = run.replaying.min(seconds_since(began));
        (run.parts, run.bytes) = (certificate.intervals(), certificate.to_json().len());
    }
    Ok(Some(run))
}
