//! RRT-Connect: a point leaves a bug trap in the plane, watched by an observer.
//!
//! `cargo run -p mp-tree --example trees rrt_connect [SEED]`

use mp_cspace::{
    Discrete, EventCounts, FineDiscrete, Iterations, Length, Outcome, Planner, Rn, Rng, Straight,
};
use mp_tree::{Problem, RrtConnect, Tuning};
use nalgebra::Vector2;

/// Whether a point is off a ring of walls that is open only at the right.
fn free(q: &Vector2<f64>) -> bool {
    let r = (q - Vector2::new(0.5, 0.5)).norm();
    !(0.2..0.3).contains(&r) || (q.x > 0.5 && (q.y - 0.5).abs() < 0.02)
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.005))?);
    let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
    let problem = Problem::new(&space, local, verifier, Vector2::new(0.5, 0.5), Vector2::new(0.05, 0.5))?;
    let tuning = Tuning { step: Length::Absolute(0.1), ..Tuning::default() };
    let mut planner = RrtConnect::new(problem, tuning)?;
    let mut seen = EventCounts::default();
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(50_000), &mut seen) {
        Outcome::Solved(path) => {
            for q in &path.states {
                println!("{:8.3} {:8.3}", q.x, q.y);
            }
            println!("{} motions, {seen:?}", planner.progress().motions);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
