//! Validity, messages, defaults.

mod common;

use common::{clutter, obstacle, robot, wall};
use mp_cspace::{Clearance, Rn, Rng, Se2, Se2State, Se3, Space, Validity};
use mp_geom::{TriMesh, pose_from_six, primitives};
use mp_robot::{FreeFlyer, Placement, PlanarFlyer, PointRobot, RigidBody, RobotError};
use nalgebra::{Isometry3, Point3, Vector3};

fn se3() -> Se3 {
    Se3::new([-2.0; 3], [2.0; 3]).unwrap()
}

/// Every answer about a configuration agrees with every other, and with plain triangle distances.
fn consistent<P: Placement, C: Space<State = P::State>>(
    space: &C,
    mut body: RigidBody<P>,
    obstacles: &[common::Obstacle],
) {
    let mut rng = Rng::seed(17);
    let states: Vec<_> = (0..400).map(|_| space.sample_uniform(&mut rng)).collect();
    let mut free = Vec::new();
    for q in &states {
        let valid = body.is_valid(q);
        free.push(valid);
        let contacts = body.explain(q);
        let clearance = body.clearance(q, f64::INFINITY);
        assert_eq!((valid, valid), (contacts.is_empty(), clearance > 0.0));
        assert_eq!(valid, !body.in_contact(q));
        assert!(body.clearance(q, 0.01) >= clearance.min(0.01) - 1e-12);
        assert!(contacts.iter().all(|c| c.depth >= 0.0 && c.depth < 4.0));
        let placed = body.mesh().transformed(&P::pose(q));
        if body.radius() > 0.0 {
            let mut nearest = f64::INFINITY;
            for (name, mesh, pose) in obstacles {
                let mesh = mesh.transformed(pose);
                let all = |m: &TriMesh| (0..m.triangles().len()).map(|i| m.triangle(i)).collect::<Vec<_>>();
                let mut distance = f64::INFINITY;
                for a in all(&placed) {
                    for b in all(&mesh) {
                        distance = distance.min(mp_collide::reference::triangle_distance(&a, &b));
                    }
                }
                assert_eq!(distance < 1e-12, contacts.iter().any(|c| c.name == *name));
                nearest = nearest.min(distance);
            }
            assert!((nearest - clearance).abs() < 1e-12);
        }
    }
    let first = free.iter().position(|f| !f);
    assert!(first.is_some() && free.iter().any(|f| *f));
    assert_eq!(body.first_invalid(&states), first);
    let only_free: Vec<_> = states.iter().zip(&free).filter(|(_, f)| **f).map(|(q, _)| q.clone()).collect();
    assert_eq!(body.first_invalid(&only_free), None);
}

#[test]
fn answers_are_consistent() {
    consistent(&se3(), FreeFlyer::new(&robot(), clutter()).unwrap(), &clutter());
    let plane = Se2::new([-2.0; 2], [2.0; 2]).unwrap();
    consistent(&plane, PlanarFlyer::new(&robot(), clutter()).unwrap(), &clutter());
    let line = Rn::<3>::new([-2.0; 3], [2.0; 3]).unwrap();
    consistent(&line, PointRobot::new(clutter()).unwrap(), &clutter());
}

#[test]
fn a_point_is_stopped_by_solids_but_not_by_rooms() {
    let cube = primitives::cuboid(2.0, 2.0, 2.0).unwrap();
    let mut robot = PointRobot::new([
        ("block".to_owned(), cube.clone(), Isometry3::translation(5.0, 0.0, 0.0)),
        ("room".to_owned(), cube.reversed(), Isometry3::identity()),
    ])
    .unwrap();
    let (in_room, in_block, on_block) =
        (Vector3::zeros(), Vector3::new(5.5, 0.0, 0.0), Vector3::new(4.0, 0.25, 0.5));
    assert!(robot.is_valid(&in_room) && !robot.is_valid(&in_block) && !robot.is_valid(&on_block));
    assert_eq!(robot.clearance(&in_room, 10.0), 1.0);
    assert_eq!(robot.clearance(&in_block, 10.0), 0.0);
    assert_eq!(robot.first_invalid(&[in_room, in_block]), Some(1));
    let contacts = robot.explain(&in_block);
    assert_eq!((contacts.len(), contacts[0].name.as_str(), contacts[0].depth), (1, "block", 0.5));
    assert_eq!(robot.enclosing(&in_block), ["block"]);
}

#[test]
fn a_planar_robot_stays_at_its_height() {
    let above = obstacle("shelf", primitives::cuboid(1.0, 1.0, 0.1).unwrap(), [0.0, 0.0, 0.5, 0.0, 0.0, 0.0]);
    let block = obstacle("block", primitives::cuboid(1.0, 1.0, 4.0).unwrap(), [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let mut robot = PlanarFlyer::new(&primitives::cuboid(0.4, 0.2, 0.5).unwrap(), [above, block]).unwrap();
    assert!(robot.is_valid(&Se2State::new(0.0, 0.0, 1.0)));
    assert!(robot.is_valid(&Se2State::new(2.35, 0.0, std::f64::consts::FRAC_PI_2)));
    assert!(!robot.is_valid(&Se2State::new(2.35, 0.0, 0.0)));
    assert_eq!(robot.explain(&Se2State::new(2.35, 0.0, 0.0))[0].name, "block");
}

#[test]
fn the_nearest_free_configuration() {
    let cube = primitives::cuboid(0.2, 0.2, 0.2).unwrap();
    let mut robot = FreeFlyer::new(&cube, [wall(1.0)]).unwrap();
    let (space, margin) = (se3(), robot.tolerance());
    // 0.05 deep in the wall: a little back is nearest.
    let q = Isometry3::translation(0.55, 0.3, 0.1);
    let contacts = robot.explain(&q);
    assert_eq!((contacts.len(), contacts[0].name.as_str()), (1, "wall"));
    assert!((contacts[0].depth - 0.05).abs() < 0.01, "{}", contacts[0].depth);
    let free = robot.nearest_free(&q, &space, margin).unwrap();
    assert!(robot.clearance(&free, 1.0) >= margin && space.contains(&free));
    assert!((space.distance(&q, &free) - 0.05).abs() < 0.01, "{free}");
    assert_eq!(robot.nearest_free(&q, &space, margin), Some(free));
    // Free already: itself.
    assert_eq!(robot.nearest_free(&free, &space, margin), Some(free));
    // In the middle of the solid wall nothing is touched, but outside is what people mean.
    let inside = Isometry3::translation(0.1, 0.0, 0.0);
    assert!(robot.is_valid(&inside) && robot.enclosing(&inside) == ["wall"]);
    let free = robot.nearest_free(&inside, &space, margin).unwrap();
    assert!((free.translation.x - 0.6).abs() < 0.05 && robot.enclosing(&free).is_empty());
    // Nowhere to go, or nowhere to begin.
    let cage = primitives::cuboid(0.3, 0.3, 0.3).unwrap();
    let mut caged = FreeFlyer::new(
        &primitives::cuboid(0.4, 0.4, 0.4).unwrap(),
        [("cage".to_owned(), cage, Isometry3::identity())],
    )
    .unwrap();
    let small = Se3::new([-0.1; 3], [0.1; 3]).unwrap();
    let margin = 0.1;
    assert_eq!(caged.nearest_free(&Isometry3::identity(), &small, margin), None);
    assert_eq!(caged.nearest_free(&Isometry3::translation(f64::NAN, 0.0, 0.0), &small, margin), None);
}

#[test]
fn nearest_free_is_free_and_near_on_random_configurations() {
    fn check<P: Placement, C: Space<State = P::State>>(space: &C, mut robot: RigidBody<P>) {
        let (mut rng, margin) = (Rng::seed(23), robot.tolerance());
        let mut tried = 0;
        while tried < 12 {
            let q = space.sample_uniform(&mut rng);
            if robot.is_valid(&q) {
                continue;
            }
            tried += 1;
            let free = robot.nearest_free(&q, space, margin).unwrap();
            assert!(robot.clearance(&free, 1.0) >= margin && space.contains(&free));
            // Not much farther than the best of many samples.
            let samples = (0..2000).map(|_| space.sample_uniform(&mut rng)).collect::<Vec<_>>();
            let best = samples
                .iter()
                .filter(|p| robot.is_valid(p))
                .map(|p| space.distance(&q, p))
                .fold(f64::INFINITY, f64::min);
            assert!(space.distance(&q, &free) <= 1.5 * best);
        }
    }
    check(&se3(), FreeFlyer::new(&robot(), clutter()).unwrap());
    check(&Se2::new([-2.0; 2], [2.0; 2]).unwrap(), PlanarFlyer::new(&robot(), clutter()).unwrap());
    check(&Rn::<3>::new([-2.0; 3], [2.0; 3]).unwrap(), PointRobot::new(clutter()).unwrap());
}

#[test]
fn default_bounds_hold_everything_with_room_to_pass() {
    let robot = FreeFlyer::new(&robot(), clutter()).unwrap();
    let ends = [Isometry3::translation(5.0, 0.0, 0.0), Isometry3::translation(0.0, -7.0, 0.0)];
    let bounds = robot.default_bounds(&ends);
    let inner = robot.obstacle_bounds();
    for p in ends.iter().map(|q| Point3::from(q.translation.vector)).chain(inner.corners()) {
        assert!(bounds.enlarged(-2.0 * robot.radius()).contains(&p));
    }
    assert!(
        (bounds.max.x - 5.0 - 2.0 * robot.radius()).abs() < 1e-12
            || bounds.max.x - 5.0 > 2.0 * robot.radius()
    );
    assert!(Se3::new(bounds.min.coords, bounds.max.coords).is_ok());
    // Also when there is nothing at all.
    let nothing = PointRobot::new([]).unwrap().default_bounds([&Vector3::new(1.0, 2.0, 3.0)]);
    assert_eq!((nothing.min, nothing.max), (Point3::new(0.0, 1.0, 2.0), Point3::new(2.0, 3.0, 4.0)));
    assert!(!PointRobot::new([]).unwrap().default_bounds([]).is_empty());
}

#[test]
fn counters_belong_to_each_clone() {
    let mut a = FreeFlyer::new(&robot(), clutter()).unwrap();
    let q = Isometry3::identity();
    a.is_valid(&q);
    let mut b = a.clone();
    b.take_counters();
    for _ in 0..3 {
        b.is_valid(&q);
    }
    b.clearance(&q, 0.1);
    assert_eq!((a.counters().collision_checks, a.counters().clearance_checks), (1, 0));
    let counted = b.take_counters();
    assert_eq!((counted.collision_checks, counted.clearance_checks), (3, 1));
    assert!(counted.work.box_tests > 0);
    assert_eq!(b.counters(), mp_robot::CheckCounters::default());
    let mut sum = a.counters();
    sum += counted;
    assert_eq!(sum.collision_checks, 4);
}

#[test]
fn what_is_refused() {
    let cube = primitives::cuboid(1.0, 1.0, 1.0).unwrap();
    let bad = ("bad".to_owned(), cube.clone(), Isometry3::translation(f64::NAN, 0.0, 0.0));
    let refused = FreeFlyer::new(&cube, [bad]);
    assert!(matches!(&refused, Err(RobotError::Obstacle(e)) if e.to_string().contains("bad")), "{refused:?}");
    // Sizes beyond single precision are handled.
    for size in [1e15, 1e40, 1e70] {
        let far = ("far".to_owned(), primitives::sphere(size, 2).unwrap(), Isometry3::identity());
        let mut robot = FreeFlyer::new(&cube, [far]).unwrap();
        assert!(robot.is_valid(&Isometry3::identity()));
        assert!(!robot.is_valid(&Isometry3::translation(0.0, 0.0, robot.obstacle_bounds().max.z)));
        let clearance = robot.clearance(&Isometry3::identity(), f64::INFINITY);
        assert!(clearance > 0.9 * size && clearance < size, "{clearance:e}");
    }
    let huge = primitives::cuboid(1e80, 1.0, 1.0).unwrap();
    assert!(matches!(FreeFlyer::new(&huge, []), Err(RobotError::TooLarge { .. })));
    let far = ("far".to_owned(), huge, Isometry3::identity());
    assert!(matches!(PlanarFlyer::new(&cube, [far]), Err(RobotError::Obstacle(_))));
    let mut robot = FreeFlyer::new(&cube, clutter()).unwrap();
    let nan = pose_from_six([f64::NAN; 6]);
    assert!(!robot.is_valid(&nan) && robot.clearance(&nan, 1.0) == 0.0);
    assert_eq!(robot.first_invalid(&[nan]), Some(0));
}
