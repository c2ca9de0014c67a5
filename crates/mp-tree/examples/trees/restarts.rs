//! Restarts: RRT-Connect begins anew on Luby's schedule until it gets through a narrow gap.
//!
//! `cargo run -p mp-tree --example trees restarts [SEED]`

use crate::shared;
use mp_cspace::{Iterations, Outcome, Planner};
use mp_tree::{Restarts, Schedule};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let mut planner = Restarts::new(Schedule::Luby, 100, |_| shared::through_gap(&space))?;
    match planner.solve(&mut shared::rng()?, &mut Iterations(50_000), &mut ()) {
        Outcome::Solved(path) => println!("attempt {} found {} states", planner.attempt(), path.states.len()),
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
