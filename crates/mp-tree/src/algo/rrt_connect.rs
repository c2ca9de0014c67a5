//! RRT-Connect and its siblings: two trees that grow toward each other.
//!
//! J. J. Kuffner and S. M. LaValle, *RRT-Connect: an efficient approach to single-query path
//! planning*, ICRA 2000. As ALG. 2 and 3 of N. Jouandeau, Y. Touati and A. Ali Cherif,
//! *Incremental motion planning with Las Vegas algorithms*, 2008.
//!
//! EXTEND takes one step at most from the node nearest to its target. CONNECT takes step after step, each a
//! new node, until the target is reached or a step fails. From one tree that holds the start and one that
//! holds the goal, repeat:
//! 1. draw a sample, uniform in the space;
//! 2. explore: grow the tree whose turn it is toward it;
//! 3. join: if that added a node, grow the other tree toward the last one added;
//! 4. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 5. the other tree has the next turn.
//!
//! Which of the two explores and which joins makes four planners (S. M. LaValle and J. J. Kuffner,
//! *Rapidly-exploring random trees: progress and prospects*, 2001; [`BiRrt`] also in the same, *Randomized
//! kinodynamic planning*, ICRA 1999). Both ends must be known states (or the goal a sampler), and motions
//! must run backward as well as forward.
//!
//! | planner | explores by | joins by | when to use it |
//! |---|---|---|---|
//! | [`RrtConnect`] | EXTEND | CONNECT | Try it first. |
//! | [`BiRrt`] | EXTEND | EXTEND | Where greedy connections do not pay: where long motions mostly fail, or where the local planner is only good at single steps. |
//! | [`RrtConCon`] | CONNECT | CONNECT | In open spaces with holonomic motions, where the authors found it the fastest on some problems. Near obstacles RRT-Connect spreads its nodes better. |
//! | [`RrtConExt`] | CONNECT | EXTEND | Rarely, for comparison: in wide open spaces, where growing toward samples pays more than growing toward the other tree. |
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `balance`: a tree with more than this times the nodes of the other one waits; 0 for strict turns | 0, or at least 1 | 0 |
//!
//! A point goes around a disc in the unit square, by each of the four:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{BiRrt, Problem, RrtConCon, RrtConExt, RrtConnect, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = || Problem::new(&space, local.clone(), verifier.clone(), start, goal);
//! let planners: [Box<dyn Planner<_, Edge = ()>>; 4] = [
//!     Box::new(RrtConnect::new(problem()?, Tuning::default())?),
//!     Box::new(BiRrt::new(problem()?, Tuning::default())?),
//!     Box::new(RrtConCon::new(problem()?, Tuning::default())?),
//!     Box::new(RrtConExt::new(problem()?, Tuning::default())?),
//! ];
//! for mut planner in planners {
//!     let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//!     let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//!     assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{
    Append, Connect, Extend, NearestSelector, PlannerInfo, Samples, TreePlannerParts, Tuning, TwoTrees,
};
use mp_cspace::Uniform;

/// Writes one of the four planners, with its entry in a module of its own: how it explores and joins; its
/// names, when to use it, and its paper.
macro_rules! two_trees {
    ($what:literal $variant:ident: $explore:ident, $join:ident;
     $module:ident { name: $name:literal, aliases: $aliases:expr, summary: $summary:literal, citation: $citation:literal }
    ) => {
        #[doc = concat!($what, ": see the [module](self).")]
        pub type $variant<'c, C, L, N> =
            TwoTrees<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, $explore, $join, Append>;

        constructors! {
            $what $variant<C, L, N> where [N: Clone],
            |problem, index, tuning: Tuning| {
                let target_sampler = Samples(Uniform(problem.space()));
                let extender = ($explore::default(), $join::default());
                let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter: Append, tuning };
                Self::assemble($name, problem, parts)
            }
        }

        #[doc = concat!($what, " by name.")]
        pub mod $module {
            use super::*;

            /// The entry of [`planners`](crate::planners).
            pub const INFO: PlannerInfo = PlannerInfo {
                name: $name,
                summary: $summary,
                citation: $citation,
                parameters: &[STEP, GOAL_BIAS, PATIENCE, BALANCE],
                aliases: $aliases,
                cannot: NEEDS_BOTH_ENDS,
            };

            pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
                Ok(Box::new($variant::with_index(args.problem, args.index, args.tuning)?))
            }
        }
    };
}

two_trees! {
    "RRT-Connect" RrtConnect: Extend, Connect;
    ext_con {
        name: "rrt-connect", aliases: &["rrt-ext-con"],
        summary: "trees from start and goal that grow toward each other; the first to try",
        citation: "Kuffner and LaValle 2000"
    }
}

two_trees! {
    "Bi-RRT" BiRrt: Extend, Extend;
    ext_ext {
        name: "bi-rrt", aliases: &["rrt-ext-ext"],
        summary: "two trees, each with one step per iteration; where long connections mostly fail",
        citation: "LaValle and Kuffner 1999"
    }
}

two_trees! {
    "RRTConExt" RrtConExt: Connect, Extend;
    con_ext {
        name: "rrt-con-ext", aliases: &[],
        summary: "two trees: greedy toward samples, one step toward each other; for comparison",
        citation: "LaValle and Kuffner 2001"
    }
}

two_trees! {
    "RRTConCon" RrtConCon: Connect, Connect;
    con_con {
        name: "rrt-con-con", aliases: &[],
        summary: "two greedy trees, which both extend as far as they can; for open spaces",
        citation: "LaValle and Kuffner 2001"
    }
}
