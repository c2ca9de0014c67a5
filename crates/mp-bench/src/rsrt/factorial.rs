//! The factorial experiment: what sorting the successors brings, and what accepting any of them brings, at
//! each number of inputs.
//!
//! ALG. 4 and RSRT differ in two things. ALG. 4 tests all successors for collision, and takes the nearest
//! free one only if it is nearer to the sample than the node it came from. RSRT sorts the successors first,
//! and takes the first free one in any case. The four combinations are run with sets of 12 to 768 inputs,
//! each set containing the smaller ones ([`InputSet::directions`](mp_control::InputSet::directions)): the
//! axes first, as in the paper, then directions of a low-discrepancy sequence on the sphere, scaled to the
//! limits of each degree of freedom, each with its opposite.

use super::in_scene::in_scene;
use crate::clock::processor_clock;
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Log};
use crate::scenes::bare;
use mp_control::{Accept, Order};
use mp_cspace::Cancel;
use mp_experiments::clutter::{ComparedPlanner, Mover, Obstacle, Run, RunSettings};
use mp_plan::{Error, Scene};
use serde::{Deserialize, Serialize};

/// Numbers of inputs.
pub(super) const INPUTS: [usize; 4] = [12, 48, 192, 768];
/// Names of the orders and of the conditions, ALG. 4's first.
pub(super) const ORDERS: [&str; 2] = ["test-all", "sort-first"];
pub(super) const ACCEPTS: [&str; 2] = ["nearer", "any"];
/// The metric in the worlds of boxes, which suits both robots.
const METRIC: &str = "scaled";

/// What is planned for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// A robot and a model among a number of boxes.
    Boxes { mover: &'static str, model: &'static str, obstacles: usize },
    /// A shipped scene; inputs are velocities, one step of the planner's default long.
    Scene(&'static str),
}

/// A problem of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FactorialProblem {
    pub(super) name: &'static str,
    pub(super) place: Place,
    /// Whether there is no obstacle: to show that the durations and limits let every cell solve that.
    pub(super) empty: bool,
}

const fn boxes(
    name: &'static str,
    mover: &'static str,
    model: &'static str,
    obstacles: usize,
) -> FactorialProblem {
    FactorialProblem { name, place: Place::Boxes { mover, model, obstacles }, empty: obstacles == 0 }
}

const fn shipped(name: &'static str) -> FactorialProblem {
    FactorialProblem { name, place: Place::Scene(name), empty: false }
}

pub(super) const PROBLEMS: [FactorialProblem; 11] = [
    boxes("free-flyer, positions, empty", "free-flyer", "positions", 0),
    boxes("free-flyer, positions, 256", "free-flyer", "positions", 256),
    boxes("free-flyer, velocities, empty", "free-flyer", "velocities", 0),
    boxes("free-flyer, velocities, 128", "free-flyer", "velocities", 128),
    boxes("6-DOF arm, positions, empty", "6-DOF arm", "positions", 0),
    boxes("6-DOF arm, positions, 128", "6-DOF arm", "positions", 128),
    boxes("6-DOF arm, velocities, empty", "6-DOF arm", "velocities", 0),
    boxes("6-DOF arm, velocities, 32", "6-DOF arm", "velocities", 32),
    shipped("gempa-3"),
    shipped("rrs-high"),
    shipped("planar-bugtrap"),
];

/// The size of the measurement.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) seeds: u64,
    pub(super) inputs: Vec<usize>,
    pub(super) problems: Vec<FactorialProblem>,
    pub(super) cap: f64,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) problem: String,
    pub(super) inputs: usize,
    pub(super) order: String,
    pub(super) accept: String,
    /// The seed, which is also the instance of the boxes.
    pub(super) seed: u64,
}

impl Plan {
    /// The case of one cell.
    pub(super) fn case(problem: &str, inputs: usize, [order, accept]: [&str; 2], seed: u64) -> Case {
        let [problem, order, accept] = [problem, order, accept].map(str::to_owned);
        Case { problem, inputs, order, accept, seed }
    }

    /// All cases, seed by seed: what was interrupted has all cells for the seeds it has.
    pub(super) fn cases(&self) -> Vec<Case> {
        let mut all = Vec::new();
        for seed in 1..=self.seeds {
            for problem in &self.problems {
                for &inputs in &self.inputs {
                    for order in ORDERS {
                        all.extend(ACCEPTS.map(|a| Self::case(problem.name, inputs, [order, a], seed)));
                    }
                }
            }
        }
        all
    }
}

/// A problem with its obstacles for one seed.
enum World {
    Boxes(Mover, &'static str, Vec<Obstacle>),
    Scene(Box<Scene>),
}

impl World {
    fn new(plan: &Plan, case: &Case) -> Result<Self> {
        let problem = plan.problems.iter().find(|p| p.name == case.problem);
        Ok(match problem.map(|p| p.place) {
            Some(Place::Boxes { mover, model, obstacles }) => {
                let mover = Mover::find(mover).into_error()?;
                let obstacles = mover.obstacles(obstacles, case.seed).into_error()?;
                Self::Boxes(mover, model, obstacles)
            }
            Some(Place::Scene(name)) => Self::Scene(Box::new(Scene::find(name)?)),
            None => return Err(Error::new(format!("there is no problem `{}` here", case.problem))),
        })
    }

    fn run(&self, case: &Case, cap: f64, cancel: &Cancel) -> Result<Option<Run>> {
        let order = if case.order == ORDERS[0] { Order::TestAll } else { Order::SortFirst };
        let accept = if case.accept == ACCEPTS[0] { Accept::Nearer } else { Accept::Any };
        let settings = RunSettings {
            planner: ComparedPlanner::Inputs(order, accept),
            inputs: case.inputs,
            seed: case.seed,
            cap,
            clock: processor_clock(),
            cancel: cancel.clone(),
        };
        match self {
            Self::Boxes(mover, model, obstacles) => {
                mover.plan(obstacles, model, METRIC, &settings).into_error()
            }
            Self::Scene(scene) => {
                let request = bare("rrt-inputs")
                    .set("order", &case.order)
                    .set("accept", &case.accept)
                    .set("inputs", case.inputs)
                    .set("levels", 1)
                    .time(cap)
                    .seed(case.seed);
                in_scene(scene, &request, cancel)
            }
        }
    }
}

/// Runs the cases that are not in the log. False when it was interrupted.
pub(super) fn measure(plan: &Plan, lab: &Lab, log: &mut Log<Case, Run>) -> Result<bool> {
    lab.measure_in(
        log,
        "rsrt, factorial",
        &plan.cases(),
        |a, b| (a.seed, &a.problem) == (b.seed, &b.problem),
        |case| World::new(plan, case),
        |world, case| world.run(case, plan.cap, &lab.cancel),
    )
}
