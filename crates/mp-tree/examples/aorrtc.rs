//! AORRTC: a point goes around a wall, at once and then by ever shorter ways.
//!
//! `cargo run -p mp-tree --example aorrtc [SEED]`

mod shared;

fn main() -> shared::Result {
    let space = shared::square()?;
    let planner = mp_tree::Aorrtc::new(shared::wall(&space)?, shared::tuning())?;
    shared::run_improving(planner, &space)
}
