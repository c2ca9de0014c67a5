//! How long it takes to build a roadmap of so many nodes.

use super::queries::steer;
use super::tables::short;
use crate::bench::{Table, nanoseconds};
use crate::output::note;
use crate::plan::Ready;
use crate::plan::mover::Mover;
use crate::plan::setting::Setting;
use crate::scenes;
use miette::{IntoDiagnostic, Result};
use mp::cspace::{DefaultNn, Nodes, Rng};
use mp::roadmap::algo::prm;
use mp::roadmap::{Builder, Learning, Reachable};
use std::path::Path;

const SIZES: [usize; 7] = [100, 316, 1_000, 3_162, 10_000, 31_623, 100_000];

/// Measures on the scene `cubicles`, a free-flyer.
pub(super) fn measure(quick: bool) -> Result<Table> {
    match Ready::load(&scenes::find(Path::new("cubicles"))?)? {
        Ready::Space(setting) => on(&setting, quick),
        Ready::Plane(setting) => on(&setting, quick),
    }
}

fn on<M: Mover>(setting: &Setting<M>, quick: bool) -> Result<Table> {
    let reach = Reachable { neighbours: 15, radius: f64::INFINITY, cycles: false };
    let learning = Learning { expand: 0.0, ..Learning::default() };
    let recipe = prm::recipe(&setting.space, reach, learning).into_diagnostic()?;
    let index = <M::Space as DefaultNn>::Nn::default();
    let steer = steer(setting, setting.verifier()?)?;
    let mut builder = Builder::new(steer, recipe.generate, recipe.connect, index);
    let mut table = Table::new([
        "nodes",
        "build s",
        "µs per node",
        "growth: exponent",
        "components",
        "largest",
        "motions per node",
    ]);
    let sizes = if quick { &SIZES[..4] } else { &SIZES[..] };
    let mut rng = Rng::seed(1);
    let (mut seconds, mut before) = (0.0, None::<(f64, f64)>);
    for &size in sizes {
        let began = nanoseconds();
        builder.build(&mut rng, &mut Nodes(size), &mut ());
        seconds += (nanoseconds() - began) * 1e-9;
        let n = size as f64;
        let exponent = before.map(|(m, s)| (seconds / s).ln() / (n / m).ln());
        before = Some((n, seconds));
        let motions = builder.progress().motions;
        let sizes = builder.map_mut().component_sizes();
        table.rows.push(vec![
            size.to_string(),
            short(seconds),
            short(1e6 * seconds / n),
            exponent.map_or_else(|| "–".to_owned(), |e| format!("{e:.2}")),
            sizes.len().to_string(),
            format!("{:.1}%", 100.0 * sizes.first().copied().unwrap_or(0) as f64 / n),
            short(motions as f64 / n),
        ]);
        note(&format!("{size} nodes in {seconds:.3} s"));
    }
    Ok(table)
}
