//! `check` in the plane.

use super::task::{either, written};
use super::{AnyTask, FlatMover, Task};
use crate::check::Verdict;
use crate::info::brief;
use miette::Result;
use mp::cspace::{Metric, MotionCheck, Path, PathFault, Space, least_clearance, verify_path};
use mp::io::JointPath;

/// A path begins at the start and ends at a goal if it is no farther off than this, in the metric of the space:
/// files often have four digits.
const MATCH: f64 = 1e-3;

/// Verifies a path from start to a goal of the task.
pub(crate) fn check(task: &AnyTask, file: &JointPath) -> Result<Verdict> {
    either!(task, task => verdict(task, file))
}

fn verdict<M: FlatMover>(task: &Task<M>, file: &JointPath) -> Result<Verdict> {
    let path = Path::straight(task.path(file)?);
    let mut faults = Vec::new();
    let (first, last) = (&path.states[0], &path.states[path.states.len() - 1]);
    let off = |a: &M::State, b: &M::State| task.space.distance(a, b);
    if off(first, &task.start) > MATCH {
        faults.push(format!("does not begin at the start: {} off", brief(off(first, &task.start))));
    }
    let nearest = task.goals.iter().map(|goal| off(last, goal)).fold(f64::INFINITY, f64::min);
    if nearest > MATCH {
        faults.push(format!("does not end at a goal: {} off", brief(nearest)));
    }
    let report = verify_path(&task.space, &path, &mut task.robot.verifier(&task.space));
    faults.extend(report.fault.map(|fault| told(task, &path, fault)));
    let clearance = match faults.is_empty() {
        true => {
            let accuracy = task.tolerance.max(1e-4 * task.robot.radius());
            let tightest = least_clearance(&task.space, &mut task.robot.clone(), &path, accuracy);
            tightest.map_or(report.clearance, |t| t.clearance.max(report.clearance))
        }
        false => 0.0,
    };
    Ok(Verdict::new(path.states.len(), report.length, clearance, faults))
}

/// The fault with the configuration at which it is, and what touches.
fn told<M: FlatMover>(task: &Task<M>, path: &Path<M::State>, fault: PathFault) -> String {
    let PathFault::Motion { edge, check } = fault else {
        return match fault {
            PathFault::OutOfBounds { state } => format!("configuration {} is out of bounds", state + 1),
            fault => fault.to_string(),
        };
    };
    let (from, to) = (&path.states[edge], path.states.get(edge + 1).unwrap_or(&path.states[edge]));
    let state = task.space.interpolate(from, to, check.failed_at().unwrap_or(0.0));
    let touching = task.touching(&state);
    let what = match (check, touching.is_empty()) {
        (MotionCheck::Undecided { .. }, _) | (_, true) => {
            format!("comes nearer to an obstacle than {} m", brief(task.tolerance))
        }
        _ => format!("hits {}", touching.join(", ")),
    };
    format!("{what} between configurations {} and {}, at [{}]", edge + 1, edge + 2, written::<M>(&state))
}
