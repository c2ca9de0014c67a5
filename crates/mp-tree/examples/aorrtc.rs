//! AORRTC: a point goes around a wall, at once and then by ever shorter ways.
//!
//! `cargo run -p mp-tree --example aorrtc [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp_cspace::{Discrete, FineDiscrete, Iterations, Resolution, Rn, Rng, Straight};
use mp_tree::{Aorrtc, Problem, Step, Tuning, improve};
use nalgebra::Vector2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
    let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.05 || q.y > 0.6;
    let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.005))?);
    let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
    let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.2), Vector2::new(0.9, 0.2))?;
    let tuning = Tuning { step: Step::Length(0.1), ..Tuning::default() };
    let mut planner = Aorrtc::new(problem, tuning)?;
    improve(&mut planner, &mut Rng::seed(seed), &mut Iterations(5_000), &mut (), |path, progress| {
        println!("after {:5} iterations: {:.4}", progress.iterations, path.length(&space));
    });
    Ok(())
}
