//! All trials, side by side.

use super::solve::{Case, Place, Run, one};
use crate::assets::courses::course;
use crate::bench::log::Log;
use miette::{IntoDiagnostic, Result};
use mp::cspace::Cancel;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// The worlds, by name.
pub(super) const WORLDS: [&str; 4] = ["maze", "low", "high", "random"];

/// The planners: `rrt` and `rrs` take steps of exactly Δq, as the paper's algorithm says; those with `-upto` steps of
/// at most Δq, as is customary, and RRT-Connect too.
pub(super) const PLANNERS: [&str; 5] = ["rrt", "rrs", "rrt-upto", "rrs-upto", "rrt-connect"];

/// What to measure.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) trials: u64,
    /// Δq, centimetres.
    pub(super) steps: Vec<u32>,
    pub(super) threads: Option<u16>,
}

impl Plan {
    pub(super) fn new(quick: bool, trials: Option<u32>, threads: Option<u16>) -> Self {
        let (trials, apart) = (trials.unwrap_or(if quick { 8 } else { 100 }), if quick { 30 } else { 5 });
        Self { trials: u64::from(trials), steps: (30..=150).step_by(apart).collect(), threads }
    }

    /// Every trial, those of one world together.
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

/// Measures what is not known yet, calling `tick` after each run that is. False when it was interrupted.
pub(super) fn measure(
    plan: &Plan,
    log: &mut Log<Case, Run>,
    cancel: &Cancel,
    tick: impl Fn() + Sync,
) -> Result<bool> {
    let threads = plan.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_diagnostic()?;
    let (known, open): (Vec<Case>, Vec<Case>) = plan.cases().into_iter().partition(|c| log.get(c).is_some());
    known.iter().for_each(|_| tick());
    // A world is made once for all that is tried in it.
    let groups: Vec<&[Case]> = open.chunk_by(|a, b| (&a.world, a.trial) == (&b.world, b.trial)).collect();
    let group = |cases: &&[Case]| -> Result<Vec<(Case, Run)>> {
        let place = Place::new(course(&cases[0].world, cases[0].trial)?)?;
        let mut done = Vec::new();
        for case in *cases {
            if cancel.0.load(Ordering::Relaxed) {
                break;
            }
            let Some(run) = one(&place, case, cancel)? else { break };
            log.write(case, &run)?;
            done.push((case.clone(), run));
            tick();
        }
        Ok(done)
    };
    let done: Vec<Result<Vec<_>>> = pool.install(|| groups.par_iter().with_max_len(1).map(group).collect());
    for each in done {
        log.learn(each?);
    }
    Ok(!cancel.0.load(Ordering::Relaxed))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All planners solve what is easy, the same way each time; nothing is run twice.
    #[test]
    fn trials_are_reproducible() {
        let plan = Plan { trials: 1, steps: vec![40], threads: Some(2) };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.jsonl");
        let mut log = Log::open(&path, 1.0, false).unwrap();
        assert!(measure(&plan, &mut log, &Cancel::new(), || ()).unwrap());
        assert_eq!(log.all().len(), plan.cases().len());
        let solved = log.all().iter().filter(|(_, run)| run.solved).count();
        assert!(solved * 2 > log.all().len(), "{solved} solved");
        let text = std::fs::read_to_string(&path).unwrap();
        let mut again = Log::open(&path, 1.0, false).unwrap();
        assert!(measure(&plan, &mut again, &Cancel::new(), || ()).unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        let mut fresh = Log::open(&folder.path().join("b.jsonl"), 1.0, false).unwrap();
        assert!(measure(&Plan { threads: Some(1), ..plan }, &mut fresh, &Cancel::new(), || ()).unwrap());
        for ((case, a), (_, b)) in log.all().iter().zip(fresh.all()) {
            assert_eq!((a.iterations, a.nodes, a.length), (b.iterations, b.nodes, b.length), "{case:?}");
        }
    }
}
