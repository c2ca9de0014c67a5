//! Bi-RRT: a point leaves a bug trap in the plane.
//!
//! `cargo run -p mp-tree --example trees bi_rrt [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    shared::run(mp_tree::BiRrt::new(shared::bug_trap(&space)?, shared::tuning())?)
}
