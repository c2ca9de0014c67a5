//! Inverse kinematics: poses made from random configurations are reached, and nothing else is called a solution.

use mp_cspace::{Configuration, Joints, Rng, Space};
use mp_geom::primitives::cuboid;
use mp_robot::{
    ArmModel, FreeTurn, IK_PRECISION, InverseKinematics, Joint, JointKind, Kinematics, Link, PoseGoal,
};
use nalgebra::{Isometry3, Matrix4, Translation3, UnitQuaternion, Vector3};

/// Axis, offset from the joint before along x, y and z, and limits.
type Row = ([f64; 3], [f64; 3], f64);

/// An arm with a spherical wrist; one with the joints of elbows in a row; a planar one; one that slides first.
const ARMS: [(&str, &[Row]); 4] = [
    (
        "spherical wrist",
        &[
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.3], 2.9),
            ([0.0, 1.0, 0.0], [0.05, 0.0, 0.2], 2.0),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 0.45], 2.5),
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.2], 2.9),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 0.2], 2.0),
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.1], 3.1),
        ],
    ),
    (
        "offsets",
        &[
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.16], 3.1),
            ([0.0, 1.0, 0.0], [0.0, 0.13, 0.0], 3.1),
            ([0.0, 1.0, 0.0], [0.0, -0.12, 0.42], 3.1),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 0.39], 3.1),
            ([0.0, 0.0, 1.0], [0.0, 0.09, 0.0], 3.1),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 0.09], 3.1),
        ],
    ),
    (
        "seven",
        &[
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.33], 2.8),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 0.0], 1.7),
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.32], 2.8),
            ([0.0, -1.0, 0.0], [0.08, 0.0, 0.0], 2.9),
            ([0.0, 0.0, 1.0], [-0.08, 0.0, 0.38], 2.8),
            ([0.0, -1.0, 0.0], [0.0, 0.0, 0.0], 2.9),
            ([0.0, 0.0, -1.0], [0.09, 0.0, 0.0], 2.8),
        ],
    ),
    (
        "four of a palletiser",
        &[
            ([0.0, 0.0, 1.0], [0.0, 0.0, 0.4], 2.9),
            ([0.0, 1.0, 0.0], [0.1, 0.0, 0.0], 1.5),
            ([0.0, 1.0, 0.0], [0.0, 0.0, 0.5], 2.0),
            ([0.0, 1.0, 0.0], [0.4, 0.0, 0.0], 2.0),
        ],
    ),
];

fn kinematics(rows: &[Row]) -> Kinematics {
    let (mut links, mut joints) = (vec![Link::new("link 0")], Vec::new());
    for (i, (axis, at, limit)) in rows.iter().enumerate() {
        let turn = JointKind::Revolute { low: -limit, high: *limit };
        let (parent, child) = (format!("link {i}"), format!("link {}", i + 1));
        links.push(Link::new(&child).with(&cuboid(0.05, 0.05, 0.05).unwrap(), &Isometry3::identity()));
        let joint = Joint::new(format!("joint {i}"), parent, child, turn);
        joints.push(joint.axis(Vector3::from(*axis)).at(Translation3::from(Vector3::from(*at)).into()));
    }
    links.push(Link::new("tool"));
    let flange = Joint::new("flange", format!("link {}", rows.len()), "tool", JointKind::Fixed);
    joints.push(flange.at(Isometry3::translation(0.0, 0.02, 0.1)));
    let model =
        ArmModel { links, joints, base: Isometry3::translation(0.5, -0.2, 0.1), ..ArmModel::default() };
    Kinematics::new(&model).unwrap()
}

/// Where the tool is, by products of matrices: another implementation.
fn forward(rows: &[Row], q: &[f64]) -> Matrix4<f64> {
    let translation = |v: Vector3<f64>| Matrix4::new_translation(&v);
    let mut pose = translation(Vector3::new(0.5, -0.2, 0.1));
    for ((axis, at, _), q) in rows.iter().zip(q) {
        // Rodrigues' formula.
        let k = Vector3::from(*axis).cross_matrix();
        let (s, c) = mp_math::sin_cos(*q);
        let turn = nalgebra::Matrix3::identity() + k * s + k * k * (1.0 - c);
        pose *= translation(Vector3::from(*at)) * turn.to_homogeneous();
    }
    pose * translation(Vector3::new(0.0, 0.02, 0.1))
}

fn pose_of(matrix: &Matrix4<f64>) -> Isometry3<f64> {
    let turn = matrix.fixed_view::<3, 3>(0, 0).into_owned();
    let rotation = UnitQuaternion::from_matrix(&turn);
    Isometry3::from_parts(Translation3::from(matrix.fixed_view::<3, 1>(0, 3).into_owned()), rotation)
}

#[test]
fn poses_of_random_configurations_are_reached() {
    for (name, rows) in ARMS {
        let kinematics = kinematics(rows);
        let space: Joints<Configuration> = kinematics.space().unwrap();
        let mut rng = Rng::seed(7);
        let mut missed = 0;
        for _ in 0..200 {
            let wanted = pose_of(&forward(rows, space.sample_uniform(&mut rng).as_slice()));
            let goal = PoseGoal::new("tool", wanted);
            let mut solver = InverseKinematics::new(&kinematics, goal.clone()).unwrap();
            let found = solver.solutions(60, 1);
            let Some(q) = found.first() else {
                missed += 1;
                continue;
            };
            let (place, turn) = goal.error(&pose_of(&forward(rows, q.as_slice())));
            // The matrix loses some digits of an angle.
            assert!(place.norm() < 2.0 * IK_PRECISION && turn.norm() < 1e-7, "{name}: {place} {turn}");
            assert!(q.iter().zip(rows).all(|(x, (.., limit))| x.abs() <= *limit), "{name}: {q:?}");
            let again = InverseKinematics::new(&kinematics, goal).unwrap().solutions(60, 1);
            assert_eq!(found, again);
        }
        assert!(missed <= 1, "{name}: {missed} of 200 poses were not reached");
    }
}

#[test]
fn all_solutions_of_a_wrist_are_found() {
    let rows = ARMS[1].1;
    let kinematics = kinematics(rows);
    let q = [0.4, -1.1, 1.3, -0.7, 1.0, 0.3];
    let goal = PoseGoal::new("tool", pose_of(&forward(rows, &q)));
    let mut solver = InverseKinematics::new(&kinematics, goal.clone()).unwrap();
    let found = solver.solutions(400, 100);
    // Shoulder, elbow and wrist each two ways, where limits and lengths allow.
    assert!((4..=16).contains(&found.len()), "{}", found.len());
    let near = |p: &Configuration| p.iter().zip(&q).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(found.iter().any(near), "{found:?}");
    for p in &found {
        let (place, turn) = goal.error(&pose_of(&forward(rows, p.as_slice())));
        assert!(place.norm() < 1e-8 && turn.norm() < 1e-7);
    }
}

#[test]
fn goals_may_leave_room() {
    let rows = ARMS[3].1;
    let kinematics = kinematics(rows);
    let q = [0.3, 0.4, 0.5, -0.2];
    let at = pose_of(&forward(rows, &q));
    // Four joints cannot turn the tool about its own axis: the whole pose is out of reach, but not what leaves that free.
    let turned = at * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
    let solve = |goal: PoseGoal| {
        let found = InverseKinematics::new(&kinematics, goal.clone())?.solutions(100, 1).pop();
        found.map(|q| pose_of(&forward(rows, q.as_slice())))
    };
    let goal = PoseGoal::new("tool", turned);
    assert_eq!(solve(goal.clone()), None);
    let about = solve(PoseGoal { free: FreeTurn::About(Vector3::z_axis()), ..goal.clone() }).unwrap();
    assert!((about.translation.vector - at.translation.vector).norm() < 1e-8);
    assert!((about.rotation * Vector3::z() - at.rotation * Vector3::z()).norm() < 1e-7);
    let all = solve(PoseGoal { free: FreeTurn::All, ..goal.clone() }).unwrap();
    assert!((all.translation.vector - at.translation.vector).norm() < 1e-8);
    // A box around a place that is just out of reach.
    let far = Isometry3::translation(0.5, -0.2, 0.1 + 0.4 + 1.2);
    let out = PoseGoal { pose: far, free: FreeTurn::All, ..goal };
    assert_eq!(solve(out.clone()), None);
    let inside = solve(PoseGoal { within: [0.2, 0.2, 0.4], ..out.clone() }).unwrap();
    let off = inside.translation.vector - far.translation.vector;
    assert!(off.x.abs() <= 0.2 + 1e-8 && off.y.abs() <= 0.2 + 1e-8 && off.z.abs() <= 0.4 + 1e-8, "{off}");
    // No place at all.
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let nowhere = Isometry3::translation(0.5, x, 0.1);
        for free in [FreeTurn::None, FreeTurn::All] {
            assert_eq!(solve(PoseGoal { pose: nowhere, free, ..out.clone() }), None);
        }
    }
    // What is no room is none.
    for x in [f64::NAN, -1.0, f64::NEG_INFINITY] {
        assert_eq!(solve(PoseGoal { within: [x; 3], ..out.clone() }), None);
    }
    // Nothing to solve.
    assert!(InverseKinematics::new(&kinematics, PoseGoal::new("gone", far)).is_none());
    assert!(InverseKinematics::new(&kinematics, PoseGoal::new("link 0", far)).is_none());
}

#[test]
fn an_axis_is_as_precise_as_a_whole_pose() {
    for (name, rows) in ARMS {
        let kinematics = kinematics(rows);
        let space: Joints<Configuration> = kinematics.space().unwrap();
        let mut rng = Rng::seed(11);
        let axis = Vector3::z_axis();
        for _ in 0..100 {
            let q = space.sample_uniform(&mut rng);
            let mut goal = PoseGoal::new("tool", Isometry3::identity());
            goal.pose = InverseKinematics::new(&kinematics, goal.clone()).unwrap().pose_at(q.as_slice());
            goal.free = FreeTurn::About(axis);
            let wanted = goal.pose.rotation * axis;
            let mut solver = InverseKinematics::new(&kinematics, goal).unwrap();
            for q in solver.solutions(20, 4) {
                // The sine of the angle: its cosine is 1 up to 1e-8 rad.
                let off = (solver.pose_at(q.as_slice()).rotation * axis).cross(&wanted).norm();
                assert!(off < 1.1 * IK_PRECISION, "{name}: {off}");
            }
        }
    }
}

#[test]
fn a_tolerance_leaves_room_to_arms_of_few_joints() {
    for (name, rows) in ARMS {
        for count in 1..=3 {
            let kinematics = kinematics(&rows[..count]);
            let space: Joints<Configuration> = kinematics.space().unwrap();
            let mut rng = Rng::seed(13);
            for case in 0..50 {
                let q = space.sample_uniform(&mut rng);
                let mut goal = PoseGoal::new("tool", Isometry3::identity());
                goal.pose = InverseKinematics::new(&kinematics, goal.clone()).unwrap().pose_at(q.as_slice());
                goal.within = [0.05; 3];
                // Off by most of the tolerance, where no joint may lead with the orientation that is asked for.
                goal.pose *= Translation3::new(0.04, -0.03, 0.045);
                let found = InverseKinematics::new(&kinematics, goal).unwrap().solutions(100, 1);
                assert!(!found.is_empty(), "{name}, {count} joints, case {case}: {q:?}");
            }
        }
    }
}
