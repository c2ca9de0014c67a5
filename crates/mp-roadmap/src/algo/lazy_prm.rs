//! LazyPRM: nodes and edges are only checked when a path leads along them.
//!
//! R. Bohlin and L. E. Kavraki, *Path planning using lazy PRM*, ICRA 2000.
//!
//! 1. add start, goal and `first` samples, uniform in the space, as nodes, free or not;
//! 2. give each an edge to its nearest neighbours, at most `neighbours`, none farther than `radius`,
//!    unchecked;
//! 3. find the shortest path from start to goal;
//! 4. check its nodes that are not known to be free, alternately from both ends toward the middle; remove
//!    the first that is not free with all its edges, and go to 3;
//! 5. check its edges the same way; remove the first that is not free, and go to 3;
//! 6. when no edge is removed, verify the path and return it;
//! 7. when there is no path, add `more` nodes: half of them uniform, half around the middle of edges that were
//!    removed, where the space is difficult; go to 2.
//!
//! (The paper checks the edges of a path at coarse resolution first, then at finer ones. The checks of this
//! library test in an order that finds obstacles of any size early, and certified ones have no resolution;
//! so edges are checked one after the other. Nodes around an edge are drawn from its middle toward a uniform sample, at a
//! random part of the length of the edge.)
//!
//! **When to use it.** When checks are expensive and the scene is not crowded: it checks little beside the shortest paths.
//! Where most edges collide, each search finds another that does.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `first`: nodes before the first search | 1, 2, … 10⁹ | 500 |
//! | `more`: nodes added when there is no path | 1, 2, … 10⁹ | 100 |
//! | `neighbours`, `radius` | as of [PRM](super::prm) | 15, 100% |
//!
//! A point goes around a disc in the unit square, with few motions checked:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Resolution, Rn, Rng, Straight};
//! use mp_roadmap::{LazyPrm, Pace, Reachable};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5))?;
//!
//! let reach = Reachable { neighbours: 15, radius: 0.2, cycles: true };
//! let mut planner = LazyPrm::new(problem, reach, Pace { first: 300, more: 100 })?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! assert!(matches!(outcome, Outcome::Solved(_)), "{outcome:?}");
//! assert!(planner.progress().motions < planner.map().edges() as u64 / 10);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::constructors;
use crate::engine::settings::{NEIGHBOURS, RADIUS, UNDIRECTED, reachable};
use crate::{
    AStar, Candidate, EdgeChecker, EdgeId, LinkState, MilestoneKind, NearestConnector, NodeGenerator, Pace,
    Reachable, Roadmap, RoadmapPlanner, RoadmapPlannerParts,
};
use mp_cspace::{
    BuildError, LocalPlanner, Reversible, Rng, Space,
    registry::{Parameter, PlannerInfo},
};
use rand::RngExt;

const FIRST: Parameter = Parameter {
    name: "first",
    range: "a whole number, 1 to 10⁹",
    default: "500",
    doc: "nodes before the first search",
};
const MORE: Parameter = Parameter {
    name: "more",
    range: "a whole number, 1 to 10⁹",
    default: "100",
    doc: "nodes added when there is no path",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "lazy-prm",
    summary: "a roadmap that is checked only along possible paths; when checks are expensive",
    citation: "Bohlin and Kavraki 2000",
    parameters: &[FIRST, MORE, NEIGHBOURS, RADIUS],
    aliases: &[],
    cannot: UNDIRECTED,
};

/// Makes it by name.
pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let count = |parameter| Ok::<_, BuildError>(args.settings.count_of(parameter)? as usize);
    let pace = Pace { first: count(&FIRST)?, more: count(&MORE)? };
    let parts = parts(reachable(args.space, args.settings)?, pace)?;
    args.build(parts)
}

/// Samples that are not checked: uniform ones, and once edges were removed also around their middles.
#[derive(Clone, Debug)]
pub struct Unchecked {
    /// Up to this many nodes there are only uniform samples.
    first: usize,
}

/// How many random edges are tried to find one that was removed.
const LOOKS: usize = 16;

impl<C, L> NodeGenerator<C, L> for Unchecked
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    /// Candidates are within the space, but not known to be free.
    fn generate(
        &mut self,
        _: u64,
        map: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
        let space = checker.space();
        let mut q = space.sample_uniform(rng);
        let edges = map.all_edges().len();
        if map.len() >= self.first && edges > 0 && rng.random::<bool>() {
            let draws = (0..LOOKS).map(|_| EdgeId(rng.random_range(0..edges) as u32));
            let removed = |edge: &EdgeId| map.edge(*edge).state == LinkState::Blocked;
            let found: Vec<EdgeId> = draws.filter(removed).take(1).collect();
            if let Some(&edge) = found.first() {
                let [a, b] = map.ends(edge).map(|id| map.state(id));
                let middle = space.interpolate(a, b, 0.5);
                let reach = space.distance(a, b) * rng.random::<f64>();
                let distance = space.distance(&middle, &q);
                if reach < distance {
                    q = space.interpolate(&middle, &q, reach / distance);
                }
            }
        }
        if space.contains(&q) {
            out.push(Candidate::new(q, MilestoneKind::Plain));
        }
    }
}

/// LazyPRM: see the [module](self).
pub type LazyPrm<'c, C, L, N> = RoadmapPlanner<'c, C, L, Unchecked, NearestConnector, AStar, N>;

constructors! {
    "LazyPRM" LazyPrm<C, L, N>,
    |_, reach: Reachable, pace: Pace| parts(reach, pace)
}

/// The parts of LazyPRM.
///
/// # Errors
/// When a parameter is out of range.
pub fn parts(
    reach: Reachable,
    pace: Pace,
) -> Result<RoadmapPlannerParts<Unchecked, NearestConnector, AStar>, BuildError> {
    BuildError::count_within(FIRST.name, pace.first as u64, 1, 1_000_000_000)?;
    BuildError::count_within(MORE.name, pace.more as u64, 1, 1_000_000_000)?;
    let generator = Unchecked { first: pace.first };
    let parts = RoadmapPlannerParts::new(generator, NearestConnector::unchecked(reach)?);
    Ok(RoadmapPlannerParts { pace, ..parts })
}
