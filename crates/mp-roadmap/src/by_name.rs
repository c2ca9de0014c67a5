//! What planners made by name are made from.

use crate::{
    Connector, EdgeChecker, EndGrowth, HasRoadmap, NodeGenerator, PATIENCE, Query, QueryMeter,
    RoadmapPlanner, RoadmapPlannerParts,
};
use mp_cspace::erased::{AnyGeometry, AnySpace, AnyStraight};
use mp_cspace::{
    BuildError, LocalPlanner, NearestNeighbors, Problem, Reversible, Space, Workers, registry::Settings,
};

/// A planner chosen at run time.
pub type AnyPlanner<'c, S, E> = Box<dyn HasRoadmap<S, E> + Send + 'c>;

/// A problem with further edge checkers for it, so that several threads can build the roadmap.
#[derive(Debug)]
pub struct ParallelProblem<'c, C: Space, L: LocalPlanner<C::State>> {
    problem: Problem<'c, C, L>,
    workers: Workers,
    checkers: Vec<EdgeChecker<'c, C, L>>,
    meter: Option<QueryMeter<'c>>,
}

/// The edge checker of an erased problem.
pub type AnyEdgeChecker<'c, S> = EdgeChecker<'c, AnySpace<'c, S>, AnyStraight<'c, S>>;

/// An erased problem for several threads.
pub type AnyParallelProblem<'c, S> = ParallelProblem<'c, AnySpace<'c, S>, AnyStraight<'c, S>>;

impl<'c, C, L> ParallelProblem<'c, C, L>
where
    C: Space + 'c,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    /// A problem with `checkers` edge checkers that work at the same time, best as many as `workers` has
    /// threads. `problem` makes the same problem on every call. The roadmap is the same to the bit for any
    /// number of checkers. Only generators with [independent](crate::NodeGenerator::independent) attempts use
    /// them.
    ///
    /// # Errors
    /// Those of `problem`.
    pub fn new(
        workers: Workers,
        checkers: usize,
        problem: impl Fn() -> Result<Problem<'c, C, L>, BuildError>,
    ) -> Result<Self, BuildError> {
        let more = if checkers > 1 { checkers } else { 0 };
        let checkers = (0..more)
            .map(|_| Ok(EdgeChecker::of(problem()?, PATIENCE).0))
            .collect::<Result<_, BuildError>>()?;
        Ok(Self { problem: problem()?, workers, checkers, meter: None })
    }

    /// Counts queries by `meter`, so that the count is the same on any number of threads.
    #[must_use]
    pub fn metered(self, meter: QueryMeter<'c>) -> Self {
        Self { meter: Some(meter), ..self }
    }

    /// The planner with these parts.
    pub(crate) fn build<G, K, Q, N>(
        self,
        index: N,
        parts: RoadmapPlannerParts<G, K, Q>,
    ) -> AnyPlanner<'c, C::State, L::Edge>
    where
        C::State: 'c,
        L: Send + 'c,
        G: NodeGenerator<C, L> + Clone + Send + Sync + 'c,
        K: Connector<C, L> + Send + Sync + 'c,
        Q: Query<C, L> + Send + 'c,
        N: NearestNeighbors<C> + Send + Sync + 'c,
    {
        let mut planner = RoadmapPlanner::assemble(self.problem, index, parts);
        if let Some(meter) = self.meter {
            planner = planner.metered(meter);
        }
        match self.checkers.is_empty() {
            true => Box::new(planner),
            false => Box::new(planner.on(self.workers, self.checkers)),
        }
    }
}

/// The problem for the thread of the caller alone.
impl<'c, C: Space, L: LocalPlanner<C::State>> From<Problem<'c, C, L>> for ParallelProblem<'c, C, L> {
    fn from(problem: Problem<'c, C, L>) -> Self {
        Self { problem, workers: Workers::single(), checkers: Vec::new(), meter: None }
    }
}

/// The types of a planner made by name: a tuple of space, local planner and index.
pub(crate) trait Types<'c> {
    type State: Clone + PartialEq + Send + Sync + std::fmt::Debug + 'c;
    type Edge: Clone + Reversible + Send + Sync + 'c;
    type Space: Space<State = Self::State> + Clone + 'c;
    type Local: LocalPlanner<Self::State, Edge = Self::Edge> + Send + 'c;
    type Index: NearestNeighbors<Self::Space> + Clone + Send + Sync + 'c;
}

impl<'c, C, L, N> Types<'c> for (C, L, N)
where
    C: Space<State: 'c> + Clone + 'c,
    L: LocalPlanner<C::State, Edge: Reversible + 'c> + Send + 'c,
    N: NearestNeighbors<C> + Clone + Send + Sync + 'c,
{
    type State = C::State;
    type Edge = L::Edge;
    type Space = C;
    type Local = L;
    type Index = N;
}

/// What a planner is made from by name.
pub(crate) struct BuildArgs<'c, 's, T: Types<'c>> {
    parallel: ParallelProblem<'c, T::Space, T::Local>,
    /// An empty index.
    index: T::Index,
    /// All parameters that are set; the planner has parameters of these names.
    pub(crate) settings: &'s Settings,
    pub(crate) space: &'c T::Space,
    geometry: Option<AnyGeometry<'c, T::State>>,
}

/// The planner, or why it cannot be made.
pub(crate) type BuildResult<'c, T> =
    Result<AnyPlanner<'c, <T as Types<'c>>::State, <T as Types<'c>>::Edge>, BuildError>;

/// Makes one kind of planner.
pub(crate) type BuildFn<'c, 's, T> = fn(BuildArgs<'c, 's, T>) -> BuildResult<'c, T>;

impl<'c, 's, T: Types<'c>> BuildArgs<'c, 's, T> {
    /// What a planner of this problem is made from.
    pub(crate) fn new(
        mut parallel: ParallelProblem<'c, T::Space, T::Local>,
        index: T::Index,
        settings: &'s Settings,
    ) -> Self {
        let (space, geometry) = (parallel.problem.space(), parallel.problem.take_obstacles().geometry);
        Self { parallel, index, settings, space, geometry }
    }

    /// The geometry of obstacles, for the planner called `planner`.
    ///
    /// # Errors
    /// When the problem does not have it.
    pub(crate) fn geometry(&self, planner: &'static str) -> Result<AnyGeometry<'c, T::State>, BuildError> {
        self.geometry.clone().ok_or(BuildError::NoGeometry { planner })
    }

    /// An empty index.
    pub(crate) fn index(&self) -> T::Index {
        self.index.clone()
    }

    /// The planner with these parts.
    pub(crate) fn build<G, K, Q>(self, parts: RoadmapPlannerParts<G, K, Q>) -> BuildResult<'c, T>
    where
        G: NodeGenerator<T::Space, T::Local> + Clone + Send + Sync + 'c,
        K: Connector<T::Space, T::Local> + Send + Sync + 'c,
        Q: Query<T::Space, T::Local> + Send + 'c,
    {
        let ends = EndGrowth::read(self.space, self.settings)?;
        Ok(self.parallel.build(self.index, RoadmapPlannerParts { ends, ..parts }))
    }
}
