//! The series of all trials.

use crate::clock::processor_clock;
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use crate::options::Common;
use mp_experiments::rrs::{Case, PreparedWorld, Run, planned};
use mp_scenes::source::disc_scenes::disc_scene;

pub(super) const WORLDS: [&str; 4] = ["maze", "low", "high", "random"];

/// The planners. Most take steps of exactly Δq, as the paper's algorithm says; those with `-upto` steps of at
/// most Δq, as is customary, and RRT-Connect too. `rrs` bends edges by snakes, as the paper does,
/// `rrs-hybrid` and `rrs-bulge` in ways of ours, `rrs-paper` by snakes in the field of eq. 3 alone, and
/// `rrs-risk` in that of obstacles and risk.
pub(super) const PLANNERS: [&str; 9] =
    ["rrt", "rrs", "rrs-hybrid", "rrs-bulge", "rrs-paper", "rrs-risk", "rrt-upto", "rrs-upto", "rrt-connect"];

/// The size of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) trials: u64,
    /// Δq, centimetres.
    pub(super) steps: Vec<u32>,
}

impl Plan {
    pub(super) fn new(common: &Common) -> Self {
        let apart = if common.quick { 30 } else { 5 };
        Self { trials: u64::from(common.runs_or(8, 100)), steps: (30..=150).step_by(apart).collect() }
    }

    /// All cases; those of one world are consecutive.
    pub(super) fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for world in WORLDS {
            for trial in 0..self.trials {
                for &step in &self.steps {
                    let case =
                        |planner: &str| Case { world: world.into(), planner: planner.into(), step, trial };
                    cases.extend(PLANNERS.map(case));
                }
            }
        }
        cases
    }
}

/// Runs the cases that are not in the log. False when it was interrupted.
pub(super) fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>) -> Result<bool> {
    lab.measure_in(
        log,
        "rrs",
        &plan.cases(),
        // A world is prepared once for all its cases.
        |a, b| (&a.world, a.trial) == (&b.world, b.trial),
        |case| PreparedWorld::new(disc_scene(&case.world, case.trial).into_error()?).into_error(),
        |prepared, case| {
            let done = planned(prepared, case, processor_clock(), &lab.cancel).into_error()?;
            Ok(done.map(|(run, _)| run))
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All planners solve what is easy, the same way each time; nothing is run twice.
    #[test]
    fn trials_are_reproducible() {
        let plan = Plan { trials: 1, steps: vec![40] };
        let folder = tempfile::tempdir().unwrap();
        let lab = Lab::test(folder.path(), 2);
        let mut log = lab.log("a", 1.0).unwrap();
        assert!(measure(&plan, &lab, &mut log).unwrap());
        assert_eq!(log.all().len(), plan.cases().len());
        let solved = log.all().iter().filter(|(_, run)| run.solved).count();
        assert!(solved * 2 > log.all().len(), "{solved} solved");
        let file = lab.file("a-runs.jsonl");
        let text = || std::fs::read_to_string(&file).unwrap();
        let before = text();
        assert!(measure(&plan, &lab, &mut lab.log("a", 1.0).unwrap()).unwrap());
        assert_eq!(before, text());
        drop(lab);
        let lab = Lab::test(folder.path(), 1);
        let mut alone = lab.log("b", 1.0).unwrap();
        assert!(measure(&plan, &lab, &mut alone).unwrap());
        for ((case, a), (_, b)) in log.all().iter().zip(alone.all()) {
            assert_eq!((a.iterations, a.nodes, a.length), (b.iterations, b.nodes, b.length), "{case:?}");
        }
    }
}
