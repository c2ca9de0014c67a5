//! The experiment of Baizid, Chellali, Luza, Vitezslav and Arrichiello, *RRS: rapidly-exploring random
//! snakes, a new method for mobile robot path planning*, §4 and §5: RRT against RRS in four worlds, for steps
//! of 30 to 150 cm, 100 trials each, by six measures. With `--follow`, §6: a simulated robot follows the
//! paths. With `--flying`, a body in space; with `--pictures`, pictures of a field and of a tree.

mod flying;
mod follow_suite;
mod pictures;
mod series;
mod tables;

use crate::error::Result;
use crate::experiment::Lab;
use crate::options::Common;
use clap::Args;
use mp_experiments::rrs::ITERATIONS;
use series::{Plan, measure};
use tables::Results;

/// The options of the suite `rrs` alone.
#[derive(Clone, Copy, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `rrs`")]
pub(crate) struct Options {
    /// Instead, let a robot with noisy wheels and a noisy laser follow the paths.
    #[arg(long)]
    follow: bool,
    /// Instead, compare RRT and RRS for a body in space, on `gempa-3` or the given scenes, with the same
    /// steps.
    #[arg(long, conflicts_with = "follow")]
    flying: bool,
    /// Instead, draw the field that pushes snakes, a tree with bent edges, a path relaxed, and the landscape
    /// of risk.
    #[arg(long, conflicts_with_all = ["follow", "flying"])]
    pictures: bool,
}

/// Runs the suite. True when it was measured completely.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::new(common)?;
    if options.follow {
        return follow_suite::run(&lab, common);
    }
    if options.flying {
        return flying::run(&lab, common);
    }
    if options.pictures {
        return pictures::run(&lab);
    }
    let plan = Plan::new(common);
    let name = lab.name("rrs");
    let mut log = lab.log(&name, ITERATIONS as f64)?;
    let complete = measure(&plan, &lab, &mut log)?;
    let results = Results { log: &log, plan: &plan };
    // An interrupted measurement may have nothing to draw.
    let charts = if complete { results.charts() } else { Vec::new() };
    lab.text(&name, &results.markdown())?;
    lab.charts(&name, charts)?;
    lab.report(&format!("{name}-summary"), &results.summary().markdown(), &results.each())?;
    Ok(complete)
}
