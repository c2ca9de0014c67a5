//! RSRT: a point with velocities leaves a bug trap in the plane, by accelerations. As `rrt_inputs`, with
//! fewer collision tests.
//!
//! `cargo run -p mp-tree --example trees rsrt [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::moving()?;
    shared::run_legs(mp_tree::Rsrt::new(shared::moving_trap(&space)?, mp_tree::Tuning::default())?)
}
