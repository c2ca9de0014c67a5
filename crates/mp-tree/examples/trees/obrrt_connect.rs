//! Two trees with the growth methods of OBRRT: out of a bug trap in the plane, along its walls.
//!
//! `cargo run -p mp-tree --example trees obrrt_connect [SEED]`

use crate::obrrt::Around;
use crate::shared;
use mp_tree::{GrowthWeights, ObrrtConnect};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let problem = shared::bug_trap(&space)?;
    shared::run(ObrrtConnect::new(problem, Around, shared::tuning(), GrowthWeights::default())?)
}
