//! Planners that build roadmaps, where the feature `roadmaps` compiles them; without it there are none.

use crate::{Error, Request};
use mp_cspace::erased::AnyIndex;
use mp_cspace::{
    AnyProblem, BuildError, Planner, Workers,
    registry::{PlannerInfo, Settings},
};
#[cfg(feature = "roadmaps")]
use mp_cspace::{Observer, Rng, Stop, StopReason};

/// A planner that builds a roadmap, and what became of the file that it is kept in.
pub(crate) struct Made<'p, S> {
    #[cfg(feature = "roadmaps")]
    planner: mp_roadmap::AnyPlanner<'p, S, ()>,
    #[cfg(not(feature = "roadmaps"))]
    none: (std::convert::Infallible, std::marker::PhantomData<&'p S>),
}

/// The problem of a run, made as often as there are threads.
pub(crate) type Make<'m, 'c, S> = &'m dyn Fn() -> Result<AnyProblem<'c, S>, BuildError>;

#[cfg(feature = "roadmaps")]
pub(crate) use mp_roadmap::planners;
#[cfg(feature = "roadmaps")]
pub use mp_roadmap::{Roadmap, RoadmapState};

/// What a roadmap in a file of the request must be one of, where it names a file.
pub(crate) fn fingerprint<K: crate::RobotKind>(kind: &K, request: &Request) -> Result<Option<u64>, Error> {
    let Some(_) = &request.roadmap else { return Ok(None) };
    let Some(fingerprint) = kind.fingerprint(request.metric) else {
        let help = "leave the file of the roadmap out";
        return Err(Error::new("roadmaps are kept of rigid bodies only").help(help));
    };
    Ok(Some(fingerprint))
}

/// The planner called `name`, if there is one.
#[cfg(feature = "roadmaps")]
pub(crate) fn planner(name: &str) -> Option<&'static PlannerInfo> {
    mp_roadmap::planner(name).ok()
}

#[cfg(feature = "roadmaps")]
impl<'p, S: RoadmapState + mp_cspace::StateVector + 'static> Made<'p, S> {
    /// The planner of `request`, going on with the roadmap that is kept.
    pub(crate) fn new(
        info: &PlannerInfo,
        make: Make<'_, 'p, S>,
        index: AnyIndex<S>,
        request: &Request,
        settings: &Settings,
        workers: Workers,
        fingerprint: Option<u64>,
    ) -> Result<Self, Error> {
        let team = mp_roadmap::ParallelProblem::new(workers, request.threads, make)?;
        let mut planner = S::roadmap_planner(info.name, team, index, settings)?;
        if let (Some(file), Some(fingerprint)) = (&request.roadmap, fingerprint)
            && file.exists()
        {
            let map = Roadmap::load(file, fingerprint).map_err(|e| {
                Error::new(e.to_string()).help("name another file, or delete it to begin anew")
            })?;
            planner.resume(map)?;
        }
        Ok(Self { planner })
    }

    pub(crate) fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        &mut *self.planner
    }

    /// Builds until stopped, whether or not start and goal get connected.
    pub(crate) fn build(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<S>,
    ) -> StopReason {
        self.planner.build(rng, stop, observer)
    }

    /// How many nodes there are.
    pub(crate) fn nodes(&self) -> usize {
        self.planner.map().len()
    }

    /// Goes on with this roadmap.
    pub(crate) fn resume(&mut self, map: Roadmap<S>) -> Result<(), Error> {
        Ok(self.planner.resume(map)?)
    }

    /// Writes the roadmap to the file that it is kept in; its edges and components, and itself if wanted.
    pub(crate) fn keep(
        &mut self,
        request: &Request,
        fingerprint: Option<u64>,
        wanted: bool,
    ) -> Result<([usize; 2], Option<Roadmap<S>>), Error> {
        if let (Some(file), Some(fingerprint)) = (&request.roadmap, fingerprint) {
            mp_io::write_atomic(file, &self.planner.map().to_bytes(fingerprint))?;
        }
        let map = [self.planner.map().edges(), self.planner.map_mut().components()];
        Ok((map, wanted.then(|| self.planner.map().clone())))
    }
}

/// Without the feature `roadmaps` any state will do.
#[cfg(not(feature = "roadmaps"))]
pub trait RoadmapState: Clone + std::fmt::Debug + PartialEq + Send + Sync {}
#[cfg(not(feature = "roadmaps"))]
impl<S: Clone + std::fmt::Debug + PartialEq + Send + Sync> RoadmapState for S {}

/// Without the feature `roadmaps` there is none.
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
impl<'p, S: RoadmapState> Made<'p, S> {
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn new(
        info: &PlannerInfo,
        _: Make<'_, 'p, S>,
        _: AnyIndex<S>,
        _: &Request,
        _: &Settings,
        _: Workers,
        _: Option<u64>,
    ) -> Result<Self, Error> {
        Err(Error::new(format!("{} is not in this program", info.name)))
    }
    pub(crate) fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        match self.none.0 {}
    }
    pub(crate) fn keep(
        &mut self,
        _: &Request,
        _: Option<u64>,
        _: bool,
    ) -> Result<([usize; 2], Option<Roadmap<S>>), Error> {
        match self.none.0 {}
    }
}
