//! Utility-guided RRT: makes the most promising of several expansions.
//!
//! B. Burns and O. Brock, *Single-query motion planning with utility-guided random trees*, ICRA 2007,
//! on the two trees of [RRT-Connect](super::rrt_connect). The expected utility of an expansion is
//! the probability that it is free times its gain; it decides on node, direction and distance.
//!
//! From one tree that holds the start and one that holds the goal, repeat:
//! 1. draw a sample, uniform in the space: the first candidate is the expansion toward it from its nearest
//!    node in the tree whose turn it is. Draw further candidates, a node of the tree and a sample each, both
//!    uniform, until there are `candidates`;
//! 2. estimate for each the probability that a step is free: the part of expansions of that node that were
//!    free (with one success and one failure added), reduced the nearer the step ends to where others failed;
//! 3. multiply by the gain: the length of the step, as a part of the longest; for nodes that were drawn,
//!    divided by one more than the expansions tried from there, as there is little left to explore around
//!    them;
//! 4. make the most promising step (the first of several), and go on toward its sample while steps are free;
//! 5. if that added a node, connect the other tree to the last;
//! 6. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 7. the other tree has the next turn.
//!
//! Simpler than the paper: there a model of the space is fitted to all configurations tested; here each node
//! remembers its own expansions, with the ends of the last eight failures, and the gain is estimated without
//! a search for neighbours.
//!
//! **When to use it.** Where checking a motion is expensive and many motions fail: around narrow passages.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `candidates`: expansions that are compared | 1, 2, … 100 000 | 4 |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `balance`: a tree with more than this times the nodes of the other one waits; 0 for strict turns | 0, or at least 1 | 0 |
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, Tuning, UtilityRrt};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = UtilityRrt::new(problem, Tuning::default(), 4)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{
    AppendDistinct, BuildError, Connect, Extender, Growing, Grown, Inserter, NearestSelector, Parameter,
    PlannerInfo, Samples, Selector, TreePlannerParts, Tuning, TwoTrees,
};
use mp_cspace::{Direction, LocalPlanner, NodeId, Space, Uniform};
use rand::RngExt;

/// How many expansions are compared.
pub(crate) const CANDIDATES: Parameter = Parameter {
    name: "candidates",
    range: "a whole number from 1 to 100000",
    default: "4",
    doc: "expansions whose expected utility is compared",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "utility-rrt",
    summary: "RRT-Connect that makes the most promising of several expansions; where most motions fail",
    citation: "Burns and Brock 2007",
    parameters: &[STEP, CANDIDATES, GOAL_BIAS, PATIENCE, BALANCE],
    aliases: &["utility-guided"],
    cannot: NEEDS_BOTH_ENDS,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let candidates = args.settings.count_of(&CANDIDATES)?;
    Ok(Box::new(UtilityRrt::with_index(args.problem, args.index, args.tuning, candidates)?))
}

/// How many failures a node remembers.
const REMEMBERED: usize = 8;
/// Most steps toward one sample.
const LIMIT: u32 = 10_000;

/// The results of expansions from a node.
#[derive(Clone, Debug)]
struct Past<S> {
    tried: u32,
    grown: u32,
    /// Where the last expansions that failed would have ended.
    failed: Vec<S>,
}

impl<S> Default for Past<S> {
    fn default() -> Self {
        Self { tried: 0, grown: 0, failed: Vec::new() }
    }
}

/// Makes the most promising of several expansions.
#[derive(Clone, Debug)]
pub struct UtilityGuided<S> {
    candidates: u64,
    /// By node, of the forward and of the backward tree.
    past: [Vec<Past<S>>; 2],
}

/// A step from a node, and its expected utility.
struct Expansion<S> {
    from: NodeId,
    toward: S,
    end: S,
    utility: f64,
}

impl<S: Clone> UtilityGuided<S> {
    fn judge<C: Space<State = S>>(
        &self,
        tree: usize,
        space: &C,
        step: f64,
        (from, state): (NodeId, &S),
        (toward, drawn): (S, bool),
    ) -> Expansion<S> {
        let past = &self.past[tree][from as usize];
        let distance = space.distance(state, &toward);
        let length = step.min(distance);
        let end =
            if distance > step { space.interpolate(state, &toward, step / distance) } else { toward.clone() };
        let mut free = (f64::from(past.grown) + 1.0) / (f64::from(past.tried) + 2.0);
        for failed in &past.failed {
            let off = space.distance(&end, failed) / (0.25 * step);
            free *= 1.0 - mp_math::exp(-0.5 * off * off);
        }
        let known = if drawn { f64::from(past.tried) + 1.0 } else { 1.0 };
        Expansion { from, toward, end, utility: free * length / step / known }
    }
}

impl<C: Space, L: LocalPlanner<C::State>> Extender<C, L> for UtilityGuided<C::State> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let (space, step) = (growing.checker().space(), growing.checker().step());
        let nodes = growing.tree().len();
        let tree = usize::from(growing.tree().direction() == Direction::Backward);
        self.past[tree].resize_with(nodes, Past::default);
        let first = (growing.target().clone(), false);
        let mut best = self.judge(tree, space, step, (from, growing.tree().state(from)), first);
        for _ in 1..self.candidates {
            if growing.checker().is_interrupted() {
                return Grown::Trapped;
            }
            let node = growing.rng().random_range(0..nodes) as NodeId;
            let toward = (space.sample_uniform(growing.rng()), true);
            let other = self.judge(tree, space, step, (node, growing.tree().state(node)), toward);
            if other.utility > best.utility {
                best = other;
            }
        }
        let mut grown = growing.step_toward(best.from, &best.toward);
        let past = &mut self.past[tree][best.from as usize];
        past.tried += 1;
        if grown == Grown::Trapped {
            if past.failed.len() == REMEMBERED {
                past.failed.remove(0);
            }
            past.failed.push(best.end);
            return Grown::Trapped;
        }
        past.grown += 1;
        let mut distance = f64::INFINITY;
        for _ in 1..LIMIT {
            let Grown::Advanced(id) = grown else { break };
            let nearer = space.distance(growing.tree().state(id), &best.toward);
            if nearer >= distance {
                break;
            }
            distance = nearer;
            match growing.step_toward(id, &best.toward) {
                Grown::Trapped => break,
                next => grown = next,
            }
        }
        match grown {
            Grown::Reached(id) if growing.tree().state(id) != growing.target() => Grown::Advanced(id),
            grown => grown,
        }
    }

    fn pruned(&mut self, direction: Direction, survivors: &[NodeId]) {
        let past = &mut self.past[usize::from(direction == Direction::Backward)];
        let kept =
            survivors.iter().map(|&id| past.get_mut(id as usize).map(std::mem::take).unwrap_or_default());
        *past = kept.collect();
    }
}

/// Utility-guided RRT: see the [module](self).
pub type UtilityRrt<'c, C, L, N> = TwoTrees<
    'c,
    C,
    L,
    Samples<Uniform<'c, C>>,
    NearestSelector<N>,
    UtilityGuided<<C as Space>::State>,
    Connect,
    AppendDistinct,
>;

constructors! {
    "Utility-guided RRT" UtilityRrt<C, L, N> where [N: Clone],
    |problem, index, tuning: Tuning, candidates: u64| {
        let candidates = BuildError::count_within(CANDIDATES.name, candidates, 1, 100_000)?;
        let explore = UtilityGuided { candidates, past: [Vec::new(), Vec::new()] };
        let parts = TreePlannerParts {
            target_sampler: Samples(Uniform(problem.space())),
            selector: NearestSelector(index),
            extender: (explore, Connect::default()),
            inserter: AppendDistinct::default(),
            tuning,
        };
        Self::assemble(INFO.name, problem, parts)
    }
}
