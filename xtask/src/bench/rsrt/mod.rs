//! `bench rsrt`: the experiments of Jouandeau, Touati and Ali Cherif 2008, *Incremental motion planning with
//! Las Vegas algorithms*: the natural expansion of an RRT (§2.4), and RRT against RSRT in worlds of 2 to 512
//! obstacles (§4), for a free-flyer and an arm of six joints, as positions and with velocities, under three
//! metrics.
//!
//! The paper stops a series when solving takes more than 60 s of a computer of 2008; `--cap` says how
//! many seconds of processor time stand for them here. A series ends as well where no instance is solved.

mod clutter;
mod expansion;
mod movers;
mod record;
mod series;
mod solve;
mod tables;

use super::chart::Labels;
use super::log::Log;
use super::report;
use crate::cli;
use crate::output::{note, print, write};
use clutter::LEVELS;
use miette::Result;
use mp::cspace::Cancel;
use std::time::Duration;

/// Seconds of processor time that stand for the paper's 60 s of 2008.
const CAP: f64 = 6.0;
const QUICK_CAP: f64 = 0.25;
/// Instances of each problem (§4).
const INSTANCES: u32 = 10;

/// Measures. True when it was measured completely.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    expansion::run(args, 1)?;
    let cap = args.rsrt.cap.unwrap_or(if args.quick { QUICK_CAP } else { CAP });
    let plan = series::Plan {
        cap,
        instances: args.runs.unwrap_or(if args.quick { 3 } else { INSTANCES }),
        levels: LEVELS
            .iter()
            .copied()
            .skip(usize::from(args.quick))
            .step_by(1 + usize::from(args.quick))
            .collect(),
        threads: args.rsrt.threads,
    };
    let name = if args.quick { "rsrt-quick" } else { "rsrt" };
    let mut log = Log::open(&args.out.join(format!("{name}-runs.jsonl")), cap, args.rsrt.fresh)?;
    let cancel = Cancel(crate::plan::interrupt::flag());
    let complete = series::measure(&plan, &mut log, &cancel)?;
    if !complete {
        note("interrupted: the same command goes on from here");
    }
    let found = tables::Found::new(&log, &plan);
    let (summary, each) = (found.summary(), found.each());
    let markdown = found.markdown();
    print(&markdown)?;
    write(&args.out.join(format!("{name}.md")), markdown.as_bytes())?;
    report(args, &format!("{name}-summary"), &summary, &each)?;
    for (file, chart) in found.charts() {
        super::chart::save(&args.out.join(format!("{name}-{file}.svg")), chart)?;
    }
    note(&format!("{} runs of up to {:?} each", log.all().len(), Duration::from_secs_f64(cap)));
    Ok(complete)
}
