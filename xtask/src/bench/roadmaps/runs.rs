//! Runs of all planners on all scenes.

use crate::bench::log::Log;
use crate::cli::Motion;
use crate::output::note;
use crate::plan::{Map, Options, Ready, planned};
use miette::Result;
use mp::cspace::Cancel;
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Seconds of processor time of a run.
    pub(super) cap: f64,
    pub(super) seeds: u32,
}

/// What was run.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) scene: String,
    pub(super) planner: String,
    pub(super) seed: u64,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) solved: bool,
    /// Processor time until there is a verified path, or nothing is left of it.
    pub(super) seconds: f64,
    pub(super) nodes: usize,
    /// Of a roadmap; zero of trees.
    pub(super) edges: usize,
    pub(super) components: usize,
    /// Collision and distance queries.
    pub(super) checks: u64,
    pub(super) motions: u64,
}

/// The tree that the roadmaps are seen beside.
pub(super) const BESIDE: &str = "rrt-connect";

/// The ways in which OBPRM makes nodes.
const OBPRM: [&str; 4] = ["obprm prototype", "obprm contact", "obprm free", "obprm shells"];

/// The planners, some with how they make nodes: those that build roadmaps, and one that does not.
pub(super) fn planners() -> Vec<&'static str> {
    let roadmaps = mp::roadmap::planners().iter().chain(mp::roadmap::planners_among());
    let names = roadmaps.map(|info| info.name).filter(|name| *name != "obprm");
    names.chain(OBPRM).chain([BESIDE]).collect()
}

/// Runs what was not run yet. True when nobody interrupted it.
pub(super) fn measure(
    problems: &[(String, Ready)],
    plan: &Plan,
    log: &mut Log<Case, Run>,
    cancel: &Cancel,
) -> Result<bool> {
    for (scene, ready) in problems {
        ready.check_ends()?;
        for planner in planners() {
            let (name, nodes) = planner.split_once(' ').map_or((planner, None), |(a, b)| (a, Some(b)));
            let mut options = Options::comparable(name, Motion::Certified, 1e6)?;
            if let Some(nodes) = nodes {
                options.settings.set("nodes", nodes);
            }
            options.processor = Some(plan.cap);
            let mut solved = 0;
            for seed in 1..=u64::from(plan.seeds) {
                if cancel.0.load(Ordering::Relaxed) {
                    return Ok(false);
                }
                let case = Case { scene: scene.clone(), planner: planner.to_owned(), seed };
                if log.get(&case).is_none() {
                    let run = one(ready, &options, seed)?;
                    log.write(&case, &run)?;
                    log.learn([(case.clone(), run)]);
                }
                solved += u32::from(log.get(&case).is_some_and(|run| run.solved));
            }
            note(&format!("{scene}: {planner} solved {solved} of {}", plan.seeds));
        }
    }
    Ok(true)
}

fn one(ready: &Ready, options: &Options, seed: u64) -> Result<Run> {
    let done = planned(ready, options, seed)?;
    let Map { edges, components } = done.map.unwrap_or(Map { edges: 0, components: 0 });
    // A planner that goes on for better paths is stopped by its cap: what counts is when the first was there.
    let seconds = if done.seconds < done.processor { done.seconds } else { done.processor };
    Ok(Run {
        solved: done.solved,
        seconds,
        nodes: done.nodes,
        edges,
        components,
        checks: done.queries,
        motions: done.motions,
    })
}
