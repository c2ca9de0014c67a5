//! Planners that build roadmaps, with the feature `roadmaps`. Without it there are none.

use crate::{Error, GrownRoadmap, MetricName, Request, RobotKind};
use mp_cspace::erased::AnyIndex;
use mp_cspace::{
    AnyProblem, BuildError, Planner, Workers,
    registry::{PlannerInfo, Settings},
};
#[cfg(feature = "roadmaps")]
use mp_cspace::{NodeId, Observer, Rng, Stop, StopReason};
#[cfg(feature = "roadmaps")]
use mp_roadmap::LinkState;
#[cfg(feature = "roadmaps")]
use std::collections::HashMap;
use std::path::Path;

/// A planner that builds a roadmap.
pub(crate) struct RoadmapPlanner<'p, S> {
    #[cfg(feature = "roadmaps")]
    planner: mp_roadmap::AnyPlanner<'p, S, ()>,
    #[cfg(not(feature = "roadmaps"))]
    none: (std::convert::Infallible, std::marker::PhantomData<&'p S>),
}

/// Makes the problem of a run, once for each thread.
pub(crate) type MakeProblem<'m, 'c, S> = &'m dyn Fn() -> Result<AnyProblem<'c, S>, BuildError>;

#[cfg(feature = "roadmaps")]
pub(crate) use mp_roadmap::planners;
#[cfg(feature = "roadmaps")]
pub use mp_roadmap::{Roadmap, RoadmapState};

/// The file in which a roadmap is kept.
#[cfg_attr(not(feature = "roadmaps"), expect(dead_code, reason = "no roadmap is read or written"))]
pub(crate) struct RoadmapFile<'r> {
    path: &'r Path,
    /// A hash of scene, robot and metric, which the roadmap in the file must have.
    fingerprint: u64,
}

impl<'r> RoadmapFile<'r> {
    /// The file at `path` for roadmaps of this robot under this metric.
    ///
    /// # Errors
    /// When roadmaps of such robots cannot be kept.
    pub(crate) fn new<K: RobotKind>(kind: &K, path: &'r Path, metric: MetricName) -> Result<Self, Error> {
        let Some(fingerprint) = kind.fingerprint(metric) else {
            let help = "leave the file of the roadmap out";
            return Err(Error::new("roadmaps are kept of rigid bodies only").help(help));
        };
        Ok(Self { path, fingerprint })
    }

    /// The file that the request names, if it names one.
    pub(crate) fn of_request<K: RobotKind>(kind: &K, request: &'r Request) -> Result<Option<Self>, Error> {
        request.roadmap.as_ref().map(|path| Self::new(kind, path, request.metric)).transpose()
    }
}

#[cfg(feature = "roadmaps")]
impl RoadmapFile<'_> {
    /// The roadmap in the file; `None` when there is no file yet.
    fn read<S: RoadmapState + mp_cspace::StateVector>(&self) -> Result<Option<Roadmap<S>>, Error> {
        if !self.path.exists() {
            return Ok(None);
        }
        let help = "name another file, or delete it to begin anew";
        Roadmap::load(self.path, self.fingerprint).map(Some).map_err(|e| Error::new(e.to_string()).help(help))
    }

    /// Writes the roadmap to the file.
    pub(crate) fn write<S: RoadmapState + mp_cspace::StateVector>(
        &self,
        map: &Roadmap<S>,
    ) -> Result<(), Error> {
        Ok(mp_io::write_atomic(self.path, &map.to_bytes(self.fingerprint))?)
    }
}

/// What a planner of roadmaps is made from.
#[cfg_attr(not(feature = "roadmaps"), expect(dead_code, reason = "no roadmap is built"))]
pub(crate) struct PlannerParts<'m, 'p, S: RoadmapState> {
    /// Makes the problem, once for each thread.
    pub(crate) problem: MakeProblem<'m, 'p, S>,
    /// An empty index of the space.
    pub(crate) index: AnyIndex<S>,
    pub(crate) settings: Settings,
    pub(crate) workers: Workers,
    pub(crate) threads: usize,
}

/// The planner called `name`, if there is one.
#[cfg(feature = "roadmaps")]
pub(crate) fn planner(name: &str) -> Option<&'static PlannerInfo> {
    mp_roadmap::planner(name).ok()
}

#[cfg(feature = "roadmaps")]
impl<'p, S: RoadmapState + mp_cspace::StateVector + 'static> RoadmapPlanner<'p, S> {
    /// The planner `info`. It begins with the roadmap in `file`, if there is one.
    pub(crate) fn new(
        info: &PlannerInfo,
        parts: PlannerParts<'_, 'p, S>,
        file: Option<&RoadmapFile<'_>>,
    ) -> Result<Self, Error> {
        let PlannerParts { problem, index, settings, workers, threads } = parts;
        let problem = mp_roadmap::ParallelProblem::new(workers, threads, problem)?;
        let mut planner = S::roadmap_planner(info.name, problem, index, &settings)?;
        if let Some(map) = file.map(RoadmapFile::read).transpose()?.flatten() {
            planner.resume(map)?;
        }
        Ok(Self { planner })
    }

    pub(crate) fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        &mut *self.planner
    }

    /// Builds until stopped, whether or not start and goal are connected.
    pub(crate) fn build(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<S>,
    ) -> StopReason {
        self.planner.build(rng, stop, observer)
    }

    /// The number of nodes.
    pub(crate) fn nodes(&self) -> usize {
        self.planner.map().len()
    }

    /// Continues with this roadmap.
    pub(crate) fn resume(&mut self, map: Roadmap<S>) -> Result<(), Error> {
        Ok(self.planner.resume(map)?)
    }

    /// Writes the roadmap to `file`, if one is given. Returns the numbers of edges and of components, and the roadmap itself
    /// if it is `wanted`.
    pub(crate) fn keep(
        &mut self,
        file: Option<&RoadmapFile<'_>>,
        wanted: bool,
    ) -> Result<([usize; 2], Option<Roadmap<S>>), Error> {
        if let Some(file) = file {
            file.write(self.planner.map())?;
        }
        let map = [self.planner.map().edges(), self.planner.map_mut().components()];
        Ok((map, wanted.then(|| self.planner.map().clone())))
    }

    /// The roadmap with its configurations as rows.
    pub(crate) fn grown(&mut self, row: &dyn Fn(&S) -> Vec<f64>) -> GrownRoadmap {
        let map = self.planner.map_mut();
        let mut numbers = HashMap::new();
        let components = (0..map.len() as NodeId).map(|id| {
            let next = numbers.len() as u32;
            *numbers.entry(map.component(id)).or_insert(next)
        });
        let components = components.collect();
        let free = map.all_edges().filter(|(_, _, link)| link.state != LinkState::Blocked);
        GrownRoadmap {
            edges: free.map(|(_, ends, _)| ends).collect(),
            rows: map.states().iter().map(row).collect(),
            kinds: map.tags().map(|tag| tag.kind.name()).collect(),
            components,
        }
    }
}

/// Without the feature `roadmaps`: any state.
#[cfg(not(feature = "roadmaps"))]
pub trait RoadmapState: Clone + std::fmt::Debug + PartialEq + Send + Sync {}
#[cfg(not(feature = "roadmaps"))]
impl<S: Clone + std::fmt::Debug + PartialEq + Send + Sync> RoadmapState for S {}

/// Without the feature `roadmaps`: a type without values.
#[cfg(not(feature = "roadmaps"))]
#[derive(Clone, Debug)]
pub struct Roadmap<S>(std::convert::Infallible, std::marker::PhantomData<S>);

#[cfg(not(feature = "roadmaps"))]
pub(crate) fn planners() -> &'static [PlannerInfo] {
    &[]
}

#[cfg(not(feature = "roadmaps"))]
pub(crate) fn planner(_: &str) -> Option<&'static PlannerInfo> {
    None
}

#[cfg(not(feature = "roadmaps"))]
impl<'p, S: RoadmapState> RoadmapPlanner<'p, S> {
    pub(crate) fn new(
        info: &PlannerInfo,
        _: PlannerParts<'_, 'p, S>,
        _: Option<&RoadmapFile<'_>>,
    ) -> Result<Self, Error> {
        Err(Error::new(format!("{} is not in this program", info.name)))
    }
    pub(crate) fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        match self.none.0 {}
    }
    pub(crate) fn grown(&mut self, _: &dyn Fn(&S) -> Vec<f64>) -> GrownRoadmap {
        match self.none.0 {}
    }
    pub(crate) fn keep(
        &mut self,
        _: Option<&RoadmapFile<'_>>,
        _: bool,
    ) -> Result<([usize; 2], Option<Roadmap<S>>), Error> {
        match self.none.0 {}
    }
}
