//! RRTConExt: a greedy tree explores, the other follows by one step.
//!
//! Named among the combinations of EXTEND and CONNECT by S. M. LaValle and J. J. Kuffner,
//! *Rapidly-exploring random trees: progress and prospects*, 2001.
//!
//! From one tree that holds the start and one that holds the goal, repeat:
//! 1. draw a sample, uniform in the space;
//! 2. connect the tree whose turn it is to it: from its nearest node step after step, each a new
//!    node, until it is reached or a step fails;
//! 3. if that added a node, extend the other tree from its nearest node, one step at most, toward
//!    the last one added;
//! 4. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 5. the other tree has the next turn.
//!
//! **When to use it.** Rarely, for comparison: in wide open spaces, where growing toward samples pays more than growing
//! toward the other tree. [RRT-Connect](super::rrt_connect) is the better first choice.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, RrtConExt, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = RrtConExt::new(problem, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{
    Append, Connect, Extend, NearestSelector, PlannerInfo, Samples, TreePlannerParts, Tuning, TwoTrees,
};
use mp_cspace::Uniform;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rrt-con-ext",
    summary: "two trees: greedy toward samples, one step toward each other; for comparison",
    citation: "LaValle and Kuffner 2001",
    parameters: &[STEP, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: NEEDS_BOTH_ENDS,
};

/// Makes it by name.
pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    Ok(Box::new(RrtConExt::with_index(args.problem, args.index, args.tuning)?))
}

/// RRTConExt: see the [module](self).
pub type RrtConExt<'c, C, L, N> =
    TwoTrees<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Connect, Extend, Append>;

constructors! {
    "RRTConExt" RrtConExt<C, L, N> where [N: Clone],
    |problem, index, tuning: Tuning| {
        let target_sampler = Samples(Uniform(problem.space()));
        let extender = (Connect::default(), Extend);
        let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter: Append, tuning };
        Self::assemble(INFO.name, problem, parts)
    }
}
