//! `bench scaling`: tree growth beside another program, space by space in turn.
//!
//! The other program is called as `PEER rrt SPACE gnat NODES SECONDS` and prints, at 10³, 10⁴, … nodes, a
//! line of JSON with `nodes` and `avg_nodes_per_s` (since it began, processor time).

use super::scaling::{Options, SPACES, measure};
use super::{Table, report};
use crate::cli;
use crate::output::note;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde::Deserialize;
use std::path::Path;
use std::process::Command;

#[derive(Clone, Copy, Debug, Deserialize)]
struct Theirs {
    nodes: usize,
    avg_nodes_per_s: f64,
}

/// Measures. True when every size was reached.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    let sizes =
        if args.quick { vec![1_000, 10_000, 100_000] } else { vec![1_000, 10_000, 100_000, 1_000_000] };
    let spaces = match args.scenes.as_slice() {
        [] => SPACES.iter().map(|s| (*s).to_owned()).collect(),
        given => given.to_vec(),
    };
    let repeats = args.runs.map_or(if args.quick { 1 } else { 3 }, |n| n as usize);
    let mut table = Table::new(["space", "nodes", "nodes/s", "bare loop nodes/s", "peer nodes/s", "ratio"]);
    let mut all = true;
    for space in spaces {
        let options = Options {
            spaces: vec![space.clone()],
            sizes: sizes.clone(),
            cap: args.time,
            repeats,
            ..Options::default()
        };
        let rows = measure(&options, |_| ()).map_err(|e| miette!("{e}"))?;
        all &= rows.len() == sizes.len();
        let theirs = match &args.peer {
            Some(program) => ask(program, &space, sizes[sizes.len() - 1], args.time)?,
            None => Vec::new(),
        };
        for row in rows {
            // Where it ran out of time, its rate at the size it reached: no less than it would be here.
            let peer = theirs.iter().find(|t| t.nodes >= row.nodes).or(theirs.last());
            note(&format!("{} {}: {:.0} nodes/s", row.space, row.nodes, row.rate()));
            table.rows.push(vec![
                row.space.clone(),
                row.nodes.to_string(),
                format!("{:.0}", row.rate()),
                format!("{:.0}", row.nodes as f64 / row.bare),
                peer.map_or("–".into(), |p| match p.nodes < row.nodes {
                    true => format!("{:.0} (at {})", p.avg_nodes_per_s, p.nodes),
                    false => format!("{:.0}", p.avg_nodes_per_s),
                }),
                peer.map_or("–".into(), |p| format!("{:.1}", row.rate() / p.avg_nodes_per_s)),
            ]);
        }
    }
    report(args, "scaling", &table, &table)?;
    Ok(all)
}

/// What the other program says of one space; sizes it does not reach in time are missing.
fn ask(program: &Path, space: &str, nodes: usize, seconds: f64) -> Result<Vec<Theirs>> {
    let (nodes, seconds) = (nodes.to_string(), seconds.to_string());
    let done = Command::new(program)
        .args(["rrt", space, "gnat", &nodes, &seconds])
        .output()
        .into_diagnostic()
        .wrap_err_with(|| format!("cannot run {}", program.display()))?;
    let text = String::from_utf8_lossy(&done.stdout);
    text.lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).into_diagnostic())
        .collect::<Result<_>>()
        .wrap_err_with(|| format!("cannot read what {} printed", program.display()))
}
