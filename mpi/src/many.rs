//! `many`: the problems of a list.

use crate::output::{Teller, note, print};
use clap::Args;
use mp_batch::{ListedProblems, ManyOptions, ManyOutcome, Shard, Tally};
use mp_plan::{Error, positive_number};
use mp_ranks::Link;
use mp_stop::Cancel;
use std::path::PathBuf;

/// The options of `mp many`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Many {
    /// The list, a text file with one JSON object a line: docs/formats/many.md describes it. Only the first rank reads it, and the scenes.
    list: PathBuf,
    /// The file for the results, which only the first rank writes. If it is there already, from a job that ended early, this one goes on
    /// with it. Results that come before their turn wait in FILE.ahead.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// How many problems at once on each rank. Results do not depend on it.
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Plan only the part I of N of the list, I from 1. `mp merge` puts the results of all parts together.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// The budget of time of each problem that names none, seconds [default: 60]. Where time ends a run, results depend on the
    /// machine: name budgets of iterations or nodes in the list, and give enough time.
    #[arg(long, value_name = "S", value_parser = positive_number)]
    time: Option<f64>,
    /// Write times into the reports. Results are then not the same twice.
    #[arg(long)]
    times: bool,
}

/// Plans the problems of a list. True when all are planned, solved or not.
pub(crate) fn run(args: &Many, link: &dyn Link, cancel: &Cancel) -> Result<bool, Error> {
    let options =
        ManyOptions { shard: args.shard, threads: args.threads.into(), times: args.times, time_s: args.time };
    let (mut teller, mut told) = (Teller::new(), false);
    let progress = |now: &ManyOutcome| {
        if !told && now.before > 0 {
            note(&format!("going on after {} of {} items", now.before, now.items));
        }
        told = true;
        let Tally { items, solved, unsolved, failed, .. } = now.tally;
        teller.say(|| {
            format!("{items} of {} done: {solved} solved, {unsolved} unsolved, {failed} failed", now.items)
        });
    };
    let ran = ListedProblems::run_on(
        link,
        &args.out,
        &options,
        cancel,
        || ListedProblems::load(&args.list, cancel),
        progress,
    )?;
    // Only the master knows.
    let Some(ran) = ran else { return Ok(true) };
    let (tally, items) = (ran.outcome.tally, ran.outcome.items);
    note(&format!("{} (collision queries)", ran.shares));
    if !ran.outcome.is_complete() {
        note(&format!("interrupted after {} of {items} items; the same command goes on", tally.items));
        return Ok(false);
    }
    print(&match args.shard {
        Shard::WHOLE => tally.to_string(),
        shard => format!("shard {shard}: {tally}"),
    })?;
    Ok(true)
}
