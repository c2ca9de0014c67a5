//! Restarts: Las Vegas algorithms with heavy tails, started again by schedules that do not know the
//! distribution of their run lengths.

use super::in_scene::in_scene;
use crate::error::Result;
use crate::experiment::{Lab, Log};
use crate::scenes::bare;
use mp_experiments::clutter::Run;
use mp_plan::{Error, Scene};
use serde::{Deserialize, Serialize};

/// No restarts, and the schedules.
pub(super) const SCHEDULES: [&str; 5] = ["none", "luby", "counter", "zeta", "wide"];
/// Iterations of a run of length 1, the same for all problems.
const UNIT: u32 = 250;

/// A problem whose run lengths have a heavy tail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HeavyProblem {
    pub(super) name: &'static str,
    pub(super) scene: &'static str,
    pub(super) planner: &'static str,
    pub(super) settings: &'static [(&'static str, &'static str)],
}

pub(super) const PROBLEMS: [HeavyProblem; 4] = [
    HeavyProblem {
        name: "gempa-3, RSRT, 12 inputs",
        scene: "gempa-3",
        planner: "rsrt",
        settings: &[("inputs", "12"), ("levels", "1")],
    },
    HeavyProblem {
        name: "gempa-3, ALG. 4, 12 inputs",
        scene: "gempa-3",
        planner: "rrt-inputs",
        settings: &[("inputs", "12"), ("levels", "1")],
    },
    HeavyProblem { name: "twisty, RRT-Connect", scene: "twisty", planner: "rrt-connect", settings: &[] },
    HeavyProblem {
        name: "easy, RSRT, 12 inputs",
        scene: "easy",
        planner: "rsrt",
        settings: &[("inputs", "12"), ("levels", "1")],
    },
];

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) problem: String,
    pub(super) schedule: String,
    pub(super) seed: u64,
}

/// The size of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) seeds: u64,
    pub(super) problems: Vec<HeavyProblem>,
    pub(super) cap: f64,
}

impl Plan {
    pub(super) fn runs(&self, problem: &str, schedule: &str) -> impl Iterator<Item = Case> {
        let [problem, schedule] = [problem, schedule].map(str::to_owned);
        (1..=self.seeds).map(move |seed| Case { problem: problem.clone(), schedule: schedule.clone(), seed })
    }

    /// All cases, seed by seed.
    pub(super) fn cases(&self) -> Vec<Case> {
        let of = |seed| {
            self.problems.iter().flat_map(move |problem| {
                SCHEDULES.map(|schedule| Case {
                    problem: problem.name.to_owned(),
                    schedule: schedule.to_owned(),
                    seed,
                })
            })
        };
        (1..=self.seeds).flat_map(of).collect()
    }
}

/// Runs the cases that are not in the log. False when it was interrupted.
pub(super) fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>) -> Result<bool> {
    let known = |case: &Case| {
        let problem = plan.problems.iter().find(|p| p.name == case.problem);
        problem.ok_or_else(|| Error::new(format!("there is no problem `{}` here", case.problem)))
    };
    lab.measure_in(
        log,
        "rsrt, restarts",
        &plan.cases(),
        |a, b| (a.seed, &a.problem) == (b.seed, &b.problem),
        |case| Scene::find(known(case)?.scene),
        |scene, case| {
            let problem = known(case)?;
            let request = match case.schedule.as_str() {
                "none" => bare(problem.planner),
                schedule => {
                    bare(&format!("restart-{}", problem.planner)).set("schedule", schedule).set("unit", UNIT)
                }
            };
            let request = problem.settings.iter().fold(request, |r, (name, value)| r.set(*name, value));
            in_scene(scene, &request.time(plan.cap).seed(case.seed), &lab.cancel)
        },
    )
}
