//! Informed RRT*: once there is a path, only states that could lie on a shorter path are sampled.
//!
//! J. D. Gammell, S. S. Srinivasa and T. D. Barfoot, *Informed RRT\*: optimal sampling-based path
//! planning focused via direct sampling of an admissible ellipsoidal heuristic*, IROS 2014.
//!
//! As [RRT*](super::rrt_star), but in step 1, when a path of cost c is known, the sample q obeys
//! d(start, q) + d(q, goal) < c. In R^n with the Euclidean metric these states fill an ellipsoid with
//! the foci start and goal, in which samples are drawn directly:
//! 1. draw a point of the unit ball;
//! 2. stretch it: c/2 along the first axis, √(c² − d(start, goal)²)/2 along the others;
//! 3. turn the first axis toward the goal, and move the centre to the middle;
//! 4. where that is outside the bounds of the space, draw again.
//!
//! In other spaces, and for several goals, uniform samples are drawn until one obeys, at most [`TRIES`]
//! times; then the last one is taken. For a goal that is a region or a sampler there is no such bound, and
//! all samples are uniform.
//!
//! **When to use it.** Instead of RRT* whenever goals are listed states, the metric is symmetric and
//! satisfies the triangle inequality, and no motion costs less than its distance. Where one of these does not
//! hold, paths are as safe, but the best may be missed.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `near`: how many nodes are near, over e·(1 + 1/d)·ln n | (0, 1000] | 1.1 |
//! | `gamma`: if above zero, near are instead those within γ·(ln n / n)^(1/d), at most a step | ≥ 0 | 0 |
//!
//! A point goes around a disc; RRT* needs three times the iterations for as short a path:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Rn, Rng, Straight};
//! use mp_tree::{InformedRrtStar, Problem, Tuning, improve};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = InformedRrtStar::new(problem, Tuning::default())?;
//! let (best, _) = improve(&mut planner, &mut Rng::seed(1), &mut Iterations(1_000), &mut (), |_, _| ());
//! let length = best.ok_or("no path")?.length(&space);
//! assert!(length > 1.038 && length < 1.06, "{length}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::rrt_star::{GAMMA, NEAR, near};
use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{GOAL_BIAS, PATIENCE, STEP};
use crate::{
    Extend, Improving, Near, NearestSelector, PlannerInfo, Problem, Rewire, Selector, TargetSampler,
    TreePlannerParts, Tuning,
};
use mp_cspace::{Direction, LocalPlanner, Rng, Space};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "informed-rrt-star",
    summary: "RRT* that samples only where a path shorter than the best can be",
    citation: "Gammell, Srinivasa and Barfoot 2014",
    parameters: &[STEP, GOAL_BIAS, PATIENCE, NEAR, GAMMA],
    aliases: &[],
    cannot: &[],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let near = near(args.settings)?;
    Ok(Box::new(InformedRrtStar::with_index(args.problem, args.index, args.tuning, near)?))
}

/// Most uniform samples drawn to find one that could lie on a shorter path.
pub const TRIES: usize = 100;

/// Samples that could lie on a path cheaper than the best.
#[derive(Clone, Debug)]
pub struct Informed<'c, C: Space> {
    space: &'c C,
    start: C::State,
    goals: Vec<C::State>,
    best: f64,
}

impl<'c, C: Space> Informed<'c, C> {
    /// For paths from `start` to any of `goals`; uniform samples where there are none.
    pub fn new(space: &'c C, start: C::State, goals: Vec<C::State>) -> Self {
        Self { space, start, goals, best: f64::INFINITY }
    }

    /// For the paths of a problem.
    pub fn of<L: LocalPlanner<C::State>>(problem: &Problem<'c, C, L>) -> Self {
        let known = !problem.goals().has_region() && !problem.goals().has_sampler();
        let goals = if known { problem.goals().listed().to_vec() } else { Vec::new() };
        Self::new(problem.space(), problem.start().clone(), goals)
    }

    /// Sets the cost of the best path.
    pub(crate) fn found(&mut self, cost: f64) {
        self.best = cost;
    }

    /// A lower bound of the cost between a state and the root of the tree that grows in `direction`; zero
    /// where the goals are not listed.
    pub(crate) fn least(&self, direction: Direction, q: &C::State) -> f64 {
        match direction {
            Direction::Forward => self.space.distance(&self.start, q),
            Direction::Backward => {
                let nearest = self.goals.iter().map(|goal| self.space.distance(q, goal)).reduce(f64::min);
                nearest.unwrap_or(0.0)
            }
        }
    }

    /// Draws a sample.
    pub fn sample(&mut self, rng: &mut Rng) -> C::State {
        if self.best.is_infinite() || self.goals.is_empty() {
            return self.space.sample_uniform(rng);
        }
        if let [goal] = self.goals.as_slice()
            && let Some(q) = self.space.sample_between(&self.start, goal, self.best, rng)
        {
            return q;
        }
        let distance = |a: &C::State, b: &C::State| self.space.distance(a, b);
        let mut q = self.space.sample_uniform(rng);
        for _ in 1..TRIES {
            let so_far = distance(&self.start, &q);
            if self.goals.iter().any(|goal| so_far + distance(&q, goal) < self.best) {
                break;
            }
            q = self.space.sample_uniform(rng);
        }
        q
    }
}

impl<C: Space> TargetSampler<C> for Informed<'_, C> {
    fn next_target<Se: Selector<C>>(&mut self, rng: &mut Rng, _: &C, _: &[C::State], _: &mut Se) -> C::State {
        self.sample(rng)
    }
    fn improved(&mut self, cost: f64) {
        self.found(cost);
    }
}

/// Informed RRT*: see the [module](self).
pub type InformedRrtStar<'c, C, L, N> =
    Improving<'c, C, L, Informed<'c, C>, NearestSelector<N>, Extend, Rewire>;

constructors! {
    "Informed RRT*" InformedRrtStar<C, L, N>,
    |problem, index, tuning: Tuning; near: Near = [Near::default()]| {
        let target_sampler = Informed::of(&problem);
        let inserter = Rewire::new(near)?;
        Self::assemble(problem, TreePlannerParts { target_sampler, selector: NearestSelector(index), extender: Extend, inserter, tuning })
    }
}
