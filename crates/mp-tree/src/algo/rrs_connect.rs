//! RRS-Connect: RRT-Connect with edges that bend around obstacles.
//!
//! The snakes of K. Baizid et al., *RRS: rapidly-exploring random snakes*, §3.3, in the place of the local planner of
//! J. J. Kuffner and S. M. LaValle, *RRT-Connect: an efficient approach to single-query path planning*, ICRA 2000.
//!
//! Steps 1 to 5 are those of [RRT-Connect](super::rrt_connect); wherever a step is blocked, though its end is free, a
//! [snake](mp_snake::Snake) bends it around the obstacle, as in [RRS](super::rrs). In the tree from the goal edges are
//! bent in forward time.
//!
//! **When to use it.** As [RRS](super::rrs), where both ends are known: it takes even fewer iterations.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of sampling a further goal state, where there is a sampler | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `range`: how far obstacles repel | (0, extent of the space] | 3% of the extent |
//! | `snake-steps`: most steps of a snake | 1 to 1,000,000 | 4 |
//!
//! A point goes around a disc in the unit square, by name:
//! ```
//! use mp_cspace::erased::AnyGradient;
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, ObstacleKnowledge, Outcome, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, Settings, build};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let from_disc = |q: &Vector2<f64>| q - Vector2::new(0.5, 0.5);
//! let free = move |q: &Vector2<f64>| from_disc(q).norm() > 0.3;
//! let field = move |q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]| {
//!     gradient.copy_from_slice(from_disc(q).normalize().as_slice());
//!     from_disc(q).norm() - 0.3
//! };
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let problem = Problem::new(&space, local, verifier, start, goal)?;
//! let settings = Settings::parse(["step=30%", "range=0.1"])?;
//! let gradient: Option<AnyGradient<Vector2<f64>>> = Some(Box::new(field));
//! let problem = problem.with_obstacles(ObstacleKnowledge { gradient, ..ObstacleKnowledge::default() });
//! let mut planner = build("rrs-connect", problem, &settings)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(100), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.states.first(), path.states.last()), (Some(&start), Some(&goal)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::rrs::{BEND, Flattened, RANGE, SNAKE_STEPS, with_bending_edges};
use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::{GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
use crate::{BuildError, PlannerInfo, RrtConnect};
use mp_snake::{Bending, SnakePlanner};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rrs-connect",
    summary: "RRT-Connect whose blocked edges are bent around obstacles by snakes",
    citation: "Baizid et al. 2014; Kuffner and LaValle 2000",
    parameters: &[STEP, GOAL_BIAS, PATIENCE, RANGE, BEND, SNAKE_STEPS],
    aliases: &[],
    cannot: NEEDS_BOTH_ENDS,
};

/// Makes it by name.
pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    if !args.problem.goals().can_aim() {
        return Err(BuildError::NoGoalState { planner: INFO.name });
    }
    let problem = with_bending_edges(INFO.name, args.problem, args.settings)?;
    Ok(Box::new(Flattened(RrsConnect::with_index(problem, args.index, args.tuning)?)))
}

/// RRS-Connect: see the [module](self). Made by [`RrtConnect::new`] of a problem with a [`SnakePlanner`].
pub type RrsConnect<'c, C, M, F, N, B = Bending> = RrtConnect<'c, C, SnakePlanner<'c, C, M, F, B>, N>;
