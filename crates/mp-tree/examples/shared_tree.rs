//! Shared tree: one RRT grown by two threads through a narrow gap, eight samples at a time.
//!
//! `cargo run -p mp-tree --example shared_tree [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Resolution, Rn, Rng, Straight};
use mp_tree::{Problem, SharedTree, Step, Tuning, Workers};
use nalgebra::Vector2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.02;
    let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.005))?);
    let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
    let problem = |_| {
        let (start, goal) = (Vector2::new(0.1, 0.2), Vector2::new(0.9, 0.2));
        Problem::new(&space, local.clone(), verifier.clone(), start, goal)
    };
    let tuning = Tuning { step: Step::Length(0.1), ..Tuning::default() };
    let mut planner = SharedTree::new(8, Workers::new(2)?, tuning, problem)?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(5_000), &mut ()) {
        Outcome::Solved(path) => {
            let progress = planner.progress();
            println!(
                "{} states after {} batches, {} nodes",
                path.states.len(),
                progress.iterations,
                progress.nodes
            );
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
