//! Multi-sample RRT: a point leaves a bug trap in the plane.
//!
//! `cargo run -p mp-tree --example trees mvb_rrt [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    shared::run(mp_tree::MvbRrt::new(shared::bug_trap(&space)?, shared::tuning(), 5)?)
}
