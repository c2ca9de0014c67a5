//! RSRT, the rapidly-exploring sorted random tree.
//!
//! N. Jouandeau, Y. Touati and A. Ali Cherif, *Incremental motion planning with Las Vegas algorithms*,
//! 2008, §3.2: [ALG. 4](super::rrt_inputs) with collision tests subordinate to the metric.
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample `q_rand`, uniform in the space, or with a small probability a goal state;
//! 2. find the node `q_prox` nearest to it;
//! 3. produce each successor of `q_prox`: every input applied for the duration, and its distance to
//!    `q_rand`;
//! 4. sort the successors by distance, ties by the order of inputs;
//! 5. test them for collision in that order; the first that is free becomes a child of `q_prox`,
//!    unless a node is there already, and no more are tested;
//! 6. where that is in the goal, verify the path: return it, or prune from the edge that failed.
//!
//! These are two changes to ALG. 4, which the paper makes at once and calls one inversion:
//! - The tests are subordinate to the metric (`order`). The paper says that this reduces "the number of calls
//!   to the collision detector proportionally to the nature and the dimension of U". It changes the number of
//!   tests and nothing else: under the same condition both orders grow the same tree.
//! - The listing has no `dmin` any more (`accept`): the child need not be nearer to the sample than `q_prox`
//!   is. From this comes the paper's "equiprobability expansion of each node independently of their
//!   relationship with obstacles". It changes the tree.
//!
//! [`InputPlanner::ordered`](mp_control::InputPlanner::ordered) and
//! [`accepting`](mp_control::InputPlanner::accepting) set each of them.
//!
//! **When to use it.** For systems that move by a set of inputs: velocities, accelerations, wheels. Under the
//! same condition it takes the same successors as ALG. 4, with fewer collision tests. For bodies that can
//! move in any direction [RRT-Connect](super::rrt_connect) is faster.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | local planner: flow, inputs, duration | an [`InputPlanner`](mp_control::InputPlanner) | |
//! | `order`: test all successors, or sort them and take the first free one | `test-all`, `sort-first` | `sort-first` |
//! | `accept`: successors nearer to the sample than the node extended, or any | `nearer`, `any` | `any` |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `step`: within it goals are connected to exactly; by name, also the longest motion | (0, extent of the space] | 5% of the extent |
//! | `inputs` (by name): directions of motion, both ways along each degree of freedom first; 0 for those alone | 0, 1, 2, … | 0 |
//! | `levels` (by name): lengths of motion, each a quarter of the one before | 1 to 20 | 3 |
//!
//! [By name](crate::build) it moves by a uniform set of inputs over the degrees of freedom, translation
//! and rotation alike, and keeps the edges of the local planner given.
//!
//! A car turns around in a lane too narrow to do so without reversing:
//! ```
//! use mp_control::{DiscreteFlowCheck, Car, InputPlanner, ReplayFinely};
//! use mp_cspace::{Iterations, Outcome, Planner, Length, Rng, Se2, Se2State};
//! use mp_tree::{Goals, Problem, Rsrt, Tuning};
//!
//! let space = Se2::new([0.0, 0.0], [8.0, 3.0])?;
//! let (car, free) = (Car::new(1.0)?, |q: &Se2State| (q.translation.y - 1.5).abs() < 1.2);
//! let check = DiscreteFlowCheck::new(&space, free, Length::Absolute(0.1))?;
//! let mut local = InputPlanner::new(&space, car, Car::inputs(1.0, 0.6, 2)?, 0.5, check)?;
//! let verifier = ReplayFinely::new(&space, car, free, Length::Absolute(0.005))?;
//! let turned = Goals::region(|q: &Se2State| q.angle.abs() > 3.0);
//!
//! let problem = Problem::new(&space, &mut local, verifier, Se2State::new(4.0, 1.5, 0.0), turned)?;
//! let mut planner = Rsrt::new(problem, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(20_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert!(path.edges.iter().any(|leg| leg.input[0] < 0.0), "it must have reversed");
//! drop(planner);
//! let counters = local.counters();
//! assert!(counters.tested < counters.successors / 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{ACCEPT, BuildArgs, BuildResult, INPUTS, LEVELS, ORDER, Types, make_by_inputs};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    AppendApart, Extend, NearestSelector, Parameter, PlannerInfo, Samples, SingleTree, TreePlannerParts,
    Tuning,
};
use mp_control::{Accept, InputChoice, Order};
use mp_cspace::Uniform;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rsrt",
    summary: "one tree moved by a set of inputs, sorted by distance before any is tested for collision",
    citation: "Jouandeau, Touati and Ali Cherif 2008",
    parameters: &[
        STEP,
        INPUTS,
        LEVELS,
        Parameter { default: "sort-first", ..ORDER },
        Parameter { default: "any", ..ACCEPT },
        GOAL_BIAS,
        PATIENCE,
    ],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    make_by_inputs(args, (Order::SortFirst, Accept::Any))
}

/// RSRT: see the [module](self).
pub type Rsrt<'c, C, L, N> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Extend, AppendApart>;

constructors! {
    "RSRT" Rsrt<C, L, N> where [L: InputChoice],
    |problem, index, tuning: Tuning| {
        let mut problem = problem;
        problem.local_mut().set_defaults(Order::SortFirst, Accept::Any);
        let target_sampler = Samples(Uniform(problem.space()));
        let inserter = AppendApart::default();
        Self::assemble(problem, TreePlannerParts { target_sampler, selector: NearestSelector(index), extender: Extend, inserter, tuning })
    }
}
