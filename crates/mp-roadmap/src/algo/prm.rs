//! PRM: the probabilistic roadmap, expanded where connecting is difficult.
//!
//! L. E. Kavraki, P. Švestka, J.-C. Latombe and M. H. Overmars, *Probabilistic roadmaps for path planning
//! in high-dimensional configuration spaces*, IEEE Transactions on Robotics and Automation 12, 1996. As in
//! §3.1 of A. Benitez, I. Huitzil, D. Vallejo, J. de la Calleja and M. A. Medina, *Key elements for motion
//! planning algorithms*, 2010.
//!
//! The learning phase repeats two steps. Construction, until there are `learn` more nodes:
//! 1. draw a sample, uniform in the space; continue if it is free;
//! 2. add it as a node q;
//! 3. N_q: the nodes within `radius` (MAXDIST) of q, at most `neighbours` (K) of them;
//! 4. in order of distance, ask the local planner for a motion from each to q, unless both are in the same
//!    component by now; where there is one, it becomes an edge.
//!
//! Expansion, until there are `expand` times as many nodes more:
//! 1. at the beginning, weight each node c by its failure ratio f(c) / (n(c) + 1), where f(c) of n(c)
//!    attempts to connect it to others failed;
//! 2. draw a node by these weights;
//! 3. make a random-bounce walk from there: `bounces` times, move toward a uniform sample by a random length
//!    of at most `walk`, halved up to four times where the motion is blocked;
//! 4. add the end of each of its motions as a node, with that motion as an edge, and connect it as above.
//!
//! (The paper keeps only the end of the walk, and the walk as its edge. Here its corners are nodes, so that
//! each edge is one motion.) A query adds start and goal as nodes; as long as they are in different
//! components learning continues, so that roadmaps grow during queries. The path found is verified; an edge
//! that fails is blocked.
//!
//! **When to use it.** To answer many queries in one scene. For a single one RRT-Connect is faster.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `neighbours`: most neighbours tried per node, K | 1, 2, … 10⁶ | 15 |
//! | `radius`: longest distance of neighbours, MAXDIST, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects nodes of one component: shorter paths, for more motions | yes, no | no |
//! | `learn`: nodes of a construction step | 1, 2, … 10⁹ | 500 |
//! | `expand`: nodes of an expansion step, as a part of those of a construction step | \[0, 10\] | 0.5 |
//! | `bounces`: motions of a random-bounce walk | 1, 2, … 100 | 3 |
//! | `walk`: longest motion of such a walk, in the metric of the space or with % of its extent | positive | 10% |
//! | `turns`: fractions of a motion at which rotate-at-s is tried where the straight motion fails | 0, 1, 2, 3 | 0 |
//! | `straight`: tries straight motions first; `no` leaves rotate-at-s alone | yes, no | yes |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! `turns` and `straight`, by name only, connect in stages ([`StagedConnector`]). The paper chooses K and
//! MAXDIST for each problem. As in the paper, construction adds twice as many nodes as expansion.
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Length, Rn, Rng, Straight};
//! use mp_roadmap::{Learning, Prm, Reachable};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let reach = Reachable { neighbours: 10, radius: 0.5, cycles: false };
//! let mut planner = Prm::new(problem, reach, Learning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::settings::{CYCLES, NEIGHBOURS, RADIUS, length, reachable};
use crate::engine::staged::{STRAIGHT, TURNS_RANGE, turns};
use crate::engine::{ENDS, ENDS_STEP};
use crate::{
    AStar, Candidate, ConnectionStages, EdgeChecker, Free, MilestoneKind, NearestConnector, NodeGenerator,
    ParentMotion, Reachable, Roadmap, RoadmapPlanner, RoadmapPlannerParts, StagedConnector,
};
use mp_cspace::{
    BuildError, Direction, Extension, Length, LocalPlanner, NodeId, Reach, Reversible, Rng, Space, Uniform,
    registry::{Parameter, PlannerInfo, Settings},
};
use rand::RngExt;

/// The parameters of the learning phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learning {
    /// Nodes of a construction step; 1 or more.
    pub learn: usize,
    /// Nodes of an expansion step, as a part of those of a construction step; 0 for no expansion.
    pub expand: f64,
    /// Motions of a random-bounce walk; 1 or more.
    pub bounces: usize,
    /// The longest motion of such a walk.
    pub walk: Length,
}

impl Default for Learning {
    fn default() -> Self {
        Self { learn: 500, expand: 0.5, bounces: 3, walk: Length::Fraction(0.1) }
    }
}

impl Learning {
    /// The values that are set, the others by default.
    ///
    /// # Errors
    /// When a value cannot be read.
    pub fn read(settings: &Settings) -> Result<Self, BuildError> {
        let default = Self::default();
        Ok(Self {
            learn: settings.count_of(&LEARN)? as usize,
            expand: settings.number(EXPAND.name)?.unwrap_or(default.expand),
            bounces: settings.count_of(&BOUNCES)? as usize,
            walk: settings.length(WALK.name)?.unwrap_or(default.walk),
        })
    }
}

const LEARN: Parameter = Parameter {
    name: "learn",
    range: "a whole number, 1 to 10⁹",
    default: "500",
    doc: "nodes of a construction step",
};
const EXPAND: Parameter = Parameter {
    name: "expand",
    range: "in [0, 10]",
    default: "0.5",
    doc: "nodes of an expansion step, as a part of those of a construction step",
};
const BOUNCES: Parameter = Parameter {
    name: "bounces",
    range: "a whole number, 1 to 100",
    default: "3",
    doc: "motions of a random-bounce walk",
};
const WALK: Parameter = Parameter {
    name: "walk",
    range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    default: "10%",
    doc: "longest motion of a random-bounce walk",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "prm",
    summary: "a roadmap of uniform samples, expanded where connecting is difficult; to answer many queries",
    citation: "Kavraki, Švestka, Latombe and Overmars 1996",
    parameters: &[
        NEIGHBOURS,
        RADIUS,
        CYCLES,
        LEARN,
        EXPAND,
        BOUNCES,
        WALK,
        turns(TURNS_RANGE, "0"),
        STRAIGHT,
        ENDS,
        ENDS_STEP,
    ],
    aliases: &["basic-prm"],
    cannot: crate::engine::settings::UNDIRECTED,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let reach = reachable(args.space, args.settings)?;
    let parts = parts(args.space, reach, Learning::read(args.settings)?)?;
    let connector = StagedConnector::new(reach, ConnectionStages::default().read(args.settings)?)?;
    args.build(parts.connected_by(connector))
}

/// The two steps of the learning phase in turn: the generator of PRM.
#[derive(Clone, Debug)]
pub struct Learn<'c, C> {
    free: Free<Uniform<'c, C>>,
    learning: Learning,
    walk: f64,
    /// The step ends when the roadmap has this many nodes.
    until: usize,
    /// In an expansion step: the cumulative sums of the weights of nodes.
    weights: Option<Vec<f64>>,
}

impl<'c, C: Space> Learn<'c, C> {
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(space: &'c C, learning: Learning) -> Result<Self, BuildError> {
        BuildError::count_within(LEARN.name, learning.learn as u64, 1, 1_000_000_000)?;
        BuildError::count_within(BOUNCES.name, learning.bounces as u64, 1, 100)?;
        if !(0.0..=10.0).contains(&learning.expand) {
            let (value, range) = (learning.expand, EXPAND.range.to_owned());
            return Err(BuildError::OutOfRange { name: EXPAND.name, value, range });
        }
        let walk = length(&WALK, learning.walk, space)?;
        Ok(Self { free: Free::uniform(space), learning, walk, until: learning.learn, weights: None })
    }

    /// Goes from one step to the next when there are enough nodes.
    fn turn<S, E>(&mut self, map: &Roadmap<S, E>) {
        if map.len() < self.until {
            return;
        }
        let more = match self.weights {
            None => (self.learning.expand * self.learning.learn as f64).round() as usize,
            Some(_) => 0,
        };
        if more > 0 {
            let mut sum = 0.0;
            let ratio = |id: usize| {
                let tag = map.tag(id as NodeId);
                f64::from(tag.failed) / (f64::from(tag.tried) + 1.0)
            };
            let sums = (0..map.len()).map(|id| {
                sum += ratio(id);
                sum
            });
            self.weights = Some(sums.collect());
            self.until = map.len() + more;
        } else {
            self.weights = None;
            self.until = map.len() + self.learning.learn;
        }
    }
}

impl<C, L> NodeGenerator<C, L> for Learn<'_, C>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn generate(
        &mut self,
        attempt: u64,
        map: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
        self.turn(map);
        // Without failed connections there is nothing to expand.
        let Some(sums) = self.weights.as_ref().filter(|sums| sums.last().is_some_and(|sum| *sum > 0.0))
        else {
            return self.free.generate(attempt, map, checker, rng, out);
        };
        let at = rng.random::<f64>() * sums.last().copied().unwrap_or_default();
        let first = sums.partition_point(|sum| *sum <= at).min(sums.len() - 1) as NodeId;
        let (space, mut here) = (checker.space(), map.state(first).clone());
        for bounce in 0..self.learning.bounces {
            if checker.is_interrupted() {
                return;
            }
            let toward = space.sample_uniform(rng);
            let mut length = self.walk * rng.random::<f64>();
            for _ in 0..=4 {
                let step = checker.extend(&here, &toward, Direction::Forward, Reach::Step(length));
                let (Extension::Advanced(motion) | Extension::Reached(motion)) = step else {
                    length /= 2.0;
                    continue;
                };
                // A step may vanish in rounding.
                if motion.end == here {
                    break;
                }
                here = motion.end.clone();
                let from = (bounce == 0 || out.is_empty()).then_some(first);
                let mut candidate = Candidate::new(here.clone(), MilestoneKind::Expanded);
                candidate.parent = Some(ParentMotion { from, motion });
                out.push(candidate);
                break;
            }
        }
    }

    fn independent(&self, map: &Roadmap<C::State, L::Edge>) -> u64 {
        match self.weights {
            // An attempt adds at most one node. What is prefetched in vain where others add nodes is dropped.
            None => self.until.saturating_sub(map.len()) as u64,
            Some(_) => 0,
        }
    }
}

/// PRM: see the [module](self).
pub type Prm<'c, C, L, N> = RoadmapPlanner<'c, C, L, Learn<'c, C>, NearestConnector, AStar, N>;

constructors! {
    "PRM" Prm<C, L, N>,
    |space, reach: Reachable, learning: Learning| parts(space, reach, learning)
}

/// The parts of PRM.
///
/// # Errors
/// When a parameter is out of range.
pub fn parts<C: Space>(
    space: &C,
    reach: Reachable,
    learning: Learning,
) -> Result<RoadmapPlannerParts<Learn<'_, C>, NearestConnector, AStar>, BuildError> {
    Ok(RoadmapPlannerParts::new(Learn::new(space, learning)?, NearestConnector::new(reach)?))
}
