//! The time to build a roadmap, against its number of nodes.

use super::queries::prm_builder;
use crate::clock::{nanoseconds, seconds_since};
use crate::error::Result;
use crate::experiment::{Table, short};
use crate::output::note;
use crate::scenes::{Rigid, either};
use mp_cspace::{Nodes, Rng};
use mp_plan::{RigidScene, RigidSpace};
use mp_roadmap::Learning;

const SIZES: [usize; 7] = [100, 316, 1_000, 3_162, 10_000, 31_623, 100_000];

/// Measures on the scene `cubicles`, a free-flyer.
pub(super) fn measure(quick: bool) -> Result<Table> {
    either!(Rigid::load("cubicles")?, scene => on(&scene, quick))
}

fn on<M: RigidSpace>(scene: &RigidScene<M>, quick: bool) -> Result<Table> {
    let mut builder = prm_builder(scene, Learning { expand: 0.0, ..Learning::default() })?;
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
        seconds += seconds_since(began);
        let n = size as f64;
        let exponent = before.map(|(m, s)| mp_math::ln(seconds / s) / mp_math::ln(n / m));
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
