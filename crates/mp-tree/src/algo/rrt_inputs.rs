//! RRT by inputs: tests the successors of a node by all inputs, and keeps the best.
//!
//! S. M. LaValle and J. J. Kuffner, *Randomized kinodynamic planning*, ICRA 1999. As ALG. 4 of
//! N. Jouandeau, Y. Touati and A. Ali Cherif, *Incremental motion planning with Las Vegas algorithms*,
//! 2008.
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample `q`, uniform in the space, or with a small probability a goal state;
//! 2. find the node `q_prox` nearest to it, at distance `dmin`;
//! 3. for each input `u`: apply it to `q_prox` for the duration, which leads to `q_tmp`;
//! 4. test the motion to `q_tmp` for collision;
//! 5. where it is free and `q_tmp` nearer to `q` than `dmin`, let it be `q_new` and its distance `dmin`;
//! 6. add `q_new` as a child of `q_prox`, unless there is none or it is in the tree already;
//! 7. where that is in the goal, verify the path: return it, or prune from the edge that failed.
//!
//! The listing in the paper does not lower `dmin` in step 5, and would keep the last of the nearer
//! successors; its text asks for the closest, which is what is done here.
//!
//! [RSRT](super::rsrt) changes two things: it sorts the successors before it tests any (`order`), and takes
//! any of them, nearer or not (`accept`). Each can be set here alone: with `order=sort-first` the tree is the
//! same, bit for bit, for fewer tests; with `accept=any` it is another tree. With both this planner is RSRT.
//! Types set them by [`InputPlanner::ordered`](mp_control::InputPlanner::ordered) and
//! [`accepting`](mp_control::InputPlanner::accepting); with [`Accept::Any`] use the type
//! [`Rsrt`](crate::Rsrt), which refuses states that a node of the tree resembles: an input and its opposite
//! lead back, but for rounding.
//!
//! **When to use it.** For comparison: [RSRT](super::rsrt) needs fewer collision tests.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | local planner: flow, inputs, duration | an [`InputPlanner`](mp_control::InputPlanner) | |
//! | `order`: test all successors, or sort them and take the first free one | `test-all`, `sort-first` | `test-all` |
//! | `accept`: successors nearer to the sample than the node extended, or any | `nearer`, `any` | `nearer` |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `step`: within it goals are connected to exactly; by name, also the longest motion | (0, extent of the space] | 5% of the extent |
//! | `inputs` (by name): directions of motion, both ways along each degree of freedom first; 0 for those alone | 0, 1, 2, … | 0 |
//! | `levels` (by name): lengths of motion, each a quarter of the one before | 1 to 20 | 3 |
//!
//! [By name](crate::build) it moves by a uniform set of inputs over the degrees of freedom, translation
//! and rotation alike, and keeps the edges of the local planner given.
//!
//! A point with velocities goes around a disc, by accelerations:
//! ```
//! use mp_control::{DiscreteFlowCheck, DoubleIntegrator, InputPlanner, InputSet, OnPosition, ReplayFinely};
//! use mp_cspace::{Iterations, Outcome, Planner, Product, Length, Rn, Rng};
//! use mp_tree::{Goals, Problem, RrtInputs, Tuning};
//! use nalgebra::Vector2;
//!
//! type State = (Vector2<f64>, Vector2<f64>);
//! let space = Product::with_velocity(Rn::new([0.0, 0.0], [1.0, 1.0])?, [0.5, 0.5])?;
//! let free = OnPosition(|q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3);
//! let system = DoubleIntegrator::new(space.spaces().0)?;
//! let check = DiscreteFlowCheck::new(&space, free.clone(), Length::Fraction(0.01))?;
//! let inputs = InputSet::grid([1.0, 1.0], 3)?;
//! let local = InputPlanner::new(&space, system, inputs, 0.2, check)?;
//! let verifier = ReplayFinely::new(&space, system, free, Length::Fraction(0.0005))?;
//! let far_side = Goals::region(|(q, _): &State| q.x > 0.9);
//!
//! let start = (Vector2::new(0.1, 0.5), Vector2::zeros());
//! let problem = Problem::new(&space, local, verifier, start, far_side)?;
//! let mut planner = RrtInputs::new(problem, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(20_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert!(path.edges.iter().all(|leg| leg.duration == 0.2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{ACCEPT, BuildArgs, BuildResult, INPUTS, LEVELS, ORDER, Types, make_by_inputs};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    AppendDistinct, Extend, NearestSelector, PlannerInfo, Samples, SingleTree, TreePlannerParts, Tuning,
};
use mp_control::{Accept, InputChoice, Order};
use mp_cspace::Uniform;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rrt-inputs",
    summary: "one tree moved by a set of inputs, all of them tested for collision; RSRT needs fewer tests",
    citation: "LaValle and Kuffner 1999",
    parameters: &[STEP, INPUTS, LEVELS, ORDER, ACCEPT, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    make_by_inputs(args, (Order::TestAll, Accept::Nearer))
}

/// RRT by inputs: see the [module](self).
pub type RrtInputs<'c, C, L, N> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Extend, AppendDistinct>;

constructors! {
    "RRT by inputs" RrtInputs<C, L, N> where [L: InputChoice],
    |problem, index, tuning: Tuning| {
        let mut problem = problem;
        problem.local_mut().set_defaults(Order::TestAll, Accept::Nearer);
        let target_sampler = Samples(Uniform(problem.space()));
        let inserter = AppendDistinct::default();
        Self::assemble(problem, TreePlannerParts { target_sampler, selector: NearestSelector(index), extender: Extend, inserter, tuning })
    }
}
