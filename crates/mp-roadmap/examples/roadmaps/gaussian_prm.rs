//! Gaussian PRM: a roadmap near walls, and a path through the gap between them.
//!
//! `cargo run -p mp-roadmap --example roadmaps gaussian_prm [SEED]`

use crate::shared;
use mp_roadmap::{GaussianPrm, Reachable, algo::gaussian_prm::MIXING};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let reach = Reachable { neighbours: 15, radius: 0.5, cycles: false };
    let mut planner = GaussianPrm::new(shared::gap(&space)?, reach, MIXING)?;
    shared::run(&mut planner)?;
    shared::tell(planner.map());
    Ok(())
}
