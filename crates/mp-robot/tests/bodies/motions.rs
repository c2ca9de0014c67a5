//! Motion checks: discrete, certified and the verifier, against each other and against sampling.

use crate::common::{clutter, obstacle, robot, wall};
use mp_cspace::{
    Certified, Discrete, Length, MotionCheck, MotionValidity, Rn, Rng, Se2, Se3, Space, Validity,
};
use mp_geom::{pose_from_six, primitives};
use mp_robot::{FreeFlyer, Placement, PlanarFlyer, PointRobot, RigidBody, Verifier};
use nalgebra::{Isometry3, Vector3};

fn se3() -> Se3 {
    Se3::new([-2.0; 3], [2.0; 3]).unwrap()
}

/// All that must hold between the three checks on random motions, short and long.
fn agree<P: Placement, C: Space<State = P::State>>(space: &C, robot: &RigidBody<P>, motions: usize) {
    let tolerance = robot.tolerance();
    let mut certified = Certified::new(space, robot.clone(), tolerance).unwrap();
    let mut discrete = Discrete::new(space, robot.clone(), Length::Fraction(0.002)).unwrap();
    let mut verifier = Verifier::new(space, robot).unwrap();
    let mut exact = robot.clone();
    let mut rng = Rng::seed(11);
    let (mut free, mut refused) = (0, 0);
    for i in 0..motions {
        let a = space.sample_uniform(&mut rng);
        let b = space.interpolate(&a, &space.sample_uniform(&mut rng), [1.0, 0.3, 0.05][i % 3]);
        let sampled = discrete.check_motion(&a, &b);
        let verified = verifier.check_motion(&a, &b);
        match certified.check_motion(&a, &b) {
            MotionCheck::Free { clearance } => {
                free += 1;
                assert!(clearance >= certified.margin());
                assert!(sampled.is_free(), "sampling found what the proof missed: {sampled:?}");
                let MotionCheck::Free { clearance } = verified else {
                    panic!("the verifier does not prove what was certified: {verified:?}");
                };
                assert!(clearance >= verifier.tolerance());
            }
            MotionCheck::Collision { at } => {
                refused += 1;
                assert!(!exact.is_valid(&space.interpolate(&a, &b, at)));
                assert!(!verified.is_free());
            }
            MotionCheck::Unproven { .. } => {}
        }
        match verified {
            MotionCheck::Free { clearance } => {
                assert!(sampled.is_free());
                for k in 0..=20 {
                    let q = space.interpolate(&a, &b, f64::from(k) / 20.0);
                    assert!(mp_cspace::Clearance::clearance(&mut exact, &q, 1e9) >= clearance - 1e-9);
                }
            }
            MotionCheck::Collision { at } => {
                let q = space.interpolate(&a, &b, at);
                // The reference calls contact what is nearer than 1e-13 of the coordinates.
                assert!(mp_cspace::Clearance::clearance(&mut exact, &q, 1.0) < 1e-11);
            }
            MotionCheck::Unproven { at } => {
                let q = space.interpolate(&a, &b, at);
                assert!(mp_cspace::Clearance::clearance(&mut exact, &q, 1.0) < 2.0 * tolerance);
            }
        }
    }
    assert!(free > motions / 10 && refused > motions / 10, "{free} free, {refused} refused");
}

#[test]
fn checks_agree_in_space() {
    agree(&se3(), &FreeFlyer::new(&robot(), clutter()).unwrap(), 900);
}

/// A body of a centimetre goes two kilometres, over a plate of a millimetre and through it.
#[test]
fn long_ways_of_small_bodies_are_checked() {
    let small = primitives::cuboid(0.01, 0.01, 0.01).unwrap();
    let plate = primitives::cuboid(0.001, 0.5, 0.5).unwrap();
    let plate = obstacle("plate", plate, [123.4567, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let flyer = FreeFlyer::new(&small, vec![plate]).unwrap();
    let space = Se3::new([-1e3; 3], [1e3; 3]).unwrap();
    let mut certified = Certified::new(&space, flyer.clone(), flyer.tolerance()).unwrap();
    let mut verifier = Verifier::new(&space, &flyer).unwrap();
    for (y, free) in [(0.2, false), (-0.2549, false), (0.2551, true), (9.0, true)] {
        let [a, b] = [-1e3, 1e3].map(|x| Isometry3::translation(x, y, 0.1));
        for found in [certified.check_motion(&a, &b), verifier.check_motion(&a, &b)] {
            let off = found.failed_at().map(|at| (2e3 * at - 1123.4567).abs());
            assert!(found.is_free() == free && off.is_none_or(|off| off < 0.01), "{y}: {found:?}");
        }
    }
}

/// Clouds beside meshes, one of them turned.
#[test]
fn checks_agree_among_points() {
    let mut obstacles: Vec<_> = clutter().into_iter().take(2).collect();
    let mut rng = Rng::seed(5);
    let shell = se3();
    let points: Vec<_> =
        (0..800).map(|_| shell.sample_uniform(&mut rng).translation.vector.normalize()).collect();
    let cloud = mp_geom::TriMesh::of_balls(points.iter().map(|v| (v * 1.2).into()).collect(), 0.02).unwrap();
    obstacles.push(obstacle("half a shell", cloud, [0.3, 0.1, -0.9, 0.3, 0.2, 0.1]));
    let robot = FreeFlyer::new(&robot(), obstacles.clone()).unwrap();
    agree(&shell, &robot, 400);

    // The same answers as with the balls as meshes, but for their facets.
    let faceted = obstacles.iter().map(|(name, mesh, pose)| (name.clone(), mesh.faceted(), *pose));
    let mut inside = FreeFlyer::new(robot.mesh(), faceted).unwrap();
    let (mut balls, mut near) = (robot, 0);
    for _ in 0..300 {
        let q = shell.sample_uniform(&mut rng);
        let [a, b] = [&mut balls, &mut inside].map(|robot| mp_cspace::Clearance::clearance(robot, &q, 1e9));
        assert!(b <= a + 1e-12 && a - b < 0.26 * 0.02 + 1e-9, "{a} {b}");
        near += usize::from(a > 0.0 && b < a);
        let contacts = balls.explain(&q);
        assert_eq!(contacts.is_empty(), a > 0.0, "{contacts:?}");
    }
    assert!(near > 100, "{near}");
}

#[test]
fn checks_agree_in_the_plane() {
    let space = Se2::new([-2.0; 2], [2.0; 2]).unwrap();
    agree(&space, &PlanarFlyer::new(&robot(), clutter()).unwrap(), 900);
}

#[test]
fn checks_agree_on_a_point() {
    let space = Rn::<3>::new([-2.0; 3], [2.0; 3]).unwrap();
    // Solids only: sampling never sees a sheet.
    let solids: Vec<_> = clutter().into_iter().take(3).collect();
    agree(&space, &PointRobot::new(solids).unwrap(), 3000);
}

/// Nothing passes a thin wall, whichever way it moves and turns.
#[test]
fn a_thin_wall_is_never_crossed() {
    let space = se3();
    let mut rng = Rng::seed(3);
    for thickness in [1e-4, 1e-7, 1e-12] {
        let robot = FreeFlyer::new(&robot(), [wall(thickness)]).unwrap();
        let mut certified = Certified::new(&space, robot.clone(), robot.tolerance()).unwrap();
        let mut verifier = Verifier::new(&space, &robot).unwrap();
        let mut free = robot.clone();
        let mut crossings = 0;
        while crossings < 300 {
            let [a, b] = [0, 1].map(|_| space.sample_uniform(&mut rng));
            let side = |q: &Isometry3<f64>| q.translation.x > 0.0;
            if side(&a) != side(&b) && free.is_valid(&a) && free.is_valid(&b) {
                crossings += 1;
                assert!(!certified.check_motion(&a, &b).is_free());
                assert!(!verifier.check_motion(&a, &b).is_free());
            }
        }
    }
    // While sampling at one percent of the extent often misses it.
    let point = primitives::sphere(0.01, 0).unwrap();
    let robot = FreeFlyer::new(&point, [wall(1e-4)]).unwrap();
    let mut discrete = Discrete::new(&space, robot.clone(), Length::Fraction(0.01)).unwrap();
    let mut verifier = Verifier::new(&space, &robot).unwrap();
    let (a, b) = (Isometry3::translation(-0.7, 0.0, 0.0), Isometry3::translation(1.3, 0.3, 0.0));
    assert!(discrete.check_motion(&a, &b).is_free());
    assert!(!verifier.check_motion(&a, &b).is_free());
}

#[test]
fn the_verifier_catches_an_edge_whose_ends_are_free() {
    let pole = obstacle("pole", primitives::cylinder(0.05, 4.0, 8).unwrap(), [0.0; 6]);
    let mut robot = FreeFlyer::new(&primitives::cuboid(0.2, 0.2, 0.2).unwrap(), [pole]).unwrap();
    let space = se3();
    let mut verifier = Verifier::new(&space, &robot).unwrap();
    let at = |x: f64, y: f64| pose_from_six([x, y, 0.0, x, 0.3, y]);
    let (a, b) = (at(-1.0, 0.0), at(1.0, 0.0));
    assert!(robot.is_valid(&a) && robot.is_valid(&b));
    let MotionCheck::Collision { at: t } = verifier.check_motion(&a, &b) else { panic!("missed the pole") };
    assert!(!robot.is_valid(&space.interpolate(&a, &b, t)));
    // Around it is free, with the clearance there is.
    let MotionCheck::Free { clearance } = verifier.check_motion(&at(-1.0, 1.0), &at(1.0, 1.0)) else {
        panic!("refused a free motion")
    };
    assert!(clearance > 0.0 && clearance < 0.9);
    // A pure turn that sweeps through it: both ends are free, all translations the same.
    let bar = FreeFlyer::new(
        &primitives::cuboid(2.0, 0.1, 0.1).unwrap(),
        [obstacle("post", primitives::cylinder(0.02, 1.0, 8).unwrap(), [0.5, 0.5, 0.0, 0.0, 0.0, 0.0])],
    )
    .unwrap();
    let mut verifier = Verifier::new(&space, &bar).unwrap();
    let turn = |yaw| pose_from_six([0.0, 0.0, 0.0, yaw, 0.0, 0.0]);
    assert!(!verifier.check_motion(&turn(0.0), &turn(1.5)).is_free());
    assert!(verifier.check_motion(&turn(0.0), &turn(-1.2)).is_free());
}

/// Narrow passages: what is certified at the default tolerance the verifier always proves, in grazing
/// contact as well.
#[test]
fn grazing_motions() {
    let space = se3();
    for exponent in 2..9 {
        let gap = mp_math::powi(0.1, exponent);
        let floor = obstacle(
            "floor",
            primitives::cuboid(8.0, 8.0, 1.0).unwrap(),
            [0.0, 0.0, -0.6 - gap, 0.0, 0.0, 0.0],
        );
        let robot = FreeFlyer::new(&primitives::cuboid(0.2, 0.2, 0.2).unwrap(), [floor]).unwrap();
        let tolerance = robot.tolerance();
        let mut certified = Certified::new(&space, robot.clone(), tolerance).unwrap();
        let mut verifier = Verifier::new(&space, &robot).unwrap();
        let (a, b) = (Isometry3::translation(-0.3, 0.0, 0.0), pose_from_six([0.3, 0.1, 0.0, 1.0, 0.0, 0.0]));
        let accepted = certified.check_motion(&a, &b).is_free();
        let proved = verifier.check_motion(&a, &b).is_free();
        // Between margin and tolerance either answer will do.
        assert!(accepted || gap < tolerance, "{gap}");
        assert!(!accepted || gap >= certified.margin(), "{gap}");
        assert!(proved || !accepted);
        if gap < verifier.tolerance() {
            assert!(matches!(verifier.check_motion(&a, &b), MotionCheck::Unproven { .. }));
        }
    }
}

#[test]
fn standing_still_bad_states_and_no_obstacles() {
    let space = se3();
    let robot = FreeFlyer::new(&robot(), clutter()).unwrap();
    let mut verifier = Verifier::new(&space, &robot).unwrap();
    let (hit, out) = (Isometry3::translation(1.0, 0.0, 0.0), Isometry3::translation(-1.8, -1.8, 1.8));
    assert_eq!(verifier.check_motion(&hit, &hit), MotionCheck::Collision { at: 0.0 });
    assert!(verifier.check_motion(&out, &out).is_free());
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(!verifier.check_motion(&out, &Isometry3::translation(x, 0.0, 0.0)).is_free());
    }
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Verifier::with_tolerance(&space, &robot, tolerance).is_err());
    }
    let alone = FreeFlyer::new(&crate::common::robot(), []).unwrap();
    let mut verifier = Verifier::new(&space, &alone).unwrap();
    let mut certified = Certified::new(&space, alone.clone(), alone.tolerance()).unwrap();
    for _ in 0..2 {
        assert!(verifier.check_motion(&hit, &out).is_free());
        assert!(certified.check_motion(&hit, &out).is_free());
    }
    assert!(!verifier.check_motion(&out, &Isometry3::translation(f64::NAN, 0.0, 0.0)).is_free());
}

/// The same far from the origin and at other scales: tolerances go with the robot.
#[test]
fn at_any_scale_and_place() {
    for (scale, offset) in [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e4), (1e-2, 1e3)] {
        let base = Vector3::repeat(offset);
        let scaled = |mesh: &mp_geom::TriMesh| {
            let vertices = mesh.vertices().iter().map(|p| p * scale).collect();
            mp_geom::TriMesh::new(vertices, mesh.triangles().to_vec()).unwrap()
        };
        let obstacles = clutter().into_iter().map(|(name, mesh, mut pose)| {
            pose.translation.vector = pose.translation.vector * scale + base;
            (name, scaled(&mesh), pose)
        });
        let body = FreeFlyer::new(&scaled(&robot()), obstacles).unwrap();
        let (low, high) = (base - Vector3::repeat(2.0 * scale), base + Vector3::repeat(2.0 * scale));
        let space = Se3::new(low, high).unwrap().with_rotation_weight(0.5 * scale).unwrap();
        assert!(space.distance(&Isometry3::from(base), &Isometry3::from(base)) == 0.0);
        agree(&space, &body, 150);
    }
}
