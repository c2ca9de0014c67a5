//! PRM*: ever shorter paths out of a ring of walls.
//!
//! `cargo run -p mp-roadmap --example roadmaps prm_star [SEED]`

use crate::shared;
use mp_cspace::Planner;
use mp_roadmap::PrmStar;

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let mut planner = PrmStar::new(shared::bug_trap(&space)?, 1.1)?;
    let mut rng = shared::rng()?;
    while planner.progress().nodes < 3_000 {
        if let Some(path) = planner.step(&mut rng, &mut ()) {
            println!("{:6} nodes: {:.4}", planner.progress().nodes, path.length(&space));
        }
    }
    shared::tell(planner.map());
    Ok(())
}
