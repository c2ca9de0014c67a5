//! Plans on a scene file: `cargo run --release -p mp --example scene -- crates/mp-scenes/assets/scenes/gempa-1.env`
#![allow(clippy::print_stdout)] // an example talks

use mp::geom::six_from_pose;
use mp::io::{self, SpaceKind};
use mp::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "crates/mp-scenes/assets/scenes/gempa-1.env".into());
    let scene = io::RigidProblem::load(&file)?;
    if scene.space != SpaceKind::Se3 {
        return Err(format!("{file} moves in the plane; this example flies").into());
    }
    let bounds = scene.position_bounds();
    let space = Se3::new(bounds.min.coords, bounds.max.coords)?;
    let obstacles = scene.obstacles.into_iter().map(|o| (o.name, o.mesh, o.pose));
    let robot = FreeFlyer::new(&scene.robot.mesh, obstacles)?;
    let (tolerance, verifier) = (robot.tolerance(), Verifier::new(&space, &robot)?);
    let local = Straight::new(&space, Certified::new(&space, robot, tolerance)?);
    let problem = Problem::new(&space, local, verifier, scene.start, Goals::states([scene.goal]))?;
    let mut planner = RrtConnect::new(problem, Tuning::default())?;
    match planner.solve(&mut Rng::seed(1), &mut Iterations(1_000_000), &mut ()) {
        Outcome::Solved(path) => {
            for pose in &path.states {
                println!("{}", six_from_pose(pose).map(|x| x.to_string()).join(" "));
            }
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
