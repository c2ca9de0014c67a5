//! All series of problems, by increasing number of obstacles.

use crate::clock::processor_clock;
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use mp_cspace::Cancel;
use mp_experiments::clutter::{ComparedPlanner, METRICS, MODELS, MOVERS, Mover, Obstacle, Run, RunSettings};
use mp_plan::Error;
use serde::{Deserialize, Serialize};

/// The size of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) cap: f64,
    pub(super) instances: u32,
    /// Numbers of obstacles, ascending.
    pub(super) levels: Vec<usize>,
}

impl Plan {
    /// The cases of all series at all levels.
    pub(super) fn cases(&self) -> Vec<Case> {
        let of = |level: &usize| Series::all().iter().flat_map(|s| s.cases(self, *level)).collect::<Vec<_>>();
        self.levels.iter().flat_map(of).collect()
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) mover: String,
    pub(super) model: String,
    pub(super) metric: String,
    pub(super) planner: String,
    pub(super) obstacles: usize,
    pub(super) instance: u64,
}

pub(super) const PLANNERS: [&str; 3] = ["rrt", "rsrt", "rrt-connect"];

/// The number of inputs: one each way along each degree of freedom.
const INPUTS: usize = 12;

/// A robot, a model, a metric and a planner, measured over numbers of obstacles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Series {
    pub(super) mover: &'static str,
    pub(super) model: &'static str,
    pub(super) metric: &'static str,
    pub(super) planner: &'static str,
}

impl Series {
    /// All series. RRT-Connect is not run with velocities: two trees grown by inputs do not meet.
    pub(super) fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for mover in MOVERS {
            for model in MODELS {
                for metric in METRICS {
                    let planners = PLANNERS.iter().filter(|p| model == "positions" || **p != "rrt-connect");
                    all.extend(planners.map(|planner| Self { mover, model, metric, planner }));
                }
            }
        }
        all
    }

    pub(super) fn case(&self, obstacles: usize, instance: u64) -> Case {
        let [mover, model, metric, planner] =
            [self.mover, self.model, self.metric, self.planner].map(str::to_owned);
        Case { mover, model, metric, planner, obstacles, instance }
    }

    pub(super) fn cases(&self, plan: &Plan, level: usize) -> Vec<Case> {
        (0..u64::from(plan.instances)).map(|instance| self.case(level, instance)).collect()
    }
}

/// Runs the cases that are not in the log. False when it was interrupted.
pub(super) fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>) -> Result<bool> {
    let most = plan.levels.last().copied().unwrap_or(0);
    let worlds = MOVERS.iter().map(|name| Worlds::new(name, most, plan.instances));
    let worlds: Vec<Worlds> = worlds.collect::<Result<_>>()?;
    let mut going = Series::all();
    for &level in &plan.levels {
        let cases: Vec<Case> = going.iter().flat_map(|series| series.cases(plan, level)).collect();
        let run = |case: &Case| {
            let of_mover = worlds.iter().find(|worlds| worlds.name == case.mover);
            let worlds = of_mover.ok_or_else(|| Error::new(format!("there is no robot `{}`", case.mover)))?;
            worlds.run(case, plan.cap, &lab.cancel)
        };
        if !lab.measure(log, &format!("rsrt, {level} obstacles"), &cases, run)? {
            return Ok(false);
        }
        // A series continues if some instance was solved.
        going.retain(|series| log.runs(series.cases(plan, level)).iter().any(|run| run.solved));
    }
    Ok(true)
}

/// A robot with the obstacles of each instance, of which the first are those of smaller problems.
struct Worlds {
    name: &'static str,
    mover: Mover,
    instances: Vec<Vec<Obstacle>>,
}

impl Worlds {
    fn new(name: &'static str, most: usize, instances: u32) -> Result<Self> {
        let mover = Mover::find(name).into_error()?;
        let instances =
            (0..instances.into()).map(|i| mover.obstacles(most, i)).collect::<mp_experiments::Result<_>>();
        Ok(Self { name, instances: instances.into_error()?, mover })
    }

    fn run(&self, case: &Case, cap: f64, cancel: &Cancel) -> Result<Option<Run>> {
        let planner = match case.planner.as_str() {
            "rrt" => ComparedPlanner::RRT,
            "rsrt" => ComparedPlanner::RSRT,
            "rrt-connect" => ComparedPlanner::Connect,
            other => return Err(Error::new(format!("there is no planner `{other}` here"))),
        };
        let settings = RunSettings {
            planner,
            inputs: INPUTS,
            seed: case.instance + 1,
            cap,
            clock: processor_clock(),
            cancel: cancel.clone(),
        };
        let obstacles = &self.instances[case.instance as usize][..case.obstacles];
        self.mover.plan(obstacles, &case.model, &case.metric, &settings).into_error()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_series_is_run_and_nothing_twice() {
        let plan = Plan { cap: 2.0, instances: 1, levels: vec![2] };
        let folder = tempfile::tempdir().unwrap();
        let lab = Lab::test(folder.path(), 2);
        let mut log = lab.log("rsrt-clutter", 2.0).unwrap();
        assert!(measure(&plan, &lab, &mut log).unwrap());
        assert_eq!(log.all().len(), Series::all().len());
        let easy = log.all().iter().filter(|(_, run)| run.solved).count();
        assert!(easy > log.all().len() / 2, "{easy} of {} solved", log.all().len());
        let text = || std::fs::read_to_string(lab.file("rsrt-clutter-runs.jsonl")).unwrap();
        let before = text();
        let mut again = lab.log("rsrt-clutter", 2.0).unwrap();
        assert!(measure(&plan, &lab, &mut again).unwrap());
        assert_eq!(before, text());
        lab.cancel.cancel();
        let mut other = lab.log("other", 2.0).unwrap();
        assert!(!measure(&plan, &lab, &mut other).unwrap());
        assert!(other.all().is_empty());
    }
}
