//! One run of a planner by name, for robots of all kinds.

use crate::counted::Counted;
use crate::planners::PlannerSpec;
use crate::prepared::Prepared;
use crate::roadmaps::{self, Roadmap};
use crate::watch::{Events, Telling};
use crate::{Control, Error, Finish, Request, RobotKind, Stage, StoppedBy};
use mp_cspace::erased::{AnyCheck, AnyGradient, AnySpace};
use mp_cspace::shorten::reduce;
use mp_cspace::{
    Certified, Outcome, Path, Planner, Progress, Rng, Space, Stop, StopReason, Workers, verify_path,
};
use mp_snake::{Params, Repulsion, relax};
use mp_tree::{TreeState, improve};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// From how far obstacles push a path that is relaxed, as a part of the extent.
const RELAX_RANGE: f64 = 0.03;
/// How much longer relaxing may make what is left after needless states.
const MOST_STRETCH: f64 = 1.15;

/// What a planner came back with.
#[derive(Clone, Debug)]
pub struct Search<S> {
    /// The path, verified by the planner, or why there is none.
    pub outcome: Outcome<Path<S>>,
    /// What was done.
    pub progress: Progress,
    /// Collision and clearance queries asked.
    pub queries: u64,
    /// How long it took.
    pub time: Duration,
    /// Of a planner that keeps improving: when it found its first path, how long that was in the metric, and the path.
    pub first: Option<(Duration, f64, Path<S>)>,
    /// Edges and connected components, of a planner that builds a roadmap.
    pub map: Option<[usize; 2]>,
    /// The roadmap itself, if [asked for](Control::keep_roadmap).
    pub roadmap: Option<Roadmap<S>>,
}

/// A planner made by name.
enum Made<'p, S> {
    Tree(mp_tree::AnyPlanner<'p, S, ()>),
    Roadmap(roadmaps::Made<'p, S>),
}

impl<'p, S: roadmaps::RoadmapState + mp_cspace::StateVector + 'static> Made<'p, S> {
    fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        match self {
            Self::Tree(planner) => &mut **planner,
            Self::Roadmap(made) => made.planner(),
        }
    }
}

/// Runs the planner of a request, and relaxes the path if that is asked for; neither shortens it nor writes it down.
///
/// # Errors
/// When the request makes no sense for this robot, or a roadmap cannot be read or written.
pub fn search<K: RobotKind>(
    kind: &K,
    request: &Request,
    control: &mut Control<'_>,
) -> Result<Search<K::State>, Error> {
    let _span =
        tracing::info_span!("plan", scene = kind.name(), planner = %request.planner, seed = request.seed)
            .entered();
    request.check()?;
    let planner = PlannerSpec::new(&request.planner)?;
    let (settings, workers) = (request.settings(), Workers::new(request.threads)?);
    let fingerprint = roadmaps::fingerprint(kind, request)?;
    let prepared = Prepared::new(kind, request)?;
    let began = Instant::now();
    control.stage(Stage::Planning);
    let problem = || prepared.problem();
    let index = prepared.index.clone();
    let mut made = match &planner {
        PlannerSpec::Tree(named) => {
            let name = named.to_string();
            Made::Tree(TreeState::tree_planner(&name, Arc::new(&problem), index, &settings, &workers)?)
        }
        PlannerSpec::Roadmap(info) => {
            let made = roadmaps::Made::new(info, &problem, index, request, &settings, workers, fingerprint)?;
            Made::Roadmap(made)
        }
    };

    let wanted = control.watch.as_ref().is_some_and(|watch| watch.wants_events());
    let telling = Telling::new(control.watch.as_deref_mut());
    let stop = prepared.stop(request, began, control.cancel.clone());
    let mut stop = stop.or(control.stop.as_deref_mut()).or(&telling);
    let mut events = Events { row: &|q| kind.row(q), telling: &telling, wanted };
    let (best, reason, first) =
        solved(made.planner(), request, &prepared.space, &mut stop, &mut events, began);
    drop(stop);
    let outcome = match (best, reason) {
        (Some(path), _) => Outcome::Solved(relax_if_asked(kind, request, path, control)?),
        (None, reason) => Outcome::Stopped(reason.unwrap_or(StopReason::Cancelled)),
    };
    let time = began.elapsed();
    let progress = made.planner().progress();
    let (map, roadmap) = match &mut made {
        Made::Tree(_) => (None, None),
        Made::Roadmap(made) => {
            let (map, roadmap) = made.keep(request, fingerprint, control.keep_roadmap)?;
            (Some(map), roadmap)
        }
    };
    // What the checkers have counted and not told yet.
    drop(made);
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
    Ok(Search {
        outcome,
        progress,
        queries: prepared.queries.load(Ordering::Relaxed),
        time,
        first,
        map,
        roadmap,
    })
}

/// The last path found and why it is not the end, and the first of a planner that keeps improving.
type Solved<S> = (Option<Path<S>>, Option<StopReason>, Option<(Duration, f64, Path<S>)>);

/// Runs the planner. Compiled for each kind of state, not of robot.
fn solved<S: TreeState>(
    planner: &mut dyn Planner<S, Edge = ()>,
    request: &Request,
    space: &AnySpace<'_, S>,
    stop: &mut dyn Stop,
    events: &mut Events<'_, '_, '_, S>,
    began: Instant,
) -> Solved<S> {
    let mut rng = Rng::seed(request.seed);
    if request.first_only {
        return match planner.solve(&mut rng, stop, events) {
            Outcome::Solved(path) => {
                if let Some(watch) = &mut *events.telling.watch.borrow_mut() {
                    watch.found(path.length(space));
                }
                (Some(path), None, None)
            }
            Outcome::Stopped(reason) => (None, Some(reason), None),
        };
    }
    let (improves, telling) = (planner.improves(), events.telling);
    let mut first = None;
    let (best, reason) = improve(planner, &mut rng, stop, events, |path, _| {
        let length = path.length(space);
        if let Some(watch) = &mut *telling.watch.borrow_mut() {
            watch.found(length);
        }
        if improves && first.is_none() {
            first = Some((began.elapsed(), length, path.clone()));
        }
    });
    (best, reason, first)
}

/// The path as it is, or [relaxed].
pub(crate) fn relax_if_asked<K: RobotKind>(
    kind: &K,
    request: &Request,
    path: Path<K::State>,
    control: &mut Control<'_>,
) -> Result<Path<K::State>, Error> {
    if request.finish != Finish::Relax {
        return Ok(path);
    }
    control.stage(Stage::Relaxing);
    relaxed(kind, path)
}

/// The path without the states it does not need, relaxed by a snake: where that is not free by the verifier, the path
/// itself. In the own metric of the space it is no longer than the path.
fn relaxed<K: RobotKind>(kind: &K, path: Path<K::State>) -> Result<Path<K::State>, Error> {
    let _span = tracing::info_span!("relax").entered();
    let unused = AtomicU64::new(0);
    let knowledge = kind.obstacles(&|| Counted::new(kind.checker().clone(), &unused));
    let Some(gradient) = knowledge.gradient else {
        return Err(Error::new("this robot knows no clearance gradient, so its paths cannot be relaxed")
            .help("leave relaxing out: shortening needs none"));
    };
    let check = Box::new(Certified::new(kind.space(), kind.checker().clone(), kind.tolerance())?);
    relaxed_by(&AnySpace::new(kind.space()), check, Box::new(kind.verifier()?), gradient, path)
}

/// The same behind pointers: compiled for each kind of state, not of robot.
fn relaxed_by<S: TreeState>(
    space: &AnySpace<'_, S>,
    mut check: AnyCheck<'_, S>,
    mut verifier: AnyCheck<'_, S>,
    gradient: AnyGradient<'_, S>,
    path: Path<S>,
) -> Result<Path<S>, Error> {
    let range = RELAX_RANGE * space.extent();
    let mut field = Repulsion::new(gradient, range)?;
    let short = reduce(space, &mut check, &path);
    let [found, least] = [&path, &short].map(|path| path.length(space));
    let params = Params { straighten: 0.5, iterations: 200, ..Params::for_range(range)? };
    // Safety may cost some length, of what was saved.
    let stretch = if least > 0.0 { (found / least).clamp(1.0, MOST_STRETCH) } else { 1.0 };
    let relaxed = relax(space, &mut check, &mut field, &short, params, stretch)?.path;
    let verified = verify_path(space, &relaxed, &mut verifier);
    if let Some(fault) = verified.fault {
        tracing::info!("the relaxed path does not pass the verifier: {fault}");
        return Ok(path);
    }
    tracing::info!("relaxed: length {found} to {}", relaxed.length(space));
    Ok(relaxed)
}
