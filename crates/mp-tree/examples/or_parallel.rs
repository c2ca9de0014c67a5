//! OR-parallel: eight runs of RRT-Connect race through a narrow gap on two threads.
//!
//! `cargo run -p mp-tree --example or_parallel [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Resolution, Rn, Rng, Straight};
use mp_tree::{OrParallel, Problem, RrtConnect, Step, Tuning, Workers};
use nalgebra::Vector2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || (q.y - 0.8).abs() < 0.01;
    let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.005))?);
    let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
    let run = |_| {
        let (start, goal) = (Vector2::new(0.1, 0.2), Vector2::new(0.9, 0.2));
        let problem = Problem::new(&space, local.clone(), verifier.clone(), start, goal)?;
        RrtConnect::new(problem, Tuning { step: Step::Length(0.1), ..Tuning::default() })
    };
    let mut planner = OrParallel::new(8, 32, Workers::new(2)?, run)?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ()) {
        Outcome::Solved(path) => println!("run {:?} found {} states", planner.winner(), path.states.len()),
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
