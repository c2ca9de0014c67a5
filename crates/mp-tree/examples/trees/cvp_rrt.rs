//! CVP-RRT: a point with velocities leaves a bug trap in the plane, by accelerations.
//!
//! `cargo run -p mp-tree --example trees cvp_rrt [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::moving()?;
    shared::run_legs(mp_tree::CvpRrt::new(shared::moving_trap(&space)?, mp_tree::Tuning::default())?)
}
