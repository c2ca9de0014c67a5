//! RRT-Connect on the shipped scenes, seed by seed in turn with another program on the same problems.
//!
//! Both sides plan with motion checks at 1% of the extent and steps of `--step`, by default 20% of it as is theirs, in
//! the metric ‖Δp‖ + 0.5·angle, from the same start to the same goal in the same bounds, one thread, until the first
//! solution. Neither time includes reading files and building the trees of meshes, with us those of the verifier
//! among them. Our time includes the independent verification of candidate solutions; theirs does not verify.
//!
//! The other program is called as
//! `PEER --problem FILE.json --planner rrtconnect --seeds 1 --seed0 N --time S --range D`, D the longest step, reads what
//! `plan --export` writes and prints a line of JSON with `solved`, `time` (seconds), `checks` and
//! `valid_at_20x_finer` (0 when its path collides at twenty times finer steps).

use super::{Table, median, report};
use crate::cli::{self, Length, Motion};
use crate::output::note;
use crate::plan::{Options, Ready, planned};
use crate::scenes;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde::Deserialize;
use std::path::Path;
use std::process::Command;

const SCENES: [&str; 4] = ["easy", "cubicles", "twisty", "apartment"];

/// What the other program says of one run.
#[derive(Clone, Copy, Debug, Deserialize)]
struct Theirs {
    solved: u8,
    time: f64,
    checks: f64,
    valid_at_20x_finer: i32,
}

/// Measures. True when every run of ours was solved.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    let named: Vec<String> = match args.scenes.as_slice() {
        [] => SCENES.map(str::to_owned).to_vec(),
        given => given.to_vec(),
    };
    let seeds = args.runs.unwrap_or(if args.quick { 3 } else { 20 });
    let mut options =
        Options::comparable("rrt-connect", Motion::Discrete(Length::Fraction(0.01)), args.time)?;
    options.settings.set("step", &args.step.to_string());
    let problems = tempfile::tempdir().into_diagnostic()?;
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
    let mut all = true;
    for name in &named {
        let ready = Ready::load(&scenes::find(Path::new(name))?)?;
        ready.check_ends()?;
        let file = match &args.peer {
            Some(_) => Some(ready.export(problems.path())?),
            None => None,
        };
        let range = match args.step {
            Length::Absolute(length) => length,
            Length::Fraction(part) => part * ready.extent(),
        };
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for seed in 1..=u64::from(seeds) {
            let own = planned(&ready, &options, seed)?;
            let peer = match (&args.peer, &file) {
                (Some(program), Some(file)) => Some(ask(program, file, seed, args.time, range)?),
                _ => None,
            };
            note(&format!(
                "{name} seed {seed}: {:.4} s{}",
                own.seconds,
                peer.map(|p| format!(", peer {:.4} s", p.time)).unwrap_or_default()
            ));
            let mut row = vec![name.clone(), seed.to_string(), u8::from(own.solved).to_string()];
            row.extend([format!("{:.6}", own.seconds), own.queries.to_string()]);
            row.extend(match peer {
                Some(p) => [
                    p.solved.to_string(),
                    format!("{:.6}", p.time),
                    p.checks.to_string(),
                    p.valid_at_20x_finer.to_string(),
                ],
                None => [const { String::new() }; 4],
            });
            each.rows.push(row);
            ours.push(own);
            theirs.extend(peer);
        }
        all &= ours.iter().all(|r| r.solved);
        // A run that was not solved counts with the time it was given.
        let seconds: Vec<f64> = ours.iter().map(|r| r.seconds).collect();
        let checks: Vec<f64> = ours.iter().map(|r| r.queries as f64).collect();
        let peer_seconds: Vec<f64> = theirs.iter().map(|r| r.time).collect();
        let peer_checks: Vec<f64> = theirs.iter().map(|r| r.checks).collect();
        let show = |v: Option<f64>, digits: usize| v.map_or("–".into(), |v| format!("{v:.digits$}"));
        let (mine, peer) = (median(&seconds), median(&peer_seconds));
        let count = |n: usize, of: usize| if of == 0 { "–".into() } else { format!("{n}/{of}") };
        let solved = theirs.iter().filter(|r| r.solved == 1).count();
        let bad = theirs.iter().filter(|r| r.solved == 1 && r.valid_at_20x_finer == 0).count();
        summary.rows.push(vec![
            name.clone(),
            count(ours.iter().filter(|r| r.solved).count(), ours.len()),
            show(mine, 4),
            show(mean(&seconds), 4),
            show(median(&checks), 0),
            count(solved, theirs.len()),
            show(peer, 4),
            show(mean(&peer_seconds), 4),
            show(median(&peer_checks), 0),
            count(bad, solved),
            show(peer.zip(mine).map(|(p, m)| p / m), 1),
        ]);
    }
    report(args, "rigid", &summary, &each)?;
    Ok(all)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// One run of the other program.
fn ask(program: &Path, problem: &Path, seed: u64, time: f64, range: f64) -> Result<Theirs> {
    let mut command = Command::new(program);
    command.arg("--problem").arg(problem).args(["--planner", "rrtconnect", "--seeds", "1"]);
    command.args(["--seed0", &seed.to_string(), "--time", &time.to_string()]);
    command.args(["--range", &range.to_string()]);
    let done =
        command.output().into_diagnostic().wrap_err_with(|| format!("cannot run {}", program.display()))?;
    let text = String::from_utf8_lossy(&done.stdout);
    let line = text.lines().find(|l| l.starts_with('{')).ok_or_else(|| {
        miette!(
            help = String::from_utf8_lossy(&done.stderr).into_owned(),
            "{} printed no line of JSON",
            program.display()
        )
    })?;
    serde_json::from_str(line)
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot read what {} printed", program.display()))
}
