//! Runs of all planners on all scenes, each with the same budget of collision queries.

use super::queries::steer;
use crate::bench::log::Log;
use crate::bench::nanoseconds;
use crate::cli::Motion;
use crate::output::note;
use crate::plan::mover::Mover;
use crate::plan::progress::Line;
use crate::plan::setting::Setting;
use crate::plan::task::Task;
use crate::plan::{Map, Options, Ready};
use miette::{IntoDiagnostic, Result};
use mp::cspace::{Cancel, DefaultNn, Outcome};
use mp::roadmap::Answers;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Collision and distance queries of a run: the same on every machine.
    pub(super) budget: u64,
    pub(super) seeds: u32,
    pub(super) threads: Option<u16>,
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
    /// Within the budget.
    pub(super) solved: bool,
    /// Processor time until there is a verified path, or nothing is left of the budget.
    pub(super) seconds: f64,
    /// Processor time to ask the roadmap that solved it for the path once more.
    pub(super) again: Option<f64>,
    pub(super) nodes: usize,
    /// Of a roadmap; zero of trees.
    pub(super) edges: usize,
    pub(super) components: usize,
    /// Collision and distance queries.
    pub(super) checks: u64,
    pub(super) motions: u64,
}

impl Run {
    /// Whether so many queries were enough.
    pub(super) fn solved_within(&self, budget: u64) -> bool {
        self.solved && self.checks <= budget
    }
}

/// The tree that the roadmaps are seen beside.
pub(super) const BESIDE: &str = "rrt-connect";

/// The ways in which OBPRM makes nodes.
const OBPRM: [&str; 4] = ["obprm prototype", "obprm contact", "obprm free", "obprm shells"];

/// The planners, some with how they make nodes: those that build roadmaps, and one that does not. PRM* is after short
/// paths, not narrow passages; and LazyPRM spends its time in searching, of which a budget of queries tells nothing.
pub(super) fn planners() -> Vec<&'static str> {
    let roadmaps = mp::roadmap::planners().iter();
    let other = ["obprm", "prm-star", "lazy-prm"];
    let names = roadmaps.map(|info| info.name).filter(|name| !other.contains(name));
    names.chain(OBPRM).chain([BESIDE]).collect()
}

/// Neighbours that an end is connected to, when the roadmap is asked once more.
const NEIGHBOURS: usize = 10;

/// Runs what was not run yet, on several threads, scene by scene. Where scenes become `harder` one after the other, what
/// solves none of the seeds is not run on those to come. True when nobody interrupted it.
pub(super) fn measure(
    problems: &[(String, Ready)],
    harder: bool,
    plan: &Plan,
    log: &mut Log<Case, Run>,
    cancel: &Cancel,
) -> Result<bool> {
    let threads = plan.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_diagnostic()?;
    let mut all = planners();
    for (scene, ready) in problems {
        ready.check_ends()?;
        let case = |planner: &&str, seed| Case { scene: scene.clone(), planner: (*planner).to_owned(), seed };
        let seeds = 1..=u64::from(plan.seeds);
        let missing: Vec<Case> = all
            .iter()
            .flat_map(|planner| seeds.clone().map(move |seed| case(planner, seed)))
            .filter(|case| log.get(case).is_none())
            .collect();
        let done: Vec<Result<Option<(Case, Run)>>> = pool.install(|| {
            let job = |case: &Case| {
                let Some(run) = run(ready, case, plan.budget, cancel)? else { return Ok(None) };
                log.write(case, &run)?;
                Ok(Some((case.clone(), run)))
            };
            missing.par_iter().with_max_len(1).map(job).collect()
        });
        for each in done {
            log.learn(each?);
        }
        if cancel.0.load(Ordering::Relaxed) {
            return Ok(false);
        }
        let solved = |planner: &&str| {
            let runs = seeds.clone().filter_map(|seed| log.get(&case(planner, seed)));
            runs.filter(|run| run.solved).count()
        };
        let said = all.iter().map(|planner| format!("{planner} {}", solved(planner)));
        note(&format!("{scene}, solved of {}: {}", plan.seeds, said.collect::<Vec<_>>().join(", ")));
        all.retain(|planner| !harder || solved(planner) > 0);
    }
    Ok(true)
}

/// One run; none when it was interrupted.
fn run(ready: &Ready, case: &Case, budget: u64, cancel: &Cancel) -> Result<Option<Run>> {
    if cancel.0.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let (name, nodes) = case.planner.split_once(' ').map_or((&*case.planner, None), |(a, b)| (a, Some(b)));
    let mut options = Options::comparable(name, Motion::Certified, 1e9)?;
    if let Some(nodes) = nodes {
        options.settings.set("nodes", nodes);
    }
    options.queries = Some(budget);
    let run = match ready {
        Ready::Space(setting) => one(setting, &options, case.seed, cancel),
        Ready::Plane(setting) => one(setting, &options, case.seed, cancel),
    }?;
    Ok((!cancel.0.load(Ordering::Relaxed)).then_some(run))
}

fn one<M: Mover>(setting: &Setting<M>, options: &Options, seed: u64, cancel: &Cancel) -> Result<Run> {
    let mut line = Line::new(&setting.problem.name, options.time, false);
    let done = setting.search(options, seed, cancel, &mut line)?;
    let Map { edges, components } = done.map.unwrap_or(Map { edges: 0, components: 0 });
    let budget = options.queries.unwrap_or(u64::MAX);
    let mut run = Run {
        solved: matches!(done.outcome, Outcome::Solved(_)) && done.queries <= budget,
        seconds: done.processor,
        again: None,
        nodes: done.progress.nodes,
        edges,
        components,
        checks: done.queries,
        motions: done.progress.motions,
    };
    if let (true, Some(map)) = (run.solved, done.roadmap) {
        let index = <M::Space as DefaultNn>::Nn::default();
        let steer = steer(setting, setting.verifier()?)?;
        let mut answers = Answers::new(steer, map, index, NEIGHBOURS).into_diagnostic()?;
        let began = nanoseconds();
        let answer = answers.answer(&setting.start, &setting.goal);
        run.again = answer.is_ok().then(|| (nanoseconds() - began) * 1e-9);
    }
    Ok(run)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::roadmaps::world::CORRIDORS;

    /// What is counted depends neither on threads nor on the clock.
    #[test]
    fn runs_are_the_same_on_any_number_of_threads() {
        let (_, ready) = CORRIDORS[0].ready().unwrap().swap_remove(4);
        let case = |planner: &&str| Case { scene: String::new(), planner: (*planner).to_owned(), seed: 3 };
        let cases: Vec<Case> = ["prm", "obprm free", "rrt-connect"].iter().map(case).collect();
        let cancel = Cancel::new();
        let counts = |threads: usize| -> Vec<_> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let job = |case: &Case| {
                let run = run(&ready, case, 4_000, &cancel).unwrap().unwrap();
                assert!(if run.solved { run.checks <= 4_000 } else { run.checks >= 4_000 });
                (run.solved, run.checks, run.nodes, run.edges, run.components, run.motions)
            };
            pool.install(|| cases.par_iter().map(job).collect())
        };
        assert_eq!(counts(1), counts(3));
        cancel.cancel();
        assert_eq!(run(&ready, &cases[0], 4_000, &cancel).unwrap(), None);
    }
}
