//! Robots in large meshes are not made to the end when a token says to end, wherever it does.

use crate::common::{Obstacle, obstacle};
use mp_cspace::{Cancel, Clock, Configuration, Interrupt};
use mp_geom::{TriMesh, primitives};
use mp_robot::{
    AmongMoving, Arm, ArmError, ArmModel, FreeFlyer, Joint, JointKind, Link, RobotError, Trajectory,
};
use nalgebra::{Isometry3, Vector3};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Readings of the clock: one for each question, as the steps between them are long.
static READ: AtomicU64 = AtomicU64::new(0);
const STEP: Duration = Duration::from_millis(2);

/// A token that says to end at question `n`.
fn at(n: u64) -> Interrupt {
    READ.store(0, Ordering::SeqCst);
    let clock = Clock::new(|| STEP * u32::try_from(READ.fetch_add(1, Ordering::SeqCst)).unwrap());
    Interrupt::by(Cancel::new(), clock, STEP * u32::try_from(n).unwrap())
}

/// Makes it to the end, which takes at least a question for eight of the `triangles`; then is interrupted at some of the questions.
fn ends<T, E: PartialEq + std::fmt::Debug>(
    what: &str,
    triangles: usize,
    ended: &E,
    make: impl Fn(&Interrupt) -> Result<T, E>,
) {
    assert!(make(&at(u64::from(u32::MAX))).is_ok(), "{what}");
    let questions = READ.load(Ordering::SeqCst);
    assert!(questions * 8 >= triangles as u64, "{what}: {questions} questions for {triangles} triangles");
    for part in [0.0, 0.1, 0.35, 0.6, 0.9, 0.99] {
        let n = 1 + (part * (questions - 2) as f64) as u64;
        let error =
            make(&at(n)).err().unwrap_or_else(|| panic!("{what}: goes on after question {n} of {questions}"));
        assert_eq!(error, *ended, "{what}");
        assert_eq!(READ.load(Ordering::SeqCst), n + 1, "{what}: the clock is read after the end");
    }
}

/// Bodies of several thousand triangles each.
fn obstacles() -> Vec<Obstacle> {
    let ring = primitives::torus(0.8, 0.2, 90, 40).unwrap();
    let ball = primitives::sphere(0.3, 3).unwrap();
    vec![
        obstacle("ring", ring, [0.0, 0.0, 3.0, 0.1, 0.2, 0.3]),
        obstacle("ball", ball, [3.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    ]
}

fn count(obstacles: &[Obstacle]) -> usize {
    obstacles.iter().map(|(_, mesh, _)| mesh.triangles().len()).sum()
}

/// One test, as the clock is one.
#[test]
fn bodies_arms_and_what_moves_around_them() {
    let (around, robot) = (obstacles(), primitives::sphere(0.2, 3).unwrap());
    let triangles = count(&around) + robot.triangles().len();
    ends("a body", triangles, &RobotError::Interrupted, |interrupt| {
        FreeFlyer::among_until(None, &robot, around.clone(), interrupt)
    });
    ends("what verifiers need of a body", triangles, &mp_cspace::Interrupted, |interrupt| {
        FreeFlyer::among(&robot, around.clone()).unwrap().make_ready(interrupt)
    });
    let body = FreeFlyer::among(&robot, []).unwrap();
    let moving = || {
        around.iter().map(|(name, mesh, pose)| {
            let there = Isometry3::translation(0.0, 1.0, 0.0) * pose;
            (name.clone(), mesh.clone(), Trajectory::new([(0.0, *pose), (1.0, there)]).unwrap())
        })
    };
    ends("what moves around a body", count(&around), &RobotError::Interrupted, |interrupt| {
        AmongMoving::new_until(body.clone(), moving(), interrupt)
    });

    let model = arm(&robot);
    let triangles = triangles + robot.triangles().len();
    ends("an arm", triangles, &ArmError::Interrupted, |interrupt| {
        Arm::new_until(&model, around.clone(), interrupt)
    });
    ends("what verifiers need of an arm", triangles, &mp_cspace::Interrupted, |interrupt| {
        Arm::new(&model, around.clone()).unwrap().make_ready(interrupt)
    });
    let arm = Arm::new(&model, []).unwrap();
    ends("an arm among others", count(&around), &ArmError::Interrupted, |interrupt| {
        arm.among_until(around.clone(), interrupt)
    });
}

/// Two links of this mesh, far apart.
fn arm(mesh: &TriMesh) -> ArmModel {
    let link = |name: &str| Link::new(name).with(mesh, &Isometry3::translation(0.0, 0.0, 0.5));
    let kind = JointKind::Revolute { low: -1.0, high: 1.0 };
    let joint = |name: &str, parent: &str, child: &str| {
        Joint::new(name, parent, child, kind).at(Isometry3::translation(0.0, 0.0, 1.0)).axis(Vector3::y())
    };
    ArmModel {
        links: vec![Link::new("base"), link("upper"), Link::new("middle"), link("lower")],
        joints: vec![
            joint("a", "base", "upper"),
            joint("b", "upper", "middle"),
            joint("c", "middle", "lower"),
        ],
        ..ArmModel::default()
    }
}

/// A search for a free configuration where there is none ends within few queries of being told to, wherever it is.
#[test]
fn a_search_for_a_free_configuration_ends() {
    let robot = primitives::cuboid(0.2, 0.2, 0.2).unwrap();
    let around = obstacle("around", primitives::cuboid(9.0, 9.0, 9.0).unwrap(), [0.0; 6]);
    let (model, cancel) = (arm(&robot), Cancel::new());
    let none = Arm::new(&model, [around]).unwrap();
    let space = none.space::<Configuration>().unwrap();
    let q = Configuration::zeros(3);
    let queries = |cancel: &Cancel| {
        let mut arm = none.clone().with_interrupt(Interrupt::new(cancel.clone()));
        let _ = arm.nearest_free(&q, &space, 10.0);
        arm.counters().clearance_checks
    };
    assert!(queries(&cancel) > 1000, "{}", queries(&cancel));
    cancel.cancel();
    assert!(queries(&cancel) < 50, "{}", queries(&cancel));
}

/// What is interrupted while it makes what verifiers need leaves nothing half made.
#[test]
fn what_was_ended_is_made_again() {
    let body = FreeFlyer::among(&primitives::cuboid(0.2, 0.2, 0.2).unwrap(), obstacles()).unwrap();
    let cancel = Cancel::new();
    cancel.cancel();
    assert!(body.make_ready(&Interrupt::new(cancel)).is_err());
    assert_eq!(body.make_ready(&Interrupt::never()), Ok(()));
    assert_eq!(body.make_ready(&Interrupt::never()), Ok(()));
}
