//! What planners by name whose edges bend have in common.

use crate::algo::rrs::{RANGE, SNAKE_STEPS};
use crate::{BuildError, PlannerInfo, Problem, Settings, Step, Verify};
use mp_cspace::erased::AnyGradient;
use mp_cspace::{MotionCheck, MotionValidity, Observer, Path, Planner, Progress, Rng, Space, Straight};
use mp_snake::{Curve, Params, Pieces, Repulsion, SnakePlanner, unbent};

/// A problem whose blocked edges are bent.
type Bent<'c, C, M> = Problem<'c, C, SnakePlanner<'c, C, M, AnyGradient<'c, <C as Space>::State>>>;

/// `problem` for the planner `info`: edges that are blocked are bent by its clearance gradient.
pub(crate) fn bent<'c, C, M>(
    info: &PlannerInfo,
    mut problem: Problem<'c, C, Straight<'c, C, M>>,
    settings: &Settings,
) -> Result<Bent<'c, C, M>, BuildError>
where
    C: Space<State: 'c>,
    M: MotionValidity<C::State> + Send + 'c,
{
    let field = problem.take_obstacles().gradient.ok_or(BuildError::NoGradient { planner: info.name })?;
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
    Problem::new(space, local, Pieces(Boxed(parts.verify)), parts.start, parts.goals)
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

/// A planner whose paths are made plain: straight between the nodes of the snakes.
pub(crate) struct Plain<P>(pub(crate) P);

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
