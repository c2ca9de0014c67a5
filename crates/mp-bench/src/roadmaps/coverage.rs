//! How many nodes cover the same part of the free space: Visib-PRM against PRM.

use super::queries::{checker, local, prm_builder};
use crate::clock::{nanoseconds, seconds_since};
use crate::error::{IntoError, Result};
use crate::experiment::{Group, Lab, Log, Median, Table, short};
use crate::scenes::{Rigid, either, free};
use mp_cspace::{
    Configuration, Direction, Extension, Iterations, KdTree, LocalPlanner, NodeId, Nodes, Reach, Rng, Space,
};
use mp_plan::{RigidScene, RigidSpace, TypedMotion};
use mp_roadmap::algo::visibility_prm;
use mp_roadmap::{Builder, Learning, Roadmap};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};

const SCENES: [&str; 5] = ["maze", "planar-bugtrap", "easy", "gempa-1", "gempa-3"];
const FAILURES: u64 = 1_000;
/// Free samples; a sample is seen when it can be connected to a node.
const SAMPLES: usize = 500;
/// The most nodes of PRM.
const MOST: usize = 20_000;
const SEEDS: u64 = 10;

#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
struct Case {
    scene: String,
    seed: u64,
}

/// Measures the coverage: medians, and a row for each seed. `None` when it was interrupted.
pub(super) fn measure(lab: &Lab, quick: bool) -> Result<Option<(Table, Table)>> {
    let (scenes, seeds) = if quick { (&SCENES[..1], 2) } else { (&SCENES[..], SEEDS) };
    let case = |scene: &str, seed| Case { scene: scene.to_owned(), seed };
    let cases: Vec<Case> =
        scenes.iter().flat_map(|scene| (1..=seeds).map(move |seed| case(scene, seed))).collect();
    let ready: Vec<Rigid> = scenes.iter().map(|name| Rigid::load(name)).collect::<Result<_>>()?;
    let mut log = lab.log("roadmaps-coverage", FAILURES as f64)?;
    let complete = lab.measure(&mut log, "coverage", &cases, |case| {
        let i = scenes.iter().position(|scene| *scene == case.scene).unwrap_or(0);
        Ok(Some(either!(&ready[i], scene => on(scene, case.seed))?))
    })?;
    let groups = log.groups(&cases, |case| case.scene.as_str());
    Ok(complete.then(|| (table(groups), each(&log, &cases))))
}

/// The fractions of the free samples that are seen: from any node, and from a node of the largest component.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Seen {
    any: f64,
    largest: f64,
}

/// A sample, and the nodes of a growing roadmap that were tried, so that no motion is checked twice.
struct Sample<S> {
    q: S,
    seen_by: Vec<NodeId>,
    unseen_by: HashSet<NodeId>,
}

fn fresh<S: Clone>(samples: &[S]) -> Vec<Sample<S>> {
    let one = |q: &S| Sample { q: q.clone(), seen_by: Vec::new(), unseen_by: HashSet::new() };
    samples.iter().map(one).collect()
}

/// The fractions that are seen; nodes are tried in order of distance.
fn seen<M: RigidSpace>(
    scene: &RigidScene<M>,
    map: &mut Roadmap<Configuration>,
    samples: &mut [Sample<Configuration>],
) -> Result<Seen> {
    let (space, mut local) = (scene.space(), local(scene)?);
    let parts: Vec<NodeId> = (0..map.len() as NodeId).map(|id| map.component(id)).collect();
    let mut sizes = HashMap::new();
    parts.iter().for_each(|part| *sizes.entry(*part).or_insert(0) += 1);
    // Of components of equal size, the one with the smallest id.
    let largest =
        sizes.iter().max_by_key(|(part, size)| (**size, std::cmp::Reverse(**part))).map(|(part, _)| *part);
    let counts = |id: &NodeId| Some(parts[*id as usize]) == largest;
    let mut order: Vec<(f64, NodeId)> = Vec::new();
    let mut count = [0; 2];
    for sample in samples.iter_mut() {
        let mut by_largest = sample.seen_by.iter().any(counts);
        order.clear();
        if !by_largest {
            let unknown = (0..map.len() as NodeId).filter(|id| !sample.unseen_by.contains(id));
            let distance = |id| (space.distance(map.state(id), &sample.q), id);
            order.extend(unknown.map(distance));
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        for (_, id) in &order {
            // One node outside of the largest component is enough.
            if !sample.seen_by.is_empty() && !counts(id) {
                continue;
            }
            let motion = local.extend(map.state(*id), &sample.q, Direction::Forward, Reach::Full);
            if !matches!(motion, Extension::Reached(_)) {
                sample.unseen_by.insert(*id);
                continue;
            }
            sample.seen_by.push(*id);
            if counts(id) {
                by_largest = true;
                break;
            }
        }
        count[0] += usize::from(!sample.seen_by.is_empty());
        count[1] += usize::from(by_largest);
    }
    let [any, largest] = count.map(|n| n as f64 / samples.len() as f64);
    Ok(Seen { any, largest })
}

/// The size that PRM's roadmap needed.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Needed {
    nodes: f64,
    components: f64,
    seconds: f64,
}

/// The result of a case.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Measured {
    few: Needed,
    guards: f64,
    estimate: f64,
    seen: Seen,
    /// The sizes to see as much, and to see as much from the largest component; `None` when no size was
    /// enough.
    many: [Option<Needed>; 2],
}

fn on<M: RigidSpace>(scene: &RigidScene<M>, seed: u64) -> Result<Measured> {
    let space = scene.space();
    let samples: Vec<_> = free(scene, Rng::stream(seed, 7)).take(SAMPLES).collect();
    let index = <KdTree>::default();
    let parts = visibility_prm::parts(space, FAILURES).into_error()?;
    let mut few = Builder::new(checker(scene, scene.verifier()?)?, parts.generator, parts.connector, index);
    let began = nanoseconds();
    few.build(&mut Rng::seed(seed), &mut Iterations(10_000_000), &mut ());
    let seconds = seconds_since(began);
    let guards = few.map().tags().filter(|tag| tag.kind == mp_roadmap::MilestoneKind::Guard);
    let (guards, estimate) = (guards.count() as f64, few.connector().coverage());
    let aim = seen(scene, few.map_mut(), &mut fresh(&samples))?;
    let (nodes, components) = (few.map().len() as f64, few.map_mut().components() as f64);

    let mut many = prm_builder(scene, Learning { expand: 0.0, ..Learning::default() })?;
    let (mut size, mut spent, mut rng) = (4, 0.0, Rng::seed(seed));
    let mut needed: [Option<Needed>; 2] = [None; 2];
    let mut samples = fresh(&samples);
    while needed.iter().any(Option::is_none) && size < MOST {
        let began = nanoseconds();
        many.build(&mut rng, &mut Nodes(size), &mut ());
        spent += seconds_since(began);
        let now = seen(scene, many.map_mut(), &mut samples)?;
        let enough = [now.any >= aim.any, now.any >= aim.any && now.largest >= aim.largest];
        for (needed, enough) in needed.iter_mut().zip(enough) {
            if needed.is_none() && enough {
                let components = many.map_mut().components() as f64;
                *needed = Some(Needed { nodes: size as f64, components, seconds: spent });
            }
        }
        size += size / 4 + 1;
    }
    let few = Needed { nodes, components, seconds };
    Ok(Measured { few, guards, estimate, seen: aim, many: needed })
}

/// A row for each scene and seed.
fn each(log: &Log<Case, Measured>, cases: &[Case]) -> Table {
    let needed = |needed: Option<&Needed>| {
        let of = |value: fn(&Needed) -> f64| needed.map_or_else(String::new, |n| value(n).to_string());
        [of(|n| n.nodes), of(|n| n.components), of(|n| n.seconds)]
    };
    let heads = ["scene", "seed", "guards", "estimate", "seen", "seen_from_largest"];
    let columns = ["nodes", "components", "seconds"];
    let of_columns =
        ["visib", "prm_seen", "prm_connected"].map(|what| columns.map(|column| format!("{what}_{column}")));
    let mut table = Table::new(heads.map(str::to_owned).into_iter().chain(of_columns.into_iter().flatten()));
    for (case, run) in log.each(cases) {
        let own = [run.guards, run.estimate, run.seen.any, run.seen.largest].map(|v| v.to_string());
        let names = [case.scene.clone(), case.seed.to_string()];
        let all = [Some(&run.few), run.many[0].as_ref(), run.many[1].as_ref()].map(needed);
        table.rows.push(names.into_iter().chain(own).chain(all.into_iter().flatten()).collect());
    }
    table.made_at(log.commits(cases))
}

/// The medians of each scene.
fn table(groups: Vec<Group<'_, &str, Case, Measured>>) -> Table {
    type Scene<'a> = Group<'a, &'a str, Case, Measured>;
    let median = |scene: &Scene<'_>, value: &dyn Fn(&Measured) -> f64| {
        Median::of(scene.values(value)).unwrap_or_default()
    };
    let few = |scene: &Scene<'_>, value: fn(&Measured) -> f64| median(scene, &value).median;
    let many = |scene: &Scene<'_>, i: usize, value: fn(&Needed) -> f64| {
        median(scene, &|m| m.many[i].as_ref().map_or(f64::INFINITY, value))
    };
    let count = |v: f64| format!("{v:.0}");
    let percent = |v: f64| format!("{:.1}%", 100.0 * v);
    let beyond = format!("> {MOST}");
    let more =
        |scene: &Scene<'_>, i: usize| short(many(scene, i, |m| m.nodes).median / few(scene, |m| m.few.nodes));
    Table::of(
        groups,
        &[
            ("scene", &|s| s.key.to_owned()),
            ("Visib-PRM nodes (95%)", &|s| median(s, &|m| m.few.nodes).cell("–", count)),
            ("of these guards", &|s| count(few(s, |m| m.guards))),
            ("estimate", &|s| percent(few(s, |m| m.estimate))),
            ("seen", &|s| percent(few(s, |m| m.seen.any))),
            ("seen from the largest component", &|s| percent(few(s, |m| m.seen.largest))),
            ("components", &|s| count(few(s, |m| m.few.components))),
            ("s", &|s| short(few(s, |m| m.few.seconds))),
            ("PRM nodes to see as much (95%)", &|s| many(s, 0, |m| m.nodes).cell(&beyond, count)),
            ("components", &|s| count(many(s, 0, |m| m.components).median)),
            ("s", &|s| short(many(s, 0, |m| m.seconds).median)),
            ("PRM nodes to see as much from the largest component (95%)", &|s| {
                many(s, 1, |m| m.nodes).cell(&beyond, count)
            }),
            ("components", &|s| count(many(s, 1, |m| m.components).median)),
            ("s", &|s| short(many(s, 1, |m| m.seconds).median)),
            ("nodes PRM : Visib-PRM, seen", &|s| more(s, 0)),
            ("connected", &|s| more(s, 1)),
        ],
    )
}
