//! Planners by name, for programs that choose at run time.

// Unit tests need none of it, and would compile all planners again.
#[cfg(not(test))]
pub mod erased;

use crate::algo;
use crate::by_name::{AnyPlanner, BuildArgs, ParallelProblem};
use mp_cspace::{
    BuildError, DefaultNn, LocalPlanner, NearestNeighbors, Problem, Reversible, Space,
    registry::{PlannerInfo, Settings},
};

/// All planners of the crate.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    algo::PLANNERS
}

/// The planner called `name`, which may be one of its [other names](PlannerInfo::aliases).
///
/// # Errors
/// When there is no such planner; the error lists the names.
pub fn planner(name: &str) -> Result<&'static PlannerInfo, BuildError> {
    let found = planners().iter().find(|info| info.is_called(name));
    found.ok_or_else(|| BuildError::unknown_planner(name, planners()))
}

/// Makes the planner called `name`, with the nearest neighbours that suit the space. The geometry of
/// obstacles comes from the [problem](Problem::with_obstacles).
///
/// # Errors
/// When there is no such planner, it has no such parameters, or refuses their values; when the problem lacks
/// the knowledge of obstacles that the planner needs.
pub fn build<'c, C, L>(
    name: &str,
    problem: Problem<'c, C, L>,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: DefaultNn + Clone + 'c,
    C::Nn: Sync + 'c,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible + 'c> + Send + 'c,
{
    build_with(name, problem, C::Nn::default(), settings)
}

/// As [`build`], with an empty index of your choice, and for a problem or a [`ParallelProblem`].
///
/// # Errors
/// As [`build`].
pub fn build_with<'c, C, L, N>(
    name: &str,
    parallel: impl Into<ParallelProblem<'c, C, L>>,
    index: N,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: Space<State: 'c> + Clone + 'c,
    L: LocalPlanner<C::State, Edge: Reversible + 'c> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + Sync + 'c,
{
    let (info, make) =
        algo::find::<(C, L, N)>(name).ok_or_else(|| BuildError::unknown_planner(name, planners()))?;
    settings.check(info)?;
    make(BuildArgs::new(parallel.into(), index, settings))
}
