//! Snakes of bodies that fly, in a scene from a file.

use mp::cspace::{Direction, Extension, Verify, verify_path};
use mp::io;
use mp::prelude::*;
use mp::snake::{Params, Repulsion, SnakePlanner, relax};

fn scene(name: &str) -> (Se3, FreeFlyer, io::RigidProblem) {
    let file = format!("{}/../mp-scenes/assets/scenes/{name}.env", env!("CARGO_MANIFEST_DIR"));
    let scene = io::RigidProblem::load(&file).unwrap();
    let bounds = scene.position_bounds();
    let space = Se3::new(bounds.min.coords, bounds.max.coords).unwrap();
    let obstacles = scene.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
    (space, FreeFlyer::new(&scene.robot.mesh, obstacles).unwrap(), scene)
}

/// Of edges that are blocked between free ends some are bent around the columns, and the verifier proves each piece.
#[test]
fn a_snake_bends_edges_around_columns() {
    let (space, robot, _) = scene("gempa-1");
    let check = Certified::new(&space, robot.clone(), robot.tolerance()).unwrap();
    let range = 0.03 * space.extent();
    let mut local = SnakePlanner::new(&space, check, robot.clone(), range).unwrap();
    let mut verifier = Verifier::new(&space, &robot).unwrap();
    let mut rng = Rng::seed(1);
    let mut bent = 0;
    for _ in 0..3000 {
        let [from, toward] = [(); 2].map(|()| space.sample_uniform(&mut rng));
        if !local.admits(&from) {
            continue;
        }
        let step = mp::cspace::Reach::Step(0.4 * space.extent());
        let extension = local.extend(&from, &toward, Direction::Forward, step);
        let (Extension::Advanced(motion) | Extension::Reached(motion)) = extension else { continue };
        if motion.edge.vertices().is_empty() {
            continue;
        }
        bent += 1;
        assert!(verifier.verify_edge(&from, &motion.edge, &motion.end).is_free());
        let straight = space.distance(&from, &motion.end);
        assert!(motion.cost > straight, "{} {straight}", motion.cost);
    }
    let done = local.counters();
    assert!(bent >= 3, "{bent} bent: {done:?}");
    assert_eq!(done.bent(), bent);
}

/// A planner's path, relaxed: proved free, no longer, of less energy.
#[test]
fn a_path_through_openings_is_relaxed() {
    let (space, robot, scene) = scene("gempa-2");
    let mut check = Certified::new(&space, robot.clone(), robot.tolerance()).unwrap();
    let mut verifier = Verifier::new(&space, &robot).unwrap();
    let problem =
        Problem::new(&space, Straight::new(&space, check.clone()), verifier.clone(), scene.start, scene.goal)
            .unwrap();
    let mut planner = RrtConnect::new(problem, Tuning::default()).unwrap();
    let Outcome::Solved(path) = planner.solve(&mut Rng::seed(3), &mut Iterations(50_000), &mut ()) else {
        panic!("not solved")
    };
    let range = 0.02 * space.extent();
    let mut field = Repulsion::new(robot, range).unwrap();
    let params = Params { iterations: 60, ..Params::for_range(range).unwrap() };
    let relaxed = relax(&space, &mut check, &mut field, &path, params, 1.0).unwrap();
    assert!(relaxed.is_better(), "{:?}", relaxed.energy);
    assert!(verify_path(&space, &relaxed.path, &mut verifier).fault.is_none());
    assert!(relaxed.path.length(&space) <= path.length(&space));
    assert_eq!(
        (relaxed.path.states.first(), relaxed.path.states.last()),
        (path.states.first(), path.states.last())
    );
}
