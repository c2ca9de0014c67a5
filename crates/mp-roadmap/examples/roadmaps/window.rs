//! A bar that must turn to pass a window between four beams.

use mp_cspace::{Certified, Iterations, Outcome, Problem, Rng, Se3, Straight};
use mp_geom::{pose_from_six, primitives::cuboid, six_from_pose};
use mp_roadmap::{HasRoadmap, Reachable};
use mp_robot::{FreeFlyer, Verifier};
use nalgebra::Isometry3;

pub(crate) type Result<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;
pub(crate) type Local<'c> = Straight<'c, Se3, Certified<'c, Se3, FreeFlyer>>;

/// Which neighbours are tried.
pub(crate) const REACH: Reachable = Reachable { neighbours: 15, radius: 2.0, cycles: false };

/// The bar among the beams.
pub(crate) fn bar() -> Result<FreeFlyer> {
    let (side, beam) = (cuboid(0.2, 1.0, 3.0)?, cuboid(0.2, 1.0, 1.2)?);
    let at = |name: &str, mesh, y, z| (String::from(name), mesh, Isometry3::translation(0.0, y, z));
    let window = [
        at("left", side.clone(), -1.0, 0.0),
        at("right", side, 1.0, 0.0),
        at("low", beam.clone(), 0.0, -0.9),
        at("high", beam, 0.0, 0.9),
    ];
    Ok(FreeFlyer::new(&cuboid(1.2, 0.15, 0.15)?, window)?)
}

/// The space around the window.
pub(crate) fn space() -> Result<Se3> {
    Ok(Se3::new([-1.5; 3], [1.5; 3])?)
}

/// From one side of the window to the other.
pub(crate) fn problem<'c>(space: &'c Se3, robot: &FreeFlyer) -> Result<Problem<'c, Se3, Local<'c>>> {
    let local = Straight::new(space, Certified::new(space, robot.clone(), robot.tolerance())?);
    let ends = [[-1.0, 0.0, 0.0, 1.5, 0.0, 0.0], [1.0, 0.2, 0.3, 1.0, 0.4, 0.0]];
    let [start, goal] = ends.map(pose_from_six);
    Ok(Problem::new(space, local, Verifier::new(space, robot)?, start, goal)?)
}

/// Plans with the seed given as the second argument, and prints the path.
pub(crate) fn run(mut planner: impl HasRoadmap<Isometry3<f64>, ()>) -> Result {
    let seed = std::env::args().nth(2).map_or(Ok(1), |text| text.parse())?;
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
