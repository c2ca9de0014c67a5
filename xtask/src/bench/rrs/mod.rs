//! `bench rrs`: the experiment of Baizid, Chellali, Luza, Vitezslav and Arrichiello, *RRS: rapidly-exploring random
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

use super::log::Log;
use super::report;
use crate::cli;
use crate::output::{note, print, write};
use crate::plan::{interrupt, progress};
use miette::Result;
use mp::cspace::Cancel;
use series::{Plan, measure};
use tables::Found;

/// Measures. True when it was measured completely.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    if args.rrs.follow {
        return following::run(args);
    }
    if args.rrs.flying {
        return flying::run(args);
    }
    if args.rrs.pictures {
        return pictures::run(args);
    }
    let plan = Plan::new(args.quick, args.runs, args.rsrt.threads);
    let name = if args.quick { "rrs-quick" } else { "rrs" };
    let path = args.out.join(format!("{name}-runs.jsonl"));
    let mut log = Log::open(&path, solve::ITERATIONS as f64, args.rsrt.fresh)?;
    let bar = progress::runs(plan.cases().len(), true);
    let complete = measure(&plan, &mut log, &Cancel(interrupt::flag()), || bar.inc(1))?;
    bar.finish_and_clear();
    if !complete {
        note("interrupted: the same command goes on from here");
    }
    let found = Found::new(&log, &plan);
    let markdown = found.markdown();
    print(&markdown)?;
    write(&args.out.join(format!("{name}.md")), markdown.as_bytes())?;
    report(args, &format!("{name}-summary"), &found.summary(), &found.each())?;
    for (file, chart) in found.charts() {
        super::chart::save(&args.out.join(format!("{name}-{file}.svg")), chart)?;
    }
    Ok(complete)
}
