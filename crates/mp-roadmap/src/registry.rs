//! Planners by name, for programs that choose at run time.

use crate::algo::{
    bridge_prm, gaussian_prm, lazy_prm, obprm, obstacle_geometry_prm, prm, prm_star, visibility_prm,
};
use crate::{BetweenObstacles, HasRoadmap, NearObstacles, Pairs, RoadmapPlanner};
use mp_cspace::{
    BuildError, DefaultNn, LocalPlanner, NearestNeighbors, ObstacleGeometry, PlannerInfo, Problem,
    Reversible, Settings, Space, closest,
};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn HasRoadmap<S, E> + Send + 'c>;

/// All planners of the crate that [`build`] makes.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    &[prm::INFO, prm_star::INFO, lazy_prm::INFO, visibility_prm::INFO, gaussian_prm::INFO, bridge_prm::INFO]
}

/// The planners that must know what obstacles look like: [`build_among`] makes them.
#[must_use]
pub fn planners_among() -> &'static [PlannerInfo] {
    &[obprm::INFO, obstacle_geometry_prm::INFO]
}

/// The planner called `name`, which may be one of its [other names](PlannerInfo::aliases), of either kind.
///
/// # Errors
/// When there is none, with the names there are.
pub fn planner(name: &str) -> Result<&'static PlannerInfo, BuildError> {
    all().find(|info| info.is_called(name)).ok_or_else(|| unknown(name))
}

fn all() -> impl Iterator<Item = &'static PlannerInfo> {
    planners().iter().chain(planners_among())
}

fn unknown(name: &str) -> BuildError {
    let known: Vec<_> = all().map(|info| info.name).collect();
    let aliases = all().flat_map(|info| info.aliases).copied();
    let suggestion = closest(name, known.iter().copied().chain(aliases));
    BuildError::UnknownPlanner { name: name.to_owned(), known, suggestion }
}

/// Makes the planner called `name`, with the nearest neighbours that suit the space.
///
/// # Errors
/// When there is no such planner, it has no such parameters, or refuses their values; when it is one of
/// [`planners_among`].
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
        "gaussian-prm" => Box::new(RoadmapPlanner::assemble(
            problem,
            index,
            Pairs::<NearObstacles>::read(space, settings, gaussian_prm::MIXING)?,
        )),
        "bridge-prm" => Box::new(RoadmapPlanner::assemble(
            problem,
            index,
            Pairs::<BetweenObstacles>::read(space, settings, bridge_prm::MIXING)?,
        )),
        name => {
            let reason = format!("{name} must know what obstacles look like, and nothing here tells it");
            return Err(BuildError::Unmade { reason });
        }
    })
}

/// As [`build_with`], also making the planners of [`planners_among`], by what `geometry` knows of robot and obstacles.
///
/// # Errors
/// As [`build`].
pub fn build_among<'c, C, L, N, H>(
    name: &str,
    problem: Problem<'c, C, L>,
    index: N,
    geometry: H,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: Space,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible> + Send + 'c,
    N: NearestNeighbors<C> + Send + 'c,
    H: ObstacleGeometry<C::State> + Clone + Send + 'c,
{
    let info = planner(name)?;
    settings.check(info)?;
    let space = problem.space();
    Ok(match info.name {
        "obprm" => {
            Box::new(RoadmapPlanner::assemble(problem, index, obprm::read(space, geometry, settings)?))
        }
        "obstacle-geometry-prm" => {
            let recipe = obstacle_geometry_prm::read(space, geometry, settings)?;
            Box::new(RoadmapPlanner::assemble(problem, index, recipe))
        }
        _ => return build_with(name, problem, index, settings),
    })
}
