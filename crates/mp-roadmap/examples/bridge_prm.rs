//! Bridge-test PRM: a roadmap in the gap between two walls, and a path through it.
//!
//! `cargo run -p mp-roadmap --example bridge_prm [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp_cspace::{
    Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Resolution, Rn, Rng, Straight,
};
use mp_roadmap::{BridgePrm, Reachable, algo::bridge_prm::MIXING};
use nalgebra::Vector2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.2 || (q.y - 0.7).abs() < 0.01;
    let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.002))?);
    let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
    let (start, goal) = (Vector2::new(0.1, 0.2), Vector2::new(0.9, 0.2));
    let problem = Problem::new(&space, local, verifier, start, goal)?;
    let reach = Reachable { neighbours: 15, radius: 0.5, cycles: false };
    let mut planner = BridgePrm::new(problem, reach, MIXING)?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(100_000), &mut ()) {
        Outcome::Solved(path) => {
            for q in &path.states {
                println!("{:8.3} {:8.3}", q.x, q.y);
            }
            let map = planner.map();
            println!("{} nodes, {} edges, {} motions", map.len(), map.edges(), planner.progress().motions);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
