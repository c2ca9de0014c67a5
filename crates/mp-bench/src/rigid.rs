//! RRT-Connect on the shipped scenes, alternating, seed by seed, with another program on the same problems.
//!
//! Both plan on one thread until the first solution, from the same start to the same goal in the same bounds.
//! Motions are checked at 1% of the extent; steps are those of `--step`, by default 20% as in the other
//! program; the metric is ‖Δp‖ + 0.5·angle. Neither time includes reading files and building the trees of
//! meshes, our verifier's trees included. Our time includes the independent verification of candidate
//! solutions; the other program does not verify.
//!
//! The other program is called as `PEER --problem FILE.json --planner rrtconnect --seeds 1 --seed0 N --time S
//! --range
//! D`, where D is the longest step. It reads the files that [`mp_io::export_ompl`] writes, and prints a line of JSON with `solved`, `time` (seconds), `checks` and `valid_at_20x_finer`
//! (0 when its path collides at twenty times finer steps).

use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, bit, mean};
use crate::options::Common;
use crate::peer::{FirstPath, first_path};
use crate::scenes::{Planned, Rigid, bare};
use clap::Args;
use mp_io::{OmplExport, export_ompl};
use mp_plan::{Length, MotionValidator, Request, median};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

const SCENES: [&str; 4] = ["easy", "cubicles", "twisty", "apartment"];

/// The options of the suite `rigid` alone.
#[derive(Clone, Copy, Debug, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `rigid`")]
pub(crate) struct Options {
    /// Longest edge of a tree, as a percentage of the extent of the space or a distance of the metric.
    #[arg(long, value_name = "ε", default_value = "20%")]
    step: Length,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    step: String,
    peer: Option<PathBuf>,
    seed: u64,
}

/// The result of a case.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Run {
    ours: Planned,
    theirs: Option<FirstPath>,
}

/// A scene prepared for both programs.
struct PreparedScene {
    rigid: Rigid,
    request: Request,
    /// The longest edge, in the metric.
    range: f64,
    /// The scene for the other program.
    file: PathBuf,
    _folder: tempfile::TempDir,
}

impl PreparedScene {
    fn new(scene: &str, step: Length, time: f64) -> Result<Self> {
        let rigid = Rigid::load(scene)?;
        let folder = tempfile::tempdir().into_error()?;
        let file =
            export_ompl(rigid.problem(), folder.path(), &rigid.problem().name, &OmplExport::default())?;
        let range = rigid.length(step);
        let motion = MotionValidator::Discrete(Length::Fraction(0.01));
        let request = bare("rrt-connect").motion(motion).time(time).set("step", step);
        Ok(Self { rigid, request, range, file, _folder: folder })
    }
}

/// Runs the suite. True when every run of ours was solved.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::one_at_a_time(common)?;
    let mut log = lab.log("rigid", common.time)?;
    let seeds = u64::from(common.runs_or(3, 20));
    let (step, peer) = (options.step.to_string(), &common.peer);
    let case =
        |scene: &String, seed| Case { scene: scene.clone(), step: step.clone(), peer: peer.clone(), seed };
    let scenes = common.scenes_or(&SCENES);
    let cases: Vec<Case> =
        scenes.iter().flat_map(|scene| (1..=seeds).map(move |seed| case(scene, seed))).collect();
    let complete = lab.measure_in(
        &mut log,
        "rigid",
        &cases,
        |a, b| a.scene == b.scene,
        |case| PreparedScene::new(&case.scene, options.step, common.time),
        |prepared, case| {
            let request = prepared.request.clone().seed(case.seed);
            let Some(ours) = prepared.rigid.plan(&request, &lab.cancel)? else { return Ok(None) };
            let ask = |peer: &PathBuf| {
                first_path(peer, &prepared.file, "rrtconnect", case.seed, common.time, prepared.range)
            };
            Ok(Some(Run { ours, theirs: case.peer.as_ref().map(ask).transpose()? }))
        },
    )?;
    if !complete {
        return Ok(false);
    }
    let peer = |run: &Run, cell: &dyn Fn(FirstPath) -> String| run.theirs.map(cell).unwrap_or_default();
    let each = Table::of(
        log.each(&cases),
        &[
            ("scene", &|(case, _)| case.scene.clone()),
            ("seed", &|(case, _)| case.seed.to_string()),
            ("solved", &|(_, run)| bit(run.ours.solved)),
            ("s", &|(_, run)| format!("{:.6}", run.ours.seconds)),
            ("checks", &|(_, run)| run.ours.queries.to_string()),
            ("peer_solved", &|(_, run)| peer(run, &|p| p.solved.to_string())),
            ("peer_s", &|(_, run)| peer(run, &|p| format!("{:.6}", p.time))),
            ("peer_checks", &|(_, run)| peer(run, &|p| p.checks.to_string())),
            ("peer_path_free", &|(_, run)| peer(run, &|p| p.valid_at_20x_finer.to_string())),
        ],
    );
    let show = |v: Option<f64>, digits: usize| v.map_or("–".into(), |v| format!("{v:.digits$}"));
    let share = |n: usize, of: usize| if of == 0 { "–".into() } else { format!("{n}/{of}") };
    let groups = log.groups(&cases, |case| &case.scene);
    let solved = groups.iter().all(|group| group.runs.iter().all(|(_, run)| run.ours.solved));
    // A run that was not solved counts with its time limit.
    let summary = Table::of(
        groups
            .iter()
            .map(|group| (group, group.runs.iter().filter_map(|(_, r)| r.theirs).collect::<Vec<_>>())),
        &[
            ("scene", &|(g, _)| g.key.clone()),
            ("solved", &|(g, _)| share(g.count(|r| r.ours.solved), g.runs.len())),
            ("median s", &|(g, _)| show(median(g.values(|r| r.ours.seconds)), 4)),
            ("mean s", &|(g, _)| show(mean(g.values(|r| r.ours.seconds)), 4)),
            ("checks (median)", &|(g, _)| show(median(g.values(|r| r.ours.queries as f64)), 0)),
            ("peer solved", &|(_, p)| share(solutions(p).count(), p.len())),
            ("peer median s", &|(_, p)| show(median(p.iter().map(|r| r.time)), 4)),
            ("peer mean s", &|(_, p)| show(mean(p.iter().map(|r| r.time)), 4)),
            ("peer checks (median)", &|(_, p)| show(median(p.iter().map(|r| r.checks)), 0)),
            ("peer paths that collide", &|(_, p)| {
                share(solutions(p).filter(|r| r.valid_at_20x_finer == 0).count(), solutions(p).count())
            }),
            ("ratio of medians", &|(g, p)| {
                let medians = median(p.iter().map(|r| r.time)).zip(median(g.values(|r| r.ours.seconds)));
                show(medians.map(|(theirs, ours)| theirs / ours), 1)
            }),
        ],
    );
    lab.report("rigid", &summary.markdown(), &each.made_at(log.commits(&cases)))?;
    Ok(solved)
}

/// The runs that the other program solved.
fn solutions(theirs: &[FirstPath]) -> impl Iterator<Item = &FirstPath> {
    theirs.iter().filter(|run| run.solved == 1)
}
