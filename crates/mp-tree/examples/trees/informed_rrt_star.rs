//! Informed RRT*: a point goes around a wall; samples fill a shrinking ellipse.
//!
//! `cargo run -p mp-tree --example trees informed_rrt_star [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let planner = mp_tree::InformedRrtStar::new(shared::wall(&space)?, shared::tuning())?;
    shared::run_improving(planner, &space)
}
