//! PRM: a roadmap around a ring of walls, and a path through its opening.
//!
//! `cargo run -p mp-roadmap --example roadmaps prm [SEED]`

use crate::shared;
use mp_roadmap::{Learning, Prm, Reachable};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let reach = Reachable { neighbours: 15, radius: 0.3, cycles: false };
    let mut planner = Prm::new(shared::bug_trap(&space)?, reach, Learning::default())?;
    shared::run(&mut planner)?;
    shared::tell(planner.map());
    Ok(())
}
