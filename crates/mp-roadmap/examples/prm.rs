//! PRM: a roadmap around a ring of walls, and a path through its opening.
//!
//! `cargo run -p mp-roadmap --example prm [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp_cspace::{
    Discrete, FineDiscrete, Iterations, Outcome, Planner, Problem, Resolution, Rn, Rng, Straight,
};
use mp_roadmap::{Learning, Prm, Reachable};
use nalgebra::Vector2;

/// Whether a point is off a ring of walls that is open only at the right.
fn free(q: &Vector2<f64>) -> bool {
    let r = (q - Vector2::new(0.5, 0.5)).norm();
    !(0.2..0.3).contains(&r) || (q.x > 0.5 && (q.y - 0.5).abs() < 0.02)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.005))?);
    let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
    let (start, goal) = (Vector2::new(0.5, 0.5), Vector2::new(0.05, 0.5));
    let problem = Problem::new(&space, local, verifier, start, goal)?;
    let reach = Reachable { neighbours: 15, radius: 0.3, cycles: false };
    let mut planner = Prm::new(problem, reach, Learning::default())?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ()) {
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
