//! The cost of queries and trees against the number of triangles.

use super::export::export;
use super::ours::{self, OURS};
use super::pair_results::PairResults;
use super::pairs::{smooth_tori, tori};
use super::peers::{self, QueryLimits};
use super::poses::{Counts, Meshes, QueryPoses};
use super::record::{QueryId, add, timed};
use crate::error::{IntoError, Result};
use crate::experiment::{Lab, Table};
use crate::options::Common;
use crate::output::note;
use crate::plot::{Axis, ChartCurve, Labels, chart};
use mp_collide::Query;
use nalgebra::Isometry3;
use std::path::PathBuf;

/// The tori have 2·n² triangles each: from a thousand to a million.
const SIDES: [usize; 7] = [22, 39, 71, 122, 224, 387, 707];
/// As many poses as other programs read, but fewer near contact, as these take long to find.
const COUNTS: Counts = Counts { near: 2_000, ..Counts::FULL };
/// The number of distances that are measured.
const DISTANCES: usize = 200;
/// The queries: set of poses, kind, name in tables.
const ASKED: [(&str, &str, &str); 4] = [
    ("uniform", "collide", "boolean, uniform poses"),
    ("near", "collide", "boolean, near contact"),
    ("uniform", "distance", "distance, uniform poses"),
    (SMOOTH, "distance", "distance, smooth tori"),
];
/// The set of uniform poses of tori without bumps.
const SMOOTH: &str = "smooth";

/// Runs the measurement. True when all programs answered.
pub(super) fn run(lab: &Lab, common: &Common, seed: u64, programs: &[PathBuf]) -> Result<bool> {
    let sides = if common.quick { &SIDES[..4] } else { &SIDES[..] };
    let rounds = common.runs_or(1, 3) as usize;
    let (mut all, mut opened, mut complete) = (Vec::new(), Vec::new(), true);
    for &n in sides {
        let (measured, pairs, answered) = measure(n, seed, rounds, programs)?;
        complete &= answered;
        note(&format!("{} triangles measured", measured.triangles / 2));
        all.push(measured);
        opened.push(pairs);
    }
    let table = table(&all, &opened);
    lab.report("collide-growth", &table.markdown(), &table)?;
    let labels = Labels {
        title: "Cost against the number of triangles of each mesh",
        x: "triangles",
        y: "times the cost of the smallest",
    };
    let axes = [Axis::Log, Axis::FromZero(None)];
    lab.write("collide-growth.svg", &chart(labels, axes, &curves(&all))?)?;
    Ok(complete)
}

/// The mean number of pairs of boxes that a distance query of disjoint meshes opens: in a normal query, and
/// when it is given the distance beforehand, which leaves only the pairs that every search with these boxes
/// must open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Opened {
    asked: f64,
    told: f64,
}

impl Opened {
    fn count(meshes: &Meshes, poses: &[Isometry3<f64>]) -> Self {
        let (a, b, here, mut query) = (&meshes.a, &meshes.b, Isometry3::identity(), Query::default());
        let (mut sum, mut free) = (Self::default(), 0.0);
        for pose in poses {
            let begin = query.counters.box_tests;
            if query.intersects(a, &here, b, pose) {
                continue;
            }
            // The other two queries do this first.
            let first = query.counters.box_tests - begin;
            let begin = query.counters.box_tests + first;
            let distance = query.distance(a, &here, b, pose).distance;
            sum.asked += (query.counters.box_tests - begin) as f64;
            let begin = query.counters.box_tests + first;
            query.clearance(a, &here, b, pose, distance.next_up());
            sum.told += (query.counters.box_tests - begin) as f64;
            free += 1.0;
        }
        Self { asked: sum.asked / free, told: sum.told / free }
    }
}

/// Measures two tori of 2·n² triangles.
fn measure(
    n: usize,
    seed: u64,
    rounds: usize,
    programs: &[PathBuf],
) -> Result<(PairResults, [Opened; 2], bool)> {
    let pair = tori(&format!("tori-{n}"), n)?;
    let meshes = Meshes::new(&pair);
    let poses = QueryPoses::new(&pair, &meshes, COUNTS, seed)?;
    let smooth = Meshes::new(&smooth_tori(SMOOTH, n)?);
    let opened = [&meshes, &smooth].map(|meshes| Opened::count(meshes, &poses.uniform[..DISTANCES]));
    let mut measured = PairResults::new(&pair);
    let here = Isometry3::identity();
    let scratch = tempfile::tempdir().into_error()?;
    if !programs.is_empty() {
        // Other programs read as many poses near contact as uniform ones.
        let near = poses.near.iter().cycle().take(COUNTS.uniform).copied().collect();
        export(scratch.path(), &pair, &QueryPoses { near, ..poses.clone() })?;
    }
    let mut complete = true;
    for _ in 0..rounds {
        let (meshes, build) = ours::build(&pair);
        measured.built(build);
        let (a, b, mut query) = (&meshes.a, &meshes.b, Query::default());
        for (set, kind, _) in ASKED {
            let (a, b) = if set == SMOOTH { (&smooth.a, &smooth.b) } else { (a, b) };
            let poses = if set == "near" { &poses.near } else { &poses.uniform };
            let (what, some) = (QueryId::new(OURS, set, kind), &poses[..DISTANCES]);
            add(
                &mut measured.records,
                match kind {
                    "collide" => timed(what, poses, 3, |p| f64::from(query.intersects(a, &here, b, p))),
                    _ => timed(what, some, 1, |p| query.distance(a, &here, b, p).distance),
                },
            );
        }
        // Only their trees are measured: queries get little time.
        let limits = QueryLimits { passes: 1, distances: 1, cap: 0.1 };
        for program in programs {
            match peers::ask(program, scratch.path(), &pair.name, limits) {
                Ok((builds, _)) => builds.into_iter().for_each(|b| measured.built(b)),
                Err(error) => {
                    complete = false;
                    note(&error.report());
                }
            }
        }
    }
    Ok((measured, opened, complete))
}

/// A row for each size; all costs are of both meshes.
fn table(all: &[PairResults], opened: &[[Opened; 2]]) -> Table {
    let libs: Vec<&str> =
        all.first().map_or(Vec::new(), |m| m.builds.iter().map(|b| b.lib.as_str()).collect());
    let head = ["triangles of each mesh".to_owned()].into_iter();
    let asked = ASKED.map(|(_, _, name)| format!("{name}, ns"));
    let pairs =
        ["pairs of boxes opened for a distance", "when told it", "smooth tori: opened", "when told it"];
    let pairs = pairs.map(str::to_owned);
    let builds = libs.iter().map(|lib| format!("{lib}: building both, ms"));
    let mut table = Table::new(head.chain(asked).chain(pairs).chain(builds));
    for (m, opened) in all.iter().zip(opened) {
        let pairs = opened.iter().flat_map(|opened| [opened.asked, opened.told]).map(|n| format!("{n:.0}"));
        let costs =
            ASKED.map(|(set, query, _)| cost(m, set, query).map_or("–".into(), |c| format!("{c:.0}")));
        let builds = libs.iter().map(|lib| {
            let build = m.builds.iter().find(|b| b.lib == *lib);
            build.map_or("–".into(), |b| format!("{:.1}", b.ms))
        });
        let row = [(m.triangles / 2).to_string()].into_iter().chain(costs).chain(pairs).chain(builds);
        table.rows.push(row.collect());
    }
    table
}

/// Nanoseconds per query.
fn cost(m: &PairResults, set: &str, query: &str) -> Option<f64> {
    m.record(OURS, set, query).map(|r| r.least)
}

/// Costs by numbers of triangles.
type Costs = Vec<(usize, f64)>;

/// Costs relative to the smallest size: a straight line is logarithmic growth.
fn curves(all: &[PairResults]) -> Vec<ChartCurve> {
    let relative = |(i, (name, costs)): (usize, (&str, Costs))| {
        let first = costs.first().map_or(1.0, |c| c.1);
        let points = costs.into_iter().map(|(triangles, cost)| (triangles as f64 / 2.0, cost / first));
        ChartCurve::new(name, i, points.collect())
    };
    let asked = ASKED.map(|(set, query, name)| {
        let costs = all.iter().filter_map(|m| Some((m.triangles, cost(m, set, query)?)));
        (name, costs.collect())
    });
    let per_triangle = |m: &PairResults| {
        let build = m.builds.iter().find(|b| b.lib == OURS)?;
        Some((m.triangles, build.ms / m.triangles as f64))
    };
    let built = ("building, per triangle", all.iter().filter_map(per_triangle).collect());
    asked.into_iter().chain([built]).enumerate().map(relative).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_from_a_thousand_to_a_million() {
        let triangles = SIDES.map(|n| 2 * n * n);
        assert!(triangles[0].abs_diff(1_000) < 50 && triangles[6].abs_diff(1_000_000) < 1_000);
    }

    #[test]
    fn small_tori_are_measured() {
        let (all, opened): (Vec<PairResults>, Vec<[Opened; 2]>) = [22, 25]
            .map(|n| {
                let (measured, opened, _) = measure(n, 1, 1, &[]).unwrap();
                (measured, opened)
            })
            .into_iter()
            .unzip();
        assert!(opened.iter().flatten().all(|n| 1.0 < n.told && n.told < 2.0 * n.asked), "{opened:?}");
        let table = table(&all, &opened);
        assert_eq!((table.head.len(), table.rows.len()), (10, 2));
        assert_eq!(table.rows[0][0], "968");
        let curves = curves(&all);
        assert_eq!(curves.len(), ASKED.len() + 1);
        assert!(curves.iter().all(|c| c.points[0] == (968.0, 1.0) && c.points[1].1 > 0.0));
    }
}
