//! `bench roadmaps`: planners that build roadmaps, in a corridor that shrinks by halves and on shipped scenes, each
//! until it has a verified path or its processor time is spent; many queries to one roadmap beside RRT-Connect;
//! building against the number of nodes; and how few nodes cover as much.

mod cover;
mod growth;
mod picture;
mod queries;
mod runs;
mod tables;
mod world;

use super::log::Log;
use crate::cli;
use crate::output::{note, print, write};
use crate::plan::Ready;
use crate::scenes;
use miette::Result;
use mp::cspace::Cancel;
use std::path::Path;

/// Seconds of processor time of a run.
const CAP: f64 = 2.0;
const QUICK_CAP: f64 = 0.25;
const SEEDS: u32 = 20;

/// Measures. True when it was measured completely.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    let plan = runs::Plan {
        cap: args.rsrt.cap.unwrap_or(if args.quick { QUICK_CAP } else { CAP }),
        seeds: args.runs.unwrap_or(if args.quick { 3 } else { SEEDS }),
    };
    let name = if args.quick { "roadmaps-quick" } else { "roadmaps" };
    let cancel = Cancel(crate::plan::interrupt::flag());
    let mut log = Log::open(&args.out.join(format!("{name}-runs.jsonl")), plan.cap, args.rsrt.fresh)?;
    let mut problems = world::corridors()?;
    let named: Vec<String> = match args.scenes.as_slice() {
        [] => world::SCENES.map(str::to_owned).to_vec(),
        given => given.to_vec(),
    };
    for name in &named {
        problems.push((name.clone(), Ready::load(&scenes::find(Path::new(name))?)?));
    }
    let complete = runs::measure(&problems, &plan, &mut log, &cancel)?;
    if !complete {
        note("interrupted: the same command goes on from here");
        return Ok(false);
    }
    let names: Vec<&str> = problems.iter().map(|(name, _)| name.as_str()).collect();
    let found = tables::Found { log: &log, plan: &plan, scenes: &names };
    let parts = [
        ("Runs", found.summary()),
        ("Corridor", found.corridor()),
        ("Many queries", queries::measure(args.quick)?),
        ("Growth", growth::measure(args.quick)?),
        ("Coverage", cover::measure(args.quick)?),
    ];
    let mut text = String::new();
    for (title, table) in &parts {
        text.push_str(&format!("## {title}\n\n{}\n\n", table.markdown()));
        let file = format!("{name}-{}.csv", title.to_lowercase().replace(' ', "-"));
        write(&args.out.join(file), table.csv().as_bytes())?;
    }
    print(&text)?;
    write(&args.out.join(format!("{name}.md")), text.as_bytes())?;
    super::chart::save(&args.out.join(format!("{name}-corridor.svg")), found.chart())?;
    picture::draw(&args.out)?;
    Ok(true)
}
