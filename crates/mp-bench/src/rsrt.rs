//! The experiments of Jouandeau, Touati and Ali Cherif 2008, *Incremental motion planning with Las Vegas algorithms*:
//! the natural expansion of an RRT (§2.4), and RRT against RSRT in worlds of 2 to 512 obstacles (§4), for a free-flyer
//! and an arm of six joints, as positions and with velocities, under three metrics.
//!
//! The paper stops a series when solving takes more than 60 s of a computer of 2008; `--cap` says how
//! many seconds of processor time stand for them here. A series ends as well where no instance is solved.

mod clutter;
mod expansion;
mod movers;
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

/// Seconds of processor time that stand for the paper's 60 s of 2008.
const CAP: f64 = 6.0;
const QUICK_CAP: f64 = 0.25;
/// Instances of each problem (§4).
const INSTANCES: u32 = 10;

/// What only the suite `rsrt` has.
#[derive(Clone, Copy, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `rsrt`")]
pub(crate) struct Options {
    /// Seconds of processor time a run may take, for the paper's 60 s of 2008 [default: 6; 0.25 with --quick].
    #[arg(long, value_name = "S", value_parser = positive_number)]
    cap: Option<f64>,
}

/// Measures. True when it was measured completely.
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
    let found = tables::Found::new(&log, &plan);
    // Of what was interrupted there may be nothing to draw.
    let charts = if complete { found.charts() } else { Vec::new() };
    lab.publish(&name, &found.markdown(), [&found.summary(), &found.each()], charts)?;
    note(&format!("{} runs of up to {:?} each", log.all().len(), Duration::from_secs_f64(cap)));
    Ok(complete)
}
