//! All series of problems, level by level.

use super::clutter::Obstacle;
use super::movers::{Flyer, Mover, SixAxes};
use super::record::{Case, Run};
use super::solve::{How, Kind, positions, velocities};
use crate::bench::log::Log;
use crate::plan::progress;
use miette::{IntoDiagnostic, Result, miette};
use mp::cspace::{Cancel, Euclidean, Manhattan, Product, ScaledEuclidean};
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// What to measure.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) cap: f64,
    pub(super) instances: u32,
    /// Numbers of obstacles, ascending.
    pub(super) levels: Vec<usize>,
    pub(super) threads: Option<u16>,
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
}

/// Whether a series is worth going on with at the level after `level`: some instance was solved, or is not known.
fn goes_on(log: &Log<Case, Run>, plan: &Plan, series: &Series, level: usize) -> bool {
    (0..u64::from(plan.instances))
        .any(|instance| log.get(&series.case(level, instance)).is_none_or(|run| run.solved))
}

/// Measures what is not known yet. False when it was interrupted.
pub(super) fn measure(plan: &Plan, log: &mut Log<Case, Run>, cancel: &Cancel) -> Result<bool> {
    let (flyer, arm) = (Flyer::new()?, SixAxes::new()?);
    let most = plan.levels.last().copied().unwrap_or(0);
    let instances = 0..u64::from(plan.instances);
    let flying: Vec<Vec<Obstacle>> =
        instances.clone().map(|i| flyer.obstacles(most, i)).collect::<Result<_>>()?;
    let reaching: Vec<Vec<Obstacle>> = instances.map(|i| arm.obstacles(most, i)).collect::<Result<_>>()?;
    let threads = plan.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_diagnostic()?;
    let mut going = Series::all();
    let bar = progress::runs(going.len() * plan.levels.len() * plan.instances as usize, true);
    for &level in &plan.levels {
        let jobs: Vec<(Series, u64)> = going
            .iter()
            .flat_map(|s| (0..u64::from(plan.instances)).map(|i| (*s, i)))
            .filter(|(s, i)| log.get(&s.case(level, *i)).is_none())
            .collect();
        bar.set_message(format!("{level} obstacles"));
        bar.inc((going.len() * plan.instances as usize - jobs.len()) as u64);
        let done: Vec<Result<Option<(Case, Run)>>> = pool.install(|| {
            let job = |&(series, instance): &(Series, u64)| {
                if cancel.0.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let world = |all: &Vec<Vec<Obstacle>>| all[instance as usize][..level].to_vec();
                let done = match series.mover {
                    "free-flyer" => one(&flyer, &world(&flying), series, instance, plan.cap, cancel),
                    _ => one(&arm, &world(&reaching), series, instance, plan.cap, cancel),
                }?;
                bar.inc(1);
                let Some(run) = done else { return Ok(None) };
                let case = series.case(level, instance);
                log.write(&case, &run)?;
                Ok(Some((case, run)))
            };
            // The slow ones first would be better, but nobody knows them.
            jobs.par_iter().with_max_len(1).map(job).collect()
        });
        for each in done {
            log.learn(each?);
        }
        if cancel.0.load(Ordering::Relaxed) {
            bar.finish_and_clear();
            return Ok(false);
        }
        let before = going.len();
        going.retain(|series| goes_on(log, plan, series, level));
        let rest = plan.levels.iter().filter(|l| **l > level).count();
        bar.inc(((before - going.len()) * rest * plan.instances as usize) as u64);
    }
    bar.finish_and_clear();
    Ok(true)
}

/// One run.
fn one<M: Mover>(
    mover: &M,
    obstacles: &[Obstacle],
    series: Series,
    instance: u64,
    cap: f64,
    cancel: &Cancel,
) -> Result<Option<Run>> {
    let kind = match series.planner {
        "rrt" => Kind::Rrt,
        "rsrt" => Kind::Rsrt,
        "rrt-connect" => Kind::Connect,
        other => return Err(miette!("there is no planner `{other}` here")),
    };
    let how = How { kind, seed: instance + 1, cap, cancel: cancel.clone() };
    let robot = mover.among(obstacles)?;
    let weights = mover.weights();
    match (series.model, series.metric) {
        ("positions", "euclidean") => positions(mover, robot, Euclidean, &how),
        ("positions", "manhattan") => positions(mover, robot, Manhattan, &how),
        ("positions", _) => {
            let scaled = ScaledEuclidean::new(mover.space(), weights).into_diagnostic()?;
            positions(mover, robot, scaled, &how)
        }
        (_, "euclidean") => velocities(mover, robot, Euclidean, &how),
        (_, "manhattan") => velocities(mover, robot, Manhattan, &how),
        _ => {
            let (most, _) = mover.limits();
            let space = Product::with_velocity(mover.space().clone(), most).into_diagnostic()?;
            // A radian per second moves as far in a second as a radian does; a body turns about three axes.
            let last = weights.last().copied().unwrap_or(1.0);
            let six = weights.iter().copied().chain(std::iter::repeat(last)).take(6);
            let moving: Vec<f64> = weights.iter().copied().chain(six).collect();
            let scaled = ScaledEuclidean::new(&space, moving).into_diagnostic()?;
            velocities(mover, robot, scaled, &how)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> Plan {
        Plan { cap: 2.0, instances: 1, levels: vec![2], threads: Some(2) }
    }

    #[test]
    fn every_series_is_run_and_nothing_twice() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.jsonl");
        let mut log = Log::open(&path, 2.0, false).unwrap();
        let cancel = Cancel::new();
        assert!(measure(&plan(), &mut log, &cancel).unwrap());
        assert_eq!(log.all().len(), Series::all().len());
        let easy = log.all().iter().filter(|(_, run)| run.solved).count();
        assert!(easy > log.all().len() / 2, "{easy} of {} solved", log.all().len());
        let text = std::fs::read_to_string(&path).unwrap();
        let mut again = Log::open(&path, 2.0, false).unwrap();
        assert!(measure(&plan(), &mut again, &cancel).unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        cancel.cancel();
        let mut fresh = Log::open(&path, 2.0, true).unwrap();
        assert!(!measure(&plan(), &mut fresh, &cancel).unwrap());
        assert!(fresh.all().is_empty());
    }
}
