//! Adaptive dynamic-domain RRT: a point leaves a bug trap in the plane.
//!
//! `cargo run -p mp-tree --example trees add_rrt [SEED]`
use crate::shared;
use mp_tree::{DdRrt, Domain};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    shared::run(DdRrt::new(shared::bug_trap(&space)?, shared::tuning(), Domain::adaptive())?)
}
