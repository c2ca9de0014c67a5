//! Regional PRM: a roadmap in a bug trap, built region by region, and a path out of it.
//!
//! `cargo run -p mp-roadmap --example roadmaps regional_prm [SEED]`

use crate::shared;
use mp_roadmap::{Reachable, RegionalPrm, Regions};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let reach = Reachable { neighbours: 15, radius: 0.5, cycles: false };
    let mut planner = RegionalPrm::new(shared::bug_trap(&space)?, Regions::default(), reach)?;
    shared::run(&mut planner)?;
    shared::tell(planner.map());
    Ok(())
}
