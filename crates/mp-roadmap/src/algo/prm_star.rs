//! PRM*: a roadmap whose shortest paths become optimal as it grows.
//!
//! S. Karaman and E. Frazzoli, *Sampling-based algorithms for optimal motion planning*, International
//! Journal of Robotics Research 30, 2011, Algorithm 4, in its variant k-nearest PRM*.
//!
//! Repeat:
//! 1. draw a sample, uniform in the space; continue if it is free;
//! 2. add it as a node q, the n-th;
//! 3. ask the local planner for a motion from each of its k(n) nearest neighbours, k(n) = ⌈k₀ ln n⌉ with
//!    k₀ = `factor` · e (1 + 1/d) in d dimensions; each motion becomes an edge, whether it closes a
//!    cycle or not.
//!
//! (The paper draws all n samples first and then connects each to k(n) neighbours; here the n-th is connected
//! when it is added, so that the roadmap can keep growing. In the limit as many neighbours are tried.) With
//! `factor` above 1 the length of the shortest path converges to the optimum as n grows. A path is searched
//! for whenever there are a tenth more nodes; stepping on returns shorter paths only.
//!
//! **When to use it.** For short paths for many queries in one scene. For one query
//! RRT* or AORRTC spend less time on regions that do not matter to it.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `factor`: neighbours, as a multiple of what is needed | \[1, 100\] | 1.1 |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! A point goes around a disc, on ever shorter paths:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Planner, Problem, Length, Rn, Rng, Straight};
//! use mp_roadmap::PrmStar;
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.005))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5))?;
//!
//! let mut planner = PrmStar::new(problem, 1.1)?;
//! let mut rng = Rng::seed(1);
//! let paths = (0..2_000).filter_map(|_| planner.step(&mut rng, &mut ()));
//! let lengths: Vec<f64> = paths.map(|path| path.length(&space)).collect();
//! // Least: two tangents and the arc between them, 0.529 + 0.509.
//! assert!(lengths.is_sorted_by(|a, b| a > b) && *lengths.last().unwrap() < 1.06);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::settings::UNDIRECTED;
use crate::engine::{ENDS, ENDS_STEP};
use crate::{
    AStar, Candidate, Connector, Free, Growing, NearestConnector, Prefetching, Reachable, RoadmapPlanner,
    RoadmapPlannerParts,
};
use mp_cspace::{
    BuildError, LocalPlanner, NearestNeighbors, NodeId, Reversible, Space, Uniform,
    registry::{Parameter, PlannerInfo},
};

const FACTOR: Parameter = Parameter {
    name: "factor",
    range: "in [1, 100]",
    default: "1.1",
    doc: "neighbours, as a multiple of the e (1 + 1/d) ln n that are needed",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "prm-star",
    summary: "a roadmap with ever shorter paths; for short paths for many queries",
    citation: "Karaman and Frazzoli 2011",
    parameters: &[FACTOR, ENDS, ENDS_STEP],
    aliases: &["prm*"],
    cannot: UNDIRECTED,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let parts = parts(args.space, args.settings.number(FACTOR.name)?.unwrap_or(1.1))?;
    args.build(parts)
}

/// Every candidate becomes a node, and is connected to as many neighbours as shortest paths need.
#[derive(Clone, Debug)]
pub struct Star {
    nearest: NearestConnector,
    /// k₀.
    per_log: f64,
}

impl Star {
    /// `factor` times as many neighbours as needed, in a space of `dim` dimensions.
    ///
    /// # Errors
    /// When the factor is not in \[1, 100\].
    pub fn new(dim: usize, factor: f64) -> Result<Self, BuildError> {
        if !(1.0..=100.0).contains(&factor) {
            let range = FACTOR.range.to_owned();
            return Err(BuildError::OutOfRange { name: FACTOR.name, value: factor, range });
        }
        let within = Reachable { neighbours: 1, radius: f64::INFINITY, cycles: true };
        let per_log = factor * std::f64::consts::E * (1.0 + 1.0 / dim.max(1) as f64);
        Ok(Self { nearest: NearestConnector::new(within)?, per_log })
    }

    /// k(n).
    fn neighbours(&self, n: usize) -> usize {
        (self.per_log * mp_math::ln(n as f64)).ceil().max(1.0) as usize
    }
}

impl<C, L> Connector<C, L> for Star
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn prefetch<N: NearestNeighbors<C>>(&self, prefetching: &mut Prefetching<'_, '_, C, L, N>) {
        let k = self.neighbours(prefetching.nodes() + 1);
        prefetching.near(k, f64::INFINITY).iter().for_each(|hit| {
            prefetching.reach(hit.id);
        });
    }

    fn adopt<N: NearestNeighbors<C>>(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        growing: &mut Growing<'_, '_, C, L, N>,
    ) -> NodeId {
        self.nearest.within.neighbours = self.neighbours(growing.map().len() + 1);
        self.nearest.adopt(candidate, growing)
    }
}

/// PRM*: see the [module](self).
pub type PrmStar<'c, C, L, N> = RoadmapPlanner<'c, C, L, Free<Uniform<'c, C>>, Star, AStar, N>;

constructors! {
    "PRM*" PrmStar<C, L, N>,
    |space, factor: f64| parts(space, factor)
}

/// The parts of PRM*.
///
/// # Errors
/// When the factor is not in \[1, 100\].
pub fn parts<C: Space>(
    space: &C,
    factor: f64,
) -> Result<RoadmapPlannerParts<Free<Uniform<'_, C>>, Star, AStar>, BuildError> {
    let parts = RoadmapPlannerParts::new(Free::uniform(space), Star::new(space.dim(), factor)?);
    Ok(RoadmapPlannerParts { improves: true, ..parts })
}
