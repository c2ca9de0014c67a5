//! RC-RRT: a point with velocities leaves a bug trap in the plane, by accelerations; states within 0.01
//! count as one.
//!
//! `cargo run -p mp-tree --example trees rc_rrt [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::moving()?;
    shared::run_legs(mp_tree::RcRrt::new(shared::moving_trap(&space)?, 0.01, mp_tree::Tuning::default())?)
}
