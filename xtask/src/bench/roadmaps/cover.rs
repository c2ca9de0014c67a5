//! How many nodes it takes to see as much of the free space: Visib-PRM against PRM.

use super::queries::{local, steer};
use super::tables::short;
use crate::bench::stats::Median;
use crate::bench::{Table, nanoseconds};
use crate::output::note;
use crate::plan::Ready;
use crate::plan::mover::Mover;
use crate::plan::setting::Setting;
use crate::scenes;
use miette::{IntoDiagnostic, Result};
use mp::cspace::{
    DefaultNn, Direction, Extension, Iterations, LocalPlanner, Metric, NodeId, Nodes, Reach, Rng, Space,
    Validity,
};
use mp::roadmap::algo::{prm, visibility_prm};
use mp::roadmap::{Builder, Learning, Reachable, Roadmap};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::path::Path;

const SCENES: [&str; 5] = ["maze", "planar-bugtrap", "easy", "gempa-1", "gempa-3"];
const FAILURES: u64 = 1_000;
/// Free samples of which as many as can be connected to a node are seen.
const SAMPLES: usize = 500;
/// PRM has at most so many nodes.
const MOST: usize = 20_000;
const SEEDS: u64 = 10;

/// Measures.
pub(super) fn measure(quick: bool, threads: Option<u16>) -> Result<Table> {
    let mut table = Table::new([
        "scene",
        "Visib-PRM nodes (95%)",
        "of these guards",
        "estimate",
        "seen",
        "seen from the largest component",
        "components",
        "s",
        "PRM nodes to see as much (95%)",
        "components",
        "s",
        "PRM nodes to see as much from the largest component (95%)",
        "components",
        "s",
        "nodes PRM : Visib-PRM, seen",
        "connected",
    ]);
    let (scenes, seeds) = if quick { (&SCENES[..1], 2) } else { (&SCENES[..], SEEDS) };
    let threads = threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_diagnostic()?;
    for name in scenes {
        let ready = Ready::load(&scenes::find(Path::new(name))?)?;
        let run = |seed| match &ready {
            Ready::Space(setting) => on(setting, seed),
            Ready::Plane(setting) => on(setting, seed),
        };
        let seeds = (1..=seeds).into_par_iter();
        let found: Vec<Measured> = pool.install(|| seeds.map(run).collect::<Result<_>>())?;
        table.rows.push([(*name).to_owned()].into_iter().chain(row(&found)).collect());
        note(&format!("{name}: coverage measured"));
    }
    Ok(table)
}

/// Parts of the free samples: with a motion from a node, and from one of the largest component.
#[derive(Clone, Copy, Debug)]
struct Seen {
    any: f64,
    largest: f64,
}

/// A sample, and what is known of the nodes of a roadmap that grows: of none twice whether there is a motion.
struct Sample<S> {
    q: S,
    seen_by: Vec<NodeId>,
    unseen_by: HashSet<NodeId>,
}

fn fresh<S: Clone>(samples: &[S]) -> Vec<Sample<S>> {
    let one = |q: &S| Sample { q: q.clone(), seen_by: Vec::new(), unseen_by: HashSet::new() };
    samples.iter().map(one).collect()
}

/// What is seen, by nodes tried in order of distance.
fn seen<M: Mover>(
    setting: &Setting<M>,
    map: &mut Roadmap<M::State>,
    samples: &mut [Sample<M::State>],
) -> Result<Seen> {
    let (space, mut local) = (&setting.space, local(setting)?);
    let parts: Vec<NodeId> = (0..map.len() as NodeId).map(|id| map.component(id)).collect();
    let mut sizes = HashMap::new();
    parts.iter().for_each(|part| *sizes.entry(*part).or_insert(0) += 1);
    // Of equal ones that which is named first.
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
            // Of the others one is enough.
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

/// How large PRM's roadmap had to be.
#[derive(Clone, Copy, Debug)]
struct Needed {
    nodes: f64,
    components: f64,
    seconds: f64,
}

/// What came of a seed.
#[derive(Clone, Copy, Debug)]
struct Measured {
    few: Needed,
    guards: f64,
    estimate: f64,
    seen: Seen,
    /// To see as much, and to see as much from the largest component.
    many: [Needed; 2],
}

fn on<M: Mover>(setting: &Setting<M>, seed: u64) -> Result<Measured> {
    let space = &setting.space;
    let mut robot = setting.robot.clone();
    let verifier = setting.verifier()?;
    let mut rng = Rng::stream(seed, 7);
    let mut samples = Vec::new();
    while samples.len() < SAMPLES {
        let q = space.sample_uniform(&mut rng);
        if robot.is_valid(&q) {
            samples.push(q);
        }
    }
    let index = <M::Space as DefaultNn>::Nn::default();
    let recipe = visibility_prm::recipe(space, FAILURES).into_diagnostic()?;
    let mut few = Builder::new(steer(setting, verifier.clone())?, recipe.generate, recipe.connect, index);
    let began = nanoseconds();
    few.build(&mut Rng::seed(seed), &mut Iterations(10_000_000), &mut ());
    let seconds = (nanoseconds() - began) * 1e-9;
    let guards = few.map().graph().node_weights().filter(|tag| tag.kind == mp::roadmap::Kind::Guard);
    let (guards, estimate) = (guards.count() as f64, few.connector().coverage());
    let aim = seen(setting, few.map_mut(), &mut fresh(&samples))?;
    let (nodes, components) = (few.map().len() as f64, few.map_mut().components() as f64);

    let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles: false };
    let learning = Learning { expand: 0.0, ..Learning::default() };
    let recipe = prm::recipe(space, reach, learning).into_diagnostic()?;
    let index = <M::Space as DefaultNn>::Nn::default();
    let mut many = Builder::new(steer(setting, verifier)?, recipe.generate, recipe.connect, index);
    let (mut size, mut spent, mut rng) = (4, 0.0, Rng::seed(seed));
    let mut needed = [None; 2];
    let mut samples = fresh(&samples);
    while needed.contains(&None) && size < MOST {
        let began = nanoseconds();
        many.build(&mut rng, &mut Nodes(size), &mut ());
        spent += (nanoseconds() - began) * 1e-9;
        let now = seen(setting, many.map_mut(), &mut samples)?;
        let enough = [now.any >= aim.any, now.any >= aim.any && now.largest >= aim.largest];
        for (needed, enough) in needed.iter_mut().zip(enough) {
            if needed.is_none() && enough {
                *needed = Some((size as f64, many.map_mut().components() as f64, spent));
            }
        }
        size += size / 4 + 1;
    }
    let many = needed.map(|found| {
        let (nodes, components, seconds) = found.unwrap_or((f64::INFINITY, f64::INFINITY, f64::INFINITY));
        Needed { nodes, components, seconds }
    });
    Ok(Measured { few: Needed { nodes, components, seconds }, guards, estimate, seen: aim, many })
}

fn row(found: &[Measured]) -> Vec<String> {
    let median = |value: &dyn Fn(&Measured) -> f64| {
        let values: Vec<f64> = found.iter().map(value).collect();
        Median::of(&values).unwrap_or(Median { median: 0.0, low: 0.0, high: 0.0 })
    };
    let count = |v: f64| format!("{v:.0}");
    let percent = |v: f64| format!("{:.1}%", 100.0 * v);
    let few = median(&|m| m.few.nodes);
    let mut cells = vec![
        few.cell("–", count),
        count(median(&|m| m.guards).median),
        percent(median(&|m| m.estimate).median),
        percent(median(&|m| m.seen.any).median),
        percent(median(&|m| m.seen.largest).median),
        count(median(&|m| m.few.components).median),
        short(median(&|m| m.few.seconds).median),
    ];
    let sizes = [0, 1].map(|i| median(&move |m| m.many[i].nodes));
    for (i, nodes) in sizes.iter().enumerate() {
        cells.push(nodes.cell(&format!("> {MOST}"), count));
        cells.push(count(median(&move |m| m.many[i].components).median));
        cells.push(short(median(&move |m| m.many[i].seconds).median));
    }
    cells.extend(sizes.map(|nodes| short(nodes.median / few.median)));
    cells
}
