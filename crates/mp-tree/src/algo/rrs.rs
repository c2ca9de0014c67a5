//! RRS, the rapidly-exploring random snakes: an RRT whose blocked edges are bent around obstacles; and
//! RRS-Connect, an RRT-Connect of that kind.
//!
//! K. Baizid, R. Chellali, R. Luza, B. Vitezslav and F. Arrichiello, *RRS: rapidly-exploring random snakes, a
//! new method for mobile robot path planning*, §3.3, steps 1 to 8. Snakes: M. Kass, A. Witkin and D.
//! Terzopoulos, *Snakes: active contour models*, IJCV 1, 1988.
//!
//! 1. Begin with the start.
//! 2. Up to the number of samples allowed:
//! 3. draw a sample, uniform in the space, or with a small probability a goal state;
//! 4. find the node nearest to it;
//! 5. go from that node toward the sample, one step at most: where the straight curve is free, add its end
//!    and the curve;
//! 6. where it is not, bend a [snake](mp_snake::Snake) from node to end around what blocks it;
//! 7. where every piece of the snake is free, add its end and the snake: the sample is rescued;
//! 8. return the tree; here, the path as soon as a node is in the goal and the path is verified piece by
//!    piece.
//!
//! So RRS is [RRT](super::rrt) with the local planner [`SnakePlanner`], and RRS-Connect is
//! [RRT-Connect](super::rrt_connect) with it: in the tree from the goal edges are bent in forward time. A
//! sample whose end is itself in collision is not rescued. How a blocked edge bends is a strategy,
//! [`Bending`]:
//! - `snake`, the default and the paper's step 6: the contour starts on the straight edge and relaxes, from
//!   few nodes to many;
//! - `bulge`, ours: all of the edge moves to the side to which the obstacle pushes it, in closed form
//!   ([`Snake::bulge`](mp_snake::Snake::bulge)), with one more corner where it grazes; nothing relaxes;
//! - `hybrid`, ours: the bulge is the initial contour, and relaxes; where no bulge is free, the straight edge
//!   does.
//!
//! In the paper's four worlds `snake` accepts as many samples as `hybrid`, solves as many problems and keeps
//! as much clearance. It takes longer, above all among long walls, around which no contour bends; `bulge`
//! bends an edge the fastest and keeps the least clearance (`docs/results/rrs.md`). A snake stops as soon as
//! it is free, or hopeless; then a free one relaxes until it keeps half the range as clearance. The energies
//! are those of [`Snake`](mp_snake::Snake), with its remarks on the formulas.
//!
//! What pushes snakes is the repulsion of obstacles by their clearance, or with `field` a field of choice. By
//! name it is the one that the [problem](mp_cspace::ObstacleKnowledge::field) has: `mp` and `mp-plan` make
//! `paper` (eq. 3), `risk`, `risk:FACTOR` and `image:FILE` for robots of the plane, as images of the world,
//! once for each run. By type any field pushes ([`SnakePlanner::with_bend`]).
//!
//! **When to use it.** Where the clearance and its gradient are cheap to compute (in the plane, by a distance
//! map, some nanoseconds) and obstacles are many and small: then steps can be much longer, and far fewer
//! iterations are needed. It does not help with long walls, around which no edge can bend within a step.
//! RRS-Connect, where both ends are known, takes even fewer iterations.
//!
//! | parameter | range | default |
//! |---|---|---|
//! | `step`: longest step | (0, extent of the space] | 5% of the extent |
//! | `goal-bias`: probability of aiming at a goal state, where there is one to aim at (RRS-Connect: of sampling a further one) | \[0, 1\] | 0.05 |
//! | `patience`: rejected paths after which each new edge is verified | 0, 1, 2, … | 10 |
//! | `range`: how far obstacles repel | (0, extent of the space] | 3% of the extent |
//! | `bend`: how blocked edges are bent | `snake`; `bulge`, `hybrid` (ours) | `snake` |
//! | `field`: what pushes snakes | `clearance`, or in the plane `paper`, `risk`, `risk:FACTOR`, `image:FILE` | `clearance` |
//! | `snake-steps`: most steps of a snake, with each number of nodes | 1 to 1,000,000 | 40 |
//!
//! Stiffness and spacing follow from the range ([`Params::for_edges`](mp_snake::Params::for_edges)). By name
//! it takes the gradient from the [problem](crate::Problem::with_obstacles), and its paths have straight
//! edges between the nodes of the snakes, verified piece by piece.
//!
//! A point goes around a disc in the unit square, in one bend:
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng};
//! use mp_snake::SnakePlanner;
//! use mp_tree::{Problem, Rrs, Tuning};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let from_disc = |q: &Vector2<f64>| q - Vector2::new(0.5, 0.48);
//! let free = move |q: &Vector2<f64>| from_disc(q).norm() > 0.2;
//! let field = move |q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]| {
//!     gradient.copy_from_slice(from_disc(q).normalize().as_slice());
//!     from_disc(q).norm() - 0.2
//! };
//! let check = Discrete::new(&space, free, Length::Fraction(0.01))?;
//! let local = SnakePlanner::new(&space, check, field, 0.1)?;
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//!
//! let mut planner = Rrs::new(Problem::new(&space, local, verifier, start, goal)?, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(1), &mut ());
//! let Outcome::Solved(path) = outcome else { panic!("{outcome:?}") };
//! assert_eq!((path.edges.len(), planner.tree().len()), (1, 2));
//! assert!(path.flattened().states.iter().all(free));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! RRS-Connect does so by name:
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

use crate::by_name::{BuildArgs, BuildResult, Types};
use crate::engine::{GOAL_BIAS, NEEDS_BOTH_ENDS_AND_GRADIENT, NEEDS_GRADIENT, PATIENCE, STEP};
use crate::{BuildError, Parameter, PlannerInfo, Problem, Rrt, RrtConnect, Settings, Verify};
use mp_cspace::erased::{AnyEnergy, AnyGradient};
use mp_cspace::{
    MotionCheck, MotionValidity, Observer, ObstacleKnowledge, Path, Planner, PolylineEdge, Progress,
    PushingField, Rng, Space, Straight,
};
use mp_snake::{Bending, Field, Params, Repulsion, SnakePlanner, With};

/// The range within which obstacles push snakes.
pub const RANGE: Parameter = Parameter {
    name: "range",
    range: "in (0, extent of the space], or with % in (0%, 100%] of the extent",
    default: "3%",
    doc: "distance within which obstacles repel snakes; also the distance between their nodes",
};

/// Most steps of a snake.
pub const SNAKE_STEPS: Parameter = Parameter {
    name: "snake-steps",
    range: "a whole number, 1 to 1000000",
    default: "40",
    doc: "most steps of a snake that bends one edge, with each number of nodes",
};

/// How blocked edges are bent.
pub const BEND: Parameter = Parameter {
    name: "bend",
    range: "snake, bulge or hybrid",
    default: "snake",
    doc: "how a blocked edge is bent: a snake relaxes (the paper), a bulge is laid, or a snake relaxes from a bulge (ours)",
};

/// What pushes snakes.
pub const FIELD: Parameter = Parameter {
    name: "field",
    range: "clearance, paper, risk, risk:FACTOR or image:FILE; all but clearance in the plane",
    default: "clearance",
    doc: "what pushes snakes: obstacles by their clearance, eq. 3 of the paper, a landscape of risk, or dark pixels",
};

/// The entry of [`planners`](crate::planners).
pub const INFO: PlannerInfo = PlannerInfo {
    name: "rrs",
    summary: "RRT whose blocked edges are bent around obstacles by snakes; for many small obstacles",
    citation: "Baizid et al. 2014; Kass, Witkin and Terzopoulos 1988",
    parameters: &[STEP, GOAL_BIAS, PATIENCE, RANGE, BEND, FIELD, SNAKE_STEPS],
    aliases: &[],
    cannot: &[NEEDS_GRADIENT],
};

pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
    let problem = with_bending_edges(INFO.name, args.problem, args.settings)?;
    Ok(Box::new(Flattened(Rrs::with_index(problem, args.index, args.tuning)?)))
}

/// RRS: see the [module](self). Made by [`Rrt::new`] of a problem with a [`SnakePlanner`].
pub type Rrs<'c, C, M, F, N, B = Bending> = Rrt<'c, C, SnakePlanner<'c, C, M, F, B>, N>;

/// RRS-Connect: see the [module](self). Made by [`RrtConnect::new`] of a problem with a [`SnakePlanner`].
pub type RrsConnect<'c, C, M, F, N, B = Bending> = RrtConnect<'c, C, SnakePlanner<'c, C, M, F, B>, N>;

/// RRS-Connect by name.
pub mod connect {
    use super::*;

    /// The entry of [`planners`](crate::planners).
    pub const INFO: PlannerInfo = PlannerInfo {
        name: "rrs-connect",
        summary: "RRT-Connect whose blocked edges are bent around obstacles by snakes",
        citation: "Baizid et al. 2014; Kuffner and LaValle 2000",
        parameters: &[STEP, GOAL_BIAS, PATIENCE, RANGE, BEND, FIELD, SNAKE_STEPS],
        aliases: &[],
        cannot: NEEDS_BOTH_ENDS_AND_GRADIENT,
    };

    pub(crate) fn make<'c, T: Types<'c>>(args: BuildArgs<'c, '_, T>) -> BuildResult<'c, T> {
        if !args.problem.goals().can_aim() {
            return Err(BuildError::NoGoalState { planner: INFO.name });
        }
        let problem = with_bending_edges(INFO.name, args.problem, args.settings)?;
        Ok(Box::new(Flattened(RrsConnect::with_index(problem, args.index, args.tuning)?)))
    }
}

/// A problem with a local planner that bends blocked edges.
type BendingProblem<'c, C, M> = Problem<'c, C, SnakePlanner<'c, C, M, NamedField<'c, <C as Space>::State>>>;

/// What pushes snakes by name.
pub(crate) enum NamedField<'c, S> {
    Repulsion(Repulsion<AnyGradient<'c, S>>),
    Alone(AnyEnergy<'c, S>),
    Both(With<Repulsion<AnyGradient<'c, S>>, AnyEnergy<'c, S>>),
}

impl<'c, S> NamedField<'c, S> {
    /// The field that `settings` name, of what is known of obstacles that repel within `range`.
    fn new(
        planner: &'static str,
        known: ObstacleKnowledge<'c, S>,
        range: f64,
        settings: &Settings,
    ) -> Result<Self, BuildError> {
        let unmade = |reason: String| BuildError::Unmade { reason };
        let name = settings.text(FIELD.name).unwrap_or(FIELD.default);
        let chosen = match (name == FIELD.default, known.field) {
            (true, _) => None,
            (false, Some(field)) => Some(field),
            (false, None) => {
                return Err(unmade(format!(
                    "{planner} cannot take the field `{name}`: the problem has no field beside the clearance"
                )));
            }
        };
        let repulsion = |gradient: Option<AnyGradient<'c, S>>| {
            let gradient = gradient.ok_or(BuildError::NoGradient { planner })?;
            Repulsion::new(gradient, range).map_err(|e| unmade(e.to_string()))
        };
        Ok(match chosen {
            None => Self::Repulsion(repulsion(known.gradient)?),
            Some(PushingField { energy, alone: true }) => Self::Alone(energy),
            Some(PushingField { energy, alone: false }) => {
                let both = With::new(repulsion(known.gradient)?, energy, 1.0);
                Self::Both(both.map_err(|e| unmade(e.to_string()))?)
            }
        })
    }
}

impl<S> Field<S> for NamedField<'_, S> {
    #[inline]
    fn energy(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        match self {
            Self::Repulsion(field) => field.energy(q, gradient),
            Self::Alone(field) => field(q, gradient),
            Self::Both(field) => field.energy(q, gradient),
        }
    }
    #[inline]
    fn clearance(&self) -> Option<f64> {
        match self {
            Self::Repulsion(field) => Field::<S>::clearance(field),
            Self::Alone(_) => None,
            Self::Both(field) => Field::<S>::clearance(field),
        }
    }
    #[inline]
    fn clearance_at(&mut self, q: &S, gradient: &mut [f64]) -> f64 {
        match self {
            Self::Repulsion(field) => field.clearance_at(q, gradient),
            Self::Alone(_) => f64::INFINITY,
            Self::Both(field) => field.clearance_at(q, gradient),
        }
    }
}

/// `problem`, for the planner called `planner`, with a local planner that bends blocked edges in the field
/// that `settings` name.
pub(crate) fn with_bending_edges<'c, C, M>(
    planner: &'static str,
    mut problem: Problem<'c, C, Straight<'c, C, M>>,
    settings: &Settings,
) -> Result<BendingProblem<'c, C, M>, BuildError>
where
    C: Space<State: 'c>,
    M: MotionValidity<C::State> + Send + 'c,
{
    let known = problem.take_obstacles();
    let parts = problem.into_parts();
    let space = parts.space;
    let range = settings.length_of(&RANGE, space)?;
    let unmade = |reason: String| BuildError::Unmade { reason };
    let params = Params::for_edges(range).map_err(|e| unmade(e.to_string()))?;
    let iterations = settings.count_of(&SNAKE_STEPS)?;
    let iterations = u32::try_from(iterations).unwrap_or(u32::MAX);
    let field = NamedField::new(planner, known, range, settings)?;
    let bend = settings.choice(BEND.name, BEND.range, |name| name.parse().ok())?.unwrap_or_default();
    let params = Params { iterations, ..params };
    let local: SnakePlanner<'_, C, M, _> =
        SnakePlanner::with_bend(space, parts.local.check, field, params, bend)
            .map_err(|e| unmade(e.to_string()))?;
    let problem = Problem::new(space, local, Boxed(parts.verify), parts.start, parts.goals)?;
    Ok(problem.with_interrupt(parts.interrupt))
}

/// A verifier behind a pointer.
struct Boxed<'c, S>(Box<dyn Verify<S, ()> + Send + 'c>);

impl<S> MotionValidity<S> for Boxed<'_, S> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        self.0.verify_edge(from, &(), to)
    }
}

/// A planner whose paths are flattened: straight edges between the nodes of the snakes.
pub(crate) struct Flattened<P>(pub(crate) P);

impl<S: Clone, P: Planner<S, Edge = PolylineEdge<S>>> Planner<S> for Flattened<P> {
    type Edge = ();
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S>> {
        self.0.step(rng, observer).map(|path| path.flattened())
    }
    fn progress(&self) -> Progress {
        self.0.progress()
    }
    fn improves(&self) -> bool {
        self.0.improves()
    }
}
