use super::*;
use mp_cspace::testkit::check_clearance_gradient;
use mp_cspace::{
    Certified, Clearance, KnownFree, MotionCheck, MotionValidity, Rn, Rng, Se2, Se2State, Space, Validity,
    obstacles::ObstacleHints,
};
use mp_geom::planar::Polygon;
use nalgebra::Vector2;
use rand::RngExt;
use std::sync::Arc;

/// Triangles and rectangles within walls of 4 × 3 m, some overlapping.
fn world(rng: &mut Rng, obstacles: usize) -> Arc<PlanarWorld> {
    let mut polygons = Vec::new();
    for _ in 0..obstacles {
        let (x, y) = (rng.random_range(0.0..4.0), rng.random_range(0.0..3.0));
        let mut near = || [x + rng.random_range(-0.4..0.4), y + rng.random_range(-0.4..0.4)];
        let ring = if polygons.len() % 2 == 0 {
            Polygon::outlined([near(), near(), near()])
        } else {
            Polygon::rectangle([x - 0.1, y - 0.2], [x + 0.1, y + 0.05])
        };
        polygons.push(ring.unwrap());
    }
    PlanarWorld::new(polygons, Some([[0.0, 0.0], [4.0, 3.0]])).unwrap().into()
}

#[test]
fn the_tolerance_of_a_polygon_far_from_its_origin_is_that_of_its_size() {
    let world = world(&mut Rng::seed(1), 3);
    let [near, far] = [0.0, 1000.0].map(|x| {
        let body = Polygon::rectangle([x - 0.1, -0.1], [x + 0.1, 0.1]).unwrap();
        PolygonRobot::new(Arc::clone(&world), body).tolerance()
    });
    assert!(near <= far && far < 3.0 * near, "{near} {far}");
}

/// The two checks of a disc agree with sampled configurations along the motion, and with each other except within the
/// tolerance.
#[test]
fn discs_pass_exactly_where_they_keep_clear() {
    let mut rng = Rng::seed(3);
    let space = Rn::<2>::new([0.0, 0.0], [4.0, 3.0]).unwrap();
    let (mut passed, mut failed) = (0, 0);
    for round in 0..60 {
        let world = world(&mut rng, round % 12);
        let radius = [0.0, 0.05, 0.2][round % 3];
        let mut robot = DiscRobot::new(Arc::clone(&world), radius).unwrap();
        let mut certified = Certified::new(&space, robot.clone(), 2.0 * robot.tolerance()).unwrap();
        let mut verifier = DiscVerifier::new(&robot);
        for _ in 0..100 {
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let b = a + (b - a) * rng.random_range(0.0..1.0);
            let (ours, theirs) = (robot.check_motion(&a, &b), verifier.check_motion(&a, &b));
            assert_eq!(certified.check_motion(&a, &b).is_free(), ours.is_free());
            // The motion that stays in place.
            let clearance = robot.signed_clearance(&a);
            match robot.check_motion(&a, &a) {
                MotionCheck::Free { .. } => assert!(clearance > robot.tolerance()),
                MotionCheck::Collision { .. } => assert!(clearance <= 0.0),
                MotionCheck::Unproven { .. } => assert!(clearance > 0.0 && clearance <= robot.tolerance()),
            }
            if robot.is_valid(&a) {
                let known = robot.check_extension(&a, &b, KnownFree::From);
                assert_eq!(known.is_free(), ours.is_free());
            }
            let places = (0..=200).map(|i| a + (b - a) * (f64::from(i) / 200.0));
            let sampled = places.map(|q| robot.signed_clearance(&q)).fold(f64::INFINITY, f64::min);
            match theirs {
                MotionCheck::Free { clearance } => {
                    passed += 1;
                    // Between two samples the distance is less by at most half a step.
                    assert!(
                        clearance <= sampled + 1e-12 && clearance >= sampled - (b - a).norm() / 400.0 - 1e-12
                    );
                    assert!(ours.is_free() || clearance < robot.tolerance());
                }
                MotionCheck::Collision { at } | MotionCheck::Unproven { at } => {
                    failed += 1;
                    assert!(!ours.is_free());
                    assert!(robot.signed_clearance(&(a + (b - a) * at)) < robot.tolerance());
                }
            }
        }
    }
    assert!(passed > 1000 && failed > 1000, "{passed} {failed}");
}

#[test]
fn polygons_pass_exactly_where_they_keep_clear() {
    let mut rng = Rng::seed(4);
    let space = Se2::new([0.0, 0.0], [4.0, 3.0]).unwrap();
    let bodies = [
        Polygon::rectangle([-0.3, -0.02], [0.3, 0.02]).unwrap(),
        Polygon::outlined([[0.0, 0.0], [0.3, 0.0], [0.3, 0.1], [0.1, 0.1], [0.1, 0.4], [0.0, 0.4]]).unwrap(),
    ];
    let (mut passed, mut failed, mut apart) = (0, 0, 0);
    for round in 0..40 {
        let robot = PolygonRobot::new(world(&mut rng, 1 + round % 8), bodies[round % 2].clone());
        let tolerance = robot.tolerance();
        let mut check = Certified::new(&space, robot.clone(), tolerance).unwrap();
        let mut verifier = PolygonVerifier::new(&space, &robot);
        let mut robot = robot;
        for _ in 0..40 {
            let (a, b) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
            let b = space.interpolate(&a, &b, rng.random_range(0.0..0.5));
            let (ours, theirs) = (check.check_motion(&a, &b), verifier.check_motion(&a, &b));
            let places = (0..=100).map(|i| space.interpolate(&a, &b, f64::from(i) / 100.0));
            let sampled = places.map(|q| robot.clearance(&q, f64::INFINITY)).fold(f64::INFINITY, f64::min);
            match theirs {
                MotionCheck::Free { clearance } => {
                    passed += 1;
                    assert!(clearance <= sampled + 1e-12 && clearance > 0.0);
                    apart += usize::from(!ours.is_free());
                }
                _ => {
                    failed += 1;
                    assert!(!ours.is_free() && sampled < 0.02, "{sampled} {theirs:?}");
                }
            }
        }
    }
    assert!(passed > 300 && failed > 300 && apart < 5, "{passed} {failed} {apart}");
}

/// Clearances change as their gradients say, and lead out of obstacles.
#[test]
fn gradients_are_those_of_the_clearance() {
    let mut rng = Rng::seed(5);
    let space = Se2::new([0.0, 0.0], [4.0, 3.0]).unwrap();
    let body = Polygon::outlined([[-0.1, -0.1], [0.4, 0.0], [-0.1, 0.1]]).unwrap();
    let (mut kinks, mut smooth, mut deep) = (0, 0, 0);
    for _ in 0..20 {
        let world = world(&mut rng, 5);
        let disc = DiscRobot::new(Arc::clone(&world), 0.05).unwrap();
        let robot = PolygonRobot::new(world, body.clone());
        for _ in 0..100 {
            let q = space.sample_uniform(&mut rng);
            let h = 1e-6;
            let (c, g) = disc.clearance_and_gradient(&q.translation);
            let at = |dx: f64, dy: f64| disc.signed_clearance(&(q.translation + Vector2::new(dx, dy)));
            let measured = Vector2::new(at(h, 0.0) - at(-h, 0.0), at(0.0, h) - at(0.0, -h)) / (2.0 * h);
            assert_eq!(c, disc.signed_clearance(&q.translation));
            if (measured - g).norm() < 1e-3 {
                smooth += 1
            } else {
                kinks += 1
            }

            let (c, g) = robot.clearance_and_gradient(&q);
            let moved = |i: usize, h: f64| {
                let mut v = [0.0; 3];
                v[i] = h;
                let to = Se2State::new(q.translation.x + v[0], q.translation.y + v[1], q.angle + v[2]);
                robot.clearance_and_gradient(&to).0
            };
            if g == [0.0; 3] {
                assert_eq!(c, 0.0);
                continue;
            }
            deep += usize::from(c < 0.0);
            assert_eq!(robot.clone().is_valid(&q), c > 0.0);
            let off = (0..3).map(|i| ((moved(i, h) - moved(i, -h)) / (2.0 * h) - g[i]).abs());
            if off.fold(0.0, f64::max) < 1e-3 { smooth += 1 } else { kinks += 1 }
        }
    }
    let world = world(&mut rng, 6);
    let mut robot = PolygonRobot::new(Arc::clone(&world), body);
    check_clearance_gradient(&space, &mut robot, 0.3, (500, 1e-6, 1e-4), 1);
    let mut disc = DiscRobot::new(world, 0.05).unwrap();
    check_clearance_gradient(space.translations(), &mut disc, 1.0, (500, 1e-6, 1e-4), 1);
    assert!(smooth > 3000 && kinks < smooth / 50 && deep > 100, "{smooth} {kinks} {deep}");
}

#[test]
fn one_within_the_other_is_collision() {
    let world = PlanarWorld::new(vec![Polygon::rectangle([1.0, 1.0], [2.0, 2.0]).unwrap()], None).unwrap();
    let world = Arc::new(world);
    let inside = Vector2::new(1.5, 1.5);
    let mut disc = DiscRobot::new(Arc::clone(&world), 0.1).unwrap();
    assert!(!disc.is_valid(&inside) && disc.touching(&inside) == Some(Some(0)));
    assert_eq!(disc.check_motion(&inside, &Vector2::new(1.6, 1.5)), MotionCheck::Collision { at: 0.0 });
    assert!(!DiscVerifier::new(&disc).check_motion(&inside, &inside).is_free());
    assert!(disc.touching(&Vector2::new(0.5, 0.5)).is_none() && disc.is_valid(&Vector2::new(0.5, 0.5)));
    let space = Se2::new([-5.0, -5.0], [5.0, 5.0]).unwrap();
    for side in [0.1, 3.0] {
        let mut robot =
            PolygonRobot::new(Arc::clone(&world), Polygon::rectangle([-side, -side], [side, side]).unwrap());
        let q = Se2State::new(1.5, 1.5, 0.3);
        assert!(!robot.is_valid(&q) && !PolygonVerifier::new(&space, &robot).check_motion(&q, &q).is_free());
        let far = Se2State::new(-4.0, -4.0, 0.3);
        assert!(
            robot.is_valid(&far) && PolygonVerifier::new(&space, &robot).check_motion(&far, &far).is_free()
        );
    }
}

#[test]
fn what_is_no_number_is_not_free() {
    let mut rng = Rng::seed(6);
    let world = world(&mut rng, 3);
    assert!([-1.0, f64::NAN, f64::INFINITY].iter().all(|r| DiscRobot::new(Arc::clone(&world), *r).is_err()));
    let mut disc = DiscRobot::new(Arc::clone(&world), 0.1).unwrap();
    let mut robot = PolygonRobot::new(world, Polygon::rectangle([0.0, 0.0], [0.1, 0.1]).unwrap());
    let space = Se2::new([0.0, 0.0], [4.0, 3.0]).unwrap();
    let mut certified = Certified::new(&space, robot.clone(), 1e-4).unwrap();
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let (q, p) = (Vector2::new(bad, 1.0), Vector2::new(1.0, 1.0));
        assert!(!disc.is_valid(&q) && !disc.check_motion(&p, &q).is_free());
        assert!(!disc.check_extension(&p, &q, KnownFree::From).is_free());
        assert!(!DiscVerifier::new(&disc).check_motion(&p, &q).is_free());
        let (q, p) = (Se2State { translation: q, angle: 0.0 }, Se2State { translation: p, angle: 0.0 });
        let turned = Se2State { translation: Vector2::new(1.0, 1.0), angle: f64::NAN };
        for q in [q, turned] {
            assert!(!robot.is_valid(&q) && !certified.check_motion(&p, &q).is_free());
            assert!(!PolygonVerifier::new(&space, &robot).check_motion(&p, &q).is_free());
        }
    }
}

/// Hints lead along the boundary that is hit.
#[test]
fn hints_lead_along_boundaries() {
    let mut rng = Rng::seed(7);
    let wall = Polygon::rectangle([1.0, 0.0], [1.2, 3.0]).unwrap();
    let world = Arc::new(PlanarWorld::new(vec![wall], None).unwrap());
    let mut disc = DiscRobot::new(Arc::clone(&world), 0.1).unwrap();
    let (from, toward, hit) = (Vector2::new(0.5, 1.0), Vector2::new(1.5, 1.0), Vector2::new(0.95, 1.0));
    assert!(disc.touches(&hit) && !disc.touches(&from));
    let ends: Vec<_> =
        (0..20).map(|_| disc.slide_along(&from, &toward, Some(&hit), &mut rng).unwrap()).collect();
    assert!(ends.iter().all(|q| (q.x - 0.5).abs() < 1e-12 && ((q.y - 1.0).abs() - 1.0).abs() < 1e-12));
    assert!(ends.iter().any(|q| q.y > 1.0) && ends.iter().any(|q| q.y < 1.0));
    assert!(
        disc.slide_along(&from, &toward, None, &mut rng)
            .is_some_and(|q| ((q - from).norm() - 1.0).abs() < 1e-12)
    );
    let mut rod = PolygonRobot::new(world, Polygon::rectangle([-0.2, -0.05], [0.2, 0.05]).unwrap());
    let [a, b, c] = [0.5, 1.5, 0.85].map(|x| Se2State::new(x, 1.0, 0.3));
    let moved = rod.slide_along(&a, &b, Some(&c), &mut rng).unwrap();
    assert!(rod.touches(&c) && (moved.translation.x - 0.5).abs() < 1e-12 && moved.angle == 0.3);
    assert_eq!(rod.moved_by(&a, &b, &c).angle, 0.3);
}
