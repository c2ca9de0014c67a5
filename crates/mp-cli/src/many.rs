//! `many` and `merge`: lists of problems, and their results.

use crate::cli::{Many, Merge};
use crate::input::is_standard;
use crate::interrupt::{self, PATIENCE, within};
use crate::output::{Claims, note, print};
use crate::progress::Line;
use mp_batch::{ListedProblems, ManyOptions, ManyOutcome, Shard, Tally, merge_results};
use mp_plan::{Error, Interrupt};
use std::path::Path;

/// Plans the problems of a list. True when all are planned, solved or not.
pub(crate) fn run(args: &Many) -> Result<bool, Error> {
    not_standard("the list", &args.list)?;
    not_standard("--out", &args.out)?;
    let cancel = interrupt::flag();
    let (list, until) = (args.list.clone(), cancel.clone());
    let load = move || ListedProblems::load(&list, &until);
    let loaded = within(&Interrupt::new(cancel.clone()), PATIENCE, load)?;
    let problems = match loaded.filter(|loaded| loaded.is_ok() || !cancel.is_raised()) {
        Some(loaded) => loaded?,
        None => {
            note("interrupted while the scenes of the list were read");
            return Ok(false);
        }
    };
    let mut claims = Claims::default();
    problems.inputs().iter().for_each(|file| claims.input(file));
    claims.output("--out", &args.out)?;
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let options = ManyOptions {
        shard: args.shard,
        threads: args.threads.map_or_else(cores, usize::from),
        times: args.times,
        time_s: args.time,
    };
    let outcome = {
        let line = Line::new("problems", None, true);
        let mut told = false;
        let progress = |now: &ManyOutcome| {
            if !told && now.before > 0 {
                note(&format!("going on after {} of {} items", now.before, now.items));
            }
            told = true;
            let Tally { items, solved, unsolved, failed, .. } = now.tally;
            line.say(&format!(
                "{items} of {} done: {solved} solved, {unsolved} unsolved, {failed} failed",
                now.items
            ));
        };
        problems.run(&args.out, &options, &cancel, progress)?
    };
    let (tally, items) = (outcome.tally, outcome.items);
    if !outcome.is_complete() {
        note(&format!("interrupted after {} of {items} items; the same command goes on", tally.items));
        return Ok(false);
    }
    print(&match args.shard {
        Shard::WHOLE => tally.to_string(),
        shard => format!("shard {shard}: {tally}"),
    })?;
    Ok(true)
}

/// Merges the results of all shards of a list.
pub(crate) fn merge(args: &Merge) -> Result<bool, Error> {
    let mut claims = Claims::default();
    for file in &args.shards {
        not_standard("a shard", file)?;
        claims.input(file);
    }
    not_standard("the merged results", &args.out)?;
    claims.output("the output", &args.out)?;
    let tally = merge_results(&args.out, &args.shards)?;
    print(&tally.to_string())?;
    note(&format!("wrote {}", args.out.display()));
    Ok(true)
}

/// Refuses standard input and output, with which nobody can go on.
fn not_standard(what: &str, file: &Path) -> Result<(), Error> {
    match is_standard(file) {
        true => Err(Error::new(format!("{what} must be a file, not `-`")).help("name a file")),
        false => Ok(()),
    }
}
