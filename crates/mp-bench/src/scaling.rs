//! The speed of tree growth, compared with another program, space by space.
//!
//! The other program is called as `PEER rrt SPACE gnat NODES SECONDS` and prints, at 10³, 10⁴, … nodes, a
//! line of JSON with `nodes` and `avg_nodes_per_s` (since its start, processor time).

mod growth;

use crate::error::Result;
use crate::experiment::{Lab, Table};
use crate::options::Common;
use crate::peer::json_lines;
use growth::{Growing, Row, SPACES};
use mp_plan::Error;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Numbers of nodes at which the clock is read; a short run leaves out the last one.
const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];

/// A case: all sizes in one space.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    space: String,
    sizes: Vec<usize>,
    repeats: usize,
    peer: Option<PathBuf>,
}

/// The result of a case. Sizes that were not reached in time are missing.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Run {
    ours: Vec<Row>,
    theirs: Vec<Theirs>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Theirs {
    nodes: usize,
    avg_nodes_per_s: f64,
}

/// Runs the suite. True when every size was reached.
pub(crate) fn run(common: &Common) -> Result<bool> {
    let lab = Lab::one_at_a_time(common)?;
    let mut log = lab.log("scaling", common.time)?;
    let sizes = if common.quick { &SIZES[..3] } else { &SIZES[..] };
    let repeats = common.runs_or(1, 3) as usize;
    let case = |space| Case { space, sizes: sizes.to_vec(), repeats, peer: common.peer.clone() };
    let spaces = common.scenes_or(&SPACES);
    if let Some(unknown) = spaces.iter().find(|space| !SPACES.contains(&space.as_str())) {
        let help = format!("there are: {}", SPACES.join(", "));
        return Err(Error::new(format!("there is no space `{unknown}`")).help(help));
    }
    let cases: Vec<Case> = spaces.into_iter().map(case).collect();
    let complete = lab.measure(&mut log, "scaling", &cases, |case| {
        let growing = Growing { sizes: &case.sizes, cap: common.time, repeats };
        let ours = growing.measure(&case.space)?;
        let ask = |peer: &PathBuf| ask(peer, &case.space, sizes[sizes.len() - 1], common.time);
        Ok(Some(Run { ours, theirs: case.peer.as_ref().map(ask).transpose()?.unwrap_or_default() }))
    })?;
    if !complete {
        return Ok(false);
    }
    let reached = log.each(&cases).all(|(_, run)| run.ours.len() == sizes.len());
    // If the other program ran out of time, its rate at the size it reached, which is an upper bound of its
    // rate here.
    let peer =
        |run: &Run, nodes: usize| run.theirs.iter().find(|t| t.nodes >= nodes).or(run.theirs.last()).copied();
    let rows = log
        .each(&cases)
        .flat_map(|(case, run)| run.ours.iter().map(move |row| (&case.space, row, peer(run, row.nodes))));
    let table = Table::of(
        rows,
        &[
            ("space", &|(space, ..)| (*space).clone()),
            ("nodes", &|(_, row, _)| row.nodes.to_string()),
            ("nodes/s", &|(_, row, _)| format!("{:.0}", row.rate())),
            ("bare loop nodes/s", &|(_, row, _)| format!("{:.0}", row.nodes as f64 / row.bare)),
            ("peer nodes/s", &|(_, row, peer)| match peer {
                None => "–".to_owned(),
                Some(p) if p.nodes < row.nodes => format!("{:.0} (at {})", p.avg_nodes_per_s, p.nodes),
                Some(p) => format!("{:.0}", p.avg_nodes_per_s),
            }),
            ("ratio", &|(_, row, peer)| {
                peer.map_or("–".to_owned(), |p| format!("{:.1}", row.rate() / p.avg_nodes_per_s))
            }),
        ],
    );
    lab.report("scaling", &table.markdown(), &table)?;
    Ok(reached)
}

/// The results of the other program in one space; sizes that it does not reach in time are missing.
fn ask(program: &Path, space: &str, nodes: usize, seconds: f64) -> Result<Vec<Theirs>> {
    let (nodes, seconds) = (nodes.to_string(), seconds.to_string());
    json_lines(Command::new(program).args(["rrt", space, "gnat", &nodes, &seconds]))
}
