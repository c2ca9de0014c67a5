//! PRM by the bridge test: nodes in narrow passages.
//!
//! D. Hsu, T. Jiang, J. Reif and Z. Sun, *The bridge test for sampling narrow passages with probabilistic
//! roadmap planners*, ICRA 2003.
//!
//! Repeat:
//! 1. draw a sample, uniform in the space; continue if it is not free;
//! 2. draw another at a distance from it that is normally distributed about zero with standard deviation
//!    `sigma`: here toward a third sample, and no farther than that;
//! 3. if that is not free either, but the state in the middle between them is, take that state;
//! 4. connect it to the nearest nodes, as [PRM](super::prm) does;
//! 5. a part `uniform` of the attempts are uniform samples, as of PRM, instead.
//!
//! The path found is verified; an edge that fails is blocked.
//!
//! **When to use it.** For narrow passages: most attempts fail, at the cost of one or two tests each, and the
//! samples found are in passages. Half of the attempts are uniform, for the rest of the space.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `sigma`: standard deviation of the distance, in the metric of the space or with % of its extent | positive | 10% |
//! | `uniform`: part of the attempts that are uniform samples | \[0, 1\] | 0.5 |
//! | `neighbours`: most neighbours tried per node | 1, 2, … 10⁶ | 15 |
//! | `radius`: longest distance of neighbours, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects nodes of one component: shorter paths, for more motions | yes, no | no |
//! | `turns`: fractions of a motion at which rotate-at-s is tried where the straight motion fails | 0, 1, 2, 3 | 0 |
//! | `straight`: tries straight motions first; `no` leaves rotate-at-s alone | yes, no | yes |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! `turns` and `straight`, by name only, connect in stages ([`StagedConnector`](crate::StagedConnector)).
//!
//! The authors mix in uniform samples too, by weights that depend on the scene.
//!
//! A point goes through a gap in a wall:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Length, Rn, Rng, Straight};
//! use mp_roadmap::{BridgePrm, Mixing, Reachable, algo::bridge_prm};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.7).abs() < 0.02;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.002))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
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

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::pairs::{sigma, uniform};
use crate::engine::settings::{CYCLES, NEIGHBOURS, RADIUS};
use crate::engine::staged::{STRAIGHT, TURNS_RANGE, turns};
use crate::engine::{ENDS, ENDS_STEP};
use crate::{Mixing, PairRule, Pairs, PairsPlanner};
use mp_cspace::{Bridge, Length, Rng, Space, registry::PlannerInfo};

/// The defaults.
pub const MIXING: Mixing = Mixing { sigma: Length::Fraction(0.1), uniform: 0.5 };

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "bridge-prm",
    summary: "a roadmap of samples between obstacles, for narrow passages, and of uniform ones",
    citation: "Hsu, Jiang, Reif and Sun 2003",
    parameters: &[
        sigma("10%"),
        uniform("0.5"),
        NEIGHBOURS,
        RADIUS,
        CYCLES,
        turns(TURNS_RANGE, "0"),
        STRAIGHT,
        ENDS,
        ENDS_STEP,
    ],
    aliases: &[],
    cannot: crate::engine::settings::UNDIRECTED,
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let parts = Pairs::<BetweenObstacles>::read(args.space, args.settings, MIXING)?;
    args.build(parts)
}

/// Takes the middle of two states, where it is free and they are not: the rule of bridge-test PRM.
#[derive(Clone, Copy, Debug)]
pub struct BetweenObstacles;

impl PairRule for BetweenObstacles {
    fn attempt<C: Space>(
        space: &C,
        free: impl FnMut(&C::State) -> bool,
        sigma: f64,
        rng: &mut Rng,
    ) -> Option<C::State> {
        Bridge::new(space, free, sigma).ok()?.attempt(rng)
    }
}

/// Bridge-test PRM: see the [module](self).
pub type BridgePrm<'c, C, L, N> = PairsPlanner<'c, C, L, N, BetweenObstacles>;
