//! PRM by the bridge test: nodes in narrow passages.
//!
//! D. Hsu, T. Jiang, J. Reif and Z. Sun, *The bridge test for sampling narrow passages with probabilistic roadmap
//! planners*, ICRA 2003.
//!
//! Repeat:
//! 1. draw a sample, uniform in the space; go on when it is not free;
//! 2. draw another at a distance from it that is normally distributed about zero with standard deviation `sigma`: here on
//!    the way to a third sample, and no farther than that;
//! 3. if that is not free either, but the state in their middle is, take that one;
//! 4. connect it to the nearest nodes, as [PRM](super::prm) does;
//! 5. a part `uniform` of the attempts are plain samples of PRM instead.
//!
//! The path found is verified; an edge that fails is blocked.
//!
//! **When to use it.** Narrow passages, above all: most attempts fail, at the price of one or two tests each, and what is found is
//! in passages. Half of the attempts are uniform, for the rest of the space.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `sigma`: standard deviation of the distance, in the metric of the space or with % of its extent | positive | 10% |
//! | `uniform`: part of the attempts that are uniform samples | \[0, 1\] | 0.5 |
//! | `neighbours`: most neighbours tried per node | 1, 2, … 10⁶ | 15 |
//! | `radius`: none farther than this, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects what is connected already: shorter paths, for more motions | yes, no | no |
//!
//! The authors mix as well, by weights that depend on the scene.
//!
//! A point goes through a gap in a wall:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Resolution, Rn, Rng, Straight};
//! use mp_roadmap::{BridgePrm, Mixing, Reachable, algo::bridge_prm};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.7).abs() < 0.02;
//! let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.002))?);
//! let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let reach = Reachable { neighbours: 10, radius: 0.5, cycles: false };
//! let mut planner = BridgePrm::new(problem, reach, bridge_prm::MIXING)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(50_000), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::mixed::{drew_uniform, sigma, uniform};
use crate::settings::{CYCLES, NEIGHBOURS, RADIUS, reachable};
use crate::{
    AStar, Candidate, Kind, Mixing, Nearest, NodeGenerator, Pace, Reachable, Recipe, Roadmap, RoadmapPlanner,
    Steer,
};
use mp_cspace::{
    Bridge, BuildError, DefaultNn, LocalPlanner, NearestNeighbors, PlannerInfo, Problem, Reversible, Rng,
    Settings, Space, Step,
};

/// The defaults.
pub const MIXING: Mixing = Mixing { sigma: Step::Fraction(0.1), uniform: 0.5 };

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "bridge-prm",
    summary: "a roadmap of samples between obstacles, for narrow passages, and of uniform ones",
    citation: "Hsu, Jiang, Reif and Sun 2003",
    parameters: &[sigma("10%"), uniform("0.5"), NEIGHBOURS, RADIUS, CYCLES],
    aliases: &[],
    cannot: crate::settings::UNDIRECTED,
};

/// Free states in the middle between two that are not, and some uniform ones: the generator of bridge-test PRM.
#[derive(Clone, Copy, Debug)]
pub struct BetweenObstacles {
    sigma: f64,
    uniform: f64,
}

impl BetweenObstacles {
    /// # Errors
    /// When a parameter is out of range.
    pub fn new<C: Space>(space: &C, mixing: Mixing) -> Result<Self, BuildError> {
        let (sigma, uniform) = mixing.checked(space)?;
        Ok(Self { sigma, uniform })
    }
}

impl<C, L> NodeGenerator<C, L> for BetweenObstacles
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    fn generate(
        &mut self,
        _: u64,
        _: &Roadmap<C::State, L::Edge>,
        steer: &mut Steer<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
        if drew_uniform(self.uniform, steer, rng, out) {
            return;
        }
        let space = steer.space();
        let pair = Bridge::new(space, |q: &C::State| steer.admits(q), self.sigma);
        let found = pair.ok().and_then(|mut pair| pair.attempt(rng));
        out.extend(found.map(|q| Candidate::new(q, Kind::Near)));
    }

    fn independent(&self, _: &Roadmap<C::State, L::Edge>) -> u64 {
        u64::MAX
    }
}

/// Bridge-test PRM: see the [module](self).
pub type BridgePrm<'c, C, L, N> = RoadmapPlanner<'c, C, L, BetweenObstacles, Nearest, AStar, N>;

impl<'c, C, L, N> BridgePrm<'c, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    /// With the nearest neighbours that suit the space.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(problem: Problem<'c, C, L>, reach: Reachable, mixing: Mixing) -> Result<Self, BuildError>
    where
        C: DefaultNn<Nn = N>,
        N: Default,
    {
        Self::with_index(problem, N::default(), reach, mixing)
    }

    /// With an empty index of your choice.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn with_index(
        problem: Problem<'c, C, L>,
        index: N,
        reach: Reachable,
        mixing: Mixing,
    ) -> Result<Self, BuildError> {
        let recipe = recipe(problem.space(), reach, mixing)?;
        Ok(Self::assemble(problem, index, recipe))
    }
}

/// The recipe of Bridge-test PRM.
///
/// # Errors
/// When a parameter is out of range.
pub fn recipe<C: Space>(
    space: &C,
    reach: Reachable,
    mixing: Mixing,
) -> Result<Recipe<BetweenObstacles, Nearest, AStar>, BuildError> {
    Ok(Recipe {
        generate: BetweenObstacles::new(space, mixing)?,
        connect: Nearest::new(reach)?,
        query: AStar::new(),
        pace: Pace::default(),
        improves: false,
    })
}

pub(crate) fn read<C: Space>(
    space: &C,
    settings: &Settings,
) -> Result<Recipe<BetweenObstacles, Nearest, AStar>, BuildError> {
    recipe(space, reachable(space, settings)?, MIXING.read(settings)?)
}
