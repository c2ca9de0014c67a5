//! LazyPRM: edges are only checked when a path leads along them.
//!
//! R. Bohlin and L. E. Kavraki, *Path planning using lazy PRM*, ICRA 2000.
//!
//! 1. add start, goal and `first` free samples, uniform in the space, as nodes;
//! 2. give each an edge to its nearest neighbours, at most `neighbours`, none farther than `radius`,
//!    unchecked;
//! 3. find the shortest path from start to goal;
//! 4. check its edges that are not known to be free, alternately from both ends toward the middle; remove
//!    those that are not free, and go to 3;
//! 5. when no edge is removed, verify the path and return it;
//! 6. when there is no path, add `more` nodes: half of them uniform, half around the middle of edges that
//!    were removed, where the space is difficult; go to 2.
//!
//! Three things differ from the paper:
//! - The paper does not check nodes either before a path leads through them. Where a fifth of the space is
//!   free, as in the shipped scene `apartment`, four fifths of the neighbours are then useless, and each
//!   costs a search. With that rule none of 3 runs was solved within 3 s, there or in `twisty` and `gempa-3`.
//!   Now all are, with a tenth of PRM's motions. A node costs one query, a search hundreds of steps.
//! - The paper removes the first edge of a path that is not free. Here all of a path are checked, with 15 to
//!   45% more motions but half as many searches, which take most of the time.
//! - The paper checks edges at coarse resolution first, then at finer ones. The checks of this library test
//!   in an order that finds obstacles of any size early, and certified ones have no resolution.
//!
//! Nodes around an edge are drawn from its middle toward a uniform sample, at a random part of the length of
//! the edge.
//!
//! **When to use it.** When checks of motions are expensive: it checks little beside the shortest paths.
//! Where checks are cheap, its searches take longer than PRM's checks.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `first`: nodes before the first search | 1, 2, … 10⁹ | 500 |
//! | `more`: nodes added when there is no path | 1, 2, … 10⁹ | 100 |
//! | `neighbours`, `radius` | as of [PRM](super::prm) | 15, 100% |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! A point goes around a disc in the unit square, with few motions checked:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Length, Rn, Rng, Straight};
//! use mp_roadmap::{LazyPrm, Pace, Reachable};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
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
use crate::engine::{ENDS, ENDS_STEP};
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
    parameters: &[FIRST, MORE, NEIGHBOURS, RADIUS, ENDS, ENDS_STEP],
    aliases: &[],
    cannot: UNDIRECTED,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let count = |parameter| Ok::<_, BuildError>(args.settings.count_of(parameter)? as usize);
    let pace = Pace { first: count(&FIRST)?, more: count(&MORE)? };
    let parts = parts(reachable(args.space, args.settings)?, pace)?;
    args.build(parts)
}

/// Free samples: uniform ones, and once edges were removed also around their middles.
#[derive(Clone, Debug)]
pub struct AroundRemoved {
    /// Up to this many nodes there are only uniform samples.
    first: usize,
}

/// How many random edges are tried to find one that was removed.
const LOOKS: usize = 16;

impl<C, L> NodeGenerator<C, L> for AroundRemoved
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
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
        if space.contains(&q) && checker.admits(&q) {
            out.push(Candidate::new(q, MilestoneKind::Plain));
        }
    }

    fn independent(&self, map: &Roadmap<C::State, L::Edge>) -> u64 {
        // An attempt adds at most one node.
        self.first.saturating_sub(map.len()) as u64
    }
}

/// LazyPRM: see the [module](self).
pub type LazyPrm<'c, C, L, N> = RoadmapPlanner<'c, C, L, AroundRemoved, NearestConnector, AStar, N>;

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
) -> Result<RoadmapPlannerParts<AroundRemoved, NearestConnector, AStar>, BuildError> {
    BuildError::count_within(FIRST.name, pace.first as u64, 1, 1_000_000_000)?;
    BuildError::count_within(MORE.name, pace.more as u64, 1, 1_000_000_000)?;
    let generator = AroundRemoved { first: pace.first };
    let parts = RoadmapPlannerParts::new(generator, NearestConnector::unchecked(reach)?);
    Ok(RoadmapPlannerParts { pace, ..parts })
}
