//! Every planner on shipped scenes, to the first verified path: what `docs/choosing-a-planner.md` is made of.

use super::{Table, median, report};
use crate::cli::{self, Motion};
use crate::output::note;
use crate::plan::{Options, Ready, planned};
use crate::scenes;
use miette::Result;
use std::path::Path;

/// Open and crowded rooms, traps and narrow passages, in the plane and in space.
const SCENES: [&str; 6] = ["maze", "planar-bugtrap", "easy", "cubicles", "twisty", "bugtrap"];

/// Measures. True: a planner that does not solve a scene in time is a result.
pub(crate) fn run(args: &cli::Bench) -> Result<bool> {
    let named: Vec<String> = match args.scenes.as_slice() {
        [] => SCENES.map(str::to_owned).to_vec(),
        given => given.to_vec(),
    };
    let seeds = args.runs.unwrap_or(if args.quick { 2 } else { 10 });
    let cap = if args.quick { args.time.min(2.0) } else { args.time };
    let mut each = Table::new(["scene", "planner", "seed", "solved", "s", "checks", "iterations"]);
    let mut summary = Table::new(["planner".to_owned()].into_iter().chain(named.clone()));
    let ready =
        named.iter().map(|n| Ready::load(&scenes::find(Path::new(n))?)).collect::<Result<Vec<_>>>()?;
    ready.iter().try_for_each(Ready::check_ends)?;
    for info in mp::tree::planners() {
        let options = Options::comparable(info.name, Motion::Certified, cap)?;
        let mut row = vec![info.name.to_owned()];
        for (name, ready) in named.iter().zip(&ready) {
            let mut seconds = Vec::new();
            let mut solved = 0;
            for seed in 1..=u64::from(seeds) {
                let done = planned(ready, &options, seed)?;
                solved += u32::from(done.solved);
                seconds.push(if done.solved { done.seconds } else { f64::INFINITY });
                each.rows.push(vec![
                    name.clone(),
                    info.name.to_owned(),
                    seed.to_string(),
                    u8::from(done.solved).to_string(),
                    format!("{:.6}", done.seconds),
                    done.queries.to_string(),
                    done.iterations.to_string(),
                ]);
            }
            let time = median(&seconds).filter(|s| s.is_finite());
            let time = time.map_or(format!("> {cap}"), |s| format!("{s:.3}"));
            row.push(if solved == seeds { time } else { format!("{time} ({solved}/{seeds})") });
        }
        note(&row.join(" | "));
        summary.rows.push(row);
    }
    report(args, "planners", &summary, &each)?;
    Ok(true)
}
