//! Retraction-based RRT: what is blocked goes on along the obstacle.
//!
//! L. Zhang and D. Manocha, *An efficient retraction-based RRT planner*, ICRA 2008, on the two trees of
//! [RRT-Connect](super::rrt_connect).
//!
//! From one tree that holds the start and one that holds the goal, repeat:
//! 1. draw a sample, uniform in the space, and extend the tree whose turn it is from the node nearest to it,
//!    one step at most;
//! 2. where that is blocked, retract the sample to the contact space: from the node, or a free step a quarter
//!    as long, move toward the sample without the part that leads into the obstacle, as the gradient of the
//!    clearance says, and a little away from it; again and again, as long as the sample comes nearer, at most
//!    `slides` times. Each move becomes a node;
//! 3. connect the other tree to the last node that was added;
//! 4. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 5. the other tree has the next turn.
//!
//! The paper finds the nearest state in contact by optimising over the contact space that penetration queries
//! describe; here the clearance and its gradient on the free side lead along it, so that all that is added is
//! certified as any edge is. Where turning and moving both lead out of an obstacle, the paper takes what is
//! nearest in its metric; here each blocked step draws the weights of the degrees of freedom anew.
//!
//! **When to use it.** Narrow passages with long walls: tubes that interlock, keys and nuts, twisted
//! corridors. Each slide costs a clearance with its gradient.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `slides`: most moves along an obstacle | 0, 1, 2, … | 8 |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `balance`: a tree with more than this times the nodes of the other one waits; 0 for strict turns | 0, or at least 1 | 0 |
//!
//! A point goes through a slanted corridor in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, RetractionRrt, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! // Walls above and below the line y = x, but for corners that are free.
//! let across = |q: &Vector2<f64>| (q.y - q.x) / 2.0_f64.sqrt();
//! let is_corner = |q: &Vector2<f64>| q.x < 0.2 || q.x > 0.8;
//! let free = move |q: &Vector2<f64>| is_corner(q) || across(q).abs() < 0.02;
//! let gradient = move |q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]| {
//!     let out = if is_corner(q) { 0.0 } else { -across(q).signum() / 2.0_f64.sqrt() };
//!     gradient.copy_from_slice(&[-out, out]);
//!     0.02 - across(q).abs()
//! };
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.002))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.9), Vector2::new(0.9, 0.1));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = RetractionRrt::new(problem, gradient, 8, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS_AND_GRADIENT, PATIENCE, STEP};
use crate::{
    AppendDistinct, BuildError, Connect, Extender, Growing, Grown, Inserter, NearestSelector, Parameter,
    PlannerInfo, Samples, Selector, TreePlannerParts, Tuning, TwoTrees,
};
use mp_cspace::{LocalPlanner, NodeId, Rng, Space, Uniform, obstacles::ClearanceGradient};
use rand::RngExt;

/// [`Retract::new`].
const SLIDES: Parameter = Parameter {
    name: "slides",
    range: "a whole number",
    default: "8",
    doc: "most moves along an obstacle after a blocked step",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "retraction-rrt",
    summary: "two trees whose blocked steps go on along the obstacle; for long narrow passages",
    citation: "Zhang and Manocha 2008",
    parameters: &[STEP, SLIDES, GOAL_BIAS, PATIENCE, BALANCE],
    aliases: &["rrrt"],
    cannot: NEEDS_BOTH_ENDS_AND_GRADIENT,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let mut problem = args.problem;
    let gradient = problem.take_obstacles().gradient.ok_or(BuildError::NoGradient { planner: INFO.name })?;
    let slides = args.settings.count_of(&SLIDES)?;
    Ok(Box::new(RetractionRrt::with_index(problem, args.index, gradient, slides, args.tuning)?))
}

/// Parts of a step that are tried, the longest first.
const PARTS: [f64; 3] = [0.25, 0.0625, 0.015_625];
/// The weights of degrees of freedom differ by up to this factor.
const SPREAD: f64 = 100.0;
/// How far a slide also leads away from the obstacle, as a part of its length.
const AWAY: f64 = 0.1;

/// Extends a step, and where that is blocked goes on along the obstacle: see the [module](self).
#[derive(Clone, Debug)]
pub struct Retract<G> {
    gradient: G,
    slides: u64,
    /// Room for a gradient, a velocity and weights.
    numbers: [Vec<f64>; 3],
}

impl<G> Retract<G> {
    /// The extender with this gradient of the clearance, which slides at most this often after a blocked
    /// step.
    #[must_use]
    pub fn new(gradient: G, slides: u64) -> Self {
        Self { gradient, slides, numbers: Default::default() }
    }

    /// A state on the way from `from` toward `target` along the obstacle that is nearest, if there is one in
    /// the way.
    fn along<C: Space>(
        &mut self,
        space: &C,
        from: &C::State,
        target: &C::State,
        length: f64,
    ) -> Option<C::State>
    where
        G: ClearanceGradient<C::State>,
    {
        let [gradient, velocity, weights] = &mut self.numbers;
        if !space.velocity_into(from, target, velocity) {
            return None;
        }
        let clearance = self.gradient.clearance_gradient(from, f64::INFINITY, gradient);
        if !clearance.is_finite() {
            return None;
        }
        let toward: f64 = gradient.iter().zip(&*velocity).map(|(g, v)| g * v).sum();
        let square: f64 = gradient.iter().zip(&*weights).map(|(g, w)| w * g * g).sum();
        if toward >= 0.0 || !(square > 0.0 && square.is_finite()) {
            return None;
        }
        for ((v, g), w) in velocity.iter_mut().zip(&*gradient).zip(&*weights) {
            *v -= (1.0 + AWAY) * toward / square * w * g;
        }
        let end = space.moved(from, velocity, 1.0)?;
        let distance = space.distance(from, &end);
        if !(distance > 0.0 && distance.is_finite()) {
            return None;
        }
        let end = space.interpolate(from, &end, (length / distance).min(1.0));
        space.contains(&end).then_some(end)
    }

    /// Draws the weights of the degrees of freedom.
    fn draw(&mut self, dim: usize, rng: &mut Rng) {
        self.numbers.iter_mut().for_each(|numbers| numbers.resize(dim, 0.0));
        let [_, _, weights] = &mut self.numbers;
        weights
            .iter_mut()
            .for_each(|w| *w = mp_math::exp(mp_math::ln(SPREAD) * (2.0 * rng.random::<f64>() - 1.0)));
    }
}

impl<C: Space, L: LocalPlanner<C::State>, G: ClearanceGradient<C::State>> Extender<C, L> for Retract<G> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let mut grown = growing.step(from);
        if grown != Grown::Trapped || self.slides == 0 {
            return grown;
        }
        let (space, step) = (growing.checker().space(), growing.checker().step());
        let target = growing.target().clone();
        self.draw(space.dim(), growing.rng());
        let mut at = from;
        let mut state = growing.tree().state(from).clone();
        let mut distance = space.distance(&state, &target);
        for _ in 0..self.slides {
            let moved = PARTS.iter().find_map(|part| {
                let along = self.along(space, &state, &target, part * step)?;
                match growing.step_toward(at, &along) {
                    Grown::Advanced(id) | Grown::Reached(id) => Some(id),
                    Grown::Trapped => None,
                }
            });
            let Some(id) = moved else { break };
            at = id;
            state = growing.tree().state(id).clone();
            grown = Grown::Advanced(id);
            let left = space.distance(&state, &target);
            if left >= distance {
                break;
            }
            distance = left;
        }
        grown
    }
}

/// Retraction-based RRT: see the [module](self).
pub type RetractionRrt<'c, C, L, N, G> =
    TwoTrees<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, Retract<G>, Connect, AppendDistinct>;

constructors! {
    "Retraction-based RRT" RetractionRrt<C, L, N, G> where [N: Clone, G: ClearanceGradient<C::State>],
    |problem, index, gradient: G, slides: u64, tuning: Tuning| {
        let target_sampler = Samples(Uniform(problem.space()));
        let extender = (Retract::new(gradient, slides), Connect::default());
        let inserter = AppendDistinct::default();
        let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter, tuning };
        Self::assemble(INFO.name, problem, parts)
    }
}
