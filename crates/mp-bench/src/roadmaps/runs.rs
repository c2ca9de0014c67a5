//! Runs of all planners on all scenes, each with the same budget of collision queries.

use super::queries::checker;
use crate::clock::{nanoseconds, seconds_since};
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use crate::output::note;
use crate::scenes::{Rigid, bare, either};
use mp_cspace::{Cancel, DefaultNn, Outcome, StopReason};
use mp_plan::{Control, Request, RigidScene, RigidSpace, RobotKind, Stage, Watch, search};
use mp_roadmap::RoadmapQueries;
use serde::{Deserialize, Serialize};

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Collision and distance queries of a run: the same on every machine.
    pub(super) budget: u64,
    pub(super) seeds: u32,
}

impl Plan {
    /// The cases of a planner in a scene.
    pub(super) fn cases(&self, scene: &str, planner: &str) -> Vec<Case> {
        let case = |seed| Case { scene: scene.to_owned(), planner: planner.to_owned(), seed };
        (1..=u64::from(self.seeds)).map(case).collect()
    }
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
    let roadmaps = mp_roadmap::planners().iter();
    let other = ["obprm", "prm-star", "lazy-prm"];
    let names = roadmaps.map(|info| info.name).filter(|name| !other.contains(name));
    names.chain(OBPRM).chain([BESIDE]).collect()
}

/// Neighbours that an end is connected to, when the roadmap is asked once more.
const NEIGHBOURS: usize = 10;

/// Runs what was not run yet, on several threads, scene by scene. Where scenes become `harder` one after the other, what
/// solves none of the seeds is not run on those to come. True when nobody interrupted it.
pub(super) fn measure(
    problems: &[(String, Rigid)],
    harder: bool,
    plan: &Plan,
    lab: &Lab,
    log: &mut Log<Case, Run>,
) -> Result<bool> {
    let mut all = planners();
    for (scene, rigid) in problems {
        let cases: Vec<Case> = all.iter().flat_map(|planner| plan.cases(scene, planner)).collect();
        if !lab.measure(log, scene, &cases, |case| run(rigid, case, plan.budget, &lab.cancel))? {
            return Ok(false);
        }
        let solved =
            |planner: &str| log.runs(plan.cases(scene, planner)).iter().filter(|run| run.solved).count();
        let said = all.iter().map(|planner| format!("{planner} {}", solved(planner)));
        note(&format!("{scene}, solved of {}: {}", plan.seeds, said.collect::<Vec<_>>().join(", ")));
        all.retain(|planner| !harder || solved(planner) > 0);
    }
    Ok(true)
}

/// One run; none when it was interrupted.
fn run(rigid: &Rigid, case: &Case, budget: u64, cancel: &Cancel) -> Result<Option<Run>> {
    let (name, nodes) = case.planner.split_once(' ').map_or((&*case.planner, None), |(a, b)| (a, Some(b)));
    let mut request = bare(name).seed(case.seed);
    if let Some(nodes) = nodes {
        request = request.set("nodes", nodes);
    }
    request.budget.queries = Some(budget);
    either!(rigid, scene => one(scene, &request, cancel))
}

/// Reads the clock when planning begins: what is made before is not measured.
struct Began(f64);

impl Watch for Began {
    fn stage(&mut self, stage: Stage) {
        if stage == Stage::Planning {
            self.0 = nanoseconds();
        }
    }
}

fn one<M: RigidSpace>(scene: &RigidScene<M>, request: &Request, cancel: &Cancel) -> Result<Option<Run>> {
    let mut began = Began(nanoseconds());
    let mut control = Control { keep_roadmap: true, ..Control::new(cancel.clone(), &mut began) };
    let done = search(scene, request, &mut control)?;
    let seconds = seconds_since(began.0);
    if matches!(done.outcome, Outcome::Stopped(StopReason::Cancelled)) {
        return Ok(None);
    }
    let [edges, components] = done.map.unwrap_or_default();
    let budget = request.budget.queries.unwrap_or(u64::MAX);
    let mut run = Run {
        solved: matches!(done.outcome, Outcome::Solved(_)) && done.queries <= budget,
        seconds,
        again: None,
        nodes: done.progress.nodes,
        edges,
        components,
        checks: done.queries,
        motions: done.progress.motions,
    };
    if let (true, Some(map)) = (run.solved, done.roadmap) {
        let index = <<M as RigidSpace>::Space as DefaultNn>::Nn::default();
        let checker = checker(scene, scene.verifier()?)?;
        let mut answers = RoadmapQueries::new(checker, map, index, NEIGHBOURS).into_error()?;
        let began = nanoseconds();
        let answer = answers.answer(scene.start(), &scene.goals()[0]);
        run.again = answer.is_ok().then(|| seconds_since(began));
    }
    Ok(Some(run))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roadmaps::world::CORRIDORS;

    /// What is counted depends neither on threads nor on the clock.
    #[test]
    fn runs_are_the_same_on_any_number_of_threads() {
        let (_, rigid) = CORRIDORS[0].ready().unwrap().swap_remove(4);
        let case = |planner: &&str| Case { scene: String::new(), planner: (*planner).to_owned(), seed: 3 };
        let cases: Vec<Case> = ["prm", "obprm free", "rrt-connect"].iter().map(case).collect();
        let folder = tempfile::tempdir().unwrap();
        let counts = |threads: usize| -> Vec<_> {
            let lab = Lab::test(folder.path(), threads);
            let job = |case: &Case| {
                let run = run(&rigid, case, 4_000, &lab.cancel)?.unwrap();
                assert!(if run.solved { run.checks <= 4_000 } else { run.checks >= 4_000 });
                Ok(Some((run.solved, run.checks, run.nodes, run.edges, run.components, run.motions)))
            };
            lab.all("test", &cases, job).unwrap().unwrap()
        };
        assert_eq!(counts(1), counts(3));
        let cancel = Cancel::new();
        cancel.cancel();
        assert_eq!(run(&rigid, &cases[0], 4_000, &cancel).unwrap(), None);
    }
}
