//! One run of a planner by name, for robots of all kinds.

use crate::planners::PlannerKind;
use crate::prepared::Prepared;
use crate::relax::relax_if_requested;
use crate::roadmaps::{Roadmap, RoadmapFile, RoadmapPlanner, RoadmapState};
use crate::watch::Events;
use crate::{Control, Error, Request, RobotKind, Stage, StoppedBy};
use mp_cspace::erased::AnySpace;
use mp_cspace::{Outcome, Path, Planner, Progress, Rng, Stop, StopReason, Workers};
use mp_tree::{TreeState, improve};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// The result of running a planner.
#[derive(Clone, Debug)]
pub struct Search<S> {
    /// The path, verified by the planner, or the reason why there is none.
    pub outcome: Outcome<Path<S>>,
    /// The counts of what was done.
    pub progress: Progress,
    /// The number of collision and clearance queries.
    pub queries: u64,
    /// How long it took.
    pub time: Duration,
    /// For an anytime planner: when it found its first path, the length of that path in the metric, and the path.
    pub first: Option<(Duration, f64, Path<S>)>,
    /// For a planner that builds a roadmap: the numbers of edges and of connected components.
    pub map: Option<[usize; 2]>,
    /// The roadmap itself, if [requested](Control::keep_roadmap).
    pub roadmap: Option<Roadmap<S>>,
}

/// A planner made by name.
enum NamedPlanner<'p, S> {
    Tree(mp_tree::AnyPlanner<'p, S, ()>),
    Roadmap(RoadmapPlanner<'p, S>),
}

impl<'p, S: RoadmapState + mp_cspace::StateVector + 'static> NamedPlanner<'p, S> {
    fn planner(&mut self) -> &mut (dyn Planner<S, Edge = ()> + 'p) {
        match self {
            Self::Tree(planner) => &mut **planner,
            Self::Roadmap(made) => made.planner(),
        }
    }
}

/// Runs the planner of a request, and relaxes the path if the request says so. The path is neither shortened nor written
/// as text.
///
/// # Errors
/// When the request is not valid for this robot, or a roadmap cannot be read or written.
pub fn search<K: RobotKind>(
    kind: &K,
    request: &Request,
    control: &mut Control<'_>,
) -> Result<Search<K::State>, Error> {
    let _span =
        tracing::info_span!("plan", scene = kind.name(), planner = %request.planner, seed = request.seed)
            .entered();
    request.check()?;
    let planner = PlannerKind::new(&request.planner)?;
    let workers = Workers::new(request.threads)?;
    let file = RoadmapFile::of_request(kind, request)?;
    let prepared = Prepared::new(kind, request)?;
    let began = Instant::now();
    control.stage(Stage::Planning);
    let mut made = match &planner {
        PlannerKind::Tree(spec) => NamedPlanner::Tree(prepared.tree_planner(&spec.to_string(), &workers)?),
        PlannerKind::Roadmap(info) => {
            NamedPlanner::Roadmap(prepared.roadmap_planner(info, workers, file.as_ref())?)
        }
    };
    let (best, reason, first) = prepared.watched(control, began, |stop, events| {
        solved(made.planner(), request, &prepared.space, stop, events, began)
    });
    let outcome = match (best, reason) {
        (Some(path), _) => Outcome::Solved(relax_if_requested(kind, request, path, control)?),
        (None, reason) => Outcome::Stopped(reason.unwrap_or(StopReason::Cancelled)),
    };
    let time = began.elapsed();
    let progress = made.planner().progress();
    let (map, roadmap) = match &mut made {
        NamedPlanner::Tree(_) => (None, None),
        NamedPlanner::Roadmap(made) => {
            let (map, roadmap) = made.keep(file.as_ref(), control.keep_roadmap)?;
            (Some(map), roadmap)
        }
    };
    // Checkers report their last queries when they are dropped.
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

/// The last path found, the reason for stopping, and the first path of an anytime planner.
type Solved<S> = (Option<Path<S>>, Option<StopReason>, Option<(Duration, f64, Path<S>)>);

/// Runs the planner. Compiled for each kind of state instead of each kind of robot.
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
                if let Some(watch) = &mut *events.adapter.watch.borrow_mut() {
                    watch.found(path.length(space));
                }
                (Some(path), None, None)
            }
            Outcome::Stopped(reason) => (None, Some(reason), None),
        };
    }
    let (improves, adapter) = (planner.improves(), events.adapter);
    let mut first = None;
    let (best, reason) = improve(planner, &mut rng, stop, events, |path, _| {
        let length = path.length(space);
        if let Some(watch) = &mut *adapter.watch.borrow_mut() {
            watch.found(length);
        }
        if improves && first.is_none() {
            first = Some((began.elapsed(), length, path.clone()));
        }
    });
    (best, reason, first)
}
