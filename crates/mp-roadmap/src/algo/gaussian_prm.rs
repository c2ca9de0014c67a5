//! PRM by the Gaussian sampling strategy: nodes near obstacles.
//!
//! V. Boor, M. H. Overmars and A. F. van der Stappen, *The Gaussian sampling strategy for probabilistic
//! roadmap planners*, ICRA 1999.
//!
//! Repeat:
//! 1. draw a sample, uniform in the space;
//! 2. draw another at a distance from it that is normally distributed about zero with standard deviation
//!    `sigma`: here toward a third sample, and no farther than that;
//! 3. if exactly one of the two is free, take that one;
//! 4. connect it to the nearest nodes, as [PRM](super::prm) does;
//! 5. a part `uniform` of the attempts are uniform samples, as of PRM, instead.
//!
//! The path found is verified; an edge that fails is blocked.
//!
//! **When to use it.** For narrow passages between large obstacles, in scenes with much open space, which
//! gets few nodes. `sigma` should be about the size of the robot.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `sigma`: standard deviation of the distance, in the metric of the space or with % of its extent | positive | 5% |
//! | `uniform`: part of the attempts that are uniform samples | \[0, 1\] | 0.1 |
//! | `neighbours`: most neighbours tried per node | 1, 2, … 10⁶ | 15 |
//! | `radius`: longest distance of neighbours, in the metric of the space or with % of its extent | positive | 100% |
//! | `cycles`: also connects nodes of one component: shorter paths, for more motions | yes, no | no |
//! | `turns`: fractions of a motion at which rotate-at-s is tried where the straight motion fails | 0, 1, 2, 3 | 0 |
//! | `straight`: tries straight motions first; `no` leaves rotate-at-s alone | yes, no | yes |
//! | `ends`, `ends-step`: trees that grow from start and goal beside the samples ([`EndGrowth`](crate::EndGrowth)): their part of the attempts, their longest step | \[0, 1); as `radius` | 0, 3% |
//!
//! `turns` and `straight`, by name only, connect in stages ([`StagedConnector`](crate::StagedConnector)).
//!
//! The authors add no uniform samples; set `uniform` to 0 for that.
//!
//! A point goes through a gap in a wall:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Length, Rn, Rng, Straight};
//! use mp_roadmap::{GaussianPrm, Mixing, Reachable, algo::gaussian_prm};
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
//! let mut planner = GaussianPrm::new(problem, reach, gaussian_prm::MIXING)?;
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
use mp_cspace::{Gaussian, Length, Rng, Space, registry::PlannerInfo};

/// The defaults.
pub const MIXING: Mixing = Mixing { sigma: Length::Fraction(0.05), uniform: 0.1 };

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "gaussian-prm",
    summary: "a roadmap of samples near obstacles",
    citation: "Boor, Overmars and van der Stappen 1999",
    parameters: &[
        sigma("5%"),
        uniform("0.1"),
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
    let parts = Pairs::<NearObstacles>::read(args.space, args.settings, MIXING)?;
    args.build(parts)
}

/// Takes the free one of two states, where the other is not free: the rule of Gaussian PRM.
#[derive(Clone, Copy, Debug)]
pub struct NearObstacles;

impl PairRule for NearObstacles {
    fn attempt<C: Space>(
        space: &C,
        free: impl FnMut(&C::State) -> bool,
        sigma: f64,
        rng: &mut Rng,
    ) -> Option<C::State> {
        Gaussian::new(space, free, sigma).ok()?.attempt(rng)
    }
}

/// Gaussian PRM: see the [module](self).
pub type GaussianPrm<'c, C, L, N> = PairsPlanner<'c, C, L, N, NearObstacles>;
