//! A run in pieces: for programs with an event loop, which plan a little between two events.

pub(crate) mod auto;
mod more_paths;
mod nearer_goal;
pub(crate) mod plan;
pub(crate) mod planners;
pub(crate) mod prepared;
#[cfg(feature = "roadmaps")]
pub(crate) mod regions;
pub(crate) mod roadmaps;
pub(crate) mod routes;
pub(crate) mod runs;
#[cfg(feature = "roadmaps")]
pub(crate) mod scene_roadmap;
pub(crate) mod search;

use crate::finish::relax::{Relaxing, relax_if_requested};
use crate::run::auto::Auto;
use crate::run::more_paths::find_more_paths;
use crate::run::plan::{left, reported};
use crate::run::planners::PlannerKind;
use crate::run::prepared::Prepared;
use crate::run::roadmaps::{Due, GrowingFile, RoadmapPlanner};
use crate::run::search::Search;
use crate::watch::Events;
use crate::{Control, Error, Report, Request, Robot, Stage, StoppedBy};
use mp_cspace::{Configuration, Outcome, Path, Planner, Progress, Rng, Stop, StopReason, Workers};
use mp_tree::improve;
use std::fmt;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// A request prepared for a scene: the data that a [`Run`] borrows. [`Scene::prepare`](crate::Scene::prepare) makes it.
pub struct PreparedRun<'s> {
    pub(crate) prepared: Prepared<'s>,
    /// The file of the scene.
    pub(crate) file: Option<String>,
}

impl PreparedRun<'_> {
    /// Makes the planner, which then has done nothing yet. Give the same `cancel` with `control` to [`Run::advance`]: the one given here
    /// ends the run within an iteration.
    ///
    /// # Errors
    /// When the request is not valid for the robot, or a roadmap cannot be read.
    pub fn begin(&self, control: &mut Control<'_>) -> Result<Run<'_>, Error> {
        self.begin_with(Rng::seed(self.prepared.request.seed), control)
    }

    /// As [`begin`](Self::begin), with other random numbers than those of the seed of the request.
    ///
    /// # Errors
    /// As [`begin`](Self::begin).
    pub fn begin_with(&self, rng: Rng, control: &mut Control<'_>) -> Result<Run<'_>, Error> {
        Ok(Run { run: RobotRun::begin(&self.prepared, rng, control)?, file: self.file.clone() })
    }

    /// The same once more: of runs that are advanced by turns, each needs its own.
    ///
    /// # Errors
    /// As those of the first.
    pub fn again(&self) -> Result<Self, Error> {
        Ok(Self { prepared: self.prepared.again()?, file: self.file.clone() })
    }
}

impl fmt::Debug for PreparedRun<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PreparedRun").field("file", &self.file).finish_non_exhaustive()
    }
}

/// A run of a planner that is advanced in pieces. The pieces do not change its result: the same request gives the same report,
/// except for its times, as [`Scene::plan`](crate::Scene::plan).
///
/// ```
/// use mp_plan::{Control, Request, Scene};
/// use mp_cspace::Iterations;
///
/// let (scene, request) = (Scene::find("easy")?, Request::new("rrt").seed(3));
/// let prepared = scene.prepare(&request)?;
/// let mut control = Control::default();
/// let mut run = prepared.begin(&mut control)?;
/// let mut pieces = 1;
/// while !run.advance(&mut Iterations(50 * pieces), &mut control) {
///     pieces += 1; // Here a program answers its events.
/// }
/// let report = run.finish(&mut control)?;
/// assert_eq!(report.fingerprint, scene.plan(&request)?.fingerprint);
/// # Ok::<(), mp_plan::Error>(())
/// ```
pub struct Run<'p> {
    run: RobotRun<'p, 'p>,
    file: Option<String>,
}

impl Run<'_> {
    /// Plans on until `pause` stops it, or the run is over: it has a path and does not improve it, its budget is used up, or
    /// `control` ends it. Returns whether it is over. Time between two calls does not count.
    pub fn advance(&mut self, pause: &mut dyn Stop, control: &mut Control<'_>) -> bool {
        self.run.advance(pause, control)
    }

    /// The counts so far.
    #[must_use]
    pub fn progress(&mut self) -> Progress {
        self.run.progress()
    }

    /// Finishes the path found, as the request says, verifies it, and makes the report. A run that is not over counts as
    /// cancelled; the best path that it found is kept.
    ///
    /// # Errors
    /// When a roadmap cannot be written, or the robot refuses to relax its path.
    pub fn finish(self, control: &mut Control<'_>) -> Result<Report, Error> {
        let mut report = self.run.finish(control)?;
        report.scene_file = self.file;
        Ok(report)
    }

    /// Ends the run as it is, with the path as found: [`Scene::found_report`](crate::Scene::found_report) makes a report of it.
    ///
    /// # Errors
    /// When a roadmap cannot be written.
    pub fn into_found(self) -> Result<FoundRun, Error> {
        self.run.into_found()
    }
}

impl fmt::Debug for Run<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run").field("file", &self.file).finish_non_exhaustive()
    }
}

/// What a run came to: plain data, from which [`Scene::found_report`](crate::Scene::found_report) makes a report elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundRun {
    /// Its counts.
    pub progress: Progress,
    /// Collision and clearance queries.
    pub queries: u64,
    /// Edges and components of a roadmap.
    pub map: Option<[usize; 2]>,
    /// The path, if there is one: the numbers of its configurations, to the bit.
    pub path: Option<Vec<Vec<f64>>>,
    /// What ended the run; `None` where the planner ended with its path, or the run is not over.
    pub ended_by: Option<StopReason>,
}

pub(crate) fn prepare<'s>(kind: &'s dyn Robot, request: &'s Request) -> Result<Prepared<'s>, Error> {
    request.check()?;
    PlannerKind::new(&request.planner)?;
    Prepared::new(kind, request)
}

pub(crate) enum NamedPlanner<'p> {
    Auto(Box<Auto<'p>>),
    Tree(mp_tree::AnyPlanner<'p, Configuration, ()>),
    Roadmap(RoadmapPlanner<'p>),
}

impl<'p> NamedPlanner<'p> {
    fn planner(&mut self) -> &mut (dyn Planner<Configuration, Edge = ()> + 'p) {
        match self {
            Self::Auto(auto) => &mut **auto,
            Self::Tree(planner) => &mut **planner,
            Self::Roadmap(made) => made.planner(),
        }
    }
}

pub(crate) struct RobotRun<'p, 'k> {
    prepared: &'p Prepared<'k>,
    /// None where the run ended before its planner was made.
    made: Option<NamedPlanner<'p>>,
    rng: Rng,
    file: Option<GrowingFile<'p>>,
    /// The part of the budget of time that is for planning.
    part: f64,
    /// The time taken so far.
    time: Duration,
    /// The counts after the last whole iteration, where another one was cut short.
    whole: Option<Progress>,
    found: Found,
}

/// The part of the budget of time that planning may take; the rest is for shortening and verifying.
pub(crate) const PLANNING_PART: f64 = 0.9;

struct Found {
    /// The last path.
    best: Option<Path<Configuration>>,
    /// The first path of an anytime planner: when it was found, and its length in the metric of the space.
    first: Option<(Duration, f64, Path<Configuration>)>,
    /// Whether the run is over, and why it stopped; no reason when it has a path that it does not improve.
    over: Option<Option<StopReason>>,
    /// Whether paths are told of when they are found: those that the planner has verified.
    tells: bool,
}

impl<'p, 'k> RobotRun<'p, 'k> {
    /// As [`new`](Self::new), with all of the time that is for planning; the planner draws from `rng`.
    pub(crate) fn begin(
        prepared: &'p Prepared<'k>,
        rng: Rng,
        control: &mut Control<'_>,
    ) -> Result<Self, Error> {
        Ok(Self { rng, ..Self::new(prepared, control, PLANNING_PART)? })
    }

    /// Makes the planner of the request, which has the part `part` of the budget of time.
    pub(crate) fn new(
        prepared: &'p Prepared<'k>,
        control: &mut Control<'_>,
        part: f64,
    ) -> Result<Self, Error> {
        let (kind, request) = (prepared.kind, &*prepared.request);
        let planner = PlannerKind::new(&request.planner)?;
        let workers = Workers::new(request.threads)?;
        let file = GrowingFile::of_request(kind, request, control.clock)?;
        let began = control.clock.now();
        control.stage(Stage::Planning);
        let interrupt = prepared.interrupt_of(control, part);
        prepared.interrupt_by(interrupt.clone());
        let made = match &planner {
            PlannerKind::Auto => Auto::new(prepared).map(|auto| NamedPlanner::Auto(Box::new(auto))),
            PlannerKind::Tree(spec) => {
                prepared.tree_planner(&spec.to_string(), &workers).map(NamedPlanner::Tree)
            }
            PlannerKind::Roadmap(info) => {
                prepared.roadmap_planner(info, workers, file.as_ref()).map(NamedPlanner::Roadmap)
            }
        };
        let mut found = Found { best: None, first: None, over: None, tells: true };
        let made = match (made, interrupt.raised()) {
            (Ok(mut made), _) => {
                // Of paths that are improved each is shown.
                let ends_with_its_path = request.first_only || !made.planner().improves();
                prepared.prove_later(prepared.proves_later() && ends_with_its_path);
                found.tells = !prepared.proves_later();
                Some(made)
            }
            // What was interrupted is no error.
            (Err(_), Some(reason)) => {
                found.over = Some(Some(reason));
                None
            }
            (Err(e), None) => return Err(e),
        };
        let time = control.clock.now().saturating_sub(began);
        let rng = Rng::seed(request.seed);
        Ok(Self { prepared, made, rng, file, part, time, whole: None, found })
    }

    /// Plans on until `pause` stops it or the run is over. Returns whether it is over. On the way it writes checkpoints of the
    /// roadmap.
    pub(crate) fn advance(&mut self, pause: &mut dyn Stop, control: &mut Control<'_>) -> bool {
        loop {
            let mut due = self.file.as_ref().map(GrowingFile::due);
            let over = self.advance_without_checkpoint(&mut pause.or(&mut due), control);
            if over || !due.is_some_and(|due: Due| due.reached) {
                return over;
            }
            if let (Some(NamedPlanner::Roadmap(made)), Some(file)) = (&self.made, &mut self.file) {
                file.checkpoint(made);
            }
        }
    }

    fn advance_without_checkpoint(&mut self, pause: &mut dyn Stop, control: &mut Control<'_>) -> bool {
        if let (None, Some(made)) = (self.found.over, &mut self.made) {
            let (clock, spent) = (control.clock, self.time);
            let began = clock.now();
            let (rng, found, whole) = (&mut self.rng, &mut self.found, &mut self.whole);
            let (prepared, first_only) = (self.prepared, self.prepared.request.first_only);
            // Time between two calls does not count.
            let [left, for_proof] = [self.part, 1.0].map(|part| prepared.time_left(control, part, spent));
            prepared.move_deadlines(began, left, for_proof);
            prepared.watched(control, |stop, events| {
                let mut stop = Pausing { stop, pause, paused: false, whole: Progress::default() };
                let time = || spent + clock.now().saturating_sub(began);
                search_on(made.planner(), found, first_only, prepared.kind, rng, &mut stop, events, &time);
                *whole = stop.cut_short().map(|_| stop.whole);
                if stop.paused && whole.is_none() {
                    found.over = None;
                }
            });
            self.time += clock.now().saturating_sub(began);
        }
        self.found.over.is_some()
    }

    /// Relaxes the path found if the request says so, and says what was done.
    pub(crate) fn into_search(mut self, control: &mut Control<'_>) -> Result<Search, Error> {
        let progress = self.progress();
        let (prepared, Found { best, first, over, .. }) = (self.prepared, self.found);
        let (kind, request) = (prepared.kind, &*prepared.request);
        let mut relaxing = Relaxing::default();
        let ended_by = over.unwrap_or(Some(StopReason::Cancelled));
        let outcome = match best {
            Some(path) => {
                let left = prepared.time_left(control, 1.0, self.time);
                let (path, work) = relax_if_requested(kind, request, path, control, left)?;
                relaxing = work;
                Outcome::Solved(path)
            }
            None => Outcome::Stopped(ended_by.unwrap_or(StopReason::Cancelled)),
        };
        let time = self.time + relaxing.time;
        let won = match &self.made {
            Some(NamedPlanner::Auto(auto)) => auto.won(),
            _ => None,
        };
        let mut roadmap_error = None;
        let (map, roadmap) = match &mut self.made {
            None | Some(NamedPlanner::Tree(_) | NamedPlanner::Auto(_)) => (None, None),
            Some(NamedPlanner::Roadmap(made)) => {
                // The path is not lost with the file.
                roadmap_error = made.save_to(self.file.as_ref()).err().map(|e| e.to_string());
                let (map, roadmap) = made.keep(control.keep_roadmap);
                if let Some(watch) = control.watch.as_mut().filter(|watch| watch.wants_roadmap()) {
                    watch.roadmap(made.grown(&|q| kind.row(q)));
                }
                (Some(map), roadmap)
            }
        };
        // Checkers report their last queries when they are dropped.
        drop(self.made);
        let outcome_word = match &outcome {
            Outcome::Solved(_) => "solved",
            Outcome::Stopped(reason) => StoppedBy::from(*reason).word(),
        };
        tracing::info!(
            outcome = outcome_word,
            iterations = progress.iterations,
            nodes = progress.nodes,
            "planned"
        );
        let queries = prepared.queries().load(Ordering::Relaxed);
        let found_unverified = ended_by.is_some() && prepared.found_unverified();
        Ok(Search {
            outcome,
            progress,
            queries,
            time,
            relaxing,
            ended_by,
            proved: !prepared.proves_later(),
            found_unverified,
            first,
            others: Vec::new(),
            map,
            roadmap,
            roadmap_error,
            won,
        })
    }

    /// The counts after the last whole iteration.
    pub(crate) fn progress(&mut self) -> Progress {
        self.whole
            .unwrap_or_else(|| self.made.as_mut().map(|made| made.planner().progress()).unwrap_or_default())
    }

    /// Finishes the path found, and makes the report.
    fn finish(self, control: &mut Control<'_>) -> Result<Report, Error> {
        let (kind, request) = (self.prepared.kind, &*self.prepared.request);
        let mut found = self.into_search(control)?;
        find_more_paths(kind, request, control, &mut found)?;
        let left = left(request, control, &found);
        reported(kind, request, found, None, control, left)
    }

    /// Ends the run as it is, with the path as found.
    fn into_found(mut self) -> Result<FoundRun, Error> {
        let progress = self.progress();
        let map = match &mut self.made {
            None | Some(NamedPlanner::Tree(_) | NamedPlanner::Auto(_)) => None,
            Some(NamedPlanner::Roadmap(made)) => {
                made.save_to(self.file.as_ref())?;
                Some(made.keep(false).0)
            }
        };
        // Checkers report their last queries when they are dropped.
        self.made = None;
        Ok(FoundRun {
            progress,
            queries: self.prepared.queries().load(Ordering::Relaxed),
            map,
            path: self.found.best.map(|path| path.states.iter().map(|q| q.to_vec()).collect()),
            ended_by: self.found.over.flatten(),
        })
    }
}

/// A stop, and another that only pauses.
pub(crate) struct Pausing<'a> {
    pub(crate) stop: &'a mut dyn Stop,
    pub(crate) pause: &'a mut dyn Stop,
    pub(crate) paused: bool,
    /// The counts before the last iteration.
    pub(crate) whole: Progress,
}

impl Stop for Pausing<'_> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        self.whole = *progress;
        let reason = self.stop.check(progress);
        if reason.is_some() {
            return reason;
        }
        let reason = self.pause.check(progress);
        self.paused = reason.is_some();
        reason
    }
    fn cut_short(&self) -> Option<StopReason> {
        self.stop.cut_short()
    }
}

/// Runs the planner until it is stopped or has its last path.
#[expect(clippy::too_many_arguments, reason = "parts of a run, of which some are borrowed")]
fn search_on(
    planner: &mut dyn Planner<Configuration, Edge = ()>,
    found: &mut Found,
    first_only: bool,
    kind: &dyn Robot,
    rng: &mut Rng,
    stop: &mut dyn Stop,
    events: &mut Events<'_, '_, '_>,
    time: &dyn Fn() -> Duration,
) {
    let (adapter, rows, tells) = (events.adapter, events.rows, found.tells);
    let report = |path: &Path<Configuration>| {
        // In the metric of the space, as other lengths of the report, whatever the search measures by.
        let length = path.length(&kind.any_space());
        if let (true, Some(watch)) = (tells, &mut *adapter.watch.borrow_mut()) {
            watch.found(length, &|| rows(path));
        }
        length
    };
    if first_only {
        found.over = Some(match planner.solve(rng, stop, events) {
            Outcome::Solved(path) => {
                report(&path);
                found.best = Some(path);
                None
            }
            Outcome::Stopped(reason) => Some(reason),
        });
        return;
    }
    let improves = planner.improves();
    let (best, reason) = improve(planner, rng, stop, events, |path, _| {
        let length = report(path);
        if improves && found.first.is_none() {
            found.first = Some((time(), length, path.clone()));
        }
    });
    found.best = best.or(found.best.take());
    found.over = Some(reason);
}
