//! All series of problems, level by level.

use super::clutter::Obstacle;
use super::movers::{Flyer, Mover, SixAxes};
use super::solve::{How, Kind, Run, positions, velocities};
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use mp_cspace::{Cancel, Euclidean, Manhattan, Product, ScaledEuclidean};
use mp_plan::Error;
use serde::{Deserialize, Serialize};

/// What to measure.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) cap: f64,
    pub(super) instances: u32,
    /// Numbers of obstacles, ascending.
    pub(super) levels: Vec<usize>,
}

/// What was run.
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

/// A mover, a model, a metric and a planner, measured over levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Series {
    pub(super) mover: &'static str,
    pub(super) model: &'static str,
    pub(super) metric: &'static str,
    pub(super) planner: &'static str,
}

impl Series {
    /// All there are. RRT-Connect cannot do with velocities: trees of inputs do not meet.
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

/// Measures what is not known yet. False when it was interrupted.
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
        // A series goes on where some instance was solved.
        going.retain(|series| log.runs(series.cases(plan, level)).iter().any(|run| run.solved));
    }
    Ok(true)
}

/// One run.
fn one<M: Mover>(
    mover: &M,
    obstacles: &[Obstacle],
    case: &Case,
    cap: f64,
    cancel: &Cancel,
) -> Result<Option<Run>> {
    let kind = match case.planner.as_str() {
        "rrt" => Kind::Rrt,
        "rsrt" => Kind::Rsrt,
        "rrt-connect" => Kind::Connect,
        other => return Err(Error::new(format!("there is no planner `{other}` here"))),
    };
    let how = How { kind, seed: case.instance + 1, cap, cancel: cancel.clone() };
    let robot = mover.among(obstacles)?;
    let weights = mover.weights();
    match (case.model.as_str(), case.metric.as_str()) {
        ("positions", "euclidean") => positions(mover, robot, Euclidean, &how),
        ("positions", "manhattan") => positions(mover, robot, Manhattan, &how),
        ("positions", _) => {
            let scaled = ScaledEuclidean::new(mover.space(), weights).into_error()?;
            positions(mover, robot, scaled, &how)
        }
        (_, "euclidean") => velocities(mover, robot, Euclidean, &how),
        (_, "manhattan") => velocities(mover, robot, Manhattan, &how),
        _ => {
            let (most, _) = mover.limits();
            let space = Product::with_velocity(mover.space().clone(), most).into_error()?;
            // A radian per second moves as far in a second as a radian does; a body turns about three axes.
            let last = weights.last().copied().unwrap_or(1.0);
            let six = weights.iter().copied().chain(std::iter::repeat(last)).take(6);
            let moving: Vec<f64> = weights.iter().copied().chain(six).collect();
            let scaled = ScaledEuclidean::new(&space, moving).into_error()?;
            velocities(mover, robot, scaled, &how)
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
