//! CVP-RRT: an RRT that learns where constraints are violated.
//!
//! P. Cheng and S. M. LaValle, *Reducing metric sensitivity in randomized trajectory design*, IROS 2001.
//!
//! With `m` inputs, from a tree that holds the start, repeat:
//! 1. draw a sample, uniform in the space, or with a small probability a goal state;
//! 2. go through the nodes in the order of their distance to it, and accept a node with violation frequency
//!    `σ` with probability `1 − σ`; take the first that is accepted;
//! 3. of the inputs never tried at that node, apply the one whose successor is nearest to the sample
//!    (exploration information: no input is tried twice);
//! 4. where the motion is free, add its end as a child;
//! 5. where it is not, add `1/m` to the node's `σ`, `1/m²` to its parent's, `1/m³` to its parent's, and so
//!    on: the part of the inputs known to violate the constraints, here and further down;
//! 6. where the child is in the goal, verify the path: return it, or prune from the edge that failed.
//!
//! A node at which all inputs fail has `σ = 1` and is never taken again. At a node whose inputs have all been
//! used, every further attempt counts as a violation, so that its `σ` rises to 1 too.
//!
//! **When to use it.** For systems with inputs where the metric misleads, so that plain RRT keeps choosing
//! nodes from which nothing free can be reached: obstacles across the way, narrow limits of velocity.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | local planner: flow, inputs, duration | an [`InputPlanner`](mp_control::InputPlanner) | |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//!
//! A car leaves a dead end that opens behind it:
//! ```
//! use mp_control::{DiscreteFlowCheck, Car, InputPlanner, ReplayFinely};
//! use mp_cspace::{Iterations, Outcome, Planner, Length, Rng, Se2, Se2State};
//! use mp_tree::{CvpRrt, Goals, Problem, Tuning};
//!
//! let space = Se2::new([0.0, 0.0], [10.0, 6.0])?;
//! let free = |q: &Se2State| {
//!     let (x, y) = (q.translation.x, q.translation.y);
//!     !((3.0..7.0).contains(&x) && (1.0..5.0).contains(&y)) || (x < 6.5 && (2.2..3.8).contains(&y))
//! };
//! let car = Car::new(1.0)?;
//! let check = DiscreteFlowCheck::new(&space, free, Length::Absolute(0.05))?;
//! let local = InputPlanner::new(&space, car, Car::inputs(1.0, 0.6, 1)?, 0.7, check)?;
//! let verifier = ReplayFinely::new(&space, car, free, Length::Absolute(0.01))?;
//! let beyond = Goals::region(|q: &Se2State| q.translation.x > 8.0);
//!
//! let problem = Problem::new(&space, local, verifier, Se2State::new(6.0, 3.0, 0.0), beyond)?;
//! let mut planner = CvpRrt::new(problem, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(100_000), &mut ());
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, INPUTS, LEVELS, Types, moved_by_inputs};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    AppendApart, NearestSelector, PlannerInfo, Purpose, Samples, Selector, SingleTree, TreePlannerParts,
    Tuning, Untried,
};
use mp_control::InputChoice;
use mp_cspace::{Hit, NodeId, Rng, Space, Uniform};
use rand::RngExt;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "cvp-rrt",
    summary: "one tree moved by a set of inputs, which avoids nodes where inputs failed; for misleading metrics",
    citation: "Cheng and LaValle 2001",
    parameters: &[STEP, INPUTS, LEVELS, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let problem = moved_by_inputs(args.problem, &args.tuning, args.settings)?;
    Ok(Box::new(CvpRrt::with_index(problem, args.index, args.tuning)?))
}

/// CVP-RRT: see the [module](self).
pub type CvpRrt<'c, C, L, N> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, LeastViolated<NearestSelector<N>>, Untried, AppendApart>;

constructors! {
    "CVP-RRT" CvpRrt<C, L, N> where [L: InputChoice],
    |problem, index, tuning: Tuning| {
        let target_sampler = Samples(Uniform(problem.space()));
        let selector = LeastViolated::new(NearestSelector(index), problem.local().count());
        let inserter = AppendApart::default();
        Self::assemble(problem, TreePlannerParts { target_sampler, selector, extender: Untried::one(), inserter, tuning })
    }
}

/// Selects the nearest node that is accepted with a probability that falls as motions from it and below it
/// fail.
#[derive(Clone, Debug)]
pub struct LeastViolated<Se> {
    nearest: Se,
    share: f64,
    frequency: Vec<f64>,
    parents: Vec<Option<NodeId>>,
}

/// Smaller increments of the frequency are not passed on to ancestors.
const LEAST: f64 = 1e-9;

impl<Se> LeastViolated<Se> {
    /// With the distances of `nearest`, and `inputs` inputs to try at each node.
    pub fn new(nearest: Se, inputs: usize) -> Self {
        Self { nearest, share: 1.0 / inputs.max(1) as f64, frequency: Vec::new(), parents: Vec::new() }
    }

    /// The violation frequency of a node, in \[0, 1\]; zero where there is no such node.
    #[must_use]
    pub fn frequency(&self, id: NodeId) -> f64 {
        self.frequency.get(id as usize).copied().unwrap_or(0.0)
    }
}

impl<C: Space, Se: Selector<C>> Selector<C> for LeastViolated<Se> {
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        _: Purpose,
        rng: &mut Rng,
        out: &mut Vec<Hit>,
    ) {
        let (mut k, mut refused) = (1, 0);
        loop {
            self.nearest.k_nearest(space, points, target, k, out);
            for &hit in &out[refused.min(out.len())..] {
                let frequency = self.frequency(hit.id);
                if frequency <= 0.0 || (frequency < 1.0 && rng.random::<f64>() >= frequency) {
                    out.clear();
                    out.push(hit);
                    return;
                }
            }
            refused = out.len();
            if k >= points.len() {
                out.clear();
                return;
            }
            k = k.saturating_mul(4);
        }
    }
    fn near(&self, space: &C, points: &[C::State], q: &C::State, radius: f64, out: &mut Vec<Hit>) {
        self.nearest.near(space, points, q, radius, out);
    }
    fn k_nearest(&self, space: &C, points: &[C::State], q: &C::State, k: usize, out: &mut Vec<Hit>) {
        self.nearest.k_nearest(space, points, q, k, out);
    }
    fn inserted(&mut self, space: &C, points: &[C::State], id: NodeId, parent: Option<NodeId>) {
        self.frequency.push(0.0);
        self.parents.push(parent);
        self.nearest.inserted(space, points, id, parent);
    }
    fn feedback(&mut self, id: NodeId, _: Purpose, grew: bool) {
        let (mut at, mut part) = (if grew { None } else { Some(id) }, self.share);
        while let Some(node) = at
            && part > LEAST
        {
            let frequency = &mut self.frequency[node as usize];
            *frequency = (*frequency + part).min(1.0);
            part *= self.share;
            at = self.parents[node as usize];
        }
    }
    fn pruned(&mut self, space: &C, points: &[C::State], survivors: &[NodeId]) {
        let renamed = |id: NodeId| survivors.binary_search(&id).ok().map(|i| i as NodeId);
        self.parents = survivors.iter().map(|&id| self.parents[id as usize].and_then(renamed)).collect();
        self.frequency = survivors.iter().map(|&id| self.frequency[id as usize]).collect();
        self.nearest.pruned(space, points, survivors);
    }
}
