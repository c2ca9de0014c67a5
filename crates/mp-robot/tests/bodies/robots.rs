//! Validity, messages, defaults.

use crate::common::{clutter, obstacle, robot, wall};
use mp_cspace::{
    Certified, Clearance, MotionValidity, Rn, Rng, Se2, Se2State, Se3, Space, TrueMetric, Validity,
};
use mp_geom::{TriMesh, pose_from_six, primitives};
use mp_robot::{FreeFlyer, Placement, PlanarFlyer, PointRobot, RigidBody, RobotError, Verifier};
use nalgebra::{Isometry3, Point3, Vector3};

fn se3() -> Se3 {
    Se3::new([-2.0; 3], [2.0; 3]).unwrap()
}

/// Every answer about a configuration agrees with every other, and with plain triangle distances.
fn consistent<P: Placement, C: Space<State = P::State>>(
    space: &C,
    mut body: RigidBody<P>,
    obstacles: &[crate::common::Obstacle],
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
    // In the middle of the wall no triangle is touched, but outside is what people mean, also if it is a surface.
    let inside = Isometry3::translation(0.1, 0.0, 0.0);
    let (name, mesh, pose) = wall(1.0);
    let mut among_surfaces = FreeFlyer::new(&cube, [(name, mesh.into_surface(), pose)]).unwrap();
    assert!(!robot.is_valid(&inside) && among_surfaces.is_valid(&inside));
    let contacts = robot.explain(&inside);
    assert!(contacts.len() == 1 && (contacts[0].depth - 0.5).abs() < 0.01, "{contacts:?}");
    for robot in [&mut robot, &mut among_surfaces] {
        assert_eq!(robot.enclosing(&inside), ["wall"]);
        let free = robot.nearest_free(&inside, &space, margin).unwrap();
        assert!((free.translation.x - 0.6).abs() < 0.05 && robot.enclosing(&free).is_empty());
    }
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

/// What checker and verifier say of `q`, and of the motion from there to `to`.
fn judged<P, C>(space: &C, mut robot: RigidBody<P>, q: &P::State, to: &P::State) -> bool
where
    P: Placement,
    C: Space<State = P::State> + TrueMetric,
{
    let free = robot.is_valid(q);
    let states = [q.clone(), to.clone()];
    assert_eq!((robot.in_contact(q), robot.first_invalid(&states)), (!free, (!free).then_some(0)));
    assert_eq!((robot.clearance(q, 1.0) > 0.0, robot.clearance(q, 0.0) > 0.0), (free, free));
    let contacts = robot.explain(q);
    assert!(contacts.is_empty() == free && contacts.iter().all(|c| c.depth > 0.0), "{contacts:?}");
    let mut verifier = Verifier::new(space, &robot).unwrap();
    assert_eq!(verifier.check_state(q, 1.0).is_free(), free);
    let mut certified = Certified::new(space, robot.clone(), robot.tolerance()).unwrap();
    // Twice: a verifier remembers where the last motion ended.
    for (from, to) in [(q, to), (to, q), (q, to)] {
        assert_eq!(certified.check_motion(from, to).is_free(), free);
        assert_eq!(verifier.check_motion(from, to).is_free(), free);
    }
    free
}

/// Such as a part in the coordinates of the whole: the tolerance is that of its size.
#[test]
fn the_tolerance_of_a_body_far_from_its_origin_is_that_of_its_size() {
    let part = primitives::cuboid(0.2, 0.2, 0.2).unwrap();
    let far = part.transformed(&Isometry3::translation(1000.0, 0.0, 0.0));
    let [near, far] = [part, far].map(|mesh| FreeFlyer::new(&mesh, []).unwrap());
    assert!((near.tolerance() / (1e-4 * near.radius()) - 1.0).abs() < 1e-9);
    assert!((1.0..2.1).contains(&(far.tolerance() / near.tolerance())), "{}", far.tolerance());
}

/// A robot inside of an obstacle and an obstacle inside of the robot, in space and in the plane; bodies of a surface and a solid.
#[test]
fn solids_have_an_inside_and_surfaces_have_none() {
    let (here, there) = (Isometry3::translation(0.1, 0.2, 0.3), Isometry3::translation(0.2, -0.1, 0.1));
    let (space, plane) = (se3(), Se2::new([-2.0; 2], [2.0; 2]).unwrap());
    let flat = [Se2State::new(0.1, 0.2, 0.5), Se2State::new(-0.1, 0.3, 0.2)];
    let surface = |mesh: &TriMesh| mesh.clone().into_surface();
    let pebble = primitives::sphere(0.1, 2).unwrap();
    let solids = [
        primitives::cuboid(4.0, 3.0, 4.0).unwrap(),
        primitives::sphere(2.0, 3).unwrap(),
        primitives::cylinder(2.0, 4.0, 32).unwrap(),
        // A closed mesh that faces inward, made a solid.
        primitives::cone(3.0, 6.0, 16).unwrap().reversed().into_solid().unwrap(),
        // A part of a body that is a surface elsewhere.
        TriMesh::merged([&surface(&pebble), &primitives::cuboid(2.0, 2.0, 2.0).unwrap()])
            .unwrap()
            .transformed(&Isometry3::translation(0.4, 0.0, 0.0)),
    ];
    for solid in &solids {
        for (around, free) in [(solid.clone(), false), (surface(solid), true)] {
            for inner in [pebble.clone(), surface(&pebble)] {
                let named = |mesh: &TriMesh| [obstacle("it", mesh.clone(), [0.0; 6])];
                let (small, large) =
                    (FreeFlyer::new(&inner, named(&around)), FreeFlyer::new(&around, named(&inner)));
                let small = small.unwrap();
                assert_eq!(small.enclosing(&here), ["it"]);
                assert_eq!(judged(&space, small, &here, &there), free);
                assert_eq!(judged(&space, large.unwrap(), &here, &there), free);
                let small = PlanarFlyer::new(&inner, named(&around)).unwrap();
                assert_eq!(judged(&plane, small, &flat[0], &flat[1]), free);
            }
        }
        // Two parts, one of them inside.
        let apart = TriMesh::merged([&pebble.transformed(&Isometry3::translation(9.0, 0.0, 0.0)), &pebble]);
        let two = FreeFlyer::new(&apart.unwrap(), [obstacle("it", solid.clone(), [0.0; 6])]).unwrap();
        assert!(!judged(&space, two, &here, &there));
        // Closed obstacles stop a point even if they are surfaces.
        let line = Rn::<3>::new([-2.0; 3], [2.0; 3]).unwrap();
        let point = PointRobot::new([obstacle("it", solid.clone(), [0.0; 6])]).unwrap();
        let ends = [here, there].map(|pose| pose.translation.vector);
        assert!(!judged(&line, point, &ends[0], &ends[1]));
    }
    // A room, whose walls are solid.
    let [room, inner] = [4.0, 3.8].map(|side| primitives::cuboid(side, side, side).unwrap());
    let room = TriMesh::merged([&surface(&room), &inner.reversed()]).unwrap().into_solid().unwrap();
    let robot = FreeFlyer::new(&pebble, [obstacle("room", room, [0.0; 6])]).unwrap();
    assert!(judged(&space, robot.clone(), &here, &there));
    let wall = Isometry3::translation(1.95, 0.2, 0.3);
    assert!(!judged(&space, robot, &wall, &Isometry3::translation(1.95, 0.3, 0.2)));
}

/// Against the equations of the solids: a small ball is free where its middle is farther from them than its radius.
#[test]
fn random_places_are_free_by_equations() {
    let solid = |mesh: Result<TriMesh, _>| obstacle("it", mesh.unwrap(), [0.0; 6]);
    type Inside = fn([f64; 3]) -> f64;
    let to_box: Inside =
        |p| [0.5, 0.7, 0.9].iter().zip(p).map(|(half, x)| x.abs() - half).fold(-9.0, f64::max);
    let to_ball: Inside = |p| mp_math::hypot(mp_math::hypot(p[0], p[1]), p[2]) - 1.0;
    let to_tube: Inside = |p| mp_math::hypot(mp_math::hypot(p[0], p[1]) - 1.0, p[2]) - 0.45;
    let shapes = [
        (solid(primitives::cuboid(1.0, 1.4, 1.8)), to_box),
        (solid(primitives::sphere(1.0, 4)), to_ball),
        (solid(primitives::torus(1.0, 0.45, 64, 32)), to_tube),
    ];
    let (space, ball) = (Se3::new([-1.2; 3], [1.2; 3]).unwrap(), primitives::sphere(0.05, 1).unwrap());
    let mut rng = Rng::seed(5);
    for (shape, depth) in shapes {
        let mut robot = FreeFlyer::new(&ball, [shape]).unwrap();
        let verifier = Verifier::new(&space, &robot).unwrap();
        let mut seen = [0; 2];
        for _ in 0..4_000 {
            let q = space.sample_uniform(&mut rng);
            let depth = depth(q.translation.vector.into());
            // Where the ball meets the surface, or hardly so, triangles decide.
            if depth.abs() < 0.06 {
                continue;
            }
            let free = depth > 0.0;
            assert_eq!((robot.is_valid(&q), verifier.check_state(&q, 1e-3).is_free()), (free, free), "{q}");
            seen[usize::from(free)] += 1;
        }
        assert!(seen.iter().all(|n| *n > 500), "{seen:?}");
    }
}

/// Closed meshes are surfaces: what is inside of one is named, for warnings; rooms, solids and open meshes are not.
#[test]
fn what_closed_meshes_hold_is_named() {
    let (cube, pebble) = (primitives::cuboid(2.0, 2.0, 2.0).unwrap(), primitives::sphere(0.1, 1).unwrap());
    let open = TriMesh::new(cube.vertices().to_vec(), cube.triangles()[2..].to_vec()).unwrap();
    let surface = cube.clone().into_surface();
    let here = Isometry3::translation(0.1, 0.0, 0.2);
    let cases = [(&surface, true), (&cube, false), (&cube.reversed(), false), (&open, false)];
    for (around, named) in cases {
        let mut small = FreeFlyer::new(&pebble, [obstacle("it", around.clone(), [0.0; 6])]).unwrap();
        let found = |around| if named { vec![("it".to_owned(), around)] } else { Vec::new() };
        assert_eq!(small.enclosures(&here), found(true));
        assert_eq!(small.enclosures(&Isometry3::translation(3.0, 0.0, 0.0)), []);
        assert_eq!(small.enclosures(&Isometry3::translation(1.0, 0.0, 0.0)), [], "it touches");
        let mut large = FreeFlyer::new(around, [obstacle("it", pebble.clone(), [0.0; 6])]).unwrap();
        assert_eq!(large.enclosures(&here), found(false));
    }
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
        let far =
            ("far".to_owned(), primitives::sphere(size, 2).unwrap().into_surface(), Isometry3::identity());
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
