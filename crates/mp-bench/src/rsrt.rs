//! The experiments of Jouandeau, Touati and Ali Cherif 2008, *Incremental motion planning with Las Vegas
//! algorithms*, in four parts. The first is the natural expansion of an RRT (§2.4). The second is a factorial
//! experiment on what RSRT changes, over the number of inputs (§3.2). The third restarts runs with heavy
//! tails. The fourth compares RRT with RSRT in worlds of 2 to 512 obstacles (§4): a free-flyer and an arm of
//! six joints, positions alone or with velocities, three metrics.
//!
//! The paper stops a series when solving takes more than 60 s on a computer of 2008; `--cap` says how many
//! seconds of processor time correspond to that here. A series also ends at the level at which no instance is
//! solved.

mod expansion;
mod factorial;
mod factorial_tables;
mod in_scene;
mod restarts;
mod restarts_tables;
mod series;
mod tables;

use crate::error::Result;
use crate::experiment::{Lab, sections};
use crate::options::Common;
use crate::output::note;
use clap::{Args, ValueEnum};
use mp_experiments::clutter::LEVELS;
use mp_plan::{Error, positive_number};
use std::time::Duration;

/// Seconds of processor time that correspond to the paper's 60 s of 2008.
const CAP: f64 = 6.0;
const QUICK_CAP: f64 = 0.25;
/// Instances of each problem (§4).
const INSTANCES: u32 = 10;
/// Seeds of each cell of the factorial experiment, and of each schedule of restarts.
const SEEDS: u32 = 20;
const RESTARTED_SEEDS: u32 = 100;

/// A part of the suite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Triangles of a tree that grows in a free square.
    Expansion,
    /// Order × acceptance × number of inputs.
    Factorial,
    /// Schedules of restarts.
    Restarts,
    /// RRT and RSRT among 2 to 512 obstacles.
    Clutter,
}

/// The options of the suite `rsrt` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `rsrt`")]
pub(crate) struct Options {
    /// Seconds of processor time per run, in place of the paper's 60 s of 2008 [default: 6; 0.25 with
    /// --quick].
    #[arg(long, value_name = "S", value_parser = positive_number)]
    cap: Option<f64>,
    /// A part to run [default: all].
    #[arg(long = "part", value_name = "PART")]
    parts: Vec<Part>,
}

/// Runs the suite. True when it was measured completely.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::new(common)?;
    let cap = options.cap.unwrap_or(if common.quick { QUICK_CAP } else { CAP });
    let part = |part: Part| options.parts.is_empty() || options.parts.contains(&part);
    if part(Part::Expansion) && !expansion::run(&lab, common.quick, 1)? {
        return Ok(false);
    }
    Ok((!part(Part::Factorial) || run_factorial(&lab, common, cap)?)
        && (!part(Part::Restarts) || run_restarts(&lab, common, cap)?)
        && (!part(Part::Clutter) || run_clutter(&lab, common, cap)?))
}

/// The problems whose names contain one of the scenes given; all, if none is given.
fn chosen<P: Clone>(common: &Common, all: &[P], name: impl Fn(&P) -> &'static str) -> Result<Vec<P>> {
    let given = &common.scenes;
    let wanted = |p: &&P| given.is_empty() || given.iter().any(|scene| name(p).contains(scene.as_str()));
    let chosen: Vec<P> = all.iter().filter(wanted).cloned().collect();
    if chosen.is_empty() {
        let names: Vec<&str> = all.iter().map(name).collect();
        let message = format!("no problem has `{}` in its name", given.join("` or `"));
        return Err(Error::new(message).help(format!("the problems are: {}", names.join("; "))));
    }
    Ok(chosen)
}

fn run_factorial(lab: &Lab, common: &Common, cap: f64) -> Result<bool> {
    let quick = common.quick;
    let plan = factorial::Plan {
        seeds: common.runs_or(2, SEEDS).into(),
        inputs: factorial::INPUTS.iter().copied().take(if quick { 2 } else { 4 }).collect(),
        problems: chosen(common, &factorial::PROBLEMS, |p| p.name)?,
        cap,
    };
    let name = lab.name("rsrt-factorial");
    let mut log = lab.log(&name, cap)?;
    if !factorial::measure(&plan, lab, &mut log)? {
        return Ok(false);
    }
    let results = factorial_tables::Results { log: &log, plan: &plan };
    let text = sections(3, &results.headline());
    let details = results
        .by_problem()
        .into_iter()
        .chain([("Solved runs and median times, s".into(), results.corners())]);
    lab.write(&format!("{name}-by-problem.md"), &sections(3, &details.collect::<Vec<_>>()))?;
    lab.report(&name, &text, &log.table(&plan.cases())?)?;
    lab.charts(&name, results.charts())?;
    Ok(true)
}

fn run_restarts(lab: &Lab, common: &Common, cap: f64) -> Result<bool> {
    let plan = restarts::Plan {
        seeds: common.runs_or(2, RESTARTED_SEEDS).into(),
        problems: chosen(common, &restarts::PROBLEMS, |p| p.name)?,
        cap,
    };
    let name = lab.name("rsrt-restarts");
    let mut log = lab.log(&name, cap)?;
    if !restarts::measure(&plan, lab, &mut log)? {
        return Ok(false);
    }
    let results = restarts_tables::Results { log: &log, plan: &plan };
    let text = results.summary().markdown() + "\n";
    lab.report(&name, &text, &log.table(&plan.cases())?)?;
    lab.charts(&name, results.charts())?;
    Ok(true)
}

fn run_clutter(lab: &Lab, common: &Common, cap: f64) -> Result<bool> {
    let quick = usize::from(common.quick);
    let plan = series::Plan {
        cap,
        instances: common.runs_or(3, INSTANCES),
        levels: LEVELS.iter().copied().skip(quick).step_by(1 + quick).collect(),
    };
    let name = lab.name("rsrt-clutter");
    let mut log = lab.log(&name, cap)?;
    let complete = series::measure(&plan, lab, &mut log)?;
    let results = tables::Results { log: &log, plan: &plan };
    lab.text(&format!("{name}-claims"), &results.markdown())?;
    lab.charts(&name, results.charts())?;
    lab.report(&name, &results.summary().markdown(), &log.table(&plan.cases())?)?;
    note(&format!("{} runs of up to {:?} each", log.all().len(), Duration::from_secs_f64(cap)));
    Ok(complete)
}
