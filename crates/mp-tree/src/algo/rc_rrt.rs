//! RC-RRT, the resolution complete RRT.
//!
//! P. Cheng and S. M. LaValle, *Resolution complete rapidly-exploring random trees*, ICRA 2002.
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample, uniform in the space, or with a small probability a goal state;
//! 2. find the nearest of the nodes that have inputs left that were never tried there;
//! 3. try these inputs in the order of their successors' distances to the sample, each only once ever,
//!    until one leads, free of collision, to a state that is not within `apart` of another node;
//! 4. add that as a child; a node at which all inputs have failed or been used is exhausted;
//! 5. where the child is in the goal, verify the path: return it, or prune from the edge that failed;
//! 6. when all nodes are exhausted, stop: [`Exhausted`](mp_cspace::StopReason::Exhausted) says that there is
//!    no path by these inputs and this duration, states within `apart` counting as one.
//!
//! Nodes are at least `apart` from each other, so there are finitely many and planning always ends; with
//! `apart` no larger than rounding that may take long. (The paper derives the distance from a Lipschitz bound
//! of the system; here it is given.)
//!
//! **When to use it.** To find out that there is no solution at a resolution; and where the metric misleads,
//! so that plain RRT tries the same inputs that collide again and again.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | local planner: flow, inputs, duration | an [`InputPlanner`](mp_control::InputPlanner) | |
//! | `apart`: states no farther apart count as one, in the metric of the space | 0 or more | |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//!
//! A point cannot leave a closed ring:
//! ```
//! use mp_control::{DiscreteFlowCheck, InputPlanner, InputSet, Kinematic, ReplayFinely};
//! use mp_cspace::{Iterations, Outcome, Planner, Length, Rn, Rng, StopReason};
//! use mp_tree::{Goals, Problem, RcRrt, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| !(0.2..0.3).contains(&(q - Vector2::new(0.5, 0.5)).norm());
//! let flow = Kinematic::new(&space)?;
//! let check = DiscreteFlowCheck::new(&space, free, Length::Absolute(0.005))?;
//! let local = InputPlanner::new(&space, flow, InputSet::spread([0.05, 0.05], 8)?, 1.0, check)?;
//! let verifier = ReplayFinely::new(&space, flow, free, Length::Absolute(0.0005))?;
//! let outside = Goals::region(|q: &Vector2<f64>| q.x < 0.1);
//!
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.5, 0.5), outside)?;
//! let mut planner = RcRrt::new(problem, 0.02, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(100_000), &mut ());
//! assert_eq!(outcome, Outcome::Stopped(StopReason::Exhausted));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, INPUTS, LEVELS, Types, moved_by_inputs};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    AppendApart, BuildError, NearestSelector, Parameter, PlannerInfo, Purpose, Samples, Selector, Settings,
    SingleTree, TreePlannerParts, Tuning, Untried,
};
use mp_control::InputChoice;
use mp_cspace::{Hit, NodeId, Rng, Space, Uniform};

/// Up to which distance states count as one.
const APART: Parameter = Parameter {
    name: "apart",
    range: "in [0, 1], in steps",
    default: "0.01",
    doc: "states no farther apart count as one",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rc-rrt",
    summary: "one tree moved by a set of inputs, each tried once per node; stops when they allow no path",
    citation: "Cheng and LaValle 2002",
    parameters: &[STEP, INPUTS, LEVELS, APART, GOAL_BIAS, PATIENCE],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let apart = apart(args.problem.space(), &args.tuning, args.settings)?;
    let problem = moved_by_inputs(args.problem, &args.tuning, args.settings)?;
    Ok(Box::new(RcRrt::with_index(problem, args.index, apart, args.tuning)?))
}

/// The setting `apart` as a distance.
pub(crate) fn apart<C: Space>(space: &C, tuning: &Tuning, settings: &Settings) -> Result<f64, BuildError> {
    Ok(settings.part_of(&APART)? * tuning.step.step_in(space)?)
}

/// RC-RRT: see the [module](self).
pub type RcRrt<'c, C, L, N> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, Unexhausted<NearestSelector<N>>, Untried, AppendApart>;

constructors! {
    "RC-RRT, where states within `apart` count as one," RcRrt<C, L, N> where [L: InputChoice],
    |problem, index, apart: f64, tuning: Tuning| {
        let target_sampler = Samples(Uniform(problem.space()));
        let (selector, inserter) = (Unexhausted::new(NearestSelector(index)), AppendApart::within(apart)?);
        Self::assemble(problem, TreePlannerParts { target_sampler, selector, extender: Untried::until_new(), inserter, tuning })
    }
}

/// Selects the nearest node that has not yet failed to grow.
#[derive(Clone, Debug, Default)]
pub struct Unexhausted<Se> {
    nearest: Se,
    exhausted: Vec<bool>,
    left: usize,
}

impl<Se> Unexhausted<Se> {
    /// A selector in which no node is exhausted yet.
    pub fn new(nearest: Se) -> Self {
        Self { nearest, exhausted: Vec::new(), left: 0 }
    }
}

impl<C: Space, Se: Selector<C>> Selector<C> for Unexhausted<Se> {
    fn select(
        &mut self,
        space: &C,
        points: &[C::State],
        target: &C::State,
        _: Purpose,
        _: &mut Rng,
        out: &mut Vec<Hit>,
    ) {
        let mut k = 1;
        loop {
            self.nearest.k_nearest(space, points, target, k, out);
            let all = k >= points.len();
            out.retain(|hit| !self.exhausted[hit.id as usize]);
            out.truncate(1);
            if all || !out.is_empty() {
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
        self.exhausted.push(false);
        self.left += 1;
        self.nearest.inserted(space, points, id, parent);
    }
    fn feedback(&mut self, id: NodeId, _: Purpose, grew: bool) {
        if !grew && !std::mem::replace(&mut self.exhausted[id as usize], true) {
            self.left -= 1;
        }
    }
    fn exhausted(&self) -> bool {
        self.left == 0
    }
    fn pruned(&mut self, space: &C, points: &[C::State], survivors: &[NodeId]) {
        self.exhausted = survivors.iter().map(|&id| self.exhausted[id as usize]).collect();
        self.left = self.exhausted.iter().filter(|exhausted| !**exhausted).count();
        self.nearest.pruned(space, points, survivors);
    }
}
