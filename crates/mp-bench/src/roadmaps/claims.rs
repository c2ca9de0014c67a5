//! What Benitez et al. 2010, *Key elements for motion planning algorithms*, say of roadmaps, as experiments:
//! how nodes are made and connected, under which metric; what each part of obstacle-geometry PRM brings; and
//! nodes in contact with obstacles under motion checks of both kinds. Every run has the same budget of
//! collision and distance queries, and runs that are compared have the same scene and seed.

use super::scenes::CORRIDORS;
use crate::error::Result;
use crate::experiment::{Lab, Log};
use crate::scenes::{Rigid, bare};
use clap::ValueEnum;
use mp_cspace::Cancel;
use mp_plan::{Error, Request};
use serde::{Deserialize, Serialize};

/// An experiment on the paper's claims.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Experiment {
    /// Connection × generation × metric.
    Factorial,
    /// Obstacle-geometry PRM without each of its parts, and the salvage of nodes that collide.
    Geometry,
    /// OBPRM with discrete motion checks beside certified ones.
    Contact,
    /// Trees that grow from start and goal beside the samples.
    Ends,
}

pub(super) const EXPERIMENTS: [Experiment; 4] =
    [Experiment::Factorial, Experiment::Geometry, Experiment::Contact, Experiment::Ends];

/// Scenes in which, at the budget, PRM solves some runs and not others, one in which it solves all, and one
/// in which it solves none.
const SCENES: [&str; 8] =
    ["rod 0.0892", "bar 0.3364", "gempa-1", "gempa-2", "gempa-3", "twisty", "bugtrap", "alpha-1.5"];

/// A way to make nodes: its name, the planner and its settings.
type Generation = (&'static str, &'static str, &'static [(&'static str, &'static str)]);

/// The ways to make nodes. Those of PRM are uniform, without its expansion.
const GENERATIONS: [Generation; 22] = [
    (UNIFORM, "prm", &[("expand", "0")]),
    ("gaussian", "gaussian-prm", &[]),
    ("bridge", "bridge-prm", &[]),
    ("obprm prototype", "obprm", &[("nodes", "prototype")]),
    ("obprm contact", "obprm", &[("nodes", "contact")]),
    ("obprm free", "obprm", &[("nodes", "free")]),
    ("obprm shells", "obprm", &[("nodes", "shells")]),
    (GEOMETRY, "obstacle-geometry-prm", &[]),
    ("no straightness", "obstacle-geometry-prm", &[("straightness", "no")]),
    ("no volume", "obstacle-geometry-prm", &[("volume", "no")]),
    ("no elastic band", "obstacle-geometry-prm", &[("bands", "0")]),
    ("no first approximation", "obstacle-geometry-prm", &[("far", "0")]),
    ("no near nodes", "obstacle-geometry-prm", &[("near", "no")]),
    ("no salvage", "obstacle-geometry-prm", &[("salvage", "no")]),
    ("no near nodes, no salvage", "obstacle-geometry-prm", &[("near", "no"), ("salvage", "no")]),
    (SALVAGED, "obstacle-geometry-prm", &[("far", "0"), ("near", "no")]),
    ("prm", "prm", &[]),
    ("prm, trees", "prm", &[TREES]),
    ("uniform, trees", "prm", &[("expand", "0"), TREES]),
    ("gaussian, trees", "gaussian-prm", &[TREES]),
    ("obprm free, trees", "obprm", &[("nodes", "free"), TREES]),
    ("obstacle geometry, trees", "obstacle-geometry-prm", &[TREES]),
];

/// Half of the attempts grow trees from start and goal.
const TREES: (&str, &str) = ("ends", "0.5");

/// The ways to make nodes, each without and with trees.
pub(super) const WITH_TREES: [[&str; 2]; 5] = [
    [UNIFORM, "uniform, trees"],
    ["prm", "prm, trees"],
    ["gaussian", "gaussian, trees"],
    ["obprm free", "obprm free, trees"],
    [GEOMETRY, "obstacle geometry, trees"],
];

/// The numbers of those of the factorial experiment, which come first, and of the variants of
/// obstacle-geometry PRM after them.
const FACTORS: usize = 8;
const PARTS: usize = 8;

pub(super) const UNIFORM: &str = "uniform";
pub(super) const GEOMETRY: &str = "obstacle geometry";
pub(super) const SALVAGED: &str = "uniform, salvaged";

/// The ways to connect nodes, with the settings for each.
const CONNECTIONS: [(&str, &[(&str, &str)]); 5] = [
    (NEAREST, &[("turns", "0")]),
    (PER_OBSTACLE, &[("connect", "obstacles"), ("turns", "0")]),
    (STAGED, &[("turns", "1")]),
    ("rotate-at-s", &[("straight", "no"), ("turns", "1")]),
    (FAR, &[("turns", "far")]),
];

pub(super) const NEAREST: &str = "k nearest";
const PER_OBSTACLE: &str = "per obstacle";
pub(super) const STAGED: &str = "staged";
/// That of obstacle-geometry PRM alone.
pub(super) const FAR: &str = "turns where far";

/// D of eq. 6 first.
pub(super) const METRICS: [&str; 3] = ["max-displacement", "euclidean", "swept-volume"];

pub(super) const CERTIFIED: &str = "certified";
/// The motion checks that are compared: certified, and tests of configurations 1% and 0.2% of the extent
/// apart.
pub(super) const CHECKS: [&str; 3] = [CERTIFIED, "discrete:1%", "discrete:0.2%"];

/// What is compared: how nodes are made and connected, the metric, and how motions are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Cell {
    pub(super) generation: &'static str,
    pub(super) connection: &'static str,
    pub(super) metric: &'static str,
    pub(super) checks: &'static str,
}

impl Cell {
    /// With certified checks, under the metric of eq. 6.
    pub(super) const fn of(generation: &'static str, connection: &'static str) -> Self {
        Self { generation, connection, metric: METRICS[0], checks: CERTIFIED }
    }

    /// Whether there is such a planner: connecting per obstacle takes nodes that belong to an obstacle.
    fn exists(&self) -> bool {
        let by_obstacles = self.generation == GEOMETRY || self.generation.starts_with("obprm");
        by_obstacles || self.connection != PER_OBSTACLE
    }

    pub(super) fn case(&self, scene: &str, seed: u64) -> Case {
        let [generation, connection, metric, checks] =
            [self.generation, self.connection, self.metric, self.checks].map(str::to_owned);
        Case { scene: scene.to_owned(), generation, connection, metric, checks, seed }
    }
}

impl Experiment {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Factorial => "roadmaps-factorial",
            Self::Geometry => "roadmaps-geometry",
            Self::Contact => "roadmaps-contact",
            Self::Ends => "roadmaps-ends",
        }
    }

    /// The scenes. In `twisty` and `bugtrap`, swept volumes take longer than all the rest.
    pub(super) fn scenes(self) -> &'static [&'static str] {
        match self {
            Self::Factorial => &SCENES[..5],
            Self::Geometry | Self::Contact => &SCENES[..7],
            Self::Ends => &SCENES,
        }
    }

    /// Seeds of each cell.
    pub(super) fn seeds(self) -> u32 {
        if self == Self::Factorial { 10 } else { 20 }
    }

    /// The cells that are compared.
    pub(super) fn cells(self) -> Vec<Cell> {
        match self {
            Self::Factorial => {
                let cells = generations().flat_map(|generation| {
                    connections().flat_map(move |connection| {
                        METRICS.map(|metric| Cell { metric, ..Cell::of(generation, connection) })
                    })
                });
                cells.filter(Cell::exists).collect()
            }
            Self::Geometry => {
                let parts = GENERATIONS[FACTORS - 1..FACTORS + PARTS].iter().map(|g| Cell::of(g.0, FAR));
                // Samples that are salvaged are compared with those of PRM, which nothing is far from.
                let parts = parts.filter(|cell| cell.generation != SALVAGED);
                let more =
                    [Cell::of(GEOMETRY, NEAREST), Cell::of(UNIFORM, NEAREST), Cell::of(SALVAGED, NEAREST)];
                parts.chain(more).collect()
            }
            Self::Contact => {
                let nodes = generations().filter(|g| *g == UNIFORM || g.starts_with("obprm"));
                nodes.flat_map(|g| CHECKS.map(|checks| Cell { checks, ..Cell::of(g, STAGED) })).collect()
            }
            Self::Ends => WITH_TREES.as_flattened().iter().map(|g| Cell::of(g, NEAREST)).collect(),
        }
    }
}

/// The ways to make nodes of the factorial experiment.
pub(super) fn generations() -> impl Iterator<Item = &'static str> {
    GENERATIONS[..FACTORS].iter().map(|g| g.0)
}

/// The ways to connect nodes of the factorial experiment.
pub(super) fn connections() -> impl Iterator<Item = &'static str> {
    CONNECTIONS.iter().map(|c| c.0).filter(|name| *name != FAR)
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) scene: String,
    pub(super) generation: String,
    pub(super) connection: String,
    pub(super) metric: String,
    pub(super) checks: String,
    pub(super) seed: u64,
}

/// The result of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    /// Whether a verified path was found within the budget.
    pub(super) solved: bool,
    /// Processor time until then, or until the budget was used up.
    pub(super) seconds: f64,
    pub(super) nodes: usize,
    pub(super) components: usize,
    /// Collision and distance queries.
    pub(super) queries: u64,
    pub(super) motions: u64,
    /// Paths that were found and failed the verification.
    pub(super) rejected: u64,
}

/// The size of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) experiment: Experiment,
    /// Collision and distance queries of a run.
    pub(super) budget: u64,
    pub(super) seeds: u64,
    pub(super) scenes: Vec<String>,
}

impl Plan {
    /// All cases, seed by seed: what was interrupted has all cells for the seeds it has.
    pub(super) fn cases(&self) -> Vec<Case> {
        let cells = self.experiment.cells();
        let of = |seed: u64, scene: &str| cells.iter().map(|cell| cell.case(scene, seed)).collect::<Vec<_>>();
        (1..=self.seeds).flat_map(|seed| self.scenes.iter().flat_map(move |scene| of(seed, scene))).collect()
    }
}

/// A scene by name: a corridor, or a shipped one.
fn place(name: &str) -> Result<Rigid> {
    match CORRIDORS.iter().find_map(|corridors| corridors.find(name)) {
        Some(corridor) => corridor,
        None => Rigid::load(name),
    }
}

/// Runs the cases that are not in the log. False when it was interrupted.
pub(super) fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>) -> Result<bool> {
    lab.measure_in(
        log,
        plan.experiment.name(),
        &plan.cases(),
        |a, b| (a.seed, &a.scene) == (b.seed, &b.scene),
        |case| place(&case.scene),
        |rigid, case| run(rigid, case, plan.budget, &lab.cancel),
    )
}

fn request(case: &Case) -> Result<Request> {
    let unknown = |name: &str| Error::new(format!("there is no way `{name}` here"));
    let generation = GENERATIONS.iter().find(|g| g.0 == case.generation);
    let (_, planner, more) = generation.ok_or_else(|| unknown(&case.generation))?;
    let connection = CONNECTIONS.iter().find(|c| c.0 == case.connection);
    let (_, connected) = connection.ok_or_else(|| unknown(&case.connection))?;
    let request = bare(planner).seed(case.seed).metric(case.metric.parse()?).motion(case.checks.parse()?);
    Ok(more.iter().chain(*connected).fold(request, |request, (key, value)| request.set(*key, value)))
}

/// One run; `None` when it was interrupted.
fn run(rigid: &Rigid, case: &Case, budget: u64, cancel: &Cancel) -> Result<Option<Run>> {
    let found = rigid.search(request(case)?, budget, cancel)?;
    Ok(found.map(|(found, solved)| Run {
        solved,
        seconds: found.time.as_secs_f64(),
        nodes: found.progress.nodes,
        components: found.map.map_or(0, |[_, components]| components),
        queries: found.queries,
        motions: found.progress.motions,
        rejected: found.progress.rejected,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_cell_is_a_planner_of_its_own() {
        for experiment in EXPERIMENTS {
            let cells = experiment.cells();
            assert_eq!(cells.iter().collect::<HashSet<_>>().len(), cells.len());
            let requests: Vec<Request> =
                cells.iter().map(|cell| request(&cell.case("", 1)).unwrap()).collect();
            for (i, request) in requests.iter().enumerate() {
                request.check().unwrap();
                assert!(!requests[..i].contains(request), "{request:?}");
            }
        }
        // 8 ways to make nodes, 4 to connect them, 3 metrics; three of the first have no obstacles.
        assert_eq!(Experiment::Factorial.cells().len(), 8 * 4 * 3 - 3 * 3);
        assert_eq!(Experiment::Geometry.cells().len(), 11);
        assert_eq!(Experiment::Contact.cells().len(), 15);
        assert_eq!(Experiment::Ends.cells().len(), 10);
    }

    /// The plan says what of a log is its own, and runs depend on nothing but their case.
    #[test]
    fn cases_are_run_once_and_alike() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Lab::test(folder.path(), 2);
        let scenes = vec!["rod 0.3".to_owned()];
        let plan = Plan { experiment: Experiment::Contact, budget: 1_500, seeds: 1, scenes };
        let mut log = lab.log("claims", 1_500.0).unwrap();
        assert!(measure(&plan, &lab, &mut log).unwrap());
        assert_eq!(log.all().len(), 15);
        assert_eq!(log.each(&plan.cases()).count(), 15);
        let (case, known) = log.all()[7];
        let again = run(&place(&case.scene).unwrap(), case, 1_500, &lab.cancel).unwrap().unwrap();
        assert_eq!(Run { seconds: known.seconds, ..again }, *known);
        assert!(if known.solved { known.queries <= 1_500 } else { known.queries >= 1_500 });
        let other = Plan { experiment: Experiment::Geometry, ..plan };
        assert!(!other.cases().contains(case));
        assert!(place("rod 0.77").is_err() && place("nowhere").is_err());
    }
}
