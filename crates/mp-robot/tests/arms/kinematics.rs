//! Where links are, and what coordinates there are.

use crate::common::{matrix, random_tree, six};
use mp_cspace::{Configuration, JointRange, Joints, Rng, Space};
use mp_geom::primitives::cuboid;
use mp_robot::{Arm, ArmModel, Joint, JointKind, Kinematics, Link};
use nalgebra::{Isometry3, Point3, SVector, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

fn bar(kind: JointKind) -> ArmModel {
    let at = Isometry3::translation(1.0, 0.0, 0.0);
    ArmModel {
        links: vec![Link::new("base"), Link::new("upper"), Link::new("lower"), Link::new("hand")],
        joints: vec![
            Joint::new("shoulder", "base", "upper", kind).axis(Vector3::z()),
            Joint::new("elbow", "upper", "lower", kind).axis(Vector3::z()).at(at),
            Joint::new("flange", "lower", "hand", JointKind::Fixed).at(at),
        ],
        base: Isometry3::translation(0.0, 0.0, 0.5),
        ..ArmModel::default()
    }
}

#[test]
fn poses_known_by_hand() {
    let model = bar(JointKind::Revolute { low: -3.0, high: 3.0 });
    let kinematics = Kinematics::new(&model).unwrap();
    let at = |q: [f64; 2]| {
        let poses = kinematics.link_poses(&q).unwrap();
        poses.iter().map(|pose| Point3::from(pose.translation.vector)).collect::<Vec<_>>()
    };
    for (q, elbow, hand) in [
        ([0.0, 0.0], [1.0, 0.0], [2.0, 0.0]),
        ([FRAC_PI_2, 0.0], [0.0, 1.0], [0.0, 2.0]),
        ([FRAC_PI_2, -FRAC_PI_2], [0.0, 1.0], [1.0, 1.0]),
        ([0.0, FRAC_PI_2], [1.0, 0.0], [1.0, 1.0]),
    ] {
        let points = at(q);
        assert!((points[2] - Point3::new(elbow[0], elbow[1], 0.5)).norm() < 1e-15);
        assert!((points[3] - Point3::new(hand[0], hand[1], 0.5)).norm() < 1e-15);
    }
    // A slide of 0.25 m along Y after a quarter turn about Z goes along -X.
    let mut model = model;
    model.joints[1].kind = JointKind::Prismatic { low: 0.0, high: 1.0 };
    model.joints[1].axis = Vector3::new(0.0, 3.0, 0.0);
    let poses = Kinematics::new(&model).unwrap().link_poses(&[FRAC_PI_2, 0.25]).unwrap();
    assert!((poses[2].translation.vector - Vector3::new(-0.25, 1.0, 0.5)).norm() < 1e-15);
    for bad in [&[0.0][..], &[0.0, f64::NAN], &[0.0; 3]] {
        assert_eq!(kinematics.link_poses(bad), None);
    }
}

#[test]
fn poses_agree_with_matrices() {
    let mut rng = Rng::seed(2);
    let mut joints = 0;
    for count in (2..30).chain([60]) {
        let model = random_tree(&mut rng, count);
        let Ok(kinematics) = Kinematics::new(&model) else { continue };
        let space: Joints<Configuration> = kinematics.space().unwrap();
        for _ in 0..5 {
            let q = space.sample_uniform(&mut rng);
            let value = |name: &str| q[kinematics.coordinates().iter().position(|c| c.name == name).unwrap()];
            let poses = kinematics.link_poses(q.as_slice()).unwrap();
            for (link, pose) in kinematics.links().zip(&poses) {
                let expected = matrix(&model, &value, link);
                assert!((pose.to_homogeneous() - expected).amax() < 1e-13 * count as f64, "{link}");
                joints += 1;
            }
        }
    }
    assert!(joints > 2000);
}

#[test]
fn a_deep_chain_stays_rigid() {
    let mut model = ArmModel { links: vec![Link::new("0")], ..ArmModel::default() };
    for i in 1..=1000 {
        model.links.push(Link::new(i.to_string()));
        let joint = Joint::new(format!("j{i}"), (i - 1).to_string(), i.to_string(), JointKind::Continuous);
        model.joints.push(joint.axis(Vector3::new(0.3, 0.5, i as f64 * 0.01)));
    }
    let kinematics = Kinematics::new(&model).unwrap();
    let poses = kinematics.link_poses(&vec![1.0; 1000]).unwrap();
    assert!((poses[1000].rotation.quaternion().norm() - 1.0).abs() < 1e-12);
}

#[test]
fn limits_and_followers_make_the_space() {
    let mut model = six();
    let space: Joints<SVector<f64, 6>> = Kinematics::new(&model).unwrap().space().unwrap();
    assert_eq!(space.ranges()[1], JointRange::Interval { low: -2.0, high: 2.0 });
    assert!(Kinematics::new(&model).unwrap().space::<SVector<f64, 5>>().is_err());
    // The third joint follows the second the other way round: -2.6 … 2.6 = -2·q + 0.6.
    model.joints[2] = model.joints[2].clone().mimic("joint 2", -2.0, 0.6);
    let kinematics = Kinematics::new(&model).unwrap();
    assert_eq!(kinematics.dof(), 5);
    let JointRange::Interval { low, high } = kinematics.coordinates()[1].range else { panic!() };
    assert!((low + 1.0).abs() < 1e-15 && (high - 1.6).abs() < 1e-15);
    // And the fourth follows the third.
    model.joints[3] = model.joints[3].clone().mimic("joint 3", 0.5, 0.0);
    let kinematics = Kinematics::new(&model).unwrap();
    assert_eq!(
        kinematics.coordinates().iter().map(|c| c.name.as_str()).collect::<Vec<_>>(),
        ["joint 1", "joint 2", "joint 5", "joint 6"]
    );
    assert_eq!(kinematics.neutral(), [0.0; 4]);
}

/// From 3 to -3 a continuous joint goes 0.28 rad, through the half turn, and so does what follows it.
#[test]
fn continuous_joints_go_the_short_way() {
    let mut model = bar(JointKind::Continuous);
    model.links[3] = Link::new("hand").with(&cuboid(0.1, 0.1, 0.1).unwrap(), &Isometry3::identity());
    model.joints[1] = model.joints[1].clone().mimic("shoulder", -2.0, 0.0);
    let arm = Arm::new(&model, []).unwrap();
    let space: Joints<SVector<f64, 1>> = arm.space().unwrap();
    let (a, b) = (SVector::from([3.0]), SVector::from([-3.0]));
    let place = |t: f64| {
        let q = space.interpolate(&a, &b, t);
        arm.kinematics().link_poses(q.as_slice()).unwrap()[3].translation.vector
    };
    let mut last = place(0.0);
    for k in 1..=100 {
        let next = place(f64::from(k) / 100.0);
        // 0.28 rad at 2 m and back by 0.57 rad at 1 m.
        assert!((next - last).norm() < 0.012);
        last = next;
    }
    let bound = mp_cspace::MotionClearance::motion_bound(&arm, &a, &b);
    assert!(bound > 0.28 && bound < (2.0 * PI - 6.0) * (2.2 + 2.0 * 1.2), "{bound}");
}

#[test]
fn joints_with_equal_limits_are_held() {
    // Joint 3 held, joint 5 following it.
    let held = {
        let mut model = six();
        model.joints[2].kind = JointKind::Revolute { low: 0.7, high: 0.7 };
        model.joints[4] = model.joints[4].clone().mimic("joint 3", -0.5, 0.1);
        model
    };
    let (free, held) = (Kinematics::new(&six()).unwrap(), Kinematics::new(&held).unwrap());
    assert_eq!(held.dof(), 4);
    let q = [0.3, -0.4, 0.9, 1.1];
    let all = [q[0], q[1], 0.7, q[2], -0.25, q[3]];
    for (a, b) in free.link_poses(&all).unwrap().iter().zip(held.link_poses(&q).unwrap()) {
        assert!((a.to_homogeneous() - b.to_homogeneous()).abs().max() < 1e-14);
    }
    // A slider stays where it is held.
    let mut model = bar(JointKind::Revolute { low: -3.0, high: 3.0 });
    model.joints[1].kind = JointKind::Prismatic { low: 0.25, high: 0.25 };
    let poses = Kinematics::new(&model).unwrap().link_poses(&[0.0]).unwrap();
    assert_eq!(poses[3].translation.vector, Vector3::new(2.0, 0.0, 0.75));
}
