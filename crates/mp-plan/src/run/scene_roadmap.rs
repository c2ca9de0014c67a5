//! A roadmap of a scene that answers many queries.

use crate::explain::refused;
use crate::finish::relax::{Relaxing, relax_if_requested};
use crate::path::state;
use crate::run::plan::reported;
use crate::run::planners::PlannerKind;
use crate::run::prepared::Prepared;
use crate::run::roadmaps::{GrowingFile, Roadmap, RoadmapFile, with_checkpoints};
use crate::run::search::Search;
use crate::{Budget, Control, End, Error, ErrorKind, Report, Request, Robot, Stage, StoppedBy};
use mp_cspace::{Configuration, Interrupt, Outcome, Rng, Stop, StopReason, Workers, registry::PlannerInfo};
use mp_roadmap::{AnyEdgeChecker, PATIENCE, erased::AnyRoadmap};
use std::fmt;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// A start or goal is connected to at most this many nearest nodes.
const NEIGHBOURS: usize = 20;

/// A roadmap of a scene, which answers queries between any two free configurations. Queries do not add nodes. Verification
/// results are kept: each edge is verified at most once, and an edge that fails is blocked for good.
///
/// [`Scene::roadmap`](crate::Scene::roadmap) builds it. It owns all its data and may be sent to another thread.
pub struct SceneRoadmap {
    pub(crate) roadmap: RobotRoadmap,
    pub(crate) file: Option<String>,
}

impl fmt::Debug for SceneRoadmap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [nodes, edges] = self.roadmap.size();
        f.debug_struct("SceneRoadmap").field("nodes", &nodes).field("edges", &edges).finish_non_exhaustive()
    }
}

impl SceneRoadmap {
    /// A path from one configuration to another, finished and verified as by [`Scene::plan`](crate::Scene::plan), according
    /// to the request that the roadmap was built with. The budget of that request is for building only: a query ends by
    /// itself.
    ///
    /// # Errors
    /// When an end is not free: what touches, how deep, and the nearest free configuration. It is not an error that the
    /// roadmap has no path: [`Report::why`] says whether more nodes are needed near an end or between.
    pub fn query(&mut self, start: &[f64], goal: &[f64]) -> Result<Report, Error> {
        self.query_with(start, goal, &mut Control::default())
    }

    /// As [`query`](Self::query), with progress reports and a stop. The stop ends the search, and what is done to the path found.
    ///
    /// # Errors
    /// As [`query`](Self::query).
    pub fn query_with(
        &mut self,
        start: &[f64],
        goal: &[f64],
        control: &mut Control<'_>,
    ) -> Result<Report, Error> {
        let mut report = self.roadmap.query(start, goal, control)?;
        report.scene_file.clone_from(&self.file);
        Ok(report)
    }

    /// Continues building until this budget is used up. Its nodes include those that exist already. No file is written: see
    /// [`save`](Self::save).
    ///
    /// # Errors
    /// When the planner of the request refuses the scene.
    pub fn grow(&mut self, budget: Budget, control: &mut Control<'_>) -> Result<(), Error> {
        self.roadmap.grow(budget, control)
    }

    /// Verifies all edges now, so that queries need not. Returns how many failed and are blocked.
    ///
    /// # Errors
    /// When the request is not valid for the robot.
    pub fn verify(&mut self) -> Result<usize, Error> {
        self.roadmap.verify()
    }

    /// How many configurations it holds.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.roadmap.size()[0]
    }

    /// The number of edges that are not blocked.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.roadmap.size()[1]
    }

    /// The number of connected components.
    pub fn components(&mut self) -> usize {
        self.roadmap.components()
    }

    /// Writes it to a file, with which [`Request::roadmap`] can continue.
    ///
    /// # Errors
    /// When roadmaps of such robots cannot be saved, or the file cannot be written.
    pub fn save(&self, file: impl AsRef<Path>) -> Result<(), Error> {
        self.roadmap.save(file.as_ref())
    }
}

pub(crate) struct RobotRoadmap {
    kind: Arc<dyn Robot>,
    request: Request,
    roadmap: AnyRoadmap,
}

/// Builds a roadmap with the planner of the request.
pub(crate) fn build(
    kind: Arc<dyn Robot>,
    request: &Request,
    control: &mut Control<'_>,
) -> Result<RobotRoadmap, Error> {
    request.check_single("a roadmap for many queries")?;
    let roadmap = grown(&*kind, request, None, control)?;
    Ok(RobotRoadmap { kind, request: request.clone(), roadmap })
}

/// A roadmap that was built elsewhere, for this robot: a [`Roadmap`].
pub(crate) fn of_map(
    kind: Arc<dyn Robot>,
    request: &Request,
    map: Roadmap<Configuration>,
) -> Result<RobotRoadmap, Error> {
    let crate::Measured { space, index } = kind.measured(request.metric)?;
    let roadmap = AnyRoadmap::new(&space, map, index, NEIGHBOURS)?;
    drop(space);
    Ok(RobotRoadmap { kind, request: request.clone(), roadmap })
}

/// The planner of the request, which must build roadmaps.
fn planner(request: &Request) -> Result<&'static PlannerInfo, Error> {
    match PlannerKind::new(&request.planner)? {
        PlannerKind::Roadmap(info) => Ok(info),
        tree @ (PlannerKind::Tree(_) | PlannerKind::Auto) => {
            let names: Vec<_> = crate::run::roadmaps::planners().iter().map(|p| p.name).collect();
            Err(Error::new(format!("{tree} builds no roadmap"))
                .help(format!("take one of: {}", names.join(", "))))
        }
    }
}

/// Grows `map`, or the roadmap in the file of the request, or a new one, until the budget is used up.
fn grown(
    kind: &dyn Robot,
    request: &Request,
    map: Option<Roadmap<Configuration>>,
    control: &mut Control<'_>,
) -> Result<AnyRoadmap, Error> {
    let info = planner(request)?;
    let _span = tracing::info_span!("roadmap", scene = kind.name(), planner = info.name, seed = request.seed)
        .entered();
    let workers = Workers::new(request.threads)?;
    let mut file = GrowingFile::of_request(kind, request, control.clock)?;
    let prepared = Prepared::new(kind, request)?;
    prepared.interrupt_by(prepared.interrupt_of(control, 1.0));
    control.stage(Stage::Planning);
    let made = prepared.roadmap_planner(info, workers, file.as_ref());
    let mut made = match (made, prepared.interrupt().raised()) {
        // Once it is interrupted, start and goal count as not free.
        (Err(_), Some(reason)) => {
            return Err(Error::new(format!("no roadmap was built: {}", StoppedBy::from(reason)))
                .help("give it more time"));
        }
        (made, _) => made?,
    };
    if let Some(map) = map {
        made.resume(map)?;
    }
    // A roadmap that is continued draws other random numbers than those it was built from.
    let mut rng = match made.nodes() {
        0 => Rng::seed(request.seed),
        nodes => Rng::stream(request.seed, nodes as u64),
    };
    let reason = with_checkpoints(&mut made, &mut file, |made, due| {
        prepared.watched(control, |stop, events| made.build(&mut rng, &mut stop.or(due), events))
    });
    made.save_to(file.as_ref())?;
    let ([edges, components], map) = made.keep(true);
    drop(made);
    let map = map.unwrap_or_default();
    tracing::info!(nodes = map.len(), edges, components, by = StoppedBy::from(reason).word(), "built");
    Ok(AnyRoadmap::new(&prepared.space, map, prepared.index.clone(), NEIGHBOURS)?)
}

impl RobotRoadmap {
    fn query(&mut self, start: &[f64], goal: &[f64], control: &mut Control<'_>) -> Result<Report, Error> {
        let (kind, request) = (&*self.kind, &self.request);
        let _span = tracing::info_span!("query", scene = kind.name()).entered();
        let [start, goal] = [state(kind, start)?, state(kind, goal)?];
        for (end, name, q) in [(End::Start, "the start", &start), (End::Goal(0), "the goal", &goal)] {
            if let Some((message, help)) = refused(kind, name, q) {
                return Err(Error::new(message).help(help).of_kind(ErrorKind::NotFree(end)));
            }
        }
        let prepared = Prepared::new(kind, request)?;
        let interrupt = Interrupt::new(control.cancel.clone());
        prepared.interrupt_by(interrupt.clone());
        control.stage(Stage::Planning);
        let began = control.clock.now();
        let (mut checker, ..) = AnyEdgeChecker::of(prepared.problem()?, PATIENCE);
        let answer = mp_roadmap::erased::answer(&mut self.roadmap, &mut checker, &start, &goal);
        let time = control.clock.now().saturating_sub(began);
        let mut progress = mp_cspace::Progress::new(0, self.roadmap.map().len(), checker.motions());
        progress.rejected = checker.rejected();
        // Checkers report their last queries when they are dropped.
        drop(checker);
        let queries = prepared.queries().load(Ordering::Relaxed);
        let map = Some([self.roadmap.map().edges(), self.roadmap.map_mut().components()]);
        let mut relaxing = Relaxing::default();
        let (outcome, why) = match (answer, interrupt.raised()) {
            (Ok(path), _) => {
                let (path, work) = relax_if_requested(kind, request, path, control, None)?;
                relaxing = work;
                (Outcome::Solved(path), None)
            }
            // What the query says about the roadmap means nothing when it was interrupted.
            (Err(_), Some(reason)) => (Outcome::Stopped(reason), None),
            (Err(why), None) => (Outcome::Stopped(StopReason::Exhausted), Some(why.to_string())),
        };
        let found = Search {
            outcome,
            progress,
            queries,
            time: time + relaxing.time,
            relaxing,
            ended_by: interrupt.raised(),
            proved: true,
            found_unverified: false,
            first: None,
            others: Vec::new(),
            map,
            won: None,
            roadmap: None,
            roadmap_error: None,
        };
        reported(kind, request, found, why, control, None)
    }

    fn grow(&mut self, budget: Budget, control: &mut Control<'_>) -> Result<(), Error> {
        let request = Request { budget, roadmap: None, ..self.request.clone() };
        request.check()?;
        self.roadmap = grown(&*self.kind, &request, Some(self.roadmap.map().clone()), control)?;
        Ok(())
    }

    fn verify(&mut self) -> Result<usize, Error> {
        let _span = tracing::info_span!("verify", scene = self.kind.name()).entered();
        let prepared = Prepared::new(&*self.kind, &self.request)?;
        let (mut checker, ..) = AnyEdgeChecker::of(prepared.problem()?, PATIENCE);
        Ok(mp_roadmap::erased::verify(&mut self.roadmap, &mut checker))
    }

    fn size(&self) -> [usize; 2] {
        [self.roadmap.map().len(), self.roadmap.map().edges()]
    }

    fn components(&mut self) -> usize {
        self.roadmap.map_mut().components()
    }

    fn save(&self, file: &Path) -> Result<(), Error> {
        RoadmapFile::new(&*self.kind, file, self.request.metric)?.write(self.roadmap.map())
    }
}
