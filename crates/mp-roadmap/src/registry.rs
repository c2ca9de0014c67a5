//! Planners by name, for programs that choose at run time.

use crate::algo::{
    bridge_prm, gaussian_prm, lazy_prm, obprm, obstacle_geometry_prm, prm, prm_star, visibility_prm,
};
use crate::planner::taken_apart;
use crate::{
    BetweenObstacles, Connector, HasRoadmap, NearObstacles, NodeGenerator, Pairs, Query, Recipe,
    RoadmapPlanner, Steer,
};
use mp_cspace::erased::{AnySpace, AnyStraight};
use mp_cspace::{
    BuildError, DefaultNn, LocalPlanner, NearestNeighbors, PlannerInfo, Problem, Reversible, Settings, Space,
    Workers, closest,
};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn HasRoadmap<S, E> + Send + 'c>;

/// All planners of the crate.
#[must_use]
pub fn planners() -> &'static [PlannerInfo] {
    &[
        prm::INFO,
        prm_star::INFO,
        lazy_prm::INFO,
        visibility_prm::INFO,
        gaussian_prm::INFO,
        bridge_prm::INFO,
        obprm::INFO,
        obstacle_geometry_prm::INFO,
    ]
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

/// A problem, and as many local planners and verifiers for it beside as threads are to build the roadmap.
#[derive(Debug)]
pub struct Team<'c, C: Space, L: LocalPlanner<C::State>> {
    problem: Problem<'c, C, L>,
    workers: Workers,
    hands: Vec<Steer<'c, C, L>>,
}

/// A team for an erased problem.
pub type AnyTeam<'c, S> = Team<'c, AnySpace<'c, S>, AnyStraight<'c, S>>;

impl<'c, C, L> Team<'c, C, L>
where
    C: Space + 'c,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    /// `problem` makes the same problem again and again; `hands` is how many work at the same time, best as many as
    /// `workers` are threads. The roadmap is the same to the bit however many there are. Only generators whose
    /// attempts are [independent](crate::NodeGenerator::independent) use them.
    ///
    /// # Errors
    /// Those of `problem`.
    pub fn new(
        workers: Workers,
        hands: usize,
        problem: impl Fn() -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError> {
        let more = if hands > 1 { hands } else { 0 };
        let hands = (0..more).map(|_| Ok(taken_apart(problem()?).0)).collect::<Result<_, BuildError>>()?;
        Ok(Self { problem: problem()?, workers, hands })
    }

    /// The planner of a recipe.
    fn made<G, K, Q, N>(self, index: N, recipe: Recipe<G, K, Q>) -> AnyPlanner<'c, C::State, L::Edge>
    where
        C::State: 'c,
        L: Send + 'c,
        G: NodeGenerator<C, L> + Clone + Send + Sync + 'c,
        K: Connector<C, L> + Send + Sync + 'c,
        Q: Query<C, L> + Send + 'c,
        N: NearestNeighbors<C> + Send + Sync + 'c,
    {
        let planner = RoadmapPlanner::assemble(self.problem, index, recipe);
        match self.hands.is_empty() {
            true => Box::new(planner),
            false => Box::new(planner.on(self.workers, self.hands)),
        }
    }
}

/// On the thread of the caller.
impl<'c, C: Space, L: LocalPlanner<C::State>> From<Problem<'c, C, L>> for Team<'c, C, L> {
    fn from(problem: Problem<'c, C, L>) -> Self {
        Self { problem, workers: Workers::alone(), hands: Vec::new() }
    }
}

/// Makes the planner called `name`, with the nearest neighbours that suit the space. What it asks of obstacles it takes
/// from the [problem](Problem::with_obstacles).
///
/// # Errors
/// When there is no such planner, it has no such parameters, or refuses their values; when the problem does not know
/// of obstacles what the planner asks.
pub fn build<'c, C, L>(
    name: &str,
    problem: Problem<'c, C, L>,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: DefaultNn + Clone + 'c,
    C::Nn: Sync + 'c,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible> + Send + 'c,
{
    build_with(name, problem, C::Nn::default(), settings)
}

/// As [`build`], with an empty index of your choice, and for a problem or a [`Team`].
///
/// # Errors
/// As [`build`].
pub fn build_with<'c, C, L, N>(
    name: &str,
    team: impl Into<Team<'c, C, L>>,
    index: N,
    settings: &Settings,
) -> Result<AnyPlanner<'c, C::State, L::Edge>, BuildError>
where
    C: Space + Clone + 'c,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible> + Send + 'c,
    N: NearestNeighbors<C> + Send + Sync + 'c,
{
    let info = planner(name)?;
    settings.check(info)?;
    let mut team = team.into();
    let space = team.problem.space();
    let known = team.problem.take_obstacles();
    let geometry = || known.geometry.ok_or(BuildError::NoGeometry { planner: info.name });
    Ok(match info.name {
        "prm" => team.made(index, prm::read(space, settings)?),
        "prm-star" => team.made(index, prm_star::read(space, settings)?),
        "lazy-prm" => team.made(index, lazy_prm::read(space, settings)?),
        "visibility-prm" => team.made(index, visibility_prm::read(space, settings)?),
        "gaussian-prm" => {
            team.made(index, Pairs::<NearObstacles>::read(space, settings, gaussian_prm::MIXING)?)
        }
        "bridge-prm" => {
            team.made(index, Pairs::<BetweenObstacles>::read(space, settings, bridge_prm::MIXING)?)
        }
        "obprm" => team.made(index, obprm::read(space, geometry()?, settings)?),
        "obstacle-geometry-prm" => {
            team.made(index, obstacle_geometry_prm::read(space, geometry()?, settings)?)
        }
        _ => return Err(unknown(name)),
    })
}
