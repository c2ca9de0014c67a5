//! LazyPRM: a path out of a ring of walls, with little of the roadmap checked.
//!
//! `cargo run -p mp-roadmap --example roadmaps lazy_prm [SEED]`

use crate::shared;
use mp_roadmap::{LazyPrm, Pace, Reachable};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let reach = Reachable { neighbours: 15, radius: 0.3, cycles: true };
    let mut planner = LazyPrm::new(shared::bug_trap(&space)?, reach, Pace { first: 500, more: 100 })?;
    shared::run(&mut planner)?;
    shared::tell(planner.map());
    Ok(())
}
