//! RRT in space and time: a body crosses a road between two that drive along it.
//!
//! `cargo run --release -p mp --example moving_obstacles [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp::cspace::{
    Certified, Iterations, Outcome, Planner, Rng, Se2, Se2State, Straight,
    space_time::{ForwardInTime, SpaceTime},
};
use mp::geom::primitives::cuboid;
use mp::robot::{AmongMoving, MovingVerifier, PlanarFlyer, Trajectory};
use mp::tree::{Goals, Length, Problem, Rrt, Tuning};
use nalgebra::Isometry3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    // Two lorries, eight metres long, pass each other: one toward larger x, one toward smaller.
    let drive = |y: f64, from: f64, to: f64| {
        let at = |x: f64| Isometry3::translation(x, y, 0.0);
        Trajectory::new([(0.0, at(from)), (10.0, at(to))])
    };
    let lorry = cuboid(8.0, 2.0, 3.0)?;
    let lorries = [
        ("eastbound".to_owned(), lorry.clone(), drive(-1.5, -14.0, 16.0)?),
        ("westbound".to_owned(), lorry, drive(1.5, 12.0, -18.0)?),
    ];
    let robot = AmongMoving::new(PlanarFlyer::new(&cuboid(0.8, 0.5, 1.0)?, [])?, lorries)?;

    // Ten seconds, at two metres a second at most.
    let positions = Se2::new([-5.0, -4.0], [5.0, 4.0])?;
    let space = SpaceTime::new(positions, 10.0, 2.0)?;
    let verifier = MovingVerifier::new(&space, &robot)?;
    let check = ForwardInTime { space: &space, check: Certified::new(&space, robot, 1e-3)? };
    let (here, there) = (Se2State::new(0.0, -3.5, 0.0), Se2State::new(0.0, 3.5, 0.0));
    let arrival = space.at_any_time(there);
    let goal = Goals::region(arrival.clone()).with_sampler(arrival);
    let problem = Problem::new(&space, Straight::new(&space, check), verifier, (here, 0.0), goal)?;
    let tuning = Tuning { step: Length::Absolute(4.0), ..Tuning::default() };
    let mut planner = Rrt::new(problem, tuning)?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(100_000), &mut ()) {
        Outcome::Solved(path) => {
            for (q, time) in &path.states {
                println!("{time:6.2} s {:8.3} {:8.3} {:8.3}", q.translation.x, q.translation.y, q.angle);
            }
            println!("{} nodes", planner.progress().nodes);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
