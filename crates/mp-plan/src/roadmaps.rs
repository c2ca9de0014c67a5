//! Planners that build roadmaps, where the feature `roadmaps` compiles them; without it there are none.

use crate::{Error, Request};
use mp_cspace::erased::AnyIndex;
use mp_cspace::{AnyProblem, BuildError, Planner, PlannerInfo, Settings, Workers};

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

/// The planner called `name`, if there is one.
#[cfg(feature = "roadmaps")]
pub(crate) fn planner(name: &str) -> Option<&'static PlannerInfo> {
    mp_roadmap::planner(name).ok()
}

#[cfg(feature = "roadmaps")]
impl<'p, S: RoadmapState + mp_cspace::Numbers + 'static> Made<'p, S> {
    /// The planner of `request`, going on with the roadmap that is kept.
    pub(crate) fn new(
        info: &PlannerInfo,
        make: Make<'_, 'p, S>,
        index: AnyIndex<'p, S>,
        request: &Request,
        settings: &Settings,
        workers: Workers,
        fingerprint: Option<u64>,
    ) -> Result<Self, Error> {
        let team = mp_roadmap::Team::new(workers, request.threads, make)?;
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
        _: AnyIndex<'p, S>,
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
