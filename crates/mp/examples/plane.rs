//! Plans for a disc in a room in the plane, with straight edges and with edges that bend:
//! `cargo run --release -p mp --example plane`
#![allow(clippy::print_stdout)] // an example talks

use mp::cspace::{Iterations, Outcome, Planner, Rn, Rng, Straight};
use mp::geom::planar::{PlanarWorld, Polygon};
use mp::robot::{DiscRobot, DiscVerifier};
use mp::snake::SnakePlanner;
use mp::tree::{Length, Problem, Rrt, Tuning};
use nalgebra::Vector2;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shelves = (0..3).map(|i| {
        let (x, y) = (0.8 + f64::from(i), 0.5 * f64::from(i % 2));
        Polygon::rectangle([x, y], [x + 0.2, y + 1.4])
    });
    let world = PlanarWorld::new(shelves.collect::<Result<_, _>>()?, Some([[0.0, 0.0], [4.0, 2.0]]))?;
    let robot = DiscRobot::new(world, 0.1)?;
    let space = Rn::<2>::new([0.0, 0.0], [4.0, 2.0])?;
    let (start, goal) = (Vector2::new(0.3, 0.3), Vector2::new(3.7, 0.3));
    let tuning = Tuning { step: Length::Absolute(0.8), ..Tuning::default() };

    let straight = Straight::new(&space, robot.clone());
    let problem = Problem::new(&space, straight, DiscVerifier::new(&robot), start, goal)?;
    let mut rrt = Rrt::new(problem, tuning)?;
    let bent = SnakePlanner::new(&space, robot.clone(), robot.clone(), 0.2)?;
    let problem = Problem::new(&space, bent, DiscVerifier::new(&robot), start, goal)?;
    let mut rrs = Rrt::new(problem, tuning)?;

    if let Outcome::Solved(path) = rrt.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ()) {
        println!("RRT: {} iterations, {:.2} m", rrt.progress().iterations, path.length(&space));
    }
    if let Outcome::Solved(path) = rrs.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ()) {
        println!("RRS: {} iterations, {:.2} m", rrs.progress().iterations, path.flattened().length(&space));
    }
    Ok(())
}
