//! The problems, and planners on them.

use mp_cspace::{Cancel, Clock};
use mp_experiments::clutter::{ComparedPlanner, MODELS, MOVERS, Mover, RunSettings};
use std::time::Duration;

/// A clock that stands still: nothing is ended by it.
fn settings(planner: ComparedPlanner) -> RunSettings {
    let clock = Clock::new(|| Duration::ZERO);
    RunSettings { planner, inputs: 12, seed: 1, cap: 1.0, clock, cancel: Cancel::new() }
}

#[test]
fn more_obstacles_are_the_same_and_some() {
    for name in MOVERS {
        let mover = Mover::find(name).unwrap();
        let (few, many) = (mover.obstacles(4, 7).unwrap(), mover.obstacles(32, 7).unwrap());
        assert_eq!(few.as_slice(), &many[..4]);
        assert!(many.iter().all(|o| mover.spares(o).unwrap()));
        assert_ne!(few, mover.obstacles(4, 8).unwrap());
    }
}

#[test]
fn nothing_else_has_a_name() {
    let said = Mover::find("arm").unwrap_err().to_string();
    assert!(said.contains("`arm`") && said.contains("6-DOF arm"), "{said}");
    let mover = Mover::find(MOVERS[0]).unwrap();
    for (model, metric) in [("positions", "l2"), ("accelerations", "euclidean")] {
        let said = mover.plan(&[], model, metric, &settings(ComparedPlanner::RRT)).unwrap_err().to_string();
        assert!(said.contains(model) && said.contains(metric), "{said}");
    }
    let met = mover.plan(&[], MODELS[1], "euclidean", &settings(ComparedPlanner::Connect)).unwrap_err();
    assert!(met.to_string().contains("do not meet"), "{met}");
}

#[test]
fn a_cancelled_run_is_none_and_without_obstacles_all_are_solved() {
    for name in MOVERS {
        let mover = Mover::find(name).unwrap();
        for planner in [ComparedPlanner::RRT, ComparedPlanner::RSRT, ComparedPlanner::Connect] {
            let settings = settings(planner);
            let run = mover.plan(&[], MODELS[0], "scaled", &settings).unwrap().unwrap();
            assert!(run.solved && run.edges > 0 && run.seconds == 0.0, "{name}: {run:?}");
            assert_eq!(Some(run), mover.plan(&[], MODELS[0], "scaled", &settings).unwrap());
            settings.cancel.cancel();
            assert_eq!(None, mover.plan(&[], MODELS[0], "scaled", &settings).unwrap());
        }
    }
}
