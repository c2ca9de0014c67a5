//! OBPRM: a bar is turned to pass a window between four beams.
//!
//! `cargo run -p mp-roadmap --example obprm [SEED]`
#![allow(clippy::print_stdout)] // an example talks

use mp_cspace::{Certified, Iterations, Outcome, Planner, Problem, Rng, Se3, Straight};
use mp_geom::{pose_from_six, primitives::cuboid, six_from_pose};
use mp_roadmap::{Obprm, OnSurfaces, Reachable};
use mp_robot::{FreeFlyer, Verifier};
use nalgebra::Isometry3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seed = std::env::args().nth(1).map_or(Ok(1), |text| text.parse())?;
    let (side, beam) = (cuboid(0.2, 1.0, 3.0)?, cuboid(0.2, 1.0, 1.2)?);
    let at = |name: &str, mesh, y, z| (String::from(name), mesh, Isometry3::translation(0.0, y, z));
    let window = [
        at("left", side.clone(), -1.0, 0.0),
        at("right", side, 1.0, 0.0),
        at("low", beam.clone(), 0.0, -0.9),
        at("high", beam, 0.0, 0.9),
    ];
    let robot = FreeFlyer::new(&cuboid(1.2, 0.15, 0.15)?, window)?;
    let space = Se3::new([-1.5; 3], [1.5; 3])?;
    let local = Straight::new(&space, Certified::new(&space, robot.clone(), robot.tolerance())?);
    let verifier = Verifier::new(&space, &robot)?;
    let ends = [[-1.0, 0.0, 0.0, 1.5, 0.0, 0.0], [1.0, 0.2, 0.3, 1.0, 0.4, 0.0]];
    let [start, goal] = ends.map(pose_from_six);
    let problem = Problem::new(&space, local, verifier, start, goal)?;
    let reach = Reachable { neighbours: 15, radius: 2.0, cycles: false };
    let mut planner = Obprm::new(problem, robot, reach, OnSurfaces::default())?;
    match planner.solve(&mut Rng::seed(seed), &mut Iterations(40_000), &mut ()) {
        Outcome::Solved(path) => {
            for q in &path.states {
                println!("{:.3?}", six_from_pose(q));
            }
            let map = planner.map();
            println!("{} nodes, {} edges, {} motions", map.len(), map.edges(), planner.progress().motions);
        }
        Outcome::Stopped(reason) => println!("no path: {reason:?}"),
    }
    Ok(())
}
