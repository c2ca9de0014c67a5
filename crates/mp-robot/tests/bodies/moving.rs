//! Robots among moving obstacles: checks, bounds and the verifier against dense sampling.

use crate::common::{clutter, robot};
use mp_cspace::{
    Certified, Clearance, MotionCheck, MotionClearance, MotionValidity, Rng, Se2, Se2State, Se3, Space,
    Validity,
    space_time::{ForwardInTime, SpaceTime},
};
use mp_geom::planar::{PlanarWorld, Polygon};
use mp_geom::{TriMesh, pose_from_six, primitives};
use mp_robot::{
    AmongMoving, AmongMovingAreas, DiscRobot, FreeFlyer, MovingVerifier, PlanarFlyer, Trajectory,
    TrajectoryError,
};
use nalgebra::{Isometry3, Point3, Vector2};

fn there_and_back() -> Trajectory {
    Trajectory::new([
        (1.0, pose_from_six([-1.5, 0.5, 0.0, 0.0, 0.0, 0.0])),
        (3.0, pose_from_six([1.5, -0.5, 0.2, 2.0, 0.5, 0.0])),
        (4.0, pose_from_six([1.5, 0.5, -0.2, 2.0, -1.0, 0.3])),
    ])
    .unwrap()
}

fn moving_bodies() -> Vec<(String, TriMesh, Trajectory)> {
    let circling = (0..=8).map(|i| {
        let a = f64::from(i) * 0.7;
        (0.6 * f64::from(i), pose_from_six([mp_math::cos(a), mp_math::sin(a), 0.1, a, 0.0, 0.0]))
    });
    vec![
        ("drone".to_owned(), primitives::cuboid(0.5, 0.3, 0.2).unwrap(), there_and_back()),
        ("blade".to_owned(), primitives::cuboid(1e-3, 0.6, 0.8).unwrap(), Trajectory::new(circling).unwrap()),
    ]
}

#[test]
fn trajectories_pass_their_poses_and_bound_their_speed() {
    let trajectory = there_and_back();
    let at = |t: f64| trajectory.pose(t);
    assert_eq!(
        (at(-5.0), at(1.0), at(3.0), at(4.0), at(99.0)),
        (at(0.5), at(0.0), at(3.0), at(5.0), at(4.0))
    );
    assert!((at(2.0).translation.vector.x).abs() < 1e-15);
    // Between, no point of the body is faster than the bound, over any stretch.
    let body = primitives::cuboid(0.5, 0.3, 0.2).unwrap();
    let radius = body.radius_about(&Point3::origin());
    for (begin, end) in [(0.0, 0.9), (0.0, 1.5), (1.2, 2.9), (2.5, 3.5), (3.1, 9.0), (4.5, 9.0)] {
        let bound = trajectory.speed(radius, begin, end);
        assert_eq!(bound, trajectory.speed(radius, end, begin));
        let mut fastest = 0.0_f64;
        for i in 0..400 {
            let [a, b] = [i, i + 1].map(|i| begin + (end - begin) * f64::from(i) / 400.0);
            for p in body.vertices() {
                fastest = fastest.max((at(a) * p - at(b) * p).norm() / (b - a));
            }
        }
        assert!(fastest <= bound * (1.0 + 1e-9), "{fastest} {bound}");
        assert!(fastest > 0.4 * bound || bound == 0.0);
    }
    assert_eq!(Trajectory::new([]), Err(TrajectoryError::Empty));
    let here = Isometry3::identity();
    let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert_eq!(Trajectory::new([(0.0, here), (1.0, nan)]), Err(TrajectoryError::NotAPose { index: 1 }));
    assert_eq!(Trajectory::new([(f64::INFINITY, here)]), Err(TrajectoryError::NotAPose { index: 0 }));
    let stuck = Trajectory::new([(1.0, here), (1.0, here)]);
    assert_eq!(stuck, Err(TrajectoryError::NotAfter { index: 1, time: 1.0 }));
}

/// Where what moves is at no time is not known, and neither is whether the robot is free.
#[test]
fn nothing_is_free_at_a_time_that_is_no_number() {
    let body = FreeFlyer::new(&robot(), clutter()).unwrap();
    let mut among = AmongMoving::new(body.clone(), moving_bodies()).unwrap();
    let far = Isometry3::translation(9.0, 9.0, 9.0);
    assert!(among.is_valid(&(far, f64::INFINITY)) && among.clearance(&(far, 2.0), 1.0) > 0.0);
    assert!(!among.is_valid(&(far, f64::NAN)));
    assert_eq!(among.clearance(&(far, f64::NAN), 1.0), 0.0);
    // The same for a clearance that is no number.
    assert!(!body.clone().keeping(f64::NAN).is_valid(&far) && body.keeping(-1.0).is_valid(&far));
    let world = PlanarWorld::new(vec![Polygon::rectangle([0.0; 2], [1.0; 2]).unwrap()], None).unwrap();
    let disc = DiscRobot::new(world, 0.1).unwrap();
    let path = Trajectory::new([(0.0, Isometry3::identity())]).unwrap();
    let area = Polygon::rectangle([-1.0; 2], [0.0; 2]).unwrap();
    let mut areas = AmongMovingAreas::new(disc.clone(), [(area, path)]).unwrap();
    assert!(
        areas.is_valid(&(Vector2::new(5.0, 5.0), 0.0))
            && !areas.is_valid(&(Vector2::new(5.0, 5.0), f64::NAN))
    );
    assert!(!disc.keeping(f64::NAN).is_valid(&Vector2::new(5.0, 5.0)));
}

/// Inside of a solid that moves along with the robot, or around one: in collision all along. Inside of a surface: free.
#[test]
fn what_moves_may_be_solid() {
    let positions = Se3::new([-2.0; 3], [2.0; 3]).unwrap();
    let space = SpaceTime::new(positions, 5.0, 4.0).unwrap();
    let at = |x: f64| pose_from_six([x, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let (cube, ball) = (primitives::cuboid(1.5, 1.5, 1.5).unwrap(), primitives::sphere(0.2, 2).unwrap());
    let (from, to) = ((at(-1.0), 1.0), (at(1.0), 3.0));
    for (around, free) in [(cube.clone(), false), (cube.into_surface(), true)] {
        for (robot, mover) in [(&ball, &around), (&around, &ball)] {
            let path = Trajectory::new([(1.0, at(-1.1)), (3.0, at(0.9))]).unwrap();
            let body = FreeFlyer::new(robot, []).unwrap();
            let mut among = AmongMoving::new(body, [("it".to_owned(), mover.clone(), path)]).unwrap();
            assert_eq!((among.is_valid(&from), among.clearance(&to, 1.0) > 0.0), (free, free));
            assert_eq!(among.touching(&from).len(), usize::from(!free));
            let mut verifier = MovingVerifier::new(&space, &among).unwrap();
            assert_eq!(verifier.check_state(&from, 1.0).is_free(), free);
            assert_eq!(verifier.check_motion(&from, &to).is_free(), free);
            let certified = Certified::new(&space, among, 1e-3).unwrap();
            let mut check = ForwardInTime { space: &space, check: certified };
            assert_eq!(check.check_motion(&from, &to).is_free(), free);
        }
    }
}

#[test]
fn checks_and_verifier_agree_with_dense_sampling() {
    let positions = Se3::new([-2.0; 3], [2.0; 3]).unwrap();
    let space = SpaceTime::new(positions, 5.0, 4.0).unwrap();
    let body = FreeFlyer::new(&robot(), clutter()).unwrap();
    let tolerance = 1e-3;
    let mut among = AmongMoving::new(body, moving_bodies()).unwrap();
    let mut verifier = MovingVerifier::new(&space, &among).unwrap();
    let certified = Certified::new(&space, among.clone(), tolerance).unwrap();
    let mut check = ForwardInTime { space: &space, check: certified };
    let mut rng = Rng::seed(11);
    let (mut free, mut hit, mut by_moving) = (0, 0, 0);
    while free < 60 || hit < 60 {
        let from = space.sample_uniform(&mut rng);
        let to = space.interpolate(&from, &space.sample_uniform(&mut rng), 0.4);
        if !space.can_move(&from, &to) {
            assert!(
                !check.check_motion(&from, &to).is_free() && !verifier.check_motion(&from, &to).is_free()
            );
            continue;
        }
        let found = check.check_motion(&from, &to);
        let verified = verifier.check_motion(&from, &to);
        let mut least = f64::INFINITY;
        for i in 0..=300 {
            let q = space.interpolate(&from, &to, f64::from(i) / 300.0);
            least = least.min(among.clearance(&q, f64::INFINITY));
            assert_eq!(among.is_valid(&q), among.clearance(&q, 1e-3) > 0.0);
        }
        let slack = among.motion_bound(&from, &to) / 600.0;
        match found {
            MotionCheck::Free { clearance } => {
                assert!(clearance <= least + 1e-9 && least >= tolerance / 2.0 - 1e-9);
                assert!(verified.is_free(), "{verified:?}: what is certified must be verified");
                free += 1;
            }
            _ => {
                assert!(least < tolerance + slack, "{least}");
                hit += 1;
                by_moving += u32::from(
                    verified != MotionCheck::Unproven { at: 0.0 }
                        && among.body().clone().clearance(&from.0, 1.0) > 0.0,
                );
            }
        }
        if let MotionCheck::Free { clearance } = verified {
            assert!(clearance <= least + 1e-9);
        }
    }
    assert!(by_moving > 5 && among.counters().collision_checks > 0);
}

/// A wall of a hundredth of a millimetre comes the other way: whoever moves, they meet.
#[test]
fn thin_moving_walls_are_never_passed() {
    let positions = Se2::new([-3.0; 2], [3.0; 2]).unwrap();
    let space = SpaceTime::new(positions, 10.0, 10.0).unwrap();
    let sweep = Trajectory::new([
        (0.0, Isometry3::translation(2.5, 0.0, 0.0)),
        (1.0, Isometry3::translation(-2.5, 0.0, 0.0)),
    ]);
    let wall = ("wall".to_owned(), primitives::cuboid(1e-5, 9.0, 1.0).unwrap(), sweep.unwrap());
    let body = PlanarFlyer::new(&primitives::cuboid(0.2, 0.2, 0.2).unwrap(), []).unwrap();
    let among = AmongMoving::new(body, [wall]).unwrap();
    let mut verifier = MovingVerifier::new(&space, &among).unwrap();
    let mut check = Certified::new(&space, among, 1e-4).unwrap();
    let at = |x: f64, t: f64| (Se2State::new(x, 0.0, 0.0), t);
    for (from, to) in
        [(at(-2.0, 0.0), at(2.0, 1.0)), (at(0.0, 0.0), at(0.0, 1.0)), (at(-2.0, 0.2), at(-2.0, 3.0))]
    {
        assert!(!check.check_motion(&from, &to).is_free());
        assert!(!verifier.check_motion(&from, &to).is_free());
    }
    for (from, to) in
        [(at(-2.0, 0.0), at(-2.0, 0.8)), (at(0.0, 0.55), at(2.0, 5.0)), (at(2.8, 0.0), at(2.8, 9.0))]
    {
        assert!(check.check_motion(&from, &to).is_free());
        assert!(verifier.check_motion(&from, &to).is_free());
    }
}
