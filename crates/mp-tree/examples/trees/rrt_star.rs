//! RRT*: a point goes around a wall by ever shorter ways.
//!
//! `cargo run -p mp-tree --example trees rrt_star [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let planner = mp_tree::RrtStar::new(shared::wall(&space)?, shared::tuning())?;
    shared::run_improving(planner, &space)
}
