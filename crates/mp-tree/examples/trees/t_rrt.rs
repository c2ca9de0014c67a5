//! T-RRT: a point leaves a bug trap in the plane, and keeps to the side where it is cheap.
//!
//! `cargo run -p mp-tree --example trees t_rrt [SEED]`

use crate::shared;
use mp_tree::{TRrt, Temperature};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let problem = shared::bug_trap(&space)?;
    // The higher, the dearer.
    let cost = |q: &shared::Point| 1.0 + 10.0 * q.y;
    shared::run(TRrt::new(problem, cost, shared::tuning(), Temperature::default())?)
}
