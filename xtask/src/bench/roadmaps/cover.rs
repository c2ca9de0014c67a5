//! How many nodes it takes to see as much of the free space: Visib-PRM against PRM.

use super::queries::{local, steer};
use super::tables::short;
use crate::bench::stats::Median;
use crate::bench::{Table, nanoseconds};
use crate::plan::Ready;
use crate::plan::mover::Mover;
use crate::plan::setting::Setting;
use crate::scenes;
use miette::{IntoDiagnostic, Result};
use mp::cspace::{
    DefaultNn, Direction, Extension, Iterations, LocalPlanner, Metric, Nodes, Reach, Rng, Space, Validity,
};
use mp::roadmap::algo::{prm, visibility_prm};
use mp::roadmap::{Builder, Learning, Reachable, Roadmap};
use std::path::Path;

const SCENES: [&str; 3] = ["maze", "planar-bugtrap", "easy"];
const FAILURES: u64 = 1_000;
/// Free samples of which as many as can be connected to a node are seen.
const SAMPLES: usize = 500;
/// PRM has at most so many nodes.
const MOST: usize = 20_000;

/// Measures.
pub(super) fn measure(quick: bool) -> Result<Table> {
    let mut table = Table::new([
        "scene",
        "Visib-PRM nodes (95%)",
        "of these guards",
        "estimate",
        "seen",
        "components",
        "s",
        "PRM nodes to see as much (95%)",
        "s",
        "nodes PRM : Visib-PRM",
    ]);
    let (scenes, seeds) = if quick { (&SCENES[..1], 2) } else { (&SCENES[..], 10) };
    for name in scenes {
        let row = match Ready::load(&scenes::find(Path::new(name))?)? {
            Ready::Space(setting) => on(&setting, seeds)?,
            Ready::Plane(setting) => on(&setting, seeds)?,
        };
        table.rows.push([(*name).to_owned()].into_iter().chain(row).collect());
    }
    Ok(table)
}

/// The share of free samples with a motion from a node, tried in order of distance.
fn seen<M: Mover>(setting: &Setting<M>, map: &Roadmap<M::State>, samples: &[M::State]) -> Result<f64> {
    let (space, mut local) = (&setting.space, local(setting)?);
    let mut order: Vec<(f64, &M::State)> = Vec::new();
    let mut count = 0;
    for q in samples {
        order.clear();
        order.extend(map.states().iter().map(|node| (space.distance(node, q), node)));
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let sees = |node: &M::State, local: &mut super::queries::Local<'_, M>| {
            matches!(local.extend(node, q, Direction::Forward, Reach::Full), Extension::Reached(_))
        };
        count += usize::from(order.iter().any(|(_, node)| sees(node, &mut local)));
    }
    Ok(count as f64 / samples.len() as f64)
}

fn on<M: Mover>(setting: &Setting<M>, seeds: u64) -> Result<Vec<String>> {
    let space = &setting.space;
    let mut robot = setting.robot.clone();
    let verifier = setting.verifier()?;
    let mut found: [Vec<f64>; 8] = Default::default();
    for seed in 1..=seeds {
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
        let took = (nanoseconds() - began) * 1e-9;
        let share = seen(setting, few.map(), &samples)?;

        let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles: false };
        let learning = Learning { expand: 0.0, ..Learning::default() };
        let recipe = prm::recipe(space, reach, learning).into_diagnostic()?;
        let index = <M::Space as DefaultNn>::Nn::default();
        let mut many =
            Builder::new(steer(setting, verifier.clone())?, recipe.generate, recipe.connect, index);
        let (mut size, mut spent, mut rng) = (4, 0.0, Rng::seed(seed));
        let nodes = loop {
            let began = nanoseconds();
            many.build(&mut rng, &mut Nodes(size), &mut ());
            spent += (nanoseconds() - began) * 1e-9;
            if seen(setting, many.map(), &samples)? >= share {
                break size as f64;
            }
            if size >= MOST {
                break f64::INFINITY;
            }
            size = (size + size / 4 + 1).min(MOST);
        };
        let guards = few.map().graph().node_weights().filter(|tag| tag.kind == mp::roadmap::Kind::Guard);
        let values = [
            few.map().len() as f64,
            guards.count() as f64,
            few.connector().coverage(),
            share,
            few.map_mut().components() as f64,
            took,
            nodes,
            spent,
        ];
        found.iter_mut().zip(values).for_each(|(all, value)| all.push(value));
    }
    let median = |i: usize| Median::of(&found[i]).unwrap_or(Median { median: 0.0, low: 0.0, high: 0.0 });
    let count = |v: f64| format!("{v:.0}");
    let percent = |v: f64| format!("{:.1}%", 100.0 * v);
    Ok(vec![
        median(0).cell("–", count),
        count(median(1).median),
        percent(median(2).median),
        percent(median(3).median),
        count(median(4).median),
        short(median(5).median),
        median(6).cell(&format!("> {MOST}"), count),
        short(median(7).median),
        short(median(6).median / median(0).median),
    ])
}
