//! Shared Bi-RRT: two trees grown by two threads until they meet in a narrow gap, eight samples at a time.
//!
//! `cargo run -p mp-tree --example trees shared_bi_rrt [SEED]`

use crate::shared;
use mp_cspace::{Iterations, Outcome, Planner};
use mp_tree::{SharedBiRrt, Workers};
use shared::Point;

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let free = |q: &Point| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.02;
    let ends = [Point::new(0.1, 0.2), Point::new(0.9, 0.2)];
    let problem = |_| shared::problem(&space, free, ends);
    let mut planner = SharedBiRrt::new(8, Workers::new(2)?, shared::tuning(), problem)?;
    match planner.solve(&mut shared::rng()?, &mut Iterations(5_000), &mut ()) {
        Outcome::Solved(path) => {
            let [here, there] = planner.trees().map(|tree| tree.len());
            let batches = planner.progress().iterations;
            println!("{} states after {batches} batches, {here} + {there} nodes", path.states.len());
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
