//! Planners by name, for programs that choose at run time.

use crate::RoadmapPlanner;
use crate::algo::{lazy_prm, prm, prm_star, visibility_prm};
use mp_cspace::{
    BuildError, DefaultNn, LocalPlanner, NearestNeighbors, Planner, PlannerInfo, Problem, Reversible,
    Settings, Space, closest,
};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn Planner<S, Edge = E> + Send + 'c>;

/// All planners of the crate.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    &[prm::INFO, prm_star::INFO, lazy_prm::INFO, visibility_prm::INFO]
}

/// The planner called `name`, which may be one of its [other names](PlannerInfo::aliases).
///
/// # Errors
/// When there is none, with the names there are.
pub fn planner(name: &str) -> Result<&'static PlannerInfo, BuildError> {
    planners().iter().find(|info| info.is_called(name)).ok_or_else(|| unknown(name))
}

fn unknown(name: &str) -> BuildError {
    let known: Vec<_> = planners().iter().map(|info| info.name).collect();
    let aliases = planners().iter().flat_map(|info| info.aliases).copied();
    let suggestion = closest(name, known.iter().copied().chain(aliases));
    BuildError::UnknownPlanner { name: name.to_owned(), known, suggestion }
}

/// Makes the planner called `name`, with the nearest neighbours that suit the space.
///
/// # Errors
/// When there is no such planner, it has no such parameters, or refuses their values.
pub fn build<'c, C, L>(
    name: &str,
    problem: Problem<'c, C, L>,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: DefaultNn,
    C::Nn: 'c,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible> + Send + 'c,
{
    build_with(name, problem, C::Nn::default(), settings)
}

/// As [`build`], with an empty index of your choice.
///
/// # Errors
/// As [`build`].
pub fn build_with<'c, C, L, N>(
    name: &str,
    problem: Problem<'c, C, L>,
    index: N,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: Space,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible> + Send + 'c,
    N: NearestNeighbors<C> + Send + 'c,
{
    let info = planner(name)?;
    settings.check(info)?;
    let space = problem.space();
    Ok(match info.name {
        "prm" => Box::new(RoadmapPlanner::assemble(problem, index, prm::read(space, settings)?)),
        "prm-star" => Box::new(RoadmapPlanner::assemble(problem, index, prm_star::read(space, settings)?)),
        "lazy-prm" => Box::new(RoadmapPlanner::assemble(problem, index, lazy_prm::read(space, settings)?)),
        "visibility-prm" => {
            Box::new(RoadmapPlanner::assemble(problem, index, visibility_prm::read(space, settings)?))
        }
        _ => return Err(unknown(name)),
    })
}
