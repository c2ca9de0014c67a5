//! OR-parallel: eight runs of RRT-Connect race through a narrow gap on two threads.
//!
//! `cargo run -p mp-tree --example trees or_parallel [SEED]`

use crate::shared;
use mp_cspace::{Iterations, Outcome, Planner};
use mp_tree::{OrParallel, Workers};

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let mut planner = OrParallel::new(8, 32, Workers::new(2)?, |_| shared::through_gap(&space))?;
    match planner.solve(&mut shared::rng()?, &mut Iterations(50_000), &mut ()) {
        Outcome::Solved(path) => println!("run {:?} found {} states", planner.winner(), path.states.len()),
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
