//! Adaptive dynamic-domain RRT: the radius of each node adapts to its successes and failures.
//!
//! L. Jaillet, A. Yershova, S. M. LaValle and T. Siméon, *Adaptive tuning of the sampling domain for
//! dynamic-domain RRTs*, IROS 2005: [dynamic-domain RRT](super::dd_rrt) whose radii are not fixed.
//!
//! Each node has a radius, infinite at first. From one tree that holds the start and one that
//! holds the goal, repeat:
//! 1. draw samples, uniform in the space, until one is no farther from its nearest node in the tree
//!    whose turn it is than the radius of that node; after `tries` samples take the next;
//! 2. extend the tree from that node, one step at most, toward it. Where that fails, an infinite
//!    radius becomes `radius`, another is multiplied by 1 - `adapt` but not below `least`; where
//!    it succeeds, a finite radius is multiplied by 1 + `adapt`;
//! 3. if that added a node, connect the other tree to it, regardless of radii;
//! 4. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 5. the other tree has the next turn.
//!
//! **When to use it.** As dynamic-domain RRT, without having to know a good radius.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `radius`: of nodes that failed for the first time, in steps | (0, ∞) | 2 |
//! | `adapt`: part by which a radius grows and shrinks | \[0, 1) | 0.05 |
//! | `least`: smallest radius, in steps | (0, `radius`\] | 0.5 |
//! | `tries`: samples refused in a row before one is taken regardless | 0, 1, 2, … | 100 |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{DdRrt, Domain, Problem, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = DdRrt::new(problem, Tuning::default(), Domain::adaptive())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::dd_rrt::{RADIUS, TRIES};
use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::{GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{DdRrt, Domain, Parameter, PlannerInfo};

/// [`Domain::adapt`].
const ADAPT: Parameter = Parameter {
    name: "adapt",
    range: "in [0, 1)",
    default: "0.05",
    doc: "part by which the radius of a node grows with a success and shrinks with a failure",
};
/// [`Domain::least`].
const LEAST: Parameter = Parameter {
    name: "least",
    range: "in (0, radius], in steps",
    default: "0.5",
    doc: "smallest radius of a node",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "add-rrt",
    summary: "dynamic-domain RRT that tunes itself; for traps and tight spaces",
    citation: "Jaillet, Yershova, LaValle and Siméon 2005",
    parameters: &[STEP, RADIUS, ADAPT, LEAST, TRIES, GOAL_BIAS, PATIENCE],
    aliases: &["adaptive-dynamic-domain"],
    cannot: NEEDS_BOTH_ENDS,
};

/// Makes it by name.
pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let domain = Domain::adaptive().read(args.settings)?;
    Ok(Box::new(DdRrt::with_index(args.problem, args.index, args.tuning, domain)?))
}

impl Domain {
    /// The defaults of the adaptive dynamic domain.
    #[must_use]
    pub fn adaptive() -> Self {
        Self { adapt: 0.05, ..Self::fixed() }
    }
}
