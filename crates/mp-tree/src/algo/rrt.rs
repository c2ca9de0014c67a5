//! RRT, the rapidly-exploring random tree.
//!
//! S. M. LaValle, *Rapidly-exploring random trees: a new tool for path planning*, TR 98-11, Iowa
//! State University, 1998. As ALG. 1 of N. Jouandeau, Y. Touati and A. Ali Cherif, *Incremental
//! motion planning with Las Vegas algorithms*, 2008, which continues the same tree when asked for
//! more iterations and never stacks a node on another (§2.2, 2.3, 2.5).
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample, uniform in the space, or with a small probability a goal state;
//! 2. find the node nearest to it;
//! 3. move from that node toward the sample, one step at most;
//! 4. where the motion is free, add its end as a child of the node;
//! 5. where that is in the goal, verify the path: return it, or prune from the edge that failed.
//!
//! **When to use it.** For goals that are only a test (a region), local planners that cannot run
//! backward, and goals that are easy to leave but hard to enter. When both
//! ends are known states, [RRT-Connect](super::rrt_connect) is usually much faster.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//!
//! A point goes around a disc to the far side of the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Goals, Problem, Rrt, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let far_side = Goals::region(|q: &Vector2<f64>| q.x > 0.95);
//!
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.5), far_side)?;
//! let mut planner = Rrt::new(problem, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert!(path.states.last().unwrap().x > 0.95);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{Append, Extend, NearestSelector, PlannerInfo, Samples, SingleTree, TreePlannerParts, Tuning};
use mp_cspace::Uniform;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rrt",
    summary: "one tree from the start, one step per iteration; for goal regions and one-way motions",
    citation: "LaValle 1998",
    parameters: &[STEP, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    Ok(Box::new(Rrt::with_index(args.problem, args.index, args.tuning)?))
}

/// RRT: see the [module](self).
pub type Rrt<'c, C, L, N> = SingleTree<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Extend, Append>;

constructors! {
    "RRT" Rrt<C, L, N>,
    |problem, index, tuning: Tuning| {
        let target_sampler = Samples(Uniform(problem.space()));
        let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender: Extend, inserter: Append, tuning };
        Self::assemble(problem, parts)
    }
}
