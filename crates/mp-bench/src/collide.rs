//! Queries between two meshes, with this project and with other libraries.
//!
//! For each pair of meshes, in rounds: build the trees, then run all boolean, tolerance, distance and motion
//! queries at the pair's poses; then parry3d once, in this process; then the other programs, one after the
//! other. All answers are compared. For two scenes, certified checks of a planner's edges are compared with
//! discrete ones.

mod edges;
mod export;
mod growth;
mod ours;
mod pair_results;
mod pairs;
mod parry;
mod peers;
mod poses;
mod record;
mod referee;
mod tables;

use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table, sections};
use crate::options::Common;
use crate::output::note;
use clap::Args;
use clap::builder::PossibleValuesParser;
use edges::Costs;
use ours::OURS;
use pair_results::PairResults;
use pairs::{PAIRS, Pair};
use parry::Parry;
use peers::QueryLimits;
use poses::{Counts, QueryPoses};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tables::is_ours;

/// The options of the suite `collide` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `collide`")]
pub(crate) struct Options {
    /// Pairs of meshes to measure on (default: all).
    #[arg(long = "pair", value_name = "PAIR", value_parser = PossibleValuesParser::new(PAIRS))]
    pairs: Vec<String>,
    /// Instead, compare boolean answers with exact arithmetic; exit code 0 if all are right.
    #[arg(long)]
    referee: bool,
    /// Instead, measure the cost of queries and trees against the number of triangles.
    #[arg(long, conflicts_with = "referee")]
    growth: bool,
    /// Poses of each pair for --referee [default: a million for all pairs together].
    #[arg(long, value_name = "N", requires = "referee")]
    poses: Option<usize>,
    /// The seed of the poses.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// A folder of other programs to measure as well; docs/benchmarks.md says how they are called.
    #[arg(long, value_name = "DIR")]
    peers: Option<PathBuf>,
    /// Write meshes and poses to this folder, for other programs; without --peers, nothing is measured.
    #[arg(long, value_name = "DIR")]
    export: Option<PathBuf>,
}

/// Runs the suite. True when everything was measured and all our own answers agree.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::one_at_a_time(common)?;
    let named: Vec<&str> = match options.pairs.as_slice() {
        [] => PAIRS.to_vec(),
        given => given.iter().map(String::as_str).collect(),
    };
    if options.referee {
        return referee::run(&lab, common, options, &named);
    }
    let programs = options.peers.as_deref().map(peers::find).transpose()?.unwrap_or_default();
    if options.growth {
        return growth::run(&lab, common, options.seed, &programs);
    }
    let scratch = tempfile::tempdir().into_error()?;
    let folder = options.export.as_deref().unwrap_or(scratch.path());
    // Other programs read all poses.
    let counts =
        if common.quick && programs.is_empty() && options.export.is_none() { QUICK } else { Counts::FULL };
    let (mut all, mut costs, mut complete) = (Vec::new(), Vec::new(), true);
    for name in named {
        let pair = Pair::load(name)?;
        let (meshes, _) = ours::build(&pair);
        let poses = QueryPoses::new(&pair, &meshes, counts, options.seed)?;
        if options.export.is_some() || !programs.is_empty() {
            export::export(folder, &pair, &poses)?;
        }
        if options.export.is_some() && options.peers.is_none() {
            note(&format!("{name}: written to {}", folder.display()));
            continue;
        }
        let (measured, answered) = measure(common, &pair, &poses, &programs, folder)?;
        complete &= answered;
        note(&progress_line(&measured));
        all.push(measured);
        if edges::CHECKED.contains(&name) {
            let (count, passes) = if common.quick { (300, 3) } else { (3_000, 7) };
            costs.extend(Costs::measure(name, count, passes)?);
        }
    }
    if all.is_empty() {
        return Ok(complete);
    }
    lab.report("collide", &text(&all, &costs), &tables::each(&all))?;
    Ok(complete && tables::consistent(&all) && costs.iter().all(Costs::consistent))
}

/// The numbers of poses of a short run.
const QUICK: Counts = Counts { uniform: 1_000, near: 1_000, edges: 50 };

/// A pair that takes less than this per round gets more rounds, up to `MANY` times as many: short
/// measurements are the ones that other work on the machine disturbs most.
const SHORT: Duration = Duration::from_secs(20);
const MANY: usize = 10;

/// Measures one pair; also returns whether every program answered.
fn measure(
    common: &Common,
    pair: &Pair,
    poses: &QueryPoses,
    programs: &[PathBuf],
    folder: &Path,
) -> Result<(PairResults, bool)> {
    let (rounds, most, passes, distances, cap) =
        if common.quick { (1, 1, 3, 100, 0.2) } else { (3, MANY, 3, 1_000, 5.0) };
    let rounds = common.runs.map_or(rounds, |n| n as usize);
    let mut measured = PairResults::new(pair);
    let mut complete = true;
    let begin = Instant::now();
    for round in 0..rounds * most {
        if round >= rounds && begin.elapsed() > SHORT * rounds as u32 {
            break;
        }
        let (meshes, build) = ours::build(pair);
        measured.built(build);
        for record in ours::ask(pair, &meshes, poses, distances, passes) {
            record::add(&mut measured.records, record);
        }
        if round == 0 {
            let (parry, build) = Parry::new(pair)?;
            measured.built(build);
            measured.records.extend(parry.ask(poses, distances, cap)?);
        }
        let limits = QueryLimits { passes, distances, cap };
        for program in programs {
            match peers::ask(program, folder, &pair.name, limits) {
                Ok((builds, records)) => {
                    builds.into_iter().for_each(|b| measured.built(b));
                    records.into_iter().for_each(|r| record::add(&mut measured.records, r));
                }
                Err(error) => {
                    complete = false;
                    note(&error.report());
                }
            }
        }
    }
    Ok((measured, complete))
}

fn progress_line(m: &PairResults) -> String {
    let own = m.records.iter().filter(|r| r.what.lib == OURS);
    let figures = own.map(|r| format!("{} {} {:.0} ns", r.what.query, r.what.set, r.least));
    format!("{}: {}", m.pair, figures.collect::<Vec<_>>().join(", "))
}

/// All tables that have rows.
fn text(all: &[PairResults], costs: &[Costs]) -> String {
    let foreign = |lib: &str| !is_ours(lib);
    let mut parts: Vec<(&str, Table)> = vec![
        ("Boolean queries, ns (how many times ours)", tables::speed(all, "collide", foreign)),
        ("Boolean queries on each instruction set, ns", tables::speed(all, "collide", is_ours)),
        ("Tolerance queries, 2% of the robot's radius, ns", tables::speed(all, "tolerance", foreign)),
        ("Distances, ns", tables::speed(all, "distance", foreign)),
        ("Motions, ns per pose", tables::speed(all, "motion", foreign)),
        ("Certified against discrete checks, per edge", edges::table(costs)),
        ("Building the trees of both meshes, ms", tables::build_times(all)),
        ("Memory of the trees of both meshes, bytes per triangle", tables::memory(all)),
        ("Agreement", tables::agreement(all)),
    ];
    parts.retain(|(_, table)| !table.rows.is_empty());
    sections(3, &parts)
}
