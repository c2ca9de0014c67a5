//! A thousand planning problems, as `mp many` plans them.

use crate::clock::{nanoseconds, seconds_since};
use crate::error::Result;
use crate::experiment::{Lab, bit};
use crate::options::Common;
use mp_plan::{Budget, Control, Request, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Scenes of all kinds of robots.
const SCENES: [&str; 20] = [
    "easy",
    "cubicles",
    "twisty",
    "apartment",
    "bugtrap",
    "maze",
    "planar-bugtrap",
    "gempa-1",
    "gempa-2",
    "gempa-4",
    "alpha-1.5",
    "arm",
    "wrench",
    "rrs-high",
    "rrs-follow",
    "rrs-maze",
    "parking",
    "crossing",
    "docks",
    "velocities",
];
/// A problem that is not solved by then has failed.
const MOST_ITERATIONS: u64 = 100_000;

/// A case of the suite: a problem and a seed.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) problem: String,
    pub(super) seed: u64,
}

/// What a run cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cost {
    pub(super) solved: bool,
    /// Processor time.
    pub(super) seconds: f64,
    pub(super) iterations: u64,
}

/// What all cases of an experiment cost, in order.
#[derive(Clone, Debug)]
pub(super) struct Costs {
    pub(super) name: &'static str,
    pub(super) runs: Vec<(Case, Cost)>,
    /// The commits at which they were measured, and how many at each.
    pub(super) commits: BTreeMap<String, usize>,
}

impl Costs {
    /// The seconds of each run.
    pub(super) fn each(&self) -> Vec<f64> {
        self.runs.iter().map(|(_, cost)| cost.seconds).collect()
    }

    /// A row for each run.
    pub(super) fn rows(&self) -> impl Iterator<Item = Vec<String>> {
        self.runs.iter().map(|(case, cost)| {
            let (problem, seed) = (case.problem.clone(), case.seed.to_string());
            let numbers = [bit(cost.solved), format!("{:.6}", cost.seconds), cost.iterations.to_string()];
            [self.name.to_owned(), problem, seed].into_iter().chain(numbers).collect()
        })
    }
}

/// The planning problems; `None` when the measurement was interrupted.
pub(super) fn measured(lab: &Lab, common: &Common) -> Result<Option<Costs>> {
    let seeds = u64::from(common.runs_or(1, 50));
    let scenes = common.scenes_or(&SCENES);
    let of = |scene: String| (1..=seeds).map(move |seed| Case { problem: scene.clone(), seed });
    let cases: Vec<Case> = scenes.into_iter().flat_map(of).collect();
    let budget = Budget { time_s: None, iterations: Some(MOST_ITERATIONS), ..Budget::default() };
    measured_as(lab, common, "problems", &cases, |scene, case| {
        Ok(Request { budget, ..Request::new(scene.default_planner()).seed(case.seed) })
    })
}

/// What the requests of the cases cost, of which each has the name of a scene, or one before a comma.
pub(super) fn measured_as(
    lab: &Lab,
    common: &Common,
    name: &'static str,
    cases: &[Case],
    request: impl Fn(&Scene, &Case) -> Result<Request> + Sync,
) -> Result<Option<Costs>> {
    let mut log = lab.log(&format!("scale-{name}"), common.time)?;
    let complete = lab.measure_in(
        &mut log,
        &format!("scale, {name}"),
        cases,
        |a: &Case, b: &Case| a.problem == b.problem && a.seed / 10 == b.seed / 10,
        |case| Scene::find(case.problem.split(',').next().unwrap_or_default()),
        |scene, case| {
            let request = request(scene, case)?;
            let began = nanoseconds();
            let mut control = Control { cancel: lab.cancel.clone(), ..Control::default() };
            let report = scene.plan_with(&request, &mut control)?;
            let cost =
                Cost { solved: report.solved, seconds: seconds_since(began), iterations: report.iterations };
            Ok((!lab.cancel.is_raised()).then_some(cost))
        },
    )?;
    let runs = log.each(cases).map(|(case, cost)| (case.clone(), *cost)).collect();
    let commits = log.commits(cases);
    Ok(complete.then_some(Costs { name, runs, commits }))
}
