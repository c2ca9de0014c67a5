//! What is refused, and how it is said.

use crate::common::six;
use mp_cspace::{Certified, Clearance, Configuration, MotionClearance, MotionValidity, Validity};
use mp_geom::primitives::cuboid;
use mp_robot::{Arm, ArmError, ArmModel, Joint, JointKind, Link};
use nalgebra::{Isometry3, SVector, Vector3};

/// The message for `six` after a change.
fn refused(change: impl FnOnce(&mut ArmModel)) -> String {
    let mut model = six();
    change(&mut model);
    let Err(error) = Arm::new(&model, []) else { panic!("accepted") };
    error.to_string()
}

#[track_caller]
fn says(message: &str, words: &[&str]) {
    assert!(words.iter().all(|word| message.contains(word)), "{message}");
}

#[test]
fn trees_that_are_none() {
    says(&refused(|m| m.links.clear()), &["joint 1", "parent", "base"]);
    says(&refused(|m| *m = ArmModel::default()), &["no links"]);
    says(&refused(|m| m.joints.clear()), &["base", "turret", "no parent"]);
    says(&refused(|m| m.joints.truncate(5)), &["base", "tool", "no parent"]);
    says(&refused(|m| m.joints[2].parent = "arm".into()), &["joint 3", "parent", "\"arm\""]);
    says(&refused(|m| m.joints[2].child = "upper".into()), &["upper", "joint 2", "joint 3", "closed chain"]);
    says(&refused(|m| m.joints[0].parent = "tool".into()), &["no parent"]);
    let ring = |m: &mut ArmModel| {
        m.links.remove(0);
        m.joints[0].parent = "tool".into();
    };
    says(&refused(ring), &["loop", "turret", "joint 1"]);
    // A loop beside a tree.
    let apart = |m: &mut ArmModel| {
        m.links.extend([Link::new("a"), Link::new("b")]);
        m.joints.push(Joint::new("ab", "a", "b", JointKind::Fixed));
        m.joints.push(Joint::new("ba", "b", "a", JointKind::Fixed));
    };
    says(&refused(apart), &["loop", "\"a\"", "\"ba\""]);
    says(&refused(|m| m.joints[3].child = "fore".into()), &["fore"]);
    says(&refused(|m| m.links[3].name = "upper".into()), &["two links", "upper"]);
    says(&refused(|m| m.joints[3].name = "joint 1".into()), &["two joints", "joint 1"]);
    says(&refused(|m| m.joints.iter_mut().for_each(|j| j.kind = JointKind::Fixed)), &["moves"]);
    let still = JointKind::Revolute { low: 0.5, high: 0.5 };
    says(&refused(|m| m.joints.iter_mut().for_each(|j| j.kind = still)), &["moves", "equal", "\"joint 6\""]);
}

#[test]
fn joints_that_make_no_sense() {
    for axis in [Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 1.0), Vector3::x() * 1e300] {
        says(&refused(|m| m.joints[1].axis = axis), &["axis", "joint 2"]);
    }
    for (low, high) in [(1.0, -1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
        let kind = JointKind::Revolute { low, high };
        says(&refused(|m| m.joints[1].kind = kind), &["joint 2", "lower limit", "continuous"]);
    }
    for x in [f64::NAN, f64::INFINITY, 1e100] {
        says(&refused(|m| m.joints[4].origin.translation.x = x), &["origin", "joint 5"]);
        says(&refused(|m| m.base.translation.x = x), &["origin", "base"]);
    }
    let far =
        Link::new("base").with(&cuboid(1.0, 1.0, 1.0).unwrap(), &Isometry3::translation(f64::NAN, 0.0, 0.0));
    says(&refused(|m| m.links[0] = far), &["base", "too large"]);
}

#[test]
fn followers_that_cannot() {
    let mimic = |joint: &'static str, factor: f64| {
        move |m: &mut ArmModel| m.joints[1] = m.joints[1].clone().mimic(joint, factor, 0.0)
    };
    says(&refused(mimic("joint 2", 1.0)), &["joint 2", "back to itself"]);
    says(&refused(mimic("elbow", 1.0)), &["joint 2", "\"elbow\"", "no joint"]);
    says(&refused(mimic("joint 1", f64::NAN)), &["joint 2", "finite"]);
    let both = |m: &mut ArmModel| {
        m.joints[1] = m.joints[1].clone().mimic("joint 3", 1.0, 0.0);
        m.joints[2] = m.joints[2].clone().mimic("joint 2", 1.0, 0.0);
    };
    says(&refused(both), &["back to itself"]);
    let fixed = |m: &mut ArmModel| {
        m.joints[0].kind = JointKind::Fixed;
        mimic("joint 1", 1.0)(m);
    };
    says(&refused(fixed), &["joint 2", "joint 1", "fixed"]);
    let held = |m: &mut ArmModel| {
        m.joints[0].kind = JointKind::Revolute { low: 2.5, high: 2.5 };
        mimic("joint 1", 1.0)(m);
    };
    says(&refused(held), &["joint 2", "joint 1", "does not move", "outside"]);
    let endless = |m: &mut ArmModel| {
        m.joints[0].kind = JointKind::Continuous;
        mimic("joint 1", 1.0)(m);
    };
    says(&refused(endless), &["joint 2", "without end"]);
    let halves = |m: &mut ArmModel| {
        endless(m);
        m.joints[1].kind = JointKind::Continuous;
        m.joints[1].mimic.as_mut().unwrap().multiplier = 0.5;
    };
    says(&refused(halves), &["whole multiplier"]);
    let apart = |m: &mut ArmModel| m.joints[1] = m.joints[1].clone().mimic("joint 1", 0.1, 1.9);
    assert!(
        Arm::new(
            &{
                let mut m = six();
                apart(&mut m);
                m
            },
            []
        )
        .is_ok()
    );
    let apart = |m: &mut ArmModel| m.joints[1] = m.joints[1].clone().mimic("joint 1", 0.1, 2.5);
    says(&refused(apart), &["no room"]);
    let pair = Some(vec![("base".to_owned(), "hand".to_owned())]);
    says(&refused(|m| m.may_touch = pair), &["base", "\"hand\""]);
}

#[test]
fn obstacles_and_states_that_are_none() {
    let cube = cuboid(1.0, 1.0, 1.0).unwrap();
    let bad = ("bad".to_owned(), cube, Isometry3::translation(f64::NAN, 0.0, 0.0));
    let error = Arm::new(&six(), [bad]).unwrap_err();
    assert!(matches!(&error, ArmError::Obstacle(_)) && error.to_string().contains("bad"));
    let mut arm = Arm::new(&six(), []).unwrap();
    let space = arm.space::<SVector<f64, 6>>().unwrap();
    let zero = SVector::<f64, 6>::zeros();
    let mut certified = Certified::new(&space, arm.clone(), arm.tolerance()).unwrap();
    for x in [f64::NAN, f64::INFINITY] {
        let q = zero.map(|_| x);
        assert!(!arm.is_valid(&q) && arm.clearance(&q, 1.0) == 0.0 && arm.in_contact(&q));
        assert!(!certified.check_motion(&zero, &q).is_free() && !certified.check_motion(&q, &zero).is_free());
        assert_eq!(arm.motion_bound(&zero, &q), f64::INFINITY);
    }
    for dof in [0, 5, 7] {
        let q = Configuration::zeros(dof);
        assert!(!arm.is_valid(&q) && arm.clearance(&q, 1.0) == 0.0);
        assert_eq!(arm.motion_bound(&q, &q), f64::INFINITY);
        assert!(arm.meshes_at(q.as_slice()).is_empty());
    }
    assert!(!certified.check_motion(&zero, &zero.map(|_| 1e300)).is_free());
}
