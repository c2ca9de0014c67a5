//! The experiments of Jouandeau, Touati and Ali Cherif 2008, *Incremental motion planning with Las Vegas algorithms*:
//! the natural expansion of an RRT (§2.4), and RRT against RSRT in worlds of 2 to 512 obstacles (§4), for a free-flyer
//! and an arm of six joints, with states that are positions or have velocities, under three metrics.
//!
//! The paper stops a series when solving takes more than 60 s on a computer of 2008; `--cap` says how
//! many seconds of processor time correspond to that here. A series also ends at the level at which no instance is solved.

mod clutter;
mod expansion;
mod robots;
mod series;
mod solve;
mod tables;

use crate::error::Result;
use crate::experiment::Lab;
use crate::options::Common;
use crate::output::note;
use clap::Args;
use clutter::LEVELS;
use mp_plan::positive_number;
use std::time::Duration;

/// Seconds of processor time that correspond to the paper's 60 s of 2008.
const CAP: f64 = 6.0;
const QUICK_CAP: f64 = 0.25;
/// Instances of each problem (§4).
const INSTANCES: u32 = 10;

/// The options of the suite `rsrt` alone.
#[derive(Clone, Copy, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `rsrt`")]
pub(crate) struct Options {
    /// Seconds of processor time per run, in place of the paper's 60 s of 2008 [default: 6; 0.25 with --quick].
    #[arg(long, value_name = "S", value_parser = positive_number)]
    cap: Option<f64>,
}

/// Runs the suite. True when it was measured completely.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::new(common)?;
    if !expansion::run(&lab, common.quick, 1)? {
        return Ok(false);
    }
    let cap = options.cap.unwrap_or(if common.quick { QUICK_CAP } else { CAP });
    let quick = usize::from(common.quick);
    let plan = series::Plan {
        cap,
        instances: common.runs_or(3, INSTANCES),
        levels: LEVELS.iter().copied().skip(quick).step_by(1 + quick).collect(),
    };
    let name = lab.name("rsrt");
    let mut log = lab.log(&name, cap)?;
    let complete = series::measure(&plan, &lab, &mut log)?;
    let results = tables::Results::new(&log, &plan);
    // An interrupted measurement may have nothing to draw.
    let charts = if complete { results.charts() } else { Vec::new() };
    lab.publish(&name, &results.markdown(), [&results.summary(), &results.each()], charts)?;
    note(&format!("{} runs of up to {:?} each", log.all().len(), Duration::from_secs_f64(cap)));
    Ok(complete)
}
