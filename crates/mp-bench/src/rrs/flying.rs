//! RRT against RRS for a body in space, with the same steps.

use crate::error::Result;
use crate::experiment::{Lab, Table, mean};
use crate::options::Common;
use crate::scenes::{Planned, Rigid, bare};
use mp_plan::median;
use serde::{Deserialize, Serialize};

const SCENES: [&str; 4] = ["gempa-3", "gempa-4", "cubicles", "twisty"];
/// Longest steps, as percentages of the extent of the space.
const STEPS: [&str; 3] = ["5%", "10%", "20%"];
/// Planners, and how they bend.
const PLANNERS: [(&str, &str); 4] = [("rrt", ""), ("rrs", "snake"), ("rrs", "bulge"), ("rrs", "hybrid")];
/// The numbers of seeds in full and short runs, and the most iterations of a run.
const SEEDS: u32 = 10;
const QUICK: u32 = 2;
const ITERATIONS: u64 = 20_000;

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    step: String,
    planner: String,
    bend: String,
    seed: u64,
}

/// Plans on each scene with each step, with the same seeds for both planners. True when it was measured
/// completely.
pub(super) fn run(lab: &Lab, common: &Common) -> Result<bool> {
    let seeds = u64::from(common.runs_or(QUICK, SEEDS));
    let most = if common.quick { ITERATIONS / 10 } else { ITERATIONS };
    let mut cases = Vec::new();
    for scene in common.scenes_or(&SCENES) {
        for (step, (planner, bend)) in STEPS.iter().flat_map(|step| PLANNERS.map(|one| (*step, one))) {
            let [step, planner, bend] = [step, planner, bend].map(str::to_owned);
            let case = |seed| Case {
                scene: scene.clone(),
                step: step.clone(),
                planner: planner.clone(),
                bend: bend.clone(),
                seed,
            };
            cases.extend((1..=seeds).map(case));
        }
    }
    let name = lab.name("rrs-flying");
    let mut log = lab.log(&name, most as f64)?;
    let scenes = common.scenes_or(&SCENES).into_iter().map(|name| Ok((Rigid::load(&name)?, name)));
    let scenes: Vec<(Rigid, String)> = scenes.collect::<Result<_>>()?;
    let complete = lab.measure(&mut log, "rrs, flying", &cases, |case| {
        let Some((scene, _)) = scenes.iter().find(|(_, name)| *name == case.scene) else { return Ok(None) };
        let request = bare(&case.planner).set("step", &case.step).iterations(most).seed(case.seed);
        let request = if case.bend.is_empty() { request } else { request.set("bend", &case.bend) };
        scene.plan(&request, &lab.cancel)
    })?;
    if !complete {
        return Ok(false);
    }
    // A run that was not solved took all iterations.
    let iterations = |run: &Planned| if run.solved { run.iterations as f64 } else { most as f64 };
    let summary = Table::of(
        log.groups(&cases, |case| [&case.scene, &case.step, &case.planner, &case.bend]),
        &[
            ("scene", &|g| g.key[0].clone()),
            ("step", &|g| g.key[1].clone()),
            ("planner", &|g| g.key[2].clone()),
            ("bend", &|g| g.key[3].clone()),
            ("solved", &|g| format!("{} of {seeds}", g.count(|run| run.solved))),
            ("mean iterations", &|g| format!("{:.0}", mean(g.values(iterations)).unwrap_or(f64::NAN))),
            ("median", &|g| format!("{:.0}", median(g.values(iterations)).unwrap_or(f64::NAN))),
            ("mean s", &|g| format!("{:.2}", mean(g.values(|run| run.seconds)).unwrap_or(f64::NAN))),
        ],
    );
    lab.report(&name, &summary.markdown(), &log.table(&cases)?)?;
    Ok(true)
}
