//! Planners with edges that bend, by name.

use crate::algo::rrs::{RANGE, SNAKE_STEPS};
use crate::algo::{rrs, rrs_connect};
use crate::{AnyPlanner, BuildError, PlannerInfo, Problem, Rrs, RrsConnect, Settings, Step, Tuning, Verify};
use mp_cspace::{
    ClearanceGradient, MotionCheck, MotionValidity, NearestNeighbors, Observer, Path, Planner, Progress, Rng,
    Space, Straight,
};
use mp_snake::{Curve, Params, Pieces, Repulsion, SnakePlanner, unbent};

/// The planners whose edges bend. They ask for a clearance gradient beside what the
/// [others](crate::planners) need, so [`build_snake`] makes them.
#[must_use]
pub fn snake_planners() -> &'static [PlannerInfo] {
    &[rrs::INFO, rrs_connect::INFO]
}

/// Makes the planner called `name`, one of [`snake_planners`], with an empty index of your choice. Edges of `problem`
/// that are blocked are bent by `field`. The paths are plain: straight between the nodes of the snakes, and verified
/// piece by piece.
///
/// # Errors
/// When there is no such planner, it has no such parameters or refuses their values, or the space knows no
/// velocities.
pub fn build_snake<'c, C, M, F, N>(
    name: &str,
    problem: Problem<'c, C, Straight<'c, C, M>>,
    field: F,
    index: N,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, ()>, BuildError>
where
    C: Space,
    C::State: 'c,
    M: MotionValidity<C::State> + Send + 'c,
    F: ClearanceGradient<C::State> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + 'c,
{
    let info = crate::planner(name)?;
    let tuning = Tuning::read(settings, info)?;
    let parts = problem.into_parts();
    let space = parts.space;
    let range = range(settings, space)?;
    let unmade = |reason: String| BuildError::Unmade { reason };
    let params = Params::for_edges(range).map_err(|e| unmade(e.to_string()))?;
    let iterations = settings.count_of(&SNAKE_STEPS)?;
    let iterations = u32::try_from(iterations).unwrap_or(u32::MAX);
    let repulsion = Repulsion::new(field, range).map_err(|e| unmade(e.to_string()))?;
    let local =
        SnakePlanner::with_params(space, parts.local.check, repulsion, Params { iterations, ..params })
            .map_err(|e| unmade(e.to_string()))?;
    let problem = Problem::new(space, local, Pieces(Boxed(parts.verify)), parts.start, parts.goals)?;
    Ok(match info.name {
        "rrs" => Box::new(Plain(Rrs::with_index(problem, index, tuning)?)),
        "rrs-connect" => Box::new(Plain(RrsConnect::with_index(problem, index, tuning)?)),
        _ => {
            let known = snake_planners().iter().map(|p| p.name).collect();
            return Err(BuildError::UnknownPlanner { name: name.to_owned(), known, suggestion: None });
        }
    })
}

fn range<C: Space>(settings: &Settings, space: &C) -> Result<f64, BuildError> {
    let step = settings.step(RANGE.name)?.unwrap_or(Step::Fraction(0.03));
    step.length_in(space).map_err(|e| match e {
        BuildError::OutOfRange { value, range, .. } => {
            BuildError::OutOfRange { name: RANGE.name, value, range }
        }
        other => other,
    })
}

/// A verifier behind a pointer.
struct Boxed<'c, S>(Box<dyn Verify<S, ()> + Send + 'c>);

impl<S> MotionValidity<S> for Boxed<'_, S> {
    fn check_motion(&mut self, from: &S, to: &S) -> MotionCheck {
        self.0.verify_edge(from, &(), to)
    }
}

/// A planner whose paths are made plain.
struct Plain<P>(P);

impl<S: Clone, P: Planner<S, Edge = Curve<S>>> Planner<S> for Plain<P> {
    type Edge = ();
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S>> {
        self.0.step(rng, observer).map(|path| unbent(&path))
    }
    fn progress(&self) -> Progress {
        self.0.progress()
    }
    fn improves(&self) -> bool {
        self.0.improves()
    }
}
