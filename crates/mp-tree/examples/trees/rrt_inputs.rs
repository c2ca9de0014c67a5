//! RRT by inputs (ALG. 4): a point with velocities leaves a bug trap in the plane, by accelerations.
//!
//! `cargo run -p mp-tree --example trees rrt_inputs [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::moving()?;
    shared::run_legs(mp_tree::RrtInputs::new(shared::moving_trap(&space)?, mp_tree::Tuning::default())?)
}
