//! RRT*: a tree that is rewired as it grows, so that its paths become optimal.
//!
//! S. Karaman and E. Frazzoli, *Sampling-based algorithms for optimal motion planning*, IJRR 30(7),
//! 2011, algorithm 6 (and its k-nearest variant). The order in which parents are tried is that of
//! A. Perez et al., *Asymptotically-optimal path planning for manipulation using incremental
//! sampling-based algorithms*, IROS 2011: cheapest first, so that most motions are never checked.
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample, uniform in the space, or with a small probability a goal state not yet reached;
//! 2. find the node nearest to it, and move from there toward the sample, one step at most;
//! 3. where the motion is free, find the nodes near its end: the k nearest, or those in a ball that
//!    shrinks as the tree grows;
//! 4. add the end under the near node through which it costs least to reach;
//! 5. make it the parent of those near nodes that are cheaper to reach through it, and update the costs
//!    below;
//! 6. where the cheapest path to the goal has become cheaper, verify it: return it, or prune from the
//!    edge that failed. Stepping on returns better paths, each cheaper than the one before.
//!
//! **When to use it.** When the length of the path matters more than the time to find it, and one tree can
//! find a path. The cost is that of the [objective](crate::Problem::with_objective) of the problem, or else of
//! the local planner: for straight motions the length of the path. Local planners that cannot reach a state
//! exactly (sets of inputs) gain nothing. [Informed RRT*](super::informed_rrt_star) converges faster on
//! problems with one goal.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `near`: how many nodes are near, over e·(1 + 1/d)·ln n | (0, 1000] | 1.1 |
//! | `gamma`: if above zero, near are instead those within γ·(ln n / n)^(1/d), at most a step | ≥ 0 | 0 |
//!
//! A point goes around a disc, on ever shorter paths:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, RrtStar, Tuning, improve};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = RrtStar::new(problem, Tuning::default())?;
//! let (best, _) = improve(&mut planner, &mut Rng::seed(1), &mut Iterations(3_000), &mut (), |_, _| ());
//! let length = best.ok_or("no path")?.length(&space);
//! // Two tangents of 0.265 and an arc of 0.509.
//! assert!(length > 1.038 && length < 1.06, "{length}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    BuildError, Extend, Improving, Near, NearestSelector, Parameter, PlannerInfo, Rewire, Samples, Settings,
    TreePlannerParts, Tuning,
};
use mp_cspace::Uniform;

/// [`Near::KNearest`] by name.
pub const NEAR: Parameter = Parameter {
    name: "near",
    range: "in (0, 1000]",
    default: "1.1",
    doc: "how many nodes are near a new one, over e (1 + 1/d) ln n",
};

/// [`Near::Radius`] by name.
pub const GAMMA: Parameter = Parameter {
    name: "gamma",
    range: "0, or a length above",
    default: "0",
    doc: "if not 0, near are instead the nodes within gamma (ln n / n)^(1/d), at most one step",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rrt-star",
    summary: "one tree, rewired as it grows: ever shorter paths until it is stopped",
    citation: "Karaman and Frazzoli 2011",
    parameters: &[STEP, GOAL_BIAS, PATIENCE, NEAR, GAMMA],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let near = near(args.settings)?;
    Ok(Box::new(RrtStar::with_index(args.problem, args.index, args.tuning, near)?))
}

/// The nodes that count as near, from settings.
///
/// # Errors
/// When a value cannot be read.
pub fn near(settings: &Settings) -> Result<Near, BuildError> {
    Ok(match (settings.number(GAMMA.name)?, settings.number(NEAR.name)?) {
        (Some(gamma), _) if gamma != 0.0 => Near::Radius { gamma },
        (_, Some(factor)) => Near::KNearest { factor },
        _ => Near::default(),
    })
}

/// RRT*: see the [module](self).
pub type RrtStar<'c, C, L, N> =
    Improving<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Extend, Rewire>;

constructors! {
    "RRT*" RrtStar<C, L, N>,
    |problem, index, tuning: Tuning; near: Near = [Near::default()]| {
        let target_sampler = Samples(Uniform(problem.space()));
        let inserter = Rewire::new(near)?;
        Self::assemble(problem, TreePlannerParts { target_sampler, selector: NearestSelector(index), extender: Extend, inserter, tuning })
    }
}
