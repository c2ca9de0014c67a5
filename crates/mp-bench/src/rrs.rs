//! The experiment of Baizid, Chellali, Luza, Vitezslav and Arrichiello, *RRS: rapidly-exploring random
//! snakes, a new method for mobile robot path planning*, §4 and §5: RRT against RRS in four worlds, for steps of 30 to
//! 150 cm, 100 trials each, by six measures. With `--follow`, §6: a robot follows the paths. With
//! `--flying`, a body in space; with `--pictures`, a field and a tree.

mod flying;
mod follow;
mod following;
mod pictures;
mod series;
mod solve;
mod tables;

use crate::error::Result;
use crate::experiment::Lab;
use crate::options::Common;
use clap::Args;
use series::{Plan, measure};
use tables::Found;

/// What only the suite `rrs` has.
#[derive(Clone, Copy, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `rrs`")]
pub(crate) struct Options {
    /// Let a robot with noisy wheels and a noisy laser follow the paths instead.
    #[arg(long)]
    follow: bool,
    /// Compare for a body that flies instead: RRT and RRS on `gempa-3` or the scenes given, with the same steps.
    #[arg(long, conflicts_with = "follow")]
    flying: bool,
    /// Draw what pushes snakes, and a tree whose edges bend, instead.
    #[arg(long, conflicts_with_all = ["follow", "flying"])]
    pictures: bool,
}

/// Measures. True when it was measured completely.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::new(common)?;
    if options.follow {
        return following::run(&lab, common);
    }
    if options.flying {
        return flying::run(&lab, common);
    }
    if options.pictures {
        return pictures::run(&lab);
    }
    let plan = Plan::new(common);
    let name = lab.name("rrs");
    let mut log = lab.log(&name, solve::ITERATIONS as f64)?;
    let complete = measure(&plan, &lab, &mut log)?;
    let found = Found::new(&log, &plan);
    // Of what was interrupted there may be nothing to draw.
    let charts = if complete { found.charts() } else { Vec::new() };
    lab.publish(&name, &found.markdown(), [&found.summary(), &found.each()], charts)?;
    Ok(complete)
}
