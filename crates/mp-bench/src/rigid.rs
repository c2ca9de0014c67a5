//! RRT-Connect on the shipped scenes, seed by seed in turn with another program on the same problems.
//!
//! Both sides plan with motion checks at 1% of the extent and steps of `--step`, by default 20% of it as is theirs, in
//! the metric ‖Δp‖ + 0.5·angle, from the same start to the same goal in the same bounds, one thread, until the first
//! solution. Neither time includes reading files and building the trees of meshes, with us those of the verifier
//! among them. Our time includes the independent verification of candidate solutions; theirs does not verify.
//!
//! The other program is called as
//! `PEER --problem FILE.json --planner rrtconnect --seeds 1 --seed0 N --time S --range D`, D the longest step, reads what
//! [`mp_io::export_ompl`] writes and prints a line of JSON with `solved`, `time` (seconds), `checks` and
//! `valid_at_20x_finer` (0 when its path collides at twenty times finer steps).

use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, mean};
use crate::options::Common;
use crate::scenes::{Planned, Rigid, bare};
use clap::Args;
use mp_io::{OmplExport, export_ompl};
use mp_plan::{Error, Length, MotionCheck, Request, median};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::Command;

const SCENES: [&str; 4] = ["easy", "cubicles", "twisty", "apartment"];

/// What only the suite `rigid` has.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Of the suite `rigid`")]
pub(crate) struct Options {
    /// Longest edge of a tree, as a percentage of the extent of the space or a distance of the metric.
    #[arg(long, value_name = "ε", default_value = "20%")]
    step: Length,
}

/// What was run.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    step: String,
    peer: Option<PathBuf>,
    seed: u64,
}

/// What came of it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Run {
    ours: Planned,
    theirs: Option<Theirs>,
}

/// What the other program says of one run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Theirs {
    solved: u8,
    time: f64,
    checks: f64,
    valid_at_20x_finer: i32,
}

/// A scene made ready for both.
struct Place {
    rigid: Rigid,
    request: Request,
    /// The longest edge, in the metric.
    range: f64,
    /// The scene for the other program.
    file: PathBuf,
    _folder: tempfile::TempDir,
}

impl Place {
    fn new(scene: &str, step: Length, time: f64) -> Result<Self> {
        let rigid = Rigid::load(scene)?;
        let folder = tempfile::tempdir().into_error()?;
        let file =
            export_ompl(rigid.problem(), folder.path(), &rigid.problem().name, &OmplExport::default())?;
        let range = match step {
            Length::Absolute(length) => length,
            Length::Fraction(part) => part * rigid.extent(),
        };
        let motion = MotionCheck::Discrete(Length::Fraction(0.01));
        let request = bare("rrt-connect").motion(motion).time(time).set("step", step);
        Ok(Self { rigid, request, range, file, _folder: folder })
    }
}

/// Measures. True when every run of ours was solved.
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
        |case| Place::new(&case.scene, options.step, common.time),
        |place, case| {
            let request = place.request.clone().seed(case.seed);
            let Some(ours) = place.rigid.plan(&request, &lab.cancel)? else { return Ok(None) };
            let ask = |peer: &PathBuf| ask(peer, &place.file, case.seed, common.time, place.range);
            Ok(Some(Run { ours, theirs: case.peer.as_ref().map(ask).transpose()? }))
        },
    )?;
    if !complete {
        return Ok(false);
    }
    let mut each = Table::new([
        "scene",
        "seed",
        "solved",
        "s",
        "checks",
        "peer_solved",
        "peer_s",
        "peer_checks",
        "peer_path_free",
    ]);
    let mut summary = Table::new([
        "scene",
        "solved",
        "median s",
        "mean s",
        "checks (median)",
        "peer solved",
        "peer median s",
        "peer mean s",
        "peer checks (median)",
        "peer paths that collide",
        "ratio of medians",
    ]);
    let groups = log.groups(&cases, |case| case.scene.as_str());
    for (scene, runs) in &groups {
        each.rows.extend(runs.iter().map(|(case, run)| row(case, run)));
        summary.rows.push(summed_up(scene, runs));
    }
    lab.report("rigid", &summary, &each)?;
    Ok(groups.iter().flat_map(|(_, runs)| runs).all(|(_, run)| run.ours.solved))
}

/// A line of one run.
fn row(case: &Case, run: &Run) -> Vec<String> {
    let Planned { solved, seconds, queries, .. } = run.ours;
    let mut row = vec![case.scene.clone(), case.seed.to_string(), u8::from(solved).to_string()];
    row.extend([format!("{seconds:.6}"), queries.to_string()]);
    row.extend(match run.theirs {
        Some(p) => [
            p.solved.to_string(),
            format!("{:.6}", p.time),
            p.checks.to_string(),
            p.valid_at_20x_finer.to_string(),
        ],
        None => [const { String::new() }; 4],
    });
    row
}

/// A line of one scene. A run that was not solved counts with the time it was given.
fn summed_up(scene: &str, runs: &[(&Case, &Run)]) -> Vec<String> {
    let ours = || runs.iter().map(|(_, run)| run.ours);
    let theirs = || runs.iter().filter_map(|(_, run)| run.theirs);
    let show = |v: Option<f64>, digits: usize| v.map_or("–".into(), |v| format!("{v:.digits$}"));
    let count = |n: usize, of: usize| if of == 0 { "–".into() } else { format!("{n}/{of}") };
    let (own, peer) = (median(ours().map(|r| r.seconds)), median(theirs().map(|r| r.time)));
    let solved = theirs().filter(|r| r.solved == 1).count();
    let bad = theirs().filter(|r| r.solved == 1 && r.valid_at_20x_finer == 0).count();
    vec![
        scene.to_owned(),
        count(ours().filter(|r| r.solved).count(), runs.len()),
        show(own, 4),
        show(mean(ours().map(|r| r.seconds)), 4),
        show(median(ours().map(|r| r.queries as f64)), 0),
        count(solved, theirs().count()),
        show(peer, 4),
        show(mean(theirs().map(|r| r.time)), 4),
        show(median(theirs().map(|r| r.checks)), 0),
        count(bad, solved),
        show(peer.zip(own).map(|(p, m)| p / m), 1),
    ]
}

/// One run of the other program.
fn ask(program: &Path, problem: &Path, seed: u64, time: f64, range: f64) -> Result<Theirs> {
    let mut command = Command::new(program);
    command.arg("--problem").arg(problem).args(["--planner", "rrtconnect", "--seeds", "1"]);
    command.args(["--seed0", &seed.to_string(), "--time", &time.to_string()]);
    command.args(["--range", &range.to_string()]);
    let done = command.output().doing(|| format!("cannot run {}", program.display()))?;
    let text = String::from_utf8_lossy(&done.stdout);
    let line = text.lines().find(|l| l.starts_with('{')).ok_or_else(|| {
        Error::new(format!("{} printed no line of JSON", program.display()))
            .help(String::from_utf8_lossy(&done.stderr))
    })?;
    serde_json::from_str(line).doing(|| format!("cannot read what {} printed", program.display()))
}
