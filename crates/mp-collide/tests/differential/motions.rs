//! Batches of poses and whole motions, against single poses.

use mp_collide::{CollisionMesh, IntervalCheck, Isa, Query, RigidMotion};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use rand::RngExt;

use crate::common::{Pcg64, bumpy, cuboid, point, pose, rng, rotation, soup};

/// Pairs of all kinds: round, edged, thin, small beside large, far from their origins, a point.
fn pair(rng: &mut Pcg64, kind: usize) -> (TriMesh, TriMesh) {
    match kind % 6 {
        0 => (bumpy(12, 0.5, 0.2), bumpy(10, 0.6, 0.1)),
        1 => (cuboid(Vector3::new(1.0, 0.05, 0.02)), soup(rng, 60, 1.5, 0.3)),
        2 => (soup(rng, 20, 0.3, 0.3), bumpy(20, 1.0, 0.4)),
        3 => (
            bumpy(5, 0.3, 0.0).transformed(&Isometry3::translation(3.0, 1.0, 0.0)),
            cuboid(Vector3::new(2.0, 2.0, 1e-6)),
        ),
        4 => (soup(rng, 1, 1e-9, 1e-12), soup(rng, 30, 1.0, 1.0)),
        _ => (cuboid(Vector3::new(0.2, 0.2, 0.2)), cuboid(Vector3::new(5.0, 5.0, 1e-9))),
    }
}

/// A row of poses near the origin: along a straight motion, bent, in another order, or anywhere.
fn row(rng: &mut Pcg64, n: usize) -> Vec<Isometry3<f64>> {
    let from = pose(rng, 1.5);
    let step = mp_math::powf(10.0, rng.random_range(-8.0..-0.3));
    let along = point(rng, step).coords;
    let turn = if rng.random_range(0..4) == 0 { Vector3::zeros() } else { point(rng, step).coords };
    let at = |t: f64| {
        let turned = UnitQuaternion::from_scaled_axis(turn * t) * from.rotation;
        Isometry3::from_parts(Translation3::from(from.translation.vector + along * t), turned)
    };
    let mut poses: Vec<_> = (0..n).map(|i| at(i as f64)).collect();
    match rng.random_range(0..6) {
        // Bent.
        0 => {
            let bend = point(rng, 0.1 * step).coords;
            for (i, p) in poses.iter_mut().enumerate() {
                p.translation.vector += bend * (i * i) as f64;
            }
        }
        // As planners test them: far apart first.
        1 => poses.sort_by_key(|p| p.translation.vector.x.to_bits().reverse_bits()),
        // Quaternions that are not quite of unit length, and of either sign.
        2 => {
            for p in &mut poses {
                let by = (1.0 + rng.random_range(-4e-7..4e-7)) * f64::from(rng.random_range(0..2) * 2 - 1);
                p.rotation = Unit::new_unchecked(Quaternion::from(p.rotation.coords * by));
            }
        }
        // With a jump.
        3 if n > 2 => poses[n / 2] = pose(rng, 1.5),
        _ => {}
    }
    poses
}

#[test]
fn batches_answer_as_single_poses_do() {
    let mut rng = rng(41);
    let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
    let (mut hits, mut later) = (0, 0);
    for kind in 0..30 {
        let (a, b) = pair(&mut rng, kind);
        let (a, b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        for _ in 0..60 {
            let n = rng.random_range(1..150);
            let poses = row(&mut rng, n);
            let here = if kind % 2 == 0 { Isometry3::identity() } else { pose(&mut rng, 0.5) };
            let expected = poses.iter().position(|p| queries[0].intersects(&a, p, &b, &here));
            for query in &mut queries {
                query.counters.queries = 0;
                assert_eq!(query.first_collision(&a, &poses, &b, &here), expected, "{kind}");
                assert_eq!(query.counters.queries as usize, expected.map_or(n, |i| i + 1));
            }
            hits += u32::from(expected.is_some());
            later += u32::from(expected.is_some_and(|i| i > 0));
        }
    }
    assert!(hits > 300 && later > 100, "{hits} {later}");
}

/// Poses bisected to the last place around contact: the first that touches, and none before.
#[test]
fn batches_are_exact_at_contact() {
    let mut rng = rng(42);
    let mut query = Query::default();
    let (a, b) = (CollisionMesh::new(&bumpy(9, 0.5, 0.2)), CollisionMesh::new(&bumpy(8, 0.7, 0.1)));
    let here = Isometry3::identity();
    for _ in 0..200 {
        let turn = rotation(&mut rng);
        let to = point(&mut rng, 1.0).coords.normalize();
        let at = |r: f64| Isometry3::from_parts(Translation3::from(to * r), turn);
        let (mut near, mut far) = (0.6, 2.0);
        if !query.intersects(&a, &at(near), &b, &here) {
            continue;
        }
        while far - near > 1e-15 * far {
            let middle = 0.5 * (near + far);
            if middle == near || middle == far {
                break;
            }
            if query.intersects(&a, &at(middle), &b, &here) { near = middle } else { far = middle }
        }
        let step = mp_math::powf(10.0, rng.random_range(-15.5..-2.0));
        let poses: Vec<_> = (0..40).map(|i| at(near + step * f64::from(30 - i))).collect();
        let expected = poses.iter().position(|p| query.intersects(&a, p, &b, &here));
        assert!(expected.is_some());
        assert_eq!(query.first_collision(&a, &poses, &b, &here), expected);
    }
}

/// An interval of a motion and the pose at `t` in [−1, 1].
fn interval(rng: &mut Pcg64, radius: f64) -> (Isometry3<f64>, RigidMotion) {
    let size = mp_math::powf(10.0, rng.random_range(-6.0..0.0));
    let mut part = || if rng.random_range(0..4) == 0 { Vector3::zeros() } else { point(rng, size).coords };
    let motion = RigidMotion::new(part(), part(), radius);
    (pose(rng, 1.8), motion)
}

fn along(middle: &Isometry3<f64>, motion: &RigidMotion, t: f64) -> Isometry3<f64> {
    let turned = UnitQuaternion::from_scaled_axis(motion.turn * t) * middle.rotation;
    Isometry3::from_parts(Translation3::from(middle.translation.vector + motion.shift * t), turned)
}

#[test]
fn what_is_clear_stays_clear_and_wide_room_is_found_clear() {
    let mut rng = rng(43);
    let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
    let (mut clear, mut beyond, mut contact, mut tight) = (0, 0, 0, 0);
    for kind in 0..24 {
        let (a, b) = pair(&mut rng, kind);
        let (a, b) = (CollisionMesh::new(&a), CollisionMesh::new(&b));
        for _ in 0..30 {
            let (middle, motion) = interval(&mut rng, a.radius());
            let here = if kind % 2 == 0 { Isometry3::identity() } else { pose(&mut rng, 0.5) };
            let margin = mp_math::powf(10.0, rng.random_range(-9.0..-1.0));
            let answers: Vec<IntervalCheck> = queries
                .iter_mut()
                .map(|q| q.check_interval(&a, &middle, &motion, &b, &here, margin))
                .collect();
            assert!(answers.iter().all(|x| *x == answers[0]), "{kind} {answers:?}");
            let query = &mut queries[0];
            let mut room_at = |at: f64| {
                assert!(at.abs() <= 1.0);
                query.clearance(&a, &along(&middle, &motion, at), &b, &here, f64::INFINITY)
            };
            match answers[0] {
                // Poses are equal to rounding.
                IntervalCheck::Collision { at } => {
                    assert!(room_at(at) < 1e-12, "{kind} {at}");
                    contact += 1;
                }
                IntervalCheck::TooClose { at } => {
                    assert!(room_at(at) < margin + 1e-12, "{kind} {at}");
                    tight += 1;
                }
                IntervalCheck::Free | IntervalCheck::Unproven => {}
            }
            let room = query.clearance(&a, &middle, &b, &here, f64::INFINITY);
            if room >= (motion.most + margin) * (1.0 + 1e-9) + 1e-12 {
                assert!(answers[0].is_free(), "{kind} {room} {margin} {motion:?}");
            }
            if answers[0].is_free() {
                clear += 1;
                beyond += u32::from(room < motion.most + margin);
                for i in -32..=32 {
                    let at = along(&middle, &motion, f64::from(i) / 32.0);
                    let clearance = query.clearance(&a, &at, &b, &here, 2.0 * margin);
                    assert!(clearance >= margin - 1e-13, "{kind} {clearance} {margin} at {i}");
                }
            }
        }
    }
    assert!(clear > 300 && beyond > 8, "{clear} {beyond}");
    assert!(contact > 30 && tight > 10, "{contact} {tight}");
}

/// What slides along a wall does not come nearer to it, however far it goes.
#[test]
fn sliding_past_is_clear_to_the_margin() {
    let mut rng = rng(45);
    let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
    let (wall, here) = (CollisionMesh::new(&cuboid(Vector3::new(1.0, 9.0, 9.0))), pose(&mut rng, 1.0));
    let shapes = [bumpy(6, 0.3, 0.2), cuboid(Vector3::new(0.4, 0.1, 0.2)), soup(&mut rng, 30, 0.3, 0.2)];
    let mut placed = 0;
    for round in 0..90 {
        let a = CollisionMesh::new(&shapes[round % 3]);
        let margin = mp_math::powf(10.0, rng.random_range(-3.0..-1.0));
        let along = Vector3::new(0.0, rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0));
        let place = Vector3::new(3.0, along.y, along.z);
        let motion = RigidMotion::new(here.rotation * along, Vector3::zeros(), a.radius());
        let mut at = here * Isometry3::from_parts(Translation3::from(place), rotation(&mut rng));
        let room = queries[0].clearance(&a, &at, &wall, &here, f64::INFINITY);
        for (part, clear) in [(1.01, true), (0.99, false)] {
            let nearer = here.rotation * Vector3::x() * (room - part * margin);
            let mut at = at;
            at.translation.vector -= nearer;
            for query in &mut queries {
                let found = query.check_interval(&a, &at, &motion, &wall, &here, margin);
                assert_eq!(found.is_free(), clear, "{round} {part} {margin} {found:?}");
            }
        }
        // As far as the wall, and into it.
        at.translation.vector -= here.rotation * Vector3::x() * (room + 1e-9);
        let found = queries[0].check_interval(&a, &at, &motion, &wall, &here, margin);
        assert!(!found.is_free(), "{round}");
        placed += u32::from(found != IntervalCheck::Unproven);
    }
    assert!(placed > 60, "{placed}");
}

/// Walls down to 1e-12 thick, and sheets without any thickness, are never passed.
#[test]
fn no_wall_is_too_thin() {
    let mut rng = rng(44);
    let mut query = Query::default();
    let a = CollisionMesh::new(&bumpy(6, 0.1, 0.2));
    let here = Isometry3::identity();
    for exponent in 1..=13 {
        let thickness = if exponent == 13 { 0.0 } else { mp_math::powi(0.1, exponent) };
        let b = CollisionMesh::new(&cuboid(Vector3::new(0.5 * thickness, 3.0, 3.0)));
        for _ in 0..200 {
            let (mut middle, motion) = interval(&mut rng, a.radius());
            // Somewhere in the interval the origin is in the wall.
            middle.translation.vector.x = motion.shift.x * rng.random_range(-1.0..1.0);
            assert!(!query.check_interval(&a, &middle, &motion, &b, &here, 0.0).is_free(), "{exponent}");
        }
    }
}

#[test]
fn bad_stretches_are_not_clear() {
    let mesh = CollisionMesh::new(&cuboid(Vector3::new(0.1, 0.1, 0.1)));
    let (here, far) = (Isometry3::identity(), Isometry3::translation(9.0, 0.0, 0.0));
    let mut query = Query::default();
    let mut clear = |middle, motion: RigidMotion, margin| {
        query.check_interval(&mesh, &middle, &motion, &mesh, &here, margin).is_free()
    };
    let still = RigidMotion::new(Vector3::zeros(), Vector3::zeros(), 1.0);
    assert!(clear(far, still, 1.0) && clear(far, still, -1.0) && !clear(here, still, 0.0));
    for x in [f64::NAN, f64::INFINITY, 1e300] {
        assert!(!clear(far, RigidMotion { shift: Vector3::new(x, 0.0, 0.0), ..still }, 0.0));
        assert!(!clear(far, RigidMotion { turn: Vector3::new(0.0, x, 0.0), ..still }, 0.0));
        assert!(!clear(far, RigidMotion { most: x, ..still }, 0.0) && !clear(far, still, x));
        assert!(!clear(Isometry3::translation(0.0, 0.0, x), still, 0.0));
    }
}
