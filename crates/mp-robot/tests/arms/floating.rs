//! Robots whose base floats.

use crate::common::{clutter, random_tree, six};
use crate::motions::least_clearances_agree;
use crate::verifier::agree;
use mp_cspace::obstacles::{ClearanceGradient, ObstacleHints};
use mp_cspace::{Clearance, Configuration, FloatingJoints, MotionClearance, Rng, Space, Validity};
use mp_geom::{Aabb, primitives::cuboid};
use mp_robot::{Arm, ArmError, ArmModel, Joint, JointKind, Link};
use nalgebra::{Isometry3, Point3, Vector3};

fn bounds() -> Aabb {
    Aabb::new(Point3::new(-1.5, -1.5, -1.0), Point3::new(1.5, 1.5, 1.5))
}

/// Six joints on a base that floats.
fn flying() -> ArmModel {
    ArmModel { floating: Some(bounds()), ..six() }
}

/// Certified motions are free when sampled, and the verifier, which has its own kinematics and its own bounds, proves them.
#[test]
fn certified_motions_are_verified_and_free_when_sampled() {
    let arm = Arm::new(&flying(), clutter()).unwrap();
    let counts = agree(&arm, &arm.floating_space().unwrap(), 200);
    assert!(counts.into_iter().all(|n| n > 20), "{counts:?}");
    let mut rng = Rng::seed(9);
    let mut sum = [0, 0];
    for count in 4..10 {
        let model = ArmModel { floating: Some(bounds()), ..random_tree(&mut rng, count) };
        let Ok(arm) = Arm::new(&model, clutter()) else { continue };
        let counts = agree(&arm, &arm.floating_space().unwrap(), 30);
        sum = [sum[0] + counts[0], sum[1] + counts[1]];
    }
    assert!(sum.into_iter().all(|n| n > 10), "{sum:?}");
}

#[test]
fn the_least_clearance_link_by_link_is_that_of_the_whole() {
    let arm = Arm::new(&flying(), clutter()).unwrap();
    let counts = least_clearances_agree(&arm, &arm.floating_space().unwrap(), 60);
    assert!(counts.into_iter().all(|n| n > 10), "{counts:?}");
}

/// With its base held at a pose, a robot that floats is the arm that stands there, except that its base can collide.
#[test]
fn at_rest_it_is_the_arm_that_stands_there() {
    let mut rng = Rng::seed(4);
    let mut flying = Arm::new(&flying(), clutter()).unwrap();
    let space = flying.floating_space().unwrap();
    assert_eq!((flying.dof(), space.dim(), flying.kinematics().floats()), (12, 12, true));
    let mut seen = [0, 0];
    for _ in 0..100 {
        let (q, to) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        let (base, joints) = FloatingJoints::split(q.as_slice()).unwrap();
        let (_, joints_to) = FloatingJoints::split(to.as_slice()).unwrap();
        let mut standing = Arm::new(&ArmModel { base, ..six() }, clutter()).unwrap();
        let still = Configuration::from(joints);
        let poses = standing.kinematics().link_poses(joints).unwrap();
        assert_eq!(flying.kinematics().link_poses(q.as_slice()).unwrap(), poses);
        let ground = cuboid(0.2, 0.2, 0.1).unwrap().transformed(&Isometry3::translation(0.0, 0.0, 0.05));
        let mut foot = mp_robot::FreeFlyer::new(&ground, clutter()).unwrap();
        let least = standing.clearance(&still, 1e9).min(foot.clearance(&base, 1e9));
        assert!((flying.clearance(&q, 1e9) - least).abs() < 1e-9);
        let free = flying.is_valid(&q);
        assert_eq!(free, standing.is_valid(&still) && foot.is_valid(&base));
        seen[usize::from(free)] += 1;
        // Only the joints move.
        let moved = space.state(&base, joints_to);
        let same = Configuration::from(joints_to);
        assert!((flying.motion_bound(&q, &moved) - standing.motion_bound(&still, &same)).abs() < 1e-9);
        let contacts = flying.explain(q.as_slice());
        assert_eq!(contacts.is_empty(), free, "{contacts:?}");
    }
    assert!(seen.into_iter().all(|n| n > 5), "{seen:?}");
}

#[test]
fn it_finds_free_configurations_gradients_and_carries_motions() {
    let mut rng = Rng::seed(5);
    let mut arm = Arm::new(&flying(), clutter()).unwrap();
    let space = arm.floating_space().unwrap();
    let (mut found, mut sloped, mut near) = (0, 0, 0);
    for _ in 0..100 {
        let q = space.sample_uniform(&mut rng);
        let free = arm.nearest_free(&q, &space, arm.tolerance());
        found += usize::from(free.as_ref().is_some_and(|p| space.contains(p) && arm.is_valid(p)));
        // A step along the gradient gains as much clearance as the gradient says.
        let mut gradient = [0.0; 12];
        let here = arm.clearance_gradient(&q, 0.3, &mut gradient);
        let steep = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        if here > 0.01 && steep > 0.1 {
            let step = 1e-6;
            let there = space.moved(&q, &gradient.map(|g| g / steep * step), 1.0).unwrap();
            let gained = (arm.clearance(&there, 1e9) - here) / step;
            near += 1;
            sloped += usize::from((gained - steep).abs() < 1e-2 * steep);
        }
        let (from, to) = (space.sample_uniform(&mut rng), space.sample_uniform(&mut rng));
        let carried = arm.moved_by(&from, &from, &to);
        assert!(space.distance(&carried, &to) < 1e-9);
    }
    // Where the nearest point changes there is no gradient.
    assert!(found > 95 && near > 8 && 10 * sloped > 7 * near, "{found} {sloped} {near}");
}

#[test]
fn what_cannot_be_is_an_error() {
    let arm = |model: &ArmModel| Arm::new(model, []).map(drop);
    let mut named = flying();
    named.joints[2].name = "alpha".to_owned();
    let error = arm(&named).unwrap_err();
    assert!(matches!(&error, ArmError::BaseName { joint, .. } if joint == "alpha"));
    assert!(error.to_string().contains("give the joint another name"), "{error}");
    // On a base that stands still the name is free.
    assert!(arm(&ArmModel { floating: None, ..named }).is_ok());
    let box_of = |low: f64, high: f64| Aabb { min: [low; 3].into(), max: [high; 3].into() };
    for bounds in [box_of(1.0, 1.0), box_of(0.0, f64::NAN), box_of(-1e300, 1e300)] {
        assert!(arm(&ArmModel { floating: Some(bounds), ..six() }).is_err(), "{bounds:?}");
    }
    let (flying, standing) = (Arm::new(&flying(), []).unwrap(), Arm::new(&six(), []).unwrap());
    assert!(matches!(flying.space::<Configuration>(), Err(ArmError::Floats)));
    assert!(matches!(standing.floating_space(), Err(ArmError::StandsStill)));
    // Lists that are no configurations.
    let space = flying.floating_space().unwrap();
    let mut checker = flying.clone();
    let mut q = space.state(&Isometry3::identity(), &[0.0; 6]);
    assert!(checker.is_valid(&q));
    q[6] = 0.9;
    assert!(!checker.is_valid(&q) && checker.clearance(&q, 1.0) == 0.0);
    assert!(flying.kinematics().link_poses(&[0.0; 6]).is_none());
    let slide = Joint::new("slide", "a", "b", JointKind::Prismatic { low: 0.0, high: 0.1 });
    let two = ArmModel {
        links: vec![Link::new("a"), Link::new("b")],
        joints: vec![slide.axis(Vector3::y())],
        floating: Some(bounds()),
        ..ArmModel::default()
    };
    assert_eq!(Arm::new(&two, []).unwrap().dof(), 7);
}
