//! Measurements of planners that build roadmaps. Each plans in corridors of decreasing width and on shipped
//! scenes, until it has a verified path or has used up its budget of collision queries. One roadmap answers
//! many queries, beside RRT-Connect. Further parts measure the building time against the number of nodes, and
//! how many nodes cover the free space, and draw all roadmaps. [`claims`] tests what the paper of key
//! elements says of making and connecting nodes. With `--scene`, only the runs on these scenes.

mod claims;
mod claims_tables;
mod coverage;
mod growth;
mod picture;
mod queries;
mod runs;
mod scenes;
mod svg_drawing;
mod tables;

use crate::error::Result;
use crate::experiment::{Lab, Table, sections};
use crate::options::Common;
use crate::output::note;
use crate::scenes::Rigid;
use claims::{EXPERIMENTS, Experiment};
use clap::Args;
use runs::Plan;
use scenes::CORRIDORS;
use tables::Results;

/// The budget of collision queries of a run.
const BUDGET: u64 = 100_000;
const QUICK_BUDGET: u64 = 10_000;
const SEEDS: u32 = 20;

/// The budget of a run of the experiments on claims.
const CLAIMS_BUDGET: u64 = 50_000;

/// The options of the suite `roadmaps` alone.
#[derive(Clone, Debug, Default, Args)]
#[group(skip)]
#[command(next_help_heading = "Of the suite `roadmaps`")]
pub(crate) struct Options {
    /// The budget of collision queries of a run [default: 100000, of experiments 50000; 10000 with --quick].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    queries: Option<u64>,
    /// An experiment on the paper's claims to run, and nothing else [default: all, and everything else].
    #[arg(long = "experiment", value_name = "EXPERIMENT")]
    experiments: Vec<Experiment>,
}

/// Runs the suite. True when it was measured completely.
pub(crate) fn run(common: &Common, options: &Options) -> Result<bool> {
    let lab = Lab::new(common)?;
    if !options.experiments.is_empty() {
        return run_claims(&lab, common, options, &options.experiments);
    }
    if common.scenes.is_empty() && !run_claims(&lab, common, options, &EXPERIMENTS)? {
        return Ok(false);
    }
    let plan = Plan {
        budget: options.queries.unwrap_or(if common.quick { QUICK_BUDGET } else { BUDGET }),
        seeds: common.runs_or(3, SEEDS),
    };
    let name = lab.name("roadmaps");
    let named = common.scenes_or(&scenes::SCENES);
    let whole = common.scenes.is_empty();
    let suites = if whole { CORRIDORS.as_slice() } else { &[] };
    let corridors = suites.iter().map(scenes::Corridors::ready).collect::<Result<Vec<_>>>()?;
    let load = |name: &String| Ok((name.clone(), Rigid::load(name)?));
    let problems = named.iter().map(load).collect::<Result<Vec<_>>>()?;

    let mut log = lab.log(&name, plan.budget as f64)?;
    let corridors_first = corridors.iter().map(|c| (c, true)).chain([(&problems, false)]);
    for (problems, harder) in corridors_first {
        if !runs::measure(problems, harder, &plan, &lab, &mut log)? {
            return Ok(false);
        }
    }
    let results = Results { log: &log, plan: &plan };
    let mut parts: Vec<(&str, Table)> = suites.iter().map(|c| (c.title, results.corridor(c))).collect();
    parts.push(("Shipped scenes", results.summary(&named)));
    if !whole {
        lab.report(&format!("{name}-scenes"), &sections(2, &parts), &log.table(&plan.all_cases(&named))?)?;
        return Ok(true);
    }
    let widths: Vec<String> = corridors.into_iter().flatten().map(|(name, _)| name).collect();
    parts.push(("Corridors", results.summary(&widths)));
    let (many, each_query) = queries::measure(common.quick)?;
    note(&many.markdown());
    parts.push(("Many queries", many));
    lab.csv(&format!("{name}-queries"), &each_query)?;
    let growth = growth::measure(common.quick)?;
    lab.csv(&format!("{name}-growth"), &growth)?;
    parts.push(("Growth", growth));
    let Some((coverage, each_roadmap)) = coverage::measure(&lab, common.quick)? else { return Ok(false) };
    lab.csv(&format!("{name}-coverage"), &each_roadmap)?;
    parts.push(("Coverage", coverage));
    let scenes = [named, widths].concat();
    lab.report(&name, &sections(2, &parts), &log.table(&plan.all_cases(&scenes))?)?;
    for corridors in &CORRIDORS {
        lab.charts(&format!("{name}-{}", corridors.name), results.charts(corridors))?;
    }
    picture::draw(&lab)?;
    Ok(true)
}

/// Runs experiments on the paper's claims. False when one was interrupted.
fn run_claims(lab: &Lab, common: &Common, options: &Options, wanted: &[Experiment]) -> Result<bool> {
    let budget = options.queries.unwrap_or(if common.quick { QUICK_BUDGET } else { CLAIMS_BUDGET });
    let mut log = lab.log(&lab.name("roadmaps-claims"), budget as f64)?;
    for &experiment in wanted {
        let seeds = common.runs_or(1, experiment.seeds()).into();
        let own = if common.quick { &experiment.scenes()[..2] } else { experiment.scenes() };
        let plan = claims::Plan { experiment, budget, seeds, scenes: common.scenes_or(own) };
        if !claims::measure(&plan, lab, &mut log)? {
            return Ok(false);
        }
        let results = claims_tables::Results { log: &log, plan: &plan };
        let name = lab.name(experiment.name());
        let scenes = format!("{}\n\n{}\n", results.intervals(), results.by_scene().markdown());
        lab.write(&format!("{name}-by-scene.md"), &scenes)?;
        lab.report(&name, &sections(3, &results.parts()), &log.table(&plan.cases())?)?;
    }
    Ok(true)
}
