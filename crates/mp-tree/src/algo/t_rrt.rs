//! T-RRT, the transition-based RRT: a tree that prefers states of low cost.
//!
//! L. Jaillet, J. Cortés and T. Siméon, *Sampling-based path planning on configuration-space costmaps*, IEEE
//! Transactions on Robotics 26(4), 2010.
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample, uniform in the space, or with a small probability a goal state;
//! 2. find the node nearest to it; where the sample is within a step, so that the tree would be refined and
//!    not expanded, and more than a part ρ of the nodes were added so, go on with probability ρ only (minimum
//!    expansion control);
//! 3. move from that node toward the sample, one step at most;
//! 4. where the motion is free, put its end to the transition test: a state that costs no more than the node
//!    passes; one that costs Δ more with probability exp(−Δ / (K·T)), K being the range of the costs seen so
//!    far;
//! 5. adapt the temperature T: after a step up that passed divide it by α^(Δ/K), after every nFailMax + 1
//!    that did not multiply it by α;
//! 6. add what passed as a child of the node; where that is in the goal, verify the path: return it, or prune
//!    from the edge that failed.
//!
//! Differences from the paper: the temperature falls with the height of a step, K is the range of costs, and
//! failures are counted even if a step up passes between them, as in D. Devaurs, T. Siméon and J. Cortés,
//! *Enhancing the transition-based RRT to deal with complex cost spaces*, ICRA 2013: otherwise steps that
//! hardly climb, which always pass, keep the tree too cold for others. And in the paper a tree with its full
//! part of refinement nodes is not refined at all until it expands: in front of a passage narrower than a
//! step it never would.
//!
//! The tree follows valleys and saddles of the cost, and climbs no higher than necessary. A state whose cost
//! is infinite or not a number is never entered. The straight motion to the goal is not tried, as its cost is
//! not bounded. Motions toward goals do not count as refinement and are never refused for it.
//!
//! **When to use it.** When the cost along a path matters more than its length: away from obstacles, over
//! level ground. It is not optimal, and only the cost of the ends of motions counts. Narrow passages are
//! entered by refinement: use ρ = 1 there, or shorter steps. [By name](crate::build) the cost is that of
//! being near obstacles, and the problem must [know](crate::Problem::with_obstacles) the gradient of the
//! clearance: with the clearance d and the range r the cost is (1 − d/r)² where d < r, and 0 elsewhere; 1 in
//! contact. Where the problem has an [objective](crate::Problem::with_objective), it is the cost of states of
//! that, and `range` is not used.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `temperature`: initial T | positive and finite | 10⁻⁶ |
//! | `alpha`: factor α of the temperature | (1, 1000] | 2 |
//! | `fails`: steps up refused before T rises, nFailMax | 0, 1, 2, … | 10 |
//! | `refine`: part ρ of the nodes that may refine the tree, and the probability of more | \[0, 1\] | 0.1 |
//! | `range` (by name): distance of obstacles from which states cost nothing | (0, extent of the space] | 10% of the extent |
//!
//! A point crosses the unit square, around its expensive middle:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, TRrt, Temperature, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |_: &Vector2<f64>| true;
//! let cost = |q: &Vector2<f64>| 1.0 + 100.0 * (0.3 - (q - Vector2::new(0.5, 0.5)).norm()).max(0.0);
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = TRrt::new(problem, cost, Tuning::default(), Temperature::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert!(path.states.iter().map(cost).sum::<f64>() / (path.states.len() as f64) < 3.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::{GOAL_BIAS, PATIENCE, STEP, constructors};
use crate::{
    Append, BuildError, Extender, Growing, Grown, Inserter, NearestSelector, Parameter, PlannerInfo, Purpose,
    Samples, Selector, SingleTree, TreePlannerParts, Tuning,
};
use mp_cspace::registry::Demand;
use mp_cspace::{
    Direction, Extension, LocalPlanner, NodeId, Reach, Rng, Space, Uniform, nearness,
    obstacles::ClearanceGradient,
};
use rand::RngExt;

/// [`Temperature::initial`].
const TEMPERATURE: Parameter = Parameter {
    name: "temperature",
    range: "positive and finite",
    default: "0.000001",
    doc: "initial temperature",
};
/// [`Temperature::alpha`].
const ALPHA: Parameter = Parameter {
    name: "alpha",
    range: "in (1, 1000]",
    default: "2",
    doc: "factor by which the temperature rises after failures, and falls after a step over all costs",
};
/// [`Temperature::fails`].
const FAILS: Parameter = Parameter {
    name: "fails",
    range: "a whole number",
    default: "10",
    doc: "steps up that are refused before the temperature rises",
};
/// [`Temperature::refine`].
const REFINE: Parameter = Parameter {
    name: "refine",
    range: "in [0, 1]",
    default: "0.1",
    doc: "part of the nodes that may refine the tree, and the probability of more",
};
/// The distance of obstacles from which states cost nothing.
const RANGE: Parameter = Parameter {
    name: "range",
    range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    default: "10%",
    doc: "states at least this far from obstacles cost nothing",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "t-rrt",
    summary: "one tree that prefers states of low cost, by name those far from obstacles",
    citation: "Jaillet, Cortés and Siméon 2010",
    parameters: &[STEP, GOAL_BIAS, PATIENCE, TEMPERATURE, ALPHA, FAILS, REFINE, RANGE],
    aliases: &["transition-rrt"],
    cannot: &[(
        Demand::NoCost,
        "it prefers states far from obstacles, and how far they are is not known of this robot: give an objective in its place, if it can have one",
    )],
};

/// A cost of states behind a pointer.
type StateCost<'c, S> = Box<dyn FnMut(&S) -> f64 + Send + 'c>;

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let (mut problem, settings) = (args.problem, args.settings);
    let range = settings.length_of(&RANGE, problem.space())?;
    let cost: StateCost<'c, T::State> = if let Some(mut given) = problem.take_objective() {
        Box::new(move |q| given.state_cost(q))
    } else {
        let known = problem.take_obstacles();
        let mut field = known.gradient.ok_or(BuildError::NoGradient { planner: INFO.name })?;
        let mut gradient = vec![0.0; problem.space().dim()];
        Box::new(move |q| nearness(field.clearance_gradient(q, range, &mut gradient), range))
    };
    let default = Temperature::default();
    let with = Temperature {
        initial: settings.number(TEMPERATURE.name)?.unwrap_or(default.initial),
        alpha: settings.number(ALPHA.name)?.unwrap_or(default.alpha),
        fails: settings.count_of(&FAILS)?,
        refine: settings.number(REFINE.name)?.unwrap_or(default.refine),
    };
    Ok(Box::new(TRrt::with_index(problem, args.index, cost, args.tuning, with)?))
}

/// The parameters of the transition test and the expansion control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature {
    /// The initial temperature T; positive and finite.
    pub initial: f64,
    /// The factor α by which the temperature rises after failures, and falls after a step over the whole
    /// range of costs; in (1, 1000].
    pub alpha: f64,
    /// Steps up refused before the temperature rises: nFailMax.
    pub fails: u64,
    /// The part ρ of the nodes that may refine the tree, and the probability with which more nodes do, in
    /// \[0, 1\].
    pub refine: f64,
}

impl Default for Temperature {
    fn default() -> Self {
        Self { initial: 1e-6, alpha: 2.0, fails: 10, refine: 0.1 }
    }
}

impl Temperature {
    fn checked(self) -> Result<Self, BuildError> {
        BuildError::positive(TEMPERATURE.name, self.initial)?;
        let out = |parameter: &Parameter, value| {
            Err(BuildError::OutOfRange { name: parameter.name, value, range: parameter.range.to_owned() })
        };
        if !(self.alpha > 1.0 && self.alpha <= 1000.0) {
            return out(&ALPHA, self.alpha);
        }
        if !(0.0..=1.0).contains(&self.refine) {
            return out(&REFINE, self.refine);
        }
        Ok(self)
    }
}

/// One step, if its end passes the transition test: see the [module](self).
#[derive(Clone, Debug)]
pub struct Transition<F> {
    cost: F,
    with: Temperature,
    temperature: f64,
    /// The least and the greatest finite cost seen.
    seen: [f64; 2],
    fails: u64,
    /// Nodes that refined the tree.
    refined: u64,
    /// The costs of nodes, as far as computed.
    costs: Vec<Option<f64>>,
}

impl<F> Transition<F> {
    /// The test with this cost of states.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(cost: F, with: Temperature) -> Result<Self, BuildError> {
        let with = with.checked()?;
        let seen = [f64::INFINITY, f64::NEG_INFINITY];
        Ok(Self { cost, with, temperature: with.initial, seen, fails: 0, refined: 0, costs: Vec::new() })
    }

    /// The present temperature.
    #[must_use]
    pub fn temperature(&self) -> f64 {
        self.temperature
    }

    fn cost_of<S>(&mut self, id: NodeId, q: &S) -> f64
    where
        F: FnMut(&S) -> f64,
    {
        let id = id as usize;
        if self.costs.len() <= id {
            self.costs.resize(id + 1, None);
        }
        match self.costs[id] {
            Some(cost) => cost,
            None => *self.costs[id].insert((self.cost)(q)),
        }
    }

    fn passes(&mut self, from: f64, to: f64, rng: &mut Rng) -> bool {
        if to <= from || !to.is_finite() {
            return to <= from;
        }
        for cost in [from, to] {
            self.seen = [self.seen[0].min(cost), self.seen[1].max(cost)];
        }
        let up = (to - from) / (self.seen[1] - self.seen[0]);
        let passes = rng.random::<f64>() < mp_math::exp(-up / self.temperature);
        if passes {
            self.temperature /= mp_math::powf(self.with.alpha, up);
        } else if self.fails >= self.with.fails {
            (self.temperature, self.fails) = (self.temperature * self.with.alpha, 0);
        } else {
            self.fails += 1;
        }
        self.temperature = self.temperature.clamp(f64::MIN_POSITIVE, f64::MAX);
        passes
    }
}

impl<C: Space, L: LocalPlanner<C::State>, F: FnMut(&C::State) -> f64> Extender<C, L> for Transition<F> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let step = growing.checker().step();
        let refines = growing.purpose() == Purpose::Explore && growing.distance(from) <= step;
        let many = self.refined as f64 > self.with.refine * growing.tree().len() as f64;
        if refines && many && !growing.rng().random_bool(self.with.refine) {
            return Grown::Trapped;
        }
        let (state, target) = (growing.tree().state(from).clone(), growing.target().clone());
        let direction = growing.tree().direction();
        let extension = growing.checker().extend(&state, &target, direction, Reach::Step(step));
        let (Extension::Advanced(motion) | Extension::Reached(motion)) = &extension else {
            return Grown::Trapped;
        };
        let (here, there) = (self.cost_of(from, &state), (self.cost)(&motion.end));
        if !self.passes(here, there, growing.rng()) {
            return Grown::Trapped;
        }
        let grown = growing.insert(from, extension);
        self.refined += u64::from(refines && grown != Grown::Trapped);
        grown
    }

    fn allows_direct(&self) -> bool {
        false
    }

    fn pruned(&mut self, _: Direction, survivors: &[NodeId]) {
        self.costs = survivors.iter().map(|&id| self.costs.get(id as usize).copied().flatten()).collect();
    }
}

/// T-RRT: see the [module](self).
pub type TRrt<'c, C, L, N, F> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Transition<F>, Append>;

constructors! {
    "T-RRT by the cost of states" TRrt<C, L, N, F> where [F: FnMut(&C::State) -> f64],
    |problem, index, cost: F, tuning: Tuning, with: Temperature| {
        let (target_sampler, extender) = (Samples(Uniform(problem.space())), Transition::new(cost, with)?);
        Self::assemble(problem, TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter: Append, tuning })
    }
}
