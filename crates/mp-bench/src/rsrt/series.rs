//! All series of problems, by increasing number of obstacles.

use super::clutter::Obstacle;
use super::robots::{Flyer, SixAxes, TestRobot};
use super::solve::{ComparedPlanner, Run, RunSettings, positions, velocities};
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use mp_cspace::{Cancel, Euclidean, Manhattan, Product, ScaledEuclidean};
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

/// A case.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) mover: String,
    pub(super) model: String,
    pub(super) metric: String,
    pub(super) planner: String,
    pub(super) obstacles: usize,
    pub(super) instance: u64,
}

pub(super) const MOVERS: [&str; 2] = ["free-flyer", "6-DOF arm"];
pub(super) const MODELS: [&str; 2] = ["positions", "velocities"];
pub(super) const METRICS: [&str; 3] = ["euclidean", "scaled", "manhattan"];
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

    /// The cases of one level.
    pub(super) fn cases(&self, plan: &Plan, level: usize) -> impl Iterator<Item = Case> {
        let series = *self;
        (0..u64::from(plan.instances)).map(move |instance| series.case(level, instance))
    }
}

/// Runs the cases that are not in the log. False when it was interrupted.
pub(super) fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>) -> Result<bool> {
    let (flyer, arm) = (Flyer::new()?, SixAxes::new()?);
    let most = plan.levels.last().copied().unwrap_or(0);
    let instances = 0..u64::from(plan.instances);
    let flying: Vec<Vec<Obstacle>> =
        instances.clone().map(|i| flyer.obstacles(most, i)).collect::<Result<_>>()?;
    let reaching: Vec<Vec<Obstacle>> = instances.map(|i| arm.obstacles(most, i)).collect::<Result<_>>()?;
    let mut going = Series::all();
    for &level in &plan.levels {
        let cases: Vec<Case> = going.iter().flat_map(|series| series.cases(plan, level)).collect();
        let run = |case: &Case| {
            let world = |all: &[Vec<Obstacle>]| all[case.instance as usize][..level].to_vec();
            match case.mover.as_str() {
                "free-flyer" => one(&flyer, &world(&flying), case, plan.cap, &lab.cancel),
                _ => one(&arm, &world(&reaching), case, plan.cap, &lab.cancel),
            }
        };
        if !lab.measure(log, &format!("rsrt, {level} obstacles"), &cases, run)? {
            return Ok(false);
        }
        // A series continues if some instance was solved.
        going.retain(|series| log.runs(series.cases(plan, level)).iter().any(|run| run.solved));
    }
    Ok(true)
}

/// One run.
fn one<M: TestRobot>(
    test_robot: &M,
    obstacles: &[Obstacle],
    case: &Case,
    cap: f64,
    cancel: &Cancel,
) -> Result<Option<Run>> {
    let planner = match case.planner.as_str() {
        "rrt" => ComparedPlanner::RRT,
        "rsrt" => ComparedPlanner::RSRT,
        "rrt-connect" => ComparedPlanner::Connect,
        other => return Err(Error::new(format!("there is no planner `{other}` here"))),
    };
    let settings =
        RunSettings { planner, inputs: INPUTS, seed: case.instance + 1, cap, cancel: cancel.clone() };
    among_boxes(test_robot, obstacles, [&case.model, &case.metric], &settings)
}

/// Plans among obstacles with states that are positions, or have velocities, under a metric. `None` when it was cancelled.
pub(super) fn among_boxes<M: TestRobot>(
    test_robot: &M,
    obstacles: &[Obstacle],
    [model, metric]: [&str; 2],
    settings: &RunSettings,
) -> Result<Option<Run>> {
    let robot = test_robot.among(obstacles)?;
    let weights = test_robot.weights();
    match (model, metric) {
        ("positions", "euclidean") => positions(test_robot, robot, Euclidean, settings),
        ("positions", "manhattan") => positions(test_robot, robot, Manhattan, settings),
        ("positions", _) => {
            let scaled = ScaledEuclidean::new(test_robot.space(), weights).into_error()?;
            positions(test_robot, robot, scaled, settings)
        }
        (_, "euclidean") => velocities(test_robot, robot, Euclidean, settings),
        (_, "manhattan") => velocities(test_robot, robot, Manhattan, settings),
        _ => {
            let (most, _) = test_robot.limits();
            let space = Product::with_velocity(test_robot.space().clone(), most).into_error()?;
            // A radian per second gets the weight of a radian; the rotation of a body has three velocities.
            let last = weights.last().copied().unwrap_or(1.0);
            let six = weights.iter().copied().chain(std::iter::repeat(last)).take(6);
            let moving: Vec<f64> = weights.iter().copied().chain(six).collect();
            let scaled = ScaledEuclidean::new(&space, moving).into_error()?;
            velocities(test_robot, robot, scaled, settings)
        }
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
        let mut log = lab.log("rsrt", 2.0).unwrap();
        assert!(measure(&plan, &lab, &mut log).unwrap());
        assert_eq!(log.all().len(), Series::all().len());
        let easy = log.all().iter().filter(|(_, run)| run.solved).count();
        assert!(easy > log.all().len() / 2, "{easy} of {} solved", log.all().len());
        let text = || std::fs::read_to_string(lab.file("rsrt-runs.jsonl")).unwrap();
        let before = text();
        let mut again = lab.log("rsrt", 2.0).unwrap();
        assert!(measure(&plan, &lab, &mut again).unwrap());
        assert_eq!(before, text());
        lab.cancel.cancel();
        let mut other = lab.log("other", 2.0).unwrap();
        assert!(!measure(&plan, &lab, &mut other).unwrap());
        assert!(other.all().is_empty());
    }
}
