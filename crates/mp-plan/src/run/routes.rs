//! Several routes of one scene: verified paths that are far apart.

use crate::finish::relax::Relaxing;
use crate::path::states;
use crate::run::plan::reported;
use crate::run::planners::PlannerKind;
use crate::run::prepared::Prepared;
use crate::run::search::Search;
use crate::run::{PLANNING_PART, Pausing};
use crate::{Control, Error, ErrorKind, Finish, Length, PathRows, Report, Request, Robot, Stage, planners};
use mp_cspace::{
    Configuration, Interrupt, Iterations, Outcome, Path, Planner, Progress, Rng, Space, Stop, StopReason,
    Workers,
};
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Iterations before routes are looked for; then twice as many each time.
const FIRST: u64 = 1000;

/// The part of the time after which nothing is listed any more.
const LISTING_PART: f64 = 0.5 * (PLANNING_PART + 1.0);

/// What was found: paths, the counts, the time, and why it ended.
struct Listed {
    paths: Vec<Path<Configuration>>,
    progress: Progress,
    time: Duration,
    ended: StopReason,
    map: Option<[usize; 2]>,
    roadmap_error: Option<String>,
}

/// At most `count` routes: see [`Scene::routes`](crate::Scene::routes).
pub(crate) fn routes(
    kind: &dyn Robot,
    request: &Request,
    count: usize,
    apart: Length,
    control: &mut Control<'_>,
) -> Result<Vec<Report>, Error> {
    let _span = tracing::info_span!("routes", scene = kind.name(), planner = %request.planner).entered();
    request.check_single("a list of routes")?;
    if request.finish == Finish::Relax {
        let error = Error::new("routes are shortened or left as they were found, not relaxed");
        return Err(error.help("leave relaxing out, and relax one path").of_kind(ErrorKind::Request));
    }
    let planner = PlannerKind::new(&request.planner)?;
    let spent = control.time_if_limited(request);
    let prepared = Prepared::new(kind, request)?;
    control.spend_since(spent);
    let planning = prepared.interrupt_of(control, PLANNING_PART);
    prepared.interrupt_by(prepared.interrupt_of(control, LISTING_PART));
    let apart = apart.in_space(&kind.any_space());
    control.stage(Stage::Planning);
    let listed = match &planner {
        PlannerKind::Tree(spec) if spec.meta_planners.is_empty() && spec.planner.name == "cyclic-rrt" => {
            of_tree(&prepared, &spec.to_string(), count, apart, &planning, control)
        }
        PlannerKind::Tree(_) | PlannerKind::Auto => return Err(one_path_only(&planner)),
        #[cfg(feature = "roadmaps")]
        PlannerKind::Roadmap(info) => of_roadmap(&prepared, info, count, apart, &planning, control),
        #[cfg(not(feature = "roadmaps"))]
        PlannerKind::Roadmap(_) => return Err(one_path_only(&planner)),
    };
    let listed = match (listed, prepared.interrupt().raised()) {
        // Once it is interrupted, start and goal count as not free.
        (Err(_), Some(ended)) => Listed {
            paths: Vec::new(),
            progress: Progress::default(),
            time: Duration::ZERO,
            ended,
            map: None,
            roadmap_error: None,
        },
        (listed, _) => listed?,
    };
    let queries = prepared.queries().load(Ordering::Relaxed);
    let search = |outcome| Search {
        outcome,
        progress: listed.progress,
        queries,
        time: listed.time,
        relaxing: Relaxing::default(),
        ended_by: Some(listed.ended),
        proved: true,
        found_unverified: false,
        first: None,
        others: Vec::new(),
        map: listed.map,
        roadmap: None,
        roadmap_error: listed.roadmap_error.clone(),
        won: None,
    };
    if listed.paths.is_empty() {
        return Ok(vec![reported(
            kind,
            request,
            search(Outcome::Stopped(listed.ended)),
            None,
            control,
            None,
        )?]);
    }
    let mut reports: Vec<Report> = Vec::new();
    let began = control.clock.now();
    for (i, path) in listed.paths.iter().enumerate() {
        // Each path has an equal share of the time left.
        let spent = listed.time + control.clock.now().saturating_sub(began);
        let share =
            prepared.time_left(control, 1.0, spent).map(|left| left / (listed.paths.len() - i) as u32);
        let found = || search(Outcome::Solved(path.clone()));
        let mut report = reported(kind, request, found(), None, control, share)?;
        // What shortening has brought together stays as it was found.
        if report.solved && !is_far(kind, &report, &reports, apart)? && report.shortened {
            let as_found = Request { finish: Finish::AsFound, ..request.clone() };
            report = reported(kind, &as_found, found(), None, control, share)?;
        }
        reports.push(report);
    }
    Ok(reports)
}

fn one_path_only(planner: &PlannerKind) -> Error {
    let roadmaps = planners().filter(|info| crate::roadmap_planners().iter().any(|r| r.name == info.name));
    let names: Vec<_> = std::iter::once("cyclic-rrt").chain(roadmaps.map(|info| info.name)).collect();
    Error::new(format!("{planner} finds one path, not several routes"))
        .help(format!("take one of: {}", names.join(", ")))
}

/// Whether some point of the path is farther than `apart` from all points of each of the others, a quarter of that apart.
fn is_far(kind: &dyn Robot, report: &Report, others: &[Report], apart: f64) -> Result<bool, Error> {
    let space = kind.any_space();
    let points = |report: &Report| {
        let rows = report.path.clone().unwrap_or_default();
        let path = PathRows { format: kind.path_format(), columns: Vec::new(), rows };
        let states = states(kind, &path)?;
        let mut points = Vec::new();
        for pair in states.windows(2) {
            let pieces = (4.0 * space.distance(&pair[0], &pair[1]) / apart).ceil().clamp(1.0, 1e3) as u32;
            let at = |i: u32| space.interpolate(&pair[0], &pair[1], f64::from(i) / f64::from(pieces));
            points.extend((0..pieces).map(at));
        }
        points.extend(states.last().cloned());
        Ok::<_, Error>(points)
    };
    let own = points(report)?;
    for other in others.iter().filter(|other| other.solved) {
        let on = points(other)?;
        if !own.iter().any(|q| on.iter().all(|p| space.distance(p, q) > 0.5 * apart)) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Takes the routes `found` in place of those listed before. A list that was interrupted may be shorter.
fn keep(
    prepared: &Prepared<'_>,
    listed: &mut Vec<Path<Configuration>>,
    found: Option<Vec<Path<Configuration>>>,
) {
    let found = found.unwrap_or_default();
    if prepared.interrupt().raised().is_none() || found.len() > listed.len() {
        *listed = found;
    }
}

/// The routes in the graph of a planner that grows one, until `planning` ends it.
fn of_tree(
    prepared: &Prepared<'_>,
    name: &str,
    count: usize,
    apart: f64,
    planning: &Interrupt,
    control: &mut Control<'_>,
) -> Result<Listed, Error> {
    let workers = Workers::new(prepared.request.threads)?;
    let (clock, began) = (control.clock, control.clock.now());
    let mut planner = prepared.tree_planner(name, &workers)?;
    let (mut rng, mut target) = (Rng::seed(prepared.request.seed), FIRST);
    let mut paths = Vec::new();
    loop {
        let ended = prepared.watched(control, |stop, events| {
            loop {
                let mut pausing = Pausing {
                    stop: &mut (&mut *stop).or(planning.clone()),
                    pause: &mut Iterations(target),
                    paused: false,
                    whole: Progress::default(),
                };
                match planner.solve(&mut rng, &mut pausing, events) {
                    // More steps close more cycles.
                    Outcome::Solved(_) => {}
                    Outcome::Stopped(_) if pausing.paused => break None,
                    Outcome::Stopped(reason) => break Some(reason),
                }
            }
        });
        keep(prepared, &mut paths, planner.routes(count, apart));
        if paths.len() >= count || ended.is_some() {
            let (progress, time) = (planner.progress(), clock.now().saturating_sub(began));
            let ended = ended.unwrap_or(StopReason::Exhausted);
            return Ok(Listed { paths, progress, time, ended, map: None, roadmap_error: None });
        }
        target = target.saturating_mul(2);
    }
}

/// The routes in a roadmap, which grows until `planning` ends it.
#[cfg(feature = "roadmaps")]
fn of_roadmap(
    prepared: &Prepared<'_>,
    info: &mp_cspace::registry::PlannerInfo,
    count: usize,
    apart: f64,
    planning: &Interrupt,
    control: &mut Control<'_>,
) -> Result<Listed, Error> {
    use crate::run::roadmaps::{GrowingFile, with_checkpoints};
    use mp_roadmap::{AnyEdgeChecker, PATIENCE, erased::AnyRoadmap};
    /// How many of the nearest nodes an end is connected to.
    const NEIGHBOURS: usize = 20;

    let (kind, request) = (prepared.kind, &*prepared.request);
    let [goal] = kind.goals() else {
        let help = "give one goal, or take cyclic-rrt";
        return Err(Error::new(format!("{} lists routes to one goal only", info.name)).help(help));
    };
    if kind.goal_parts().is_some() {
        let help = "give all numbers of the goal, or take cyclic-rrt";
        return Err(
            Error::new(format!("{} lists routes to a goal that leaves nothing free", info.name)).help(help)
        );
    }
    let mut file = GrowingFile::of_request(kind, request, control.clock)?;
    let (clock, began) = (control.clock, control.clock.now());
    let workers = Workers::new(request.threads)?;
    let mut made = prepared.roadmap_planner(info, workers, file.as_ref())?;
    let (mut rng, mut target) = (Rng::seed(request.seed), FIRST);
    let mut paths = Vec::new();
    loop {
        let (ended, paused) = with_checkpoints(&mut made, &mut file, |made, due| {
            prepared.watched(control, |stop, events| {
                let mut pausing = Pausing {
                    stop: &mut stop.or(planning.clone()),
                    pause: &mut Iterations(target),
                    paused: false,
                    whole: Progress::default(),
                };
                let reason = made.build(&mut rng, &mut (&mut pausing).or(due), events);
                (reason, pausing.paused)
            })
        });
        let roadmap_error = made.save_to(file.as_ref()).err().map(|e| e.to_string());
        let (map, roadmap) = made.keep(true);
        let roadmap = roadmap.unwrap_or_default();
        let mut roadmap = AnyRoadmap::new(&prepared.space, roadmap, prepared.index.clone(), NEIGHBOURS)?;
        let found = match (prepared.problem(), prepared.interrupt().raised()) {
            // Once it is interrupted, start and goal count as not free.
            (Err(_), Some(_)) => Err(mp_roadmap::Unanswered::Apart),
            (problem, _) => {
                let (mut checker, ..) = AnyEdgeChecker::of(problem?, PATIENCE);
                let ends = [kind.start(), goal];
                mp_roadmap::erased::routes(&mut roadmap, &mut checker, ends, count, apart)
            }
        };
        let [edges, components] = map;
        if count > 1 && edges > 0 && edges + components == made.nodes() {
            let help = match info.parameters.iter().any(|parameter| parameter.name == "cycles") {
                true => "set its parameter `cycles` to yes, or take cyclic-rrt, prm-star or lazy-prm",
                false => "take cyclic-rrt, prm-star or lazy-prm",
            };
            return Err(Error::new(format!(
                "{} builds a roadmap without cycles, in which there is one route only",
                info.name
            ))
            .help(help));
        }
        keep(prepared, &mut paths, found.ok());
        if paths.len() >= count || !paused {
            let (progress, time) = (made.planner().progress(), clock.now().saturating_sub(began));
            return Ok(Listed { paths, progress, time, ended, map: Some(map), roadmap_error });
        }
        target = target.saturating_mul(2);
    }
}
