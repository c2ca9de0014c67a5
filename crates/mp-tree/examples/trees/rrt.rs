//! RRT: a rod in the plane turns to pass a slit, to anywhere on the other side.
//!
//! `cargo run -p mp-tree --example trees rrt [SEED]`

use mp_cspace::{Discrete, FineDiscrete, Iterations, Length, Outcome, Planner, Rng, Se2, Se2State, Straight};
use mp_tree::{Goals, Problem, Rrt, Tuning};
use nalgebra::Point2;

/// Whether a rod 0.3 m long is clear of a wall at x = 1 m with a slit of 0.1 m.
fn free(q: &Se2State) -> bool {
    (-10..=10).all(|i| {
        let p = q.transform_point(&Point2::new(0.015 * f64::from(i), 0.0));
        (p.x - 1.0).abs() > 0.05 || (p.y - 0.5).abs() < 0.05
    })
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?;
    let space = Se2::new([0.0, 0.0], [2.0, 1.0])?;
    let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
    let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
    let start = Se2State::new(0.3, 0.3, 1.5);
    let beyond = Goals::region(|q: &Se2State| q.translation.x > 1.5);
    let problem = Problem::new(&space, local, verifier, start, beyond)?;
    let tuning = Tuning { step: Length::Fraction(0.1), ..Tuning::default() };
    let mut planner = Rrt::new(problem, tuning)?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut ()) {
        Outcome::Solved(path) => {
            for q in &path.states {
                println!("{:8.3} {:8.3} {:8.3}", q.translation.x, q.translation.y, q.angle);
            }
            println!("{} nodes", planner.progress().nodes);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
