//! `bench rrs --flying`: RRT against RRS for a body that flies, with the same steps.

use crate::bench::{Table, report};
use crate::cli::{self, Motion};
use crate::output::print;
use crate::plan::{Options, Ready, planned, progress};
use crate::scenes;
use miette::{IntoDiagnostic, Result};
use rayon::prelude::*;
use std::path::Path;

const SCENE: &str = "gempa-3";
/// Longest steps, of the extent of the space, and those of a short run.
const STEPS: [&str; 3] = ["5%", "10%", "20%"];
const PLANNERS: [&str; 2] = ["rrt", "rrs"];
/// Seeds, and those of a short run; iterations a run may take.
const SEEDS: u32 = 10;
const QUICK: u32 = 2;
const ITERATIONS: u64 = 20_000;

/// Plans in each scene with each step, the same seeds for both planners. True.
pub(super) fn run(args: &cli::Bench) -> Result<bool> {
    let seeds = u64::from(args.runs.unwrap_or(if args.quick { QUICK } else { SEEDS }));
    let most = if args.quick { ITERATIONS / 10 } else { ITERATIONS };
    let threads = args.rsrt.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_diagnostic()?;
    let named: Vec<String> =
        if args.scenes.is_empty() { vec![SCENE.to_owned()] } else { args.scenes.clone() };
    let mut each = Table::new(["scene", "step", "planner", "seed", "solved", "iterations", "s"]);
    let mut summary =
        Table::new(["scene", "step", "planner", "solved", "mean iterations", "median", "mean s"]);
    let bar = progress::runs(named.len() * STEPS.len() * PLANNERS.len() * seeds as usize, true);
    for name in &named {
        let ready = Ready::load(&scenes::find(Path::new(name))?)?;
        ready.check_ends()?;
        for (step, planner) in STEPS.iter().flat_map(|s| PLANNERS.map(|p| (s, p))) {
            let mut options = Options::comparable(planner, Motion::Certified, f64::MAX)?;
            options.settings.set("step", step);
            options.iterations = Some(most);
            let one = |seed: u64| {
                let done = planned(&ready, &options, seed);
                bar.inc(1);
                done
            };
            let runs: Vec<_> = pool.install(|| {
                (0..seeds as usize).into_par_iter().with_max_len(1).map(|i| one(i as u64 + 1)).collect()
            });
            let (mut solved, mut iterations, mut seconds) = (0, Vec::new(), 0.0);
            for (seed, run) in (1..=seeds).zip(runs) {
                let run = run?;
                solved += u32::from(run.solved);
                iterations.push(if run.solved { run.iterations } else { most } as f64);
                seconds += run.seconds;
                let head = [name, *step, planner].map(str::to_owned);
                let tail = [seed.to_string(), u8::from(run.solved).to_string(), run.iterations.to_string()];
                each.rows.push(head.into_iter().chain(tail).chain([format!("{:.4}", run.seconds)]).collect());
            }
            let n = iterations.len() as f64;
            let mean = iterations.iter().sum::<f64>() / n;
            let middle = crate::bench::median(&iterations).unwrap_or(f64::NAN);
            summary.rows.push(vec![
                name.clone(),
                (*step).to_owned(),
                planner.to_owned(),
                format!("{solved} of {seeds}"),
                format!("{mean:.0}"),
                format!("{middle:.0}"),
                format!("{:.2}", seconds / n),
            ]);
        }
    }
    bar.finish_and_clear();
    print(&summary.markdown())?;
    report(args, if args.quick { "rrs-flying-quick" } else { "rrs-flying" }, &summary, &each)?;
    Ok(true)
}
