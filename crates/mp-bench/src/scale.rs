//! What more ranks bring than there are here: measured costs of real items, replayed for 1 to 10,000 ranks.
//!
//! Measured are planning problems over the shipped scenes, lengths of runs of problems with heavy tails, and
//! portfolios on 1, 2 and 4 ranks; the other costs are those of the experiments in `docs/results/data`.
//! `docs/results/scale.md` has the results.

mod portfolios;
mod problems;
mod sweeps;

use crate::error::Result;
use crate::experiment::{Lab, Table};
use crate::options::Common;

/// How many ranks are replayed.
const RANKS: [usize; 9] = [1, 2, 4, 16, 64, 256, 1000, 4000, 10_000];
/// The time (s) from sending a message until the other rank acts on it. Idle ranks look for messages of MPI
/// every millisecond, and a small message takes at most 0.1 ms in the network of a cluster (MPI over
/// Ethernet; a hundredth of that over InfiniBand).
const LATENCY_S: f64 = 2.1e-3;
/// What the master needs for a result and the item that it sends in return, s. See
/// [`sweeps::master_seconds`], to which ten microseconds of MPI are added.
const MESSAGE_S: f64 = 2e-5;

/// Runs the suite. True when it was measured completely.
pub(crate) fn run(common: &Common) -> Result<bool> {
    let lab = Lab::new(common)?;
    let Some(problems) = problems::measured(&lab, common)? else { return Ok(false) };
    let Some(lengths) = portfolios::lengths(&lab, common)? else { return Ok(false) };
    let Some(on_threads) = portfolios::on_threads(&lab, common)? else { return Ok(false) };
    let costs = sweeps::all_costs(problems.each())?;
    let items = if common.quick { 10_000 } else { 1_000_000 };
    let text = [
        "## Sweeps".to_owned(),
        sweeps::text(&costs, items),
        "## Portfolios".to_owned(),
        portfolios::text(&on_threads, &lengths)?,
    ];
    let mut each = Table::new(["experiment", "case", "seed", "solved", "seconds", "iterations"]);
    each.rows.extend(problems.rows());
    each.rows.extend(lengths.rows());
    let mut commits = problems.commits.clone();
    lengths.commits.iter().for_each(|(commit, runs)| *commits.entry(commit.clone()).or_default() += runs);
    lab.report(&lab.name("scale"), &(text.join("\n\n") + "\n"), &each.made_at(commits))?;
    Ok(true)
}
