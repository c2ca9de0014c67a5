//! Bridge-test PRM: a roadmap in the gap between two walls, and a path through it.
//!
//! `cargo run -p mp-roadmap --example roadmaps bridge_prm [SEED]`

use crate::shared;
use mp_roadmap::{BridgePrm, Reachable, algo::bridge_prm::MIXING};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let reach = Reachable { neighbours: 15, radius: 0.5, cycles: false };
    let mut planner = BridgePrm::new(shared::gap(&space)?, reach, MIXING)?;
    shared::run(&mut planner)?;
    shared::tell(planner.map());
    Ok(())
}
