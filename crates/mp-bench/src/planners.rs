//! Every planner on shipped scenes, to the first verified path: the source of the table in
//! `docs/choosing-a-planner.md`.

use crate::error::Result;
use crate::experiment::{Lab, Table};
use crate::options::Common;
use crate::scenes::{Planned, Rigid, bare};
use mp_plan::median;
use serde::{Deserialize, Serialize};

/// Open and crowded rooms, traps and narrow passages, in the plane and in space.
const SCENES: [&str; 6] = ["maze", "planar-bugtrap", "easy", "cubicles", "twisty", "bugtrap"];

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    planner: String,
    seed: u64,
}

/// Runs the suite. True when it was measured completely; a planner that does not solve a scene in time is a
/// result.
pub(crate) fn run(common: &Common) -> Result<bool> {
    let lab = Lab::one_at_a_time(common)?;
    let scenes = common.scenes_or(&SCENES);
    let seeds = common.runs_or(2, 10);
    let cap = if common.quick { common.time.min(2.0) } else { common.time };
    let mut log = lab.log("planners", cap)?;
    let case = |scene: &String, planner: &str, seed: u32| Case {
        scene: scene.clone(),
        planner: planner.to_owned(),
        seed: u64::from(seed),
    };
    let of = |scene: &String, planner: &str| {
        (1..=seeds).map(|seed| case(scene, planner, seed)).collect::<Vec<_>>()
    };
    let planners = || mp_tree::planners().iter().map(|info| info.name);
    let cases: Vec<Case> =
        scenes.iter().flat_map(|s| planners().flat_map(|p| of(s, p)).collect::<Vec<_>>()).collect();
    let complete = lab.measure_in(
        &mut log,
        "planners",
        &cases,
        |a, b| a.scene == b.scene,
        |case| Rigid::load(&case.scene),
        |scene, case| scene.plan(&bare(&case.planner).time(cap).seed(case.seed), &lab.cancel),
    )?;
    if !complete {
        return Ok(false);
    }
    let cell = |scene: &String, planner: &str| {
        let runs: Vec<&Planned> = log.runs(of(scene, planner));
        let solved = runs.iter().filter(|run| run.solved).count();
        let seconds = runs.iter().map(|run| if run.solved { run.seconds } else { f64::INFINITY });
        let time = median(seconds).filter(|s| s.is_finite());
        let time = time.map_or(format!("> {cap}"), |s| format!("{s:.3}"));
        if solved == runs.len() { time } else { format!("{time} ({solved}/{seeds})") }
    };
    let mut summary = Table::new(["planner".to_owned()].into_iter().chain(scenes.clone()));
    for planner in planners() {
        let cells = scenes.iter().map(|scene| cell(scene, planner));
        summary.rows.push([planner.to_owned()].into_iter().chain(cells).collect());
    }
    lab.report("planners", &summary.markdown(), &log.table(&cases)?)?;
    Ok(true)
}
