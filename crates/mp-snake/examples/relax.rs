//! A jagged path around a disc, relaxed: shorter, and farther from the disc.
//!
//! `cargo run -p mp-snake --example relax`
#![allow(clippy::print_stdout)] // examples talk

use mp_cspace::{FineDiscrete, Length, Path, Rn};
use mp_snake::{Params, Repulsion, relax};
use nalgebra::Vector2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let space = Rn::<2>::new([-1.0; 2], [1.0; 2])?;
    let clearance = |q: &Vector2<f64>| q.norm() - 0.3;
    let field = |q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]| {
        gradient.copy_from_slice((q / q.norm()).as_slice());
        clearance(q)
    };
    let jagged = [(-0.9, 0.0), (-0.4, 0.1), (-0.2, 0.8), (0.0, 0.35), (0.3, 0.7), (0.9, 0.0)];
    let path = Path::straight(jagged.map(|(x, y)| Vector2::new(x, y)).to_vec());
    let mut check = FineDiscrete::new(&space, |q: &Vector2<f64>| clearance(q) > 0.0, Length::Absolute(1e-3))?;
    let relaxed =
        relax(&space, &mut check, &mut Repulsion::new(field, 0.2)?, &path, Params::for_range(0.2)?, 1.0)?;
    let least = |path: &Path<Vector2<f64>>| path.states.iter().map(clearance).fold(f64::INFINITY, f64::min);
    println!("length    {:.2} -> {:.2} m", path.length(&space), relaxed.path.length(&space));
    println!("clearance {:.2} -> {:.2} m", least(&path), least(&relaxed.path));
    Ok(())
}
