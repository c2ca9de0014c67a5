//! Planners by name, for programs that choose at run time.

use crate::algo::{rrt, rrt_connect};
use crate::{BuildError, PlannerInfo, Problem, Rrt, RrtConnect, Settings, closest};
use mp_cspace::{DefaultNn, LocalPlanner, NearestNeighbors, Planner, Space};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn Planner<S, Edge = E> + 'c>;

/// All planners of the crate.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    &[rrt::INFO, rrt_connect::INFO]
}

/// The planner called `name`.
///
/// # Errors
/// When there is none, with the names there are.
pub fn planner(name: &str) -> Result<&'static PlannerInfo, BuildError> {
    planners().iter().find(|info| info.name == name).ok_or_else(|| unknown(name))
}

fn unknown(name: &str) -> BuildError {
    let known: Vec<_> = planners().iter().map(|info| info.name).collect();
    let suggestion = closest(name, known.iter().copied());
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
    L: LocalPlanner<C::State> + 'c,
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
    L: LocalPlanner<C::State> + 'c,
    N: NearestNeighbors<C> + Clone + 'c,
{
    let tuning = settings.tuning(planner(name)?)?;
    Ok(match name {
        "rrt" => Box::new(Rrt::with_index(problem, index, tuning)?),
        "rrt-connect" => Box::new(RrtConnect::with_index(problem, index, tuning)?),
        _ => return Err(unknown(name)),
    })
}
