//! AORRTC: a point goes around a wall, at once and then by ever shorter ways.
//!
//! `cargo run -p mp-tree --example trees aorrtc [SEED]`

use crate::shared;
pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let planner = mp_tree::Aorrtc::new(shared::wall(&space)?, shared::tuning())?;
    shared::run_improving(planner, &space)
}
