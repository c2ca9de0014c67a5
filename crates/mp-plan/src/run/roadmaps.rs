//! Planners that build roadmaps, with the feature `roadmaps`. Without it there are none.

use crate::{Error, GrownRoadmap, MetricName, Request, Robot};
use mp_cspace::erased::AnyIndex;
use mp_cspace::{
    AnyProblem, BuildError, Configuration, Planner, Workers,
    registry::{PlannerInfo, Settings},
};
use mp_cspace::{Clock, Progress, SparseClock, Stop, StopReason};
#[cfg(feature = "roadmaps")]
use mp_cspace::{NodeId, Observer, Rng};
#[cfg(feature = "roadmaps")]
use mp_roadmap::{LinkState, ParallelProblem, QueryMeter, RoadmapError};
use mp_store::Lock;
#[cfg(feature = "roadmaps")]
use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::AtomicU64;
use std::time::Duration;
#[cfg(feature = "roadmaps")]
use std::{cell::Cell, sync::atomic::Ordering};

/// A planner that builds a roadmap.
pub(crate) struct RoadmapPlanner<'p> {
    #[cfg(feature = "roadmaps")]
    planner: mp_roadmap::AnyPlanner<'p, Configuration, ()>,
    #[cfg(not(feature = "roadmaps"))]
    none: (std::convert::Infallible, std::marker::PhantomData<&'p ()>),
}

/// Makes the problem of a run, once for each thread.
pub(crate) type MakeProblem<'m, 'c> = &'m dyn Fn() -> Result<AnyProblem<'c, Configuration>, BuildError>;

#[cfg(feature = "roadmaps")]
pub use mp_roadmap::Roadmap;
#[cfg(feature = "roadmaps")]
pub(crate) use mp_roadmap::planners;

/// The least time between two checkpoints of a roadmap that grows.
const CHECKPOINTS: Duration = Duration::from_secs(3);
/// At most 1/`CHECKPOINT_PART` of the time goes into writing checkpoints.
const CHECKPOINT_PART: u32 = 20;

/// The file in which a roadmap is kept, locked for this process: other processes that would write to it are refused.
#[cfg_attr(not(feature = "roadmaps"), expect(dead_code, reason = "no roadmap is read or written"))]
pub(crate) struct RoadmapFile<'r> {
    path: &'r Path,
    /// A hash of scene, robot and metric, which the roadmap in the file must have.
    fingerprint: u64,
    /// How many numbers a configuration has.
    numbers: usize,
    _lock: Lock,
}

impl<'r> RoadmapFile<'r> {
    /// The file at `path` for roadmaps of this robot under this metric. Its folder is made when it is missing.
    ///
    /// # Errors
    /// When roadmaps of such robots cannot be kept, or another process grows the roadmap in this file.
    pub(crate) fn new(kind: &dyn Robot, path: &'r Path, metric: MetricName) -> Result<Self, Error> {
        let Some(fingerprint) = kind.fingerprint(metric) else {
            let help = "leave the file of the roadmap out";
            return Err(Error::new("roadmaps are kept of rigid bodies only").help(help));
        };
        mp_store::make_folder(mp_store::folder_of(path))?;
        Ok(Self { path, fingerprint, numbers: kind.start().len(), _lock: Lock::of_file(path)? })
    }
}

#[cfg(feature = "roadmaps")]
impl RoadmapFile<'_> {
    /// The roadmap in the file; `None` when there is no file yet.
    fn read(&self) -> Result<Option<Roadmap<Configuration>>, Error> {
        if !self.path.exists() {
            return Ok(None);
        }
        let help = "name another file, or delete it to begin anew";
        let map: Roadmap<Configuration> =
            Roadmap::load(self.path, self.fingerprint).map_err(|e| match e.error {
                RoadmapError::File(file) => file.into(),
                _ => Error::new(e.to_string()).help(help),
            })?;
        match map.states().iter().all(|q| q.len() == self.numbers) {
            true => Ok(Some(map)),
            false => {
                let path = self.path.display();
                Err(Error::new(format!("{path} holds configurations of another kind of robot")).help(help))
            }
        }
    }

    pub(crate) fn write(&self, map: &Roadmap<Configuration>) -> Result<(), Error> {
        Ok(mp_store::write(self.path, &map.to_bytes(self.fingerprint))?)
    }
}

/// The file of a roadmap that grows. It is written at checkpoints, so that a process that is killed loses only some seconds of
/// growth. Checkpoints change no result: the run is paused between two steps, and the time of writing does not count.
pub(crate) struct GrowingFile<'r> {
    pub(crate) file: RoadmapFile<'r>,
    clock: Clock,
    next: Duration,
}

impl<'r> GrowingFile<'r> {
    /// The file that the request names, if it names one.
    ///
    /// # Errors
    /// As [`RoadmapFile::new`].
    pub(crate) fn of_request(
        kind: &dyn Robot,
        request: &'r Request,
        clock: Clock,
    ) -> Result<Option<Self>, Error> {
        let Some(path) = &request.roadmap else { return Ok(None) };
        let file = RoadmapFile::new(kind, path, request.metric)?;
        Ok(Some(Self { file, clock, next: clock.now() + CHECKPOINTS }))
    }

    /// Stops the run when it is time for a checkpoint.
    pub(crate) fn due(&self) -> Due {
        Due { clock: SparseClock::new(self.clock), at: self.next, reached: false }
    }

    /// Writes the roadmap. A failure is only told in the log: the run goes on, and it is an error if writing fails at its end too.
    pub(crate) fn checkpoint(&mut self, planner: &RoadmapPlanner<'_>) {
        let began = self.clock.now();
        if let Err(e) = planner.save(&self.file) {
            tracing::warn!("the roadmap was not saved: {e}");
        }
        let now = self.clock.now();
        self.next = now + CHECKPOINTS.max(CHECKPOINT_PART * now.saturating_sub(began));
    }
}

/// Lets `build` work until it stops by itself; when a checkpoint is due, it is stopped, the roadmap is written, and `build`
/// is called again.
#[cfg(feature = "roadmaps")]
pub(crate) fn with_checkpoints<'p, T>(
    planner: &mut RoadmapPlanner<'p>,
    file: &mut Option<GrowingFile<'_>>,
    mut build: impl FnMut(&mut RoadmapPlanner<'p>, &mut Option<Due>) -> T,
) -> T {
    loop {
        let mut due = file.as_ref().map(GrowingFile::due);
        let built = build(planner, &mut due);
        match file {
            Some(file) if due.is_some_and(|due| due.reached) => file.checkpoint(planner),
            _ => return built,
        }
    }
}

/// Stops when a checkpoint is due.
pub(crate) struct Due {
    clock: SparseClock,
    at: Duration,
    /// Whether it has stopped the run.
    pub(crate) reached: bool,
}

impl Stop for Due {
    fn check(&mut self, _: &Progress) -> Option<StopReason> {
        self.reached = self.clock.read().is_some_and(|now| now >= self.at);
        self.reached.then_some(StopReason::Deadline)
    }
}

/// What a planner of roadmaps is made from.
#[cfg_attr(not(feature = "roadmaps"), expect(dead_code, reason = "no roadmap is built"))]
pub(crate) struct PlannerParts<'m, 'p> {
    /// Makes the problem, once for each thread.
    pub(crate) problem: MakeProblem<'m, 'p>,
    /// An empty index of the space.
    pub(crate) index: AnyIndex<Configuration>,
    pub(crate) settings: Settings,
    pub(crate) workers: Workers,
    pub(crate) threads: usize,
    /// The common count of the queries of all checkers.
    pub(crate) queries: &'p AtomicU64,
}

/// The planner called `name`, if there is one.
#[cfg(feature = "roadmaps")]
pub(crate) fn planner(name: &str) -> Option<&'static PlannerInfo> {
    // Without the error of `mp_roadmap::planner`, which looks for names that are like it.
    planners().iter().find(|info| info.is_called(name))
}

#[cfg(feature = "roadmaps")]
impl<'p> RoadmapPlanner<'p> {
    /// The planner `info`. It begins with the roadmap in `file`, if there is one.
    pub(crate) fn new(
        info: &PlannerInfo,
        parts: PlannerParts<'_, 'p>,
        file: Option<&GrowingFile<'_>>,
    ) -> Result<Self, Error> {
        let PlannerParts { problem, index, settings, workers, threads, queries } = parts;
        let meter = QueryMeter { of_thread: mp_kinds::counted::queries_of_thread, common: queries };
        // Each problem checks its start and goals. That counts once, however many threads there are.
        let first = Cell::new(true);
        let problem = || {
            let before = queries.load(Ordering::Relaxed);
            let made = problem();
            if !first.replace(false) {
                queries.store(before, Ordering::Relaxed);
            }
            made
        };
        let problem = ParallelProblem::new(workers, threads, problem)?.metered(meter);
        let mut planner = mp_roadmap::erased::build(info.name, problem, index, &settings)?;
        if let Some(map) = file.map(|file| file.file.read()).transpose()?.flatten() {
            planner.resume(map)?;
        }
        Ok(Self { planner })
    }

    pub(crate) fn planner(&mut self) -> &mut (dyn Planner<Configuration, Edge = ()> + 'p) {
        &mut *self.planner
    }

    /// Builds until stopped, whether or not start and goal are connected.
    pub(crate) fn build(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<Configuration>,
    ) -> StopReason {
        self.planner.build(rng, stop, observer)
    }

    pub(crate) fn nodes(&self) -> usize {
        self.planner.map().len()
    }

    /// Continues with this roadmap.
    pub(crate) fn resume(&mut self, map: Roadmap<Configuration>) -> Result<(), Error> {
        Ok(self.planner.resume(map)?)
    }

    /// Writes the roadmap to `file`.
    pub(crate) fn save(&self, file: &RoadmapFile<'_>) -> Result<(), Error> {
        file.write(self.planner.map())
    }

    /// Returns the numbers of edges and of components, and the roadmap itself if it is `wanted`.
    pub(crate) fn keep(&mut self, wanted: bool) -> ([usize; 2], Option<Roadmap<Configuration>>) {
        let map = [self.planner.map().edges(), self.planner.map_mut().components()];
        (map, wanted.then(|| self.planner.map().clone()))
    }

    pub(crate) fn grown(&mut self, row: &dyn Fn(&Configuration) -> Vec<f64>) -> GrownRoadmap {
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

impl RoadmapPlanner<'_> {
    /// Writes the roadmap to `file`, if one is given.
    pub(crate) fn save_to(&self, file: Option<&GrowingFile<'_>>) -> Result<(), Error> {
        file.map_or(Ok(()), |file| self.save(&file.file))
    }
}

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
impl<'p> RoadmapPlanner<'p> {
    pub(crate) fn new(
        info: &PlannerInfo,
        _: PlannerParts<'_, 'p>,
        _: Option<&GrowingFile<'_>>,
    ) -> Result<Self, Error> {
        Err(Error::new(format!("{} is not in this program", info.name)))
    }
    pub(crate) fn planner(&mut self) -> &mut (dyn Planner<Configuration, Edge = ()> + 'p) {
        match self.none.0 {}
    }
    pub(crate) fn grown(&mut self, _: &dyn Fn(&Configuration) -> Vec<f64>) -> GrownRoadmap {
        match self.none.0 {}
    }
    pub(crate) fn save(&self, _: &RoadmapFile<'_>) -> Result<(), Error> {
        match self.none.0 {}
    }
    pub(crate) fn keep(&mut self, _: bool) -> ([usize; 2], Option<Roadmap<Configuration>>) {
        match self.none.0 {}
    }
}
