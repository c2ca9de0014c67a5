//! Obstacle-based RRT: the tree grows along obstacles as well as toward samples.
//!
//! S. Rodriguez, X. Tang, J.-M. Lien and N. M. Amato, *An obstacle-based rapidly-exploring random tree*,
//! ICRA 2006.
//!
//! From a tree that holds the start, repeat:
//! 1. draw a sample, uniform in the space (or aim at a goal), and find the node nearest to it;
//! 2. draw one of the growth methods below, by weight;
//! 3. extend the tree from the node, one step at most, in the direction of the method;
//! 4. where a goal is reached, verify the path: return it, or prune from the edge that failed.
//!
//! | method | grows |
//! |---|---|
//! | G0 | toward the sample, as RRT |
//! | G1 | toward the position of the sample, with the rotation of the node |
//! | G2 | along a random obstacle, toward the rotation of the sample |
//! | G3 | along a random obstacle, with the rotation of the node |
//! | G4 | in place toward the rotation of the sample; then another step toward the sample |
//! | G5 | toward the sample; where that fails, along the obstacle hit, toward the rotation of the sample |
//! | G6 | toward the sample; where that fails, along the obstacle hit, with the rotation of the node |
//! | G7 | toward the sample; where that fails, and a ray beside it fails too, by the vector between the two hits, in either direction: along the C-obstacle |
//!
//! [`ObstacleHints`] give the directions of obstacles. Rigid bodies among meshes implement it, and you may
//! implement it for your own robots. Without a hint, all methods but G1 and G4 extend toward the sample.
//! Directions that lead out of the space are followed as far as they are within it, down to an eighth of a
//! step.
//!
//! Differences from the paper: its push to the medial axis is left out; along an obstacle the distance is
//! that of the sample in position; rays of G7 are no longer than a step, and the second leads toward a state
//! a tenth of the way from the sample to another.
//!
//! Iterations against RRT, means of 100 seeds, steps of 20% of the extent, in the tests' worlds: 290 instead
//! of 740 through a narrow passage in the plane, 1400 instead of 2200 in space, 1500 instead of 1800 for a
//! rod that must turn in a gap; 610 instead of 680 and 1070 instead of 1240 out of bug traps. An iteration
//! costs a fifth to a third more motions, and the search for hits.
//!
//! **When to use it.** For one-way motions and goal regions beyond narrow passages, where the walls lead
//! through the passage and a robot that turns as it goes gets stuck. Where there are goal states and motions
//! can be reversed, try [RRT-Connect](super::rrt_connect) first, and then [`ObrrtConnect`]: it grows two
//! trees as RRT-Connect does, and each step toward a sample is made by one of these methods. With `balance=1`
//! and steps of 0.3% to 1% it solves tubes, keys and assemblies that the one tree solves late or not at all;
//! with `walks=0.5` also long threads, and bug traps.
//! Made [by name](crate::build) both take the hints [of the problem](crate::Problem::with_obstacles).
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | weights of G0 … G7 | each 0 or more, finite, some positive | see [`GrowthWeights`] |
//! | `goal_bias`: probability of aiming at a goal | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `walks`, of two trees: part of the steps that [go on as the tree came](super::walks) | \[0, 1\] | 0 |
//! | `balance`, of two trees: one with more than this times the nodes of the other waits; 0 for strict turns | 0, or at least 1 | 0 |
//!
//! A point goes around discs in the unit square, along their tangents:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight, obstacles::ObstacleHints};
//! use mp_tree::{GrowthWeights, Obrrt, ObrrtConnect, Problem, Tuning};
//! use nalgebra::Vector2;
//! use rand::RngExt;
//!
//! type Point = Vector2<f64>;
//! const DISCS: [(Point, f64); 2] = [(Point::new(0.5, 0.3), 0.29), (Point::new(0.5, 0.8), 0.19)];
//!
//! struct Tangents;
//! impl ObstacleHints<Point> for Tangents {
//!     fn touches(&mut self, q: &Point) -> bool {
//!         DISCS.iter().any(|(center, radius)| (q - center).norm() <= *radius)
//!     }
//!     fn slide_along(&mut self, from: &Point, toward: &Point, hit: Option<&Point>, rng: &mut Rng) -> Option<Point> {
//!         let (center, _) = match hit {
//!             Some(q) => DISCS.into_iter().find(|(center, radius)| (q - center).norm() <= *radius)?,
//!             None => DISCS[rng.random_range(0..DISCS.len())],
//!         };
//!         let out = (from - center).try_normalize(0.0)? * (toward - from).norm();
//!         let tangent = Point::new(-out.y, out.x);
//!         Some(if rng.random_bool(0.5) { from + tangent } else { from - tangent })
//!     }
//!     // A point has no rotation.
//!     fn moved_by(&self, q: &Point, from: &Point, to: &Point) -> Point {
//!         q + (to - from)
//!     }
//! }
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Point| !Tangents.touches(q);
//! let (start, goal) = (Point::new(0.1, 0.5), Point::new(0.9, 0.5));
//! let problem = || {
//!     let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.005))?);
//!     let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//!     Problem::new(&space, local, verifier, start, goal)
//! };
//!
//! let (tuning, weights) = (Tuning::default(), GrowthWeights::default());
//! let planners: [Box<dyn Planner<Point, Edge = ()>>; 2] = [
//!     Box::new(Obrrt::new(problem()?, Tangents, tuning, weights)?),
//!     Box::new(ObrrtConnect::new(problem()?, Tangents, tuning, weights)?),
//! ];
//! for mut planner in planners {
//!     let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//!     let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//!     assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::algo::walks::WALKS;
use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS_AND_HINTS, NEEDS_HINTS, PATIENCE, STEP};
use crate::{
    AppendDistinct, BuildError, Connect, Extender, Growing, Grown, Inserter, NearestSelector, PlannerInfo,
    Samples, Selector, SingleTree, TreePlannerParts, Tuning, TwoTrees, Walks,
};
use mp_cspace::{LocalPlanner, NodeId, Rng, Space, Uniform, obstacles::ObstacleHints};
use rand::RngExt;

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "obrrt",
    summary: "one tree that also grows along obstacles; for goal regions and one-way motions through narrow passages",
    citation: "Rodriguez, Tang, Lien and Amato 2006",
    parameters: &[STEP, GOAL_BIAS, PATIENCE],
    aliases: &["ob-rrt"],
    cannot: &[NEEDS_HINTS],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let mut problem = args.problem;
    let hints = problem.take_obstacles().hints.ok_or(BuildError::NoHints { planner: INFO.name })?;
    Ok(Box::new(Obrrt::with_index(problem, args.index, hints, args.tuning, GrowthWeights::default())?))
}

/// States tested on a motion that failed, to find where it collides.
const LOOKS: u32 = 10;
/// Most doublings of a C-obstacle vector to make it as long as a step.
const DOUBLINGS: u32 = 8;

/// The relative frequencies of the growth methods G0 to G7, in this order. Each is zero or more and finite,
/// and at least one is positive. The default, 0.3, 0.05, 0.025, 0.025, 0.1, 0.1, 0.1 and 0.3, was chosen by
/// measurement: methods that follow the obstacle that was hit gain most, above all G7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrowthWeights(pub [f64; 8]);

impl Default for GrowthWeights {
    fn default() -> Self {
        Self([0.3, 0.05, 0.025, 0.025, 0.1, 0.1, 0.1, 0.3])
    }
}

impl GrowthWeights {
    fn checked(self) -> Result<Self, BuildError> {
        let bad = |value| {
            let range = "0 or more and finite, one of them positive".to_owned();
            Err(BuildError::OutOfRange { name: "weights", value, range })
        };
        if let Some(&value) = self.0.iter().find(|w| !(**w >= 0.0 && w.is_finite())) {
            return bad(value);
        }
        let sum = self.0.iter().sum::<f64>();
        if sum > 0.0 && sum.is_finite() { Ok(self) } else { bad(sum) }
    }

    fn draw(&self, rng: &mut Rng) -> usize {
        let mut left = rng.random::<f64>() * self.0.iter().sum::<f64>();
        let mut last = 0;
        for (method, &weight) in self.0.iter().enumerate().filter(|(_, w)| **w > 0.0) {
            last = method;
            left -= weight;
            if left < 0.0 {
                break;
            }
        }
        last
    }
}

/// Extends by one of the methods of obstacle-based RRT: see the [module](self).
#[derive(Clone, Debug)]
pub struct ObstacleGuided<H> {
    hints: H,
    weights: GrowthWeights,
}

impl<H> ObstacleGuided<H> {
    /// The extender with these hints and frequencies.
    ///
    /// # Errors
    /// When a weight is negative or not finite, or none is positive.
    pub fn new(hints: H, weights: GrowthWeights) -> Result<Self, BuildError> {
        Ok(Self { hints, weights: weights.checked()? })
    }

    /// The hints that say which obstacle stops a motion, and how it lies.
    pub fn hints(&self) -> &H {
        &self.hints
    }

    /// The first of the tested states on the step from `from` toward `target` in which the robot touches an
    /// obstacle.
    fn hit<C: Space>(&mut self, space: &C, step: f64, from: &C::State, target: &C::State) -> Option<C::State>
    where
        H: ObstacleHints<C::State>,
    {
        let end = (step / space.distance(from, target)).min(1.0);
        (1..=LOOKS)
            .map(|i| space.interpolate(from, target, end * f64::from(i) / f64::from(LOOKS)))
            .find(|q| self.hints.touches(q))
    }

    /// A step from a node along the C-obstacle between it and `target`.
    fn along_c_obstacle<C: Space>(
        &mut self,
        space: &C,
        step: f64,
        from: &C::State,
        target: &C::State,
        rng: &mut Rng,
    ) -> Option<C::State>
    where
        H: ObstacleHints<C::State>,
    {
        let beside = space.interpolate(target, &space.sample_uniform(rng), 0.1);
        let mut ends = [self.hit(space, step, from, target)?, self.hit(space, step, from, &beside)?];
        if rng.random_bool(0.5) {
            ends.reverse();
        }
        let mut along = self.hints.moved_by(from, &ends[0], &ends[1]);
        for _ in 0..DOUBLINGS {
            if space.distance(from, &along) >= step {
                break;
            }
            along = self.hints.moved_by(&along, from, &along);
        }
        Some(along)
    }
}

/// One step in the direction of `along`, as far as it stays in the space.
fn follow<C, L, Se, A>(from: NodeId, along: &C::State, growing: &mut Growing<'_, '_, C, L, Se, A>) -> Grown
where
    C: Space,
    L: LocalPlanner<C::State>,
    Se: Selector<C>,
    A: Inserter<C, L>,
{
    let (space, step) = (growing.checker().space(), growing.checker().step());
    let state = growing.tree().state(from);
    let distance = space.distance(state, along);
    if !(distance > 0.0 && distance.is_finite()) {
        return Grown::Trapped;
    }
    let most = (step / distance).min(1.0);
    let mut ends = [1.0, 0.5, 0.25, 0.125].iter().map(|part| space.interpolate(state, along, most * part));
    match ends.find(|q| space.contains(q)) {
        Some(end) => growing.step_toward(from, &end),
        None => Grown::Trapped,
    }
}

impl<C: Space, L: LocalPlanner<C::State>, H: ObstacleHints<C::State>> Extender<C, L> for ObstacleGuided<H> {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let (space, step) = (growing.checker().space(), growing.checker().step());
        let (state, sample) = (growing.tree().state(from).clone(), growing.target().clone());
        let method = self.weights.draw(growing.rng());
        let grown = match method {
            1 => follow(from, &space.with_rotation_of(&sample, &state), growing),
            2 | 3 => match self.hints.slide_along(&state, &sample, None, growing.rng()) {
                Some(along) if method == 2 => follow(from, &space.with_rotation_of(&along, &sample), growing),
                Some(along) => follow(from, &along, growing),
                None => growing.step(from),
            },
            4 => match follow(from, &space.with_rotation_of(&state, &sample), growing) {
                Grown::Advanced(turned) | Grown::Reached(turned) => match growing.step(turned) {
                    Grown::Trapped => Grown::Advanced(turned),
                    grown => grown,
                },
                // The robot has no rotation, or no room to turn.
                Grown::Trapped => growing.step(from),
            },
            5 | 6 => match growing.step(from) {
                Grown::Trapped => {
                    let hit = self.hit(space, step, &state, &sample);
                    let rng = growing.rng();
                    match hit.and_then(|hit| self.hints.slide_along(&state, &sample, Some(&hit), rng)) {
                        Some(along) if method == 5 => {
                            follow(from, &space.with_rotation_of(&along, &sample), growing)
                        }
                        Some(along) => follow(from, &along, growing),
                        None => Grown::Trapped,
                    }
                }
                grown => grown,
            },
            7 => match growing.step(from) {
                Grown::Trapped => match self.along_c_obstacle(space, step, &state, &sample, growing.rng()) {
                    Some(along) => follow(from, &along, growing),
                    None => Grown::Trapped,
                },
                grown => grown,
            },
            _ => growing.step(from),
        };
        match grown {
            Grown::Reached(id) if growing.tree().state(id) != growing.target() => Grown::Advanced(id),
            grown => grown,
        }
    }
}

/// Obstacle-based RRT: see the [module](self).
pub type Obrrt<'c, C, L, N, H> =
    SingleTree<'c, C, L, Samples<Uniform<'c, C>>, NearestSelector<N>, ObstacleGuided<H>, AppendDistinct>;

constructors! {
    "Obstacle-based RRT" Obrrt<C, L, N, H> where [H: ObstacleHints<C::State>],
    |problem, index, hints: H, tuning: Tuning, weights: GrowthWeights| {
        let (target_sampler, extender) = (Samples(Uniform(problem.space())), ObstacleGuided::new(hints, weights)?);
        let inserter = AppendDistinct::default();
        Self::assemble(problem, TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter, tuning })
    }
}

/// Two trees with the growth methods of OBRRT: see the [module](self).
pub type ObrrtConnect<'c, C, L, N, H> = TwoTrees<
    'c,
    C,
    L,
    Samples<Uniform<'c, C>>,
    NearestSelector<N>,
    Walks<ObstacleGuided<H>>,
    Connect,
    AppendDistinct,
>;

constructors! {
    "Two trees with the growth methods of OBRRT" ObrrtConnect<C, L, N, H> where [N: Clone, H: ObstacleHints<C::State>],
    |problem, index, hints: H, tuning: Tuning, weights: GrowthWeights; walks: f64 = [0.0]| {
        let target_sampler = Samples(Uniform(problem.space()));
        let extender = (Walks::new(ObstacleGuided::new(hints, weights)?, walks)?, Connect::default());
        let inserter = AppendDistinct::default();
        let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter, tuning };
        Self::assemble(connect::INFO.name, problem, parts)
    }
}

/// Two trees with the growth methods of OBRRT by name.
pub mod connect {
    use super::*;

    /// The entry of [`planners`](crate::planners).
    pub const INFO: PlannerInfo = PlannerInfo {
        name: "obrrt-connect",
        summary: "RRT-Connect whose trees also grow along obstacles; for narrow passages between goal states",
        citation: "Rodriguez, Tang, Lien and Amato 2006; Kuffner and LaValle 2000",
        parameters: &[STEP, WALKS, GOAL_BIAS, PATIENCE, BALANCE],
        aliases: &[],
        cannot: NEEDS_BOTH_ENDS_AND_HINTS,
    };

    pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
        let mut problem = args.problem;
        let hints = problem.take_obstacles().hints.ok_or(BuildError::NoHints { planner: INFO.name })?;
        let (weights, walks) = (GrowthWeights::default(), args.settings.number(WALKS.name)?.unwrap_or(0.0));
        Ok(Box::new(ObrrtConnect::with_index(problem, args.index, hints, args.tuning, weights, walks)?))
    }
}
