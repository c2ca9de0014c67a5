//! Multi-sample RRT: the tree grows where its Voronoi regions are surely large.
//!
//! S. R. Lindemann and S. M. LaValle, *Incrementally reducing dispersion by increasing Voronoi bias
//! in RRTs*, ICRA 2004, with fresh samples in every iteration; here on the two trees of
//! [RRT-Connect](super::rrt_connect).
//!
//! From one tree that holds the start and one that holds the goal, repeat:
//! 1. draw `samples` samples, uniform in the space, and find for each its nearest node in the tree
//!    whose turn it is: the node that collects most samples probably has the largest Voronoi region
//!    (the first of several);
//! 2. extend the tree from there, one step at most, toward the mean of the samples collected;
//! 3. if that added a node, connect the other tree to it;
//! 4. where the trees have met, verify the path: return it, or prune from the edge that failed;
//! 5. the other tree has the next turn.
//!
//! The mean is computed by interpolation, one sample after the other. In Euclidean space Voronoi
//! regions are convex, so the mean lies in the region of the node that collected the samples; in
//! other spaces the node nearest to the mean is extended, almost always the same.
//!
//! **When to use it.** To cover open spaces evenly with few nodes, where motions are so expensive to check
//! that a few more searches for neighbours do not matter. In a bug trap the large regions belong to nodes at
//! walls: use [dynamic domains](super::dd_rrt) there. A tree of many more nodes than samples grows as that of
//! RRT-Connect.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `samples`: how many are compared; 1 is RRT-Connect | 1, 2, … 100 000 | 5 |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `balance`: a tree with more than this times the nodes of the other one waits; 0 for strict turns | 0, or at least 1 | 0 |
//!
//! A point goes around a disc in the unit square:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! use mp_tree::{MvbRrt, Problem, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let mut planner = MvbRrt::new(problem, Tuning::default(), 5)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{
    Append, BuildError, Connect, Extend, NearestSelector, Parameter, PlannerInfo, Purpose, Selector,
    TargetSampler, TreePlannerParts, Tuning, TwoTrees,
};
use mp_cspace::{Hit, Interrupt, NodeId, Rng, Space};

/// How many samples are compared.
pub(crate) const SAMPLES: Parameter = Parameter {
    name: "samples",
    range: "a whole number from 1 to 100000",
    default: "5",
    doc: "samples whose nearest nodes are compared",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "mvb-rrt",
    summary: "RRT-Connect toward the largest Voronoi region; covers open spaces with few nodes",
    citation: "Lindemann and LaValle 2004",
    parameters: &[STEP, SAMPLES, GOAL_BIAS, PATIENCE, BALANCE],
    aliases: &["ms-rrt"],
    cannot: NEEDS_BOTH_ENDS,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let samples = args.settings.count_of(&SAMPLES)?;
    Ok(Box::new(MvbRrt::with_index(args.problem, args.index, args.tuning, samples)?))
}

/// Samples the mean of the samples nearest to one node: the node that is nearest to most of several samples.
#[derive(Clone, Debug)]
pub struct VoronoiBias {
    samples: u64,
    hits: Vec<Hit>,
    interrupt: Interrupt,
}

impl<C: Space> TargetSampler<C> for VoronoiBias {
    fn next_target<Se: Selector<C>>(
        &mut self,
        rng: &mut Rng,
        space: &C,
        points: &[C::State],
        selector: &mut Se,
    ) -> C::State {
        // For each region that was hit: its node, how often, and the mean of the samples.
        let mut regions: Vec<(NodeId, u32, C::State)> = Vec::new();
        let mut best = 0;
        for _ in 0..self.samples {
            if self.interrupt.ask() {
                break;
            }
            let q = space.sample_uniform(rng);
            selector.select(space, points, &q, Purpose::Explore, rng, &mut self.hits);
            let Some(hit) = self.hits.first() else { continue };
            let Some(i) = regions.iter().position(|(id, ..)| *id == hit.id) else {
                regions.push((hit.id, 1, q));
                continue;
            };
            let (_, count, mean) = &mut regions[i];
            *count += 1;
            *mean = space.interpolate(mean, &q, 1.0 / f64::from(*count));
            if *count > regions[best].1 {
                best = i;
            }
        }
        match regions.into_iter().nth(best) {
            Some((_, _, mean)) => mean,
            None => space.sample_uniform(rng),
        }
    }
}

/// Multi-sample RRT: see the [module](self).
pub type MvbRrt<'c, C, L, N> = TwoTrees<'c, C, L, VoronoiBias, NearestSelector<N>, Extend, Connect, Append>;

constructors! {
    "Multi-sample RRT" MvbRrt<C, L, N> where [N: Clone],
    |problem, index, tuning: Tuning, samples: u64| {
        let samples = BuildError::count_within(SAMPLES.name, samples, 1, 100_000)?;
        let target_sampler = VoronoiBias { samples, hits: Vec::new(), interrupt: problem.interrupt().clone() };
        let extender = (Extend, Connect::default());
        let parts = TreePlannerParts { target_sampler, selector: NearestSelector(index), extender, inserter: Append, tuning };
        Self::assemble(INFO.name, problem, parts)
    }
}
