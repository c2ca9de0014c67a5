//! Runs of all planners on all scenes, each with the same budget of collision queries.

use super::queries::checker;
use crate::clock::{nanoseconds, seconds_since};
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use crate::output::note;
use crate::scenes::{Rigid, bare, either};
use mp_cspace::{Cancel, Configuration, KdTree};
use mp_plan::{Motion, RigidScene, RigidSpace, TypedMotion};
use mp_roadmap::{Roadmap, RoadmapQueries};
use serde::{Deserialize, Serialize};

/// The size of the measurement.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// Collision and distance queries of a run: the same on every machine.
    pub(super) budget: u64,
    pub(super) seeds: u32,
}

impl Plan {
    /// The cases of a planner on a scene, one for each seed.
    pub(super) fn cases(&self, scene: &str, planner: &str) -> Vec<Case> {
        let case = |seed| Case { scene: scene.to_owned(), planner: planner.to_owned(), seed };
        (1..=u64::from(self.seeds)).map(case).collect()
    }

    /// The cases of all planners on these scenes.
    pub(super) fn all_cases(&self, scenes: &[String]) -> Vec<Case> {
        let of = |scene| planners().into_iter().flat_map(move |planner| self.cases(scene, planner));
        scenes.iter().map(String::as_str).flat_map(of).collect()
    }
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) scene: String,
    pub(super) planner: String,
    pub(super) seed: u64,
}

/// The result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    /// Whether a path was found within the budget.
    pub(super) solved: bool,
    /// Processor time until there is a verified path or the budget is used up.
    pub(super) seconds: f64,
    /// Processor time of one more query for the path to the finished roadmap.
    pub(super) again: Option<f64>,
    pub(super) nodes: usize,
    /// The edges of a roadmap; zero for trees.
    pub(super) edges: usize,
    pub(super) components: usize,
    /// Collision and distance queries.
    pub(super) checks: u64,
    pub(super) motions: u64,
}

impl Run {
    /// Whether the run was solved with at most `budget` queries.
    pub(super) fn solved_within(&self, budget: u64) -> bool {
        self.solved && self.checks <= budget
    }
}

/// The tree planner with which the roadmaps are compared.
pub(super) const BESIDE: &str = "rrt-connect";

/// OBPRM with each of its ways to make nodes.
const OBPRM: [&str; 4] = ["obprm prototype", "obprm contact", "obprm free", "obprm shells"];

/// The planners, some with their way to make nodes: those that build roadmaps, and one tree planner. PRM* is
/// left out as it aims at short paths, not at narrow passages, LazyPRM as most of its cost is graph search,
/// not queries, and regional PRM as its samples are those of PRM: the suite `regions` measures it.
pub(super) fn planners() -> Vec<&'static str> {
    let roadmaps = mp_roadmap::planners().iter();
    let other = ["obprm", "prm-star", "lazy-prm", "regional-prm"];
    let names = roadmaps.map(|info| info.name).filter(|name| !other.contains(name));
    names.chain(OBPRM).chain([BESIDE]).collect()
}

/// The number of neighbours to which start and goal are connected in one more query.
const NEIGHBOURS: usize = 10;

/// Runs the cases that are not in the log, on several threads, scene by scene. When the scenes become
/// `harder` in order, a planner that solves none of the seeds of a scene is not run on later ones. False when
/// it was interrupted.
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

/// One run; `None` when it was interrupted.
fn run(rigid: &Rigid, case: &Case, budget: u64, cancel: &Cancel) -> Result<Option<Run>> {
    let (name, nodes) = case.planner.split_once(' ').map_or((&*case.planner, None), |(a, b)| (a, Some(b)));
    let request = bare(name).seed(case.seed);
    let request = nodes.into_iter().fold(request, |request, nodes| request.set("nodes", nodes));
    let Some((found, solved)) = rigid.search(request, budget, cancel)? else { return Ok(None) };
    let [edges, components] = found.map.unwrap_or_default();
    let again = match found.roadmap.filter(|_| solved) {
        Some(map) => either!(rigid, scene => again(scene, map)?),
        None => None,
    };
    Ok(Some(Run {
        solved,
        seconds: found.time.as_secs_f64(),
        again,
        nodes: found.progress.nodes,
        edges,
        components,
        checks: found.queries,
        motions: found.progress.motions,
    }))
}

/// The processor time of a query for the path from start to goal; `None` when there is none.
fn again<M: RigidSpace>(scene: &RigidScene<M>, map: Roadmap<Configuration>) -> Result<Option<f64>> {
    let checker = checker(scene, scene.verifier()?)?;
    let mut answers = RoadmapQueries::new(checker, map, <KdTree>::default(), NEIGHBOURS).into_error()?;
    let began = nanoseconds();
    let answer = answers.answer(scene.start(), &scene.goals()[0]);
    Ok(answer.is_ok().then(|| seconds_since(began)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roadmaps::scenes::CORRIDORS;

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
