//! Graded scenes × planners: `auto`, RRT-Connect and the best single planners, to the first verified path, in
//! processor time; with `--peer` also planners of another program, on the same problems.
//!
//! A run that is not solved within `--time` was cut short, ours at nine tenths of it, as the last is for the
//! proof: curves and intervals are those of survival analysis. The other program is called as by the suite
//! `rigid`, with `rrtconnect`, `bitstar`, `kpiece` and `est`; its paths that collide at twenty times finer
//! steps count as not solved.

mod tables;

use crate::clock::processor_clock;
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log, sections};
use crate::options::Common;
use crate::peer;
use crate::scenes::{Rigid, bare, problem};
use clap::Args;
use mp_cspace::Cancel;
use mp_io::{OmplExport, export_ompl};
use mp_plan::{Control, Error, Request, Scene, StoppedBy};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// The planners, each with its settings.
const PLANNERS: [&str; 8] = [
    "auto",
    "rrt-connect",
    "obrrt-connect step=1% walks=0.5 balance=1",
    "obrrt-connect step=0.3% balance=1",
    "obrrt step=1%",
    "retraction-rrt",
    "rrt-connect step=1%",
    "bridge-prm metric=scaled",
];
/// Those of the other program, after this word; without `range` with its own longest step, a fifth of the
/// extent.
const PEER: &str = "peer ";
const PEERS: [&str; 5] =
    ["peer rrtconnect", "peer rrtconnect range=5%", "peer bitstar", "peer kpiece", "peer est"];
/// Seconds of a run of a short measurement.
const QUICK_CAP: f64 = 1.0;

/// The options of the suite `puzzles` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `puzzles`")]
pub(crate) struct Options {
    /// A planner to measure, with its settings and metric: `rrt-connect step=1% metric=scaled` [default: auto
    /// and seven others].
    #[arg(long = "planner", value_name = "PLANNER")]
    planners: Vec<String>,
    /// Only scenes of this grade or below.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..))]
    grade: Option<u8>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    planner: String,
    seed: u64,
}

/// The result of a case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Run {
    solved: bool,
    seconds: f64,
    iterations: u64,
    queries: u64,
    /// Of `auto`, the search that has found the path.
    won: Option<String>,
}

/// The size of the measurement.
#[derive(Clone, Debug)]
struct Plan {
    scenes: Vec<String>,
    planners: Vec<String>,
    seeds: u64,
    cap: f64,
}

impl Plan {
    fn new(common: &Common, options: &Options) -> Self {
        let graded = mp_scenes::PUZZLES.iter().filter(|p| options.grade.is_none_or(|most| p.grade <= most));
        let graded: Vec<&str> = graded.map(|puzzle| puzzle.scene).collect();
        let peers = if common.peer.is_some() { &PEERS[..] } else { &[] };
        let own = || PLANNERS.iter().chain(peers).map(|planner| (*planner).to_owned()).collect();
        Self {
            scenes: common.scenes_or(&graded),
            planners: if options.planners.is_empty() { own() } else { options.planners.clone() },
            seeds: common.runs_or(1, 20).into(),
            cap: if common.quick { common.time.min(QUICK_CAP) } else { common.time },
        }
    }

    fn runs(&self, scene: &str, planner: &str) -> impl Iterator<Item = Case> {
        let [scene, planner] = [scene, planner].map(str::to_owned);
        (1..=self.seeds).map(move |seed| Case { scene: scene.clone(), planner: planner.clone(), seed })
    }

    /// All cases, seed by seed.
    fn cases(&self) -> Vec<Case> {
        let of = |seed| {
            self.scenes.iter().flat_map(move |scene| {
                self.planners.iter().map(move |planner| Case {
                    scene: scene.clone(),
                    planner: planner.clone(),
                    seed,
                })
            })
        };
        (1..=self.seeds).flat_map(of).collect()
    }
}

/// Runs the suite. True when it was measured completely; a scene that is not solved in time is a result.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::new(common)?;
    let plan = Plan::new(common, options);
    let name = lab.name("puzzles");
    let mut log = lab.log(&name, plan.cap)?;
    if !measure(&plan, &lab, &mut log, common.peer.as_ref())? {
        return Ok(false);
    }
    let results = tables::Results { log: &log, plan: &plan };
    lab.report(&name, &sections(2, &results.tables()), &log.table(&plan.cases())?)?;
    lab.charts(&name, results.charts())?;
    Ok(true)
}

/// Runs the cases that are not in the log. False when it was interrupted.
fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>, peer: Option<&PathBuf>) -> Result<bool> {
    lab.measure_in(
        log,
        "puzzles",
        &plan.cases(),
        |a, b| (a.seed, &a.scene) == (b.seed, &b.scene),
        |case| Scene::find(&case.scene),
        |scene, case| match case.planner.strip_prefix(PEER) {
            None => planned(scene, &request(&case.planner)?.time(plan.cap).seed(case.seed), &lab.cancel),
            Some(planner) => {
                let program = peer.ok_or_else(|| {
                    Error::new(format!("`{}` is a planner of another program", case.planner))
                        .help("name the program: --peer PROGRAM")
                })?;
                asked(program, case, planner, plan.cap).map(Some)
            }
        },
    )
}

/// The request for the first path of a planner that is written as `NAME SETTING=VALUE …`, where a setting may
/// be the metric.
fn request(planner: &str) -> Result<Request> {
    let mut words = planner.split_whitespace();
    let request = bare(words.next().unwrap_or_default());
    words.try_fold(request, |request, word| match word.strip_prefix("metric=") {
        Some(metric) => Ok(Request { metric: metric.parse()?, ..request }),
        None => request.set_each(&[word.to_owned()]),
    })
}

/// A run of ours; `None` when it was interrupted.
fn planned(scene: &Scene, request: &Request, cancel: &Cancel) -> Result<Option<Run>> {
    let mut control = Control { cancel: cancel.clone(), clock: processor_clock(), ..Control::default() };
    let report = scene.plan_with(request, &mut control)?;
    let run = Run {
        solved: report.solved,
        seconds: report.time_s,
        iterations: report.iterations,
        queries: report.collision_checks,
        won: report.won,
    };
    Ok((report.stopped_by != Some(StoppedBy::Interrupted)).then_some(run))
}

/// A run of the other program.
fn asked(program: &Path, case: &Case, planner: &str, cap: f64) -> Result<Run> {
    let folder = tempfile::tempdir().into_error()?;
    let problem = problem(&case.scene)?;
    let file = export_ompl(&problem, folder.path(), &problem.name, &OmplExport::default())?;
    let (planner, range) = match planner.split_once(" range=") {
        Some((planner, range)) => (planner, Rigid::new(problem)?.length(range.parse().into_error()?)),
        None => (planner, 0.0),
    };
    let found = peer::first_path(program, &file, planner, case.seed, cap, range)?;
    Ok(Run {
        solved: found.solved == 1 && found.valid_at_20x_finer != 0,
        seconds: found.cpu.unwrap_or(found.time),
        queries: found.checks as u64,
        ..Run::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_run_once_and_the_same_again() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Lab::test(folder.path(), 2);
        let plan = Plan {
            scenes: vec!["easy".to_owned()],
            planners: PLANNERS[..3].iter().map(|planner| (*planner).to_owned()).collect(),
            seeds: 2,
            cap: 20.0,
        };
        let mut log = lab.log("puzzles", plan.cap).unwrap();
        assert!(measure(&plan, &lab, &mut log, None).unwrap());
        assert_eq!(log.all().len(), 6);
        for seed in 1..=2 {
            let [auto, connect] = [0, 1].map(|i| log.runs(plan.runs("easy", PLANNERS[i]))[seed - 1]);
            assert!(auto.solved && connect.solved && connect.won.is_none());
            assert_eq!(auto.won.as_deref(), Some("rrt-connect balance=1"));
        }
        let mut again = lab.log("again", plan.cap).unwrap();
        assert!(measure(&plan, &lab, &mut again, None).unwrap());
        for ((_, a), (_, b)) in log.all().into_iter().zip(again.all()) {
            assert_eq!(a.queries, b.queries);
        }
        let theirs = Plan { planners: vec![PEERS[0].to_owned()], ..plan };
        assert!(measure(&theirs, &lab, &mut again, None).unwrap_err().remedy().unwrap().contains("--peer"));
    }

    #[test]
    fn graded_scenes_and_planners_are_there() {
        let plan = Plan::new(&Common::test(), &Options::default());
        assert!(plan.scenes.len() >= 12 && plan.planners.len() == PLANNERS.len());
        for scene in &plan.scenes {
            problem(scene).unwrap();
        }
        for planner in &plan.planners {
            request(planner).unwrap().check().unwrap();
        }
        assert_eq!(request(PLANNERS[7]).unwrap().metric, mp_plan::MetricName::Scaled);
        let easy = Plan::new(&Common::test(), &Options { grade: Some(1), ..Options::default() });
        assert!(!easy.scenes.is_empty() && easy.scenes.len() < plan.scenes.len());
    }
}
