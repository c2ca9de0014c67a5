//! `bench roadmaps`: planners that build roadmaps, in corridors that shrink and on shipped scenes, each until it has a
//! verified path or its budget of collision queries is spent; many queries to one roadmap beside RRT-Connect;
//! building against the number of nodes; how few nodes cover as much; and pictures of all roadmaps. With `--scene` these
//! scenes alone.

mod cover;
mod drawing;
mod growth;
mod picture;
mod queries;
mod runs;
mod tables;
mod world;

use super::Table;
use super::log::Log;
use crate::cli;
use crate::output::{note, print, write};
use crate::plan::Ready;
use crate::scenes;
use miette::{IntoDiagnostic, Result};
use mp::cspace::Cancel;
use runs::{Case, Plan, Run};
use std::path::Path;
use tables::Found;
use world::CORRIDORS;

/// Collision queries of a run.
const BUDGET: u64 = 100_000;
const QUICK_BUDGET: u64 = 10_000;
const SEEDS: u32 = 20;

/// Measures. True when it was measured completely.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    let plan = Plan {
        budget: args.rsrt.queries.unwrap_or(if args.quick { QUICK_BUDGET } else { BUDGET }),
        seeds: args.runs.unwrap_or(if args.quick { 3 } else { SEEDS }),
        threads: args.rsrt.threads,
    };
    let name = if args.quick { "roadmaps-quick" } else { "roadmaps" };
    let named: Vec<String> = match args.scenes.as_slice() {
        [] => world::SCENES.map(str::to_owned).to_vec(),
        given => given.to_vec(),
    };
    let whole = args.scenes.is_empty();
    let suites = if whole { CORRIDORS.as_slice() } else { &[] };
    let corridors = suites.iter().map(world::Corridors::ready).collect::<Result<Vec<_>>>()?;
    let load = |name: &String| Ok((name.clone(), Ready::load(&scenes::find(Path::new(name))?)?));
    let problems = named.iter().map(load).collect::<Result<Vec<_>>>()?;

    let cancel = Cancel(crate::plan::interrupt::flag());
    let mut log =
        Log::open(&args.out.join(format!("{name}-runs.jsonl")), plan.budget as f64, args.rsrt.fresh)?;
    let corridors_first = corridors.iter().map(|c| (c, true)).chain([(&problems, false)]);
    for (problems, harder) in corridors_first {
        if !runs::measure(problems, harder, &plan, &mut log, &cancel)? {
            note("interrupted: the same command goes on from here");
            return Ok(false);
        }
    }
    let found = Found { log: &log, plan: &plan };
    let mut parts: Vec<(&str, Table)> = suites.iter().map(|c| (c.title, found.corridor(c))).collect();
    parts.push(("Shipped scenes", found.summary(&named)));
    if !whole {
        save(args, &format!("{name}-scenes"), &parts, &log)?;
        return Ok(true);
    }
    let widths: Vec<String> = corridors.into_iter().flatten().map(|(name, _)| name).collect();
    parts.push(("Corridors", found.summary(&widths)));
    let many = queries::measure(args.quick)?;
    note(&many.markdown());
    parts.push(("Many queries", many));
    parts.push(("Growth", growth::measure(args.quick)?));
    parts.push(("Coverage", cover::measure(args.quick, args.rsrt.threads)?));
    save(args, name, &parts, &log)?;
    for corridors in &CORRIDORS {
        let file = args.out.join(format!("{name}-{}.svg", corridors.name));
        super::chart::save(&file, found.chart(corridors))?;
    }
    picture::draw(&args.out)?;
    Ok(true)
}

/// Prints the tables, and writes them as Markdown, CSV and JSON, the last with all runs there are.
fn save(args: &cli::Bench, name: &str, parts: &[(&str, Table)], log: &Log<Case, Run>) -> Result<()> {
    let mut text = String::new();
    for (title, table) in parts {
        text.push_str(&format!("## {title}\n\n{}\n\n", table.markdown()));
        let file = format!("{name}-{}.csv", title.to_lowercase().replace(' ', "-"));
        write(&args.out.join(file), table.csv().as_bytes())?;
    }
    print(&text)?;
    write(&args.out.join(format!("{name}.md")), text.as_bytes())?;
    let tables: serde_json::Map<_, _> =
        parts.iter().map(|(title, table)| ((*title).to_owned(), table.json())).collect();
    let json = serde_json::json!({ "tables": tables, "runs": log.all() });
    let json = serde_json::to_string_pretty(&json).into_diagnostic()?;
    write(&args.out.join(format!("{name}.json")), json.as_bytes())
}
