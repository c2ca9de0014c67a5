//! Many queries to one roadmap, compared with RRT-Connect for each.

use crate::clock::{nanoseconds, processor_clock, seconds_since};
use crate::error::{IntoError, Result};
use crate::experiment::{Median, Table, bit, mean, short};
use crate::output::note;
use crate::scenes::{Rigid, either, free};
use mp_cspace::{Certified, Deadline, KdTree, Nodes, Outcome, Planner, Problem, Rng, Straight};
use mp_plan::{Motion, RigidScene, RigidSpace, TypedMotion};
use mp_roadmap::algo::prm;
use mp_roadmap::{
    Builder, EdgeChecker, Learn, Learning, NearestConnector, PATIENCE, Reachable, RoadmapQueries,
};
use mp_tree::{RrtConnect, Tuning};
use std::time::Duration;

/// Nodes of the roadmaps.
const SIZES: [usize; 3] = [500, 2_000, 8_000];
const QUERIES: usize = 1_000;
/// The number of neighbours to which start and goal are connected.
const NEIGHBOURS: usize = 10;
/// Seconds of processor time that RRT-Connect may take for one query.
const CAP: f64 = 2.0;

pub(super) type SpaceOf<M> = <RigidScene<M> as TypedMotion>::Space;
pub(super) type Local<'c, M> =
    Straight<'c, SpaceOf<M>, Certified<'c, SpaceOf<M>, <RigidScene<M> as TypedMotion>::Checker>>;

/// The local planner: straight motions with certified checks.
pub(super) fn local<M: RigidSpace>(scene: &RigidScene<M>) -> Result<Local<'_, M>> {
    let check = Certified::new(scene.space(), scene.checker().clone(), scene.tolerance()).into_error()?;
    Ok(Straight::new(scene.space(), check))
}

/// The edge checker of roadmaps in a scene.
pub(super) fn checker<'c, M: RigidSpace>(
    scene: &'c RigidScene<M>,
    verifier: <RigidScene<M> as TypedMotion>::Verifier<'c>,
) -> Result<EdgeChecker<'c, SpaceOf<M>, Local<'c, M>>> {
    Ok(EdgeChecker::new(scene.space(), local(scene)?, verifier, PATIENCE))
}

type PrmBuilder<'c, M> =
    Builder<'c, SpaceOf<M>, Local<'c, M>, Learn<'c, SpaceOf<M>>, NearestConnector, KdTree>;

/// A roadmap of PRM that is to grow in a scene.
pub(super) fn prm_builder<M: RigidSpace>(
    scene: &RigidScene<M>,
    learning: Learning,
) -> Result<PrmBuilder<'_, M>> {
    let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles: false };
    let parts = prm::parts(scene.space(), reach, learning).into_error()?;
    let checker = checker(scene, scene.verifier()?)?;
    Ok(Builder::new(checker, parts.generator, parts.connector, KdTree::default()))
}

/// Measures on the scene `cubicles`: a summary, and a row for each query.
pub(super) fn measure(quick: bool) -> Result<(Table, Table)> {
    either!(Rigid::load("cubicles")?, scene => on(&scene, quick))
}

fn on<M: RigidSpace>(scene: &RigidScene<M>, quick: bool) -> Result<(Table, Table)> {
    let (sizes, count) = if quick { (&SIZES[..1], 100) } else { (&SIZES[..], QUERIES) };
    let space = scene.space();
    let ends: Vec<_> = free(scene, Rng::stream(1, 99)).take(2 * count).collect();
    let pairs = ends.as_chunks::<2>().0;
    let verifier = scene.verifier()?;

    let mut alone = Vec::new();
    for (seed, [start, goal]) in (1..).zip(pairs) {
        let began = nanoseconds();
        let problem = Problem::new(space, local(scene)?, verifier.clone(), start.clone(), goal.clone());
        let solved = match problem {
            Err(_) => false,
            Ok(problem) => {
                let mut planner = RrtConnect::new(problem, Tuning::default()).into_error()?;
                let mut stop = Deadline::by(processor_clock(), Duration::from_secs_f64(CAP));
                matches!(planner.solve(&mut Rng::seed(seed), &mut stop, &mut ()), Outcome::Solved(_))
            }
        };
        let seconds = seconds_since(began);
        alone.push(if solved { seconds } else { f64::INFINITY });
    }
    let mut table = Table::new([
        "",
        "nodes",
        "components",
        "build s",
        "answered",
        "median ms (95%)",
        "mean ms",
        "queries per s",
        "RRT-Connect : this, medians",
        "means",
    ]);
    let mut each = Table::new(["asked", "nodes", "query", "answered", "seconds"]);
    let of = |times: &[f64]| Median::of(times.iter().copied()).unwrap_or_default();
    let mean = |times: &[f64]| mean(times.iter().copied().filter(|t| t.is_finite())).unwrap_or(0.0);
    let connect = (of(&alone), mean(&alone));
    let mut row = |what: &str, map: [String; 3], times: &[f64]| {
        let (median, mean) = (of(times), mean(times));
        let answered = times.iter().filter(|t| t.is_finite()).count();
        let mut cells = vec![what.to_owned()];
        cells.extend(map);
        cells.extend([
            format!("{:.1}%", 100.0 * answered as f64 / times.len() as f64),
            median.cell("–", |s| short(1e3 * s)),
            short(1e3 * mean),
            format!("{:.0}", 1.0 / mean),
            format!("{:.1}", connect.0.median / median.median),
            format!("{:.1}", connect.1 / mean),
        ]);
        note(&cells.join(" | "));
        for (query, &seconds) in times.iter().enumerate() {
            let answered = seconds.is_finite();
            let took = if answered { format!("{seconds:.4e}") } else { String::new() };
            each.rows.push(vec![what.to_owned(), cells[1].clone(), query.to_string(), bit(answered), took]);
        }
        table.rows.push(cells);
    };
    row("RRT-Connect", [const { String::new() }; 3], &alone);
    for &size in sizes {
        let mut builder = prm_builder(scene, Learning::default())?;
        let began = nanoseconds();
        builder.build(&mut Rng::seed(1), &mut Nodes(size), &mut ());
        let build = seconds_since(began);
        let components = builder.map_mut().components();
        let mut ask = |what: &str, build: f64, answers: &mut RoadmapQueries<'_, _, _, _>| {
            let mut times = Vec::new();
            for [start, goal] in pairs {
                let began = nanoseconds();
                let solved = answers.answer(start, goal).is_ok();
                let seconds = seconds_since(began);
                times.push(if solved { seconds } else { f64::INFINITY });
            }
            row(what, [size.to_string(), components.to_string(), short(build)], &times);
        };
        let map = builder.map().clone();
        ask("roadmap", build, &mut builder.into_answers(NEIGHBOURS));
        let index = <KdTree>::default();
        let mut answers =
            RoadmapQueries::new(checker(scene, verifier.clone())?, map, index, NEIGHBOURS).into_error()?;
        let began = nanoseconds();
        answers.verify();
        let verified = seconds_since(began);
        ask("roadmap, edges verified when built", build + verified, &mut answers);
    }
    Ok((table, each))
}
