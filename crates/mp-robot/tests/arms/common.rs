//! Arms the tests share.

use mp_cspace::{Joints, Rng, Space, Validity};
use mp_geom::{Shape, TriMesh, pose_from_six, primitives::cuboid};
use mp_robot::{Arm, ArmModel, Joint, JointKind, Link};
use nalgebra::{Isometry3, Matrix4, Point3, SVector, Vector3};
use rand::RngExt;

/// How many of `all` cases a test takes: under valgrind, which takes a hundred times as long, a tenth (`cargo xtask memcheck` says so).
pub(crate) fn cases_of(all: usize) -> usize {
    if std::env::var_os("MP_MEMCHECK").is_some() { all.div_ceil(10) } else { all }
}

pub(crate) type Obstacle = (String, TriMesh, Isometry3<f64>);

pub(crate) fn obstacle(name: &str, mesh: TriMesh, six: [f64; 6]) -> Obstacle {
    (name.to_owned(), mesh, pose_from_six(six))
}

/// Six joints as industrial arms have them, on a base, with box links; reach about 1.2 m.
pub(crate) fn six() -> ArmModel {
    let turn = |low: f64, high: f64| JointKind::Revolute { low, high };
    let (y, z) = (Vector3::y(), Vector3::z());
    let links = [
        ("base", [0.2, 0.2, 0.1], [0.0, 0.0, 0.05]),
        ("turret", [0.16, 0.16, 0.18], [0.0, 0.0, 0.1]),
        ("upper", [0.1, 0.1, 0.4], [0.0, 0.0, 0.2]),
        ("fore", [0.08, 0.08, 0.3], [0.0, 0.0, 0.15]),
        ("roll", [0.06, 0.06, 0.08], [0.0, 0.0, 0.05]),
        ("pitch", [0.05, 0.05, 0.08], [0.0, 0.0, 0.04]),
        ("tool", [0.04, 0.12, 0.1], [0.0, 0.0, 0.05]),
    ];
    let joints = [
        (0.12, z, turn(-2.9, 2.9)),
        (0.2, y, turn(-2.0, 2.0)),
        (0.42, y, turn(-2.6, 2.6)),
        (0.32, z, turn(-3.1, 3.1)),
        (0.11, y, turn(-2.1, 2.1)),
        (0.09, z, turn(-3.1, 3.1)),
    ];
    let make = |(name, [x, y, z], [a, b, c]): (&str, [f64; 3], [f64; 3])| {
        Link::new(name).with(&cuboid(x, y, z).unwrap(), &Isometry3::translation(a, b, c))
    };
    let joint = |(i, (height, axis, kind)): (usize, (f64, Vector3<f64>, JointKind))| {
        let at = Isometry3::translation(0.0, 0.0, height);
        Joint::new(format!("joint {}", i + 1), links[i].0, links[i + 1].0, kind).at(at).axis(axis)
    };
    ArmModel {
        links: links.map(make).to_vec(),
        joints: joints.into_iter().enumerate().map(joint).collect(),
        ..ArmModel::default()
    }
}

/// The arm of [`six`], each link a row of balls of different sizes.
pub(crate) fn six_of_balls() -> ArmModel {
    let mut model = six();
    for link in &mut model.links {
        let bounds = link.shapes[0].aabb();
        let (low, high) = (bounds.min, bounds.max);
        let radius = 0.25 * (high.x - low.x + high.y - low.y);
        let ball = |i: u32| {
            let up = f64::from(i) / 4.0;
            let at =
                Point3::new(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z + up * (high.z - low.z));
            TriMesh::of_balls(vec![at], radius * (1.0 - 0.15 * up)).unwrap()
        };
        link.shapes = (0..5).map(ball).collect();
    }
    model
}

/// What is around it: solids of all forms, and the surface of a mesh.
pub(crate) fn round_clutter() -> Vec<Obstacle> {
    let shape = |name: &str, lengths: &[f64]| Shape::primitive(name, lengths).unwrap().mesh().unwrap();
    vec![
        obstacle("table", cuboid(2.0, 2.0, 0.02).unwrap(), [0.0, 0.0, -0.06, 0.0, 0.0, 0.0]),
        obstacle("can", shape("cylinder", &[0.1, 0.3]), [0.5, 0.2, 0.4, 0.3, 0.2, 0.1]),
        obstacle("rail", shape("capsule", &[0.04, 1.0]), [-0.4, 0.3, 0.6, 0.3, 1.2, 0.0]),
        obstacle("ball", shape("sphere", &[0.15]), [0.1, -0.5, 0.7, 0.0, 0.0, 0.0]),
        obstacle("sheet", cuboid(0.3, 0.8, 0.02).unwrap().into_surface(), [0.6, -0.2, 0.8, 0.0, 0.3, 0.0]),
    ]
}

/// Things around it.
pub(crate) fn clutter() -> Vec<Obstacle> {
    let block = |x: f64, y: f64, z: f64| cuboid(x, y, z).unwrap();
    vec![
        obstacle("table", block(2.0, 2.0, 0.02), [0.0, 0.0, -0.01, 0.0, 0.0, 0.0]),
        obstacle("shelf", block(0.3, 0.8, 0.02), [0.6, 0.0, 0.5, 0.0, 0.0, 0.0]),
        obstacle("post", block(0.05, 0.05, 1.2), [-0.4, 0.3, 0.6, 0.3, 0.0, 0.0]),
        obstacle("beam", block(0.05, 1.5, 0.05), [-0.3, 0.0, 0.9, 0.2, 0.1, 0.0]),
    ]
}

/// A configuration of [`six`].
pub(crate) type Six = SVector<f64, 6>;

/// Pairs of random free configurations of [`six`] with the tool on different sides of the plane x = 0 of the frame `sheet`.
pub(crate) fn across(
    arm: &mut Arm,
    space: &Joints<Six>,
    sheet: &Isometry3<f64>,
    count: usize,
    rng: &mut Rng,
) -> Vec<[Six; 2]> {
    let to_sheet = sheet.inverse();
    let mut found = Vec::new();
    while found.len() < count {
        let [a, b] = [0, 1].map(|_| space.sample_uniform(rng));
        let side = |q: &Six| {
            let pose = arm.kinematics().link_poses(q.as_slice()).unwrap()[6];
            (to_sheet * Point3::from(pose.translation.vector)).x > 0.0
        };
        if side(&a) != side(&b) && arm.is_valid(&a) && arm.is_valid(&b) {
            found.push([a, b]);
        }
    }
    found
}

/// A random tree of links with joints of all kinds; some mimic.
pub(crate) fn random_tree(rng: &mut Rng, count: usize) -> ArmModel {
    let pose = |rng: &mut Rng, reach: f64| {
        pose_from_six([0.0; 6].map(|_: f64| rng.random_range(-1.0..1.0)).map(|x: f64| x * reach))
    };
    let mut model = ArmModel { base: pose(rng, 0.5), ..ArmModel::default() };
    for i in 0..count {
        let mut link = Link::new(format!("l{i}"));
        for _ in 0..rng.random_range(0..3) {
            let size = [0.0; 3].map(|_: f64| rng.random_range(0.05..0.3));
            link = link.with(&cuboid(size[0], size[1], size[2]).unwrap(), &pose(rng, 0.2));
        }
        model.links.push(link);
        if i == 0 {
            continue;
        }
        let kind = match rng.random_range(0..6) {
            0 => JointKind::Fixed,
            1 => JointKind::Continuous,
            2 => JointKind::Prismatic { low: -0.2, high: 0.3 },
            _ => JointKind::Revolute { low: -1.5, high: 2.5 },
        };
        let parent = rng.random_range(i.saturating_sub(3)..i);
        let axis = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let joint = Joint::new(format!("j{i}"), format!("l{parent}"), format!("l{i}"), kind);
        let mut joint = joint.at(pose(rng, 0.4)).axis(axis);
        // What has limits may follow what has limits.
        let limited = |kind| matches!(kind, JointKind::Revolute { .. } | JointKind::Prismatic { .. });
        let leader = &model.joints.iter().rev().find(|other| limited(other.kind));
        if let (true, Some(leader), 0) = (limited(kind), leader, rng.random_range(0..3)) {
            joint = joint.mimic(leader.name.clone(), 0.5 * rng.random_range(-1.0..1.0), 0.05);
        }
        model.joints.push(joint);
    }
    // In any order: links by the names of joints only.
    let at = rng.random_range(0..count);
    model.links.rotate_left(at);
    model
}

/// The pose of a link, by homogeneous matrices from the link up: another way than the crate's.
pub(crate) fn matrix(model: &ArmModel, values: &dyn Fn(&str) -> f64, link: &str) -> Matrix4<f64> {
    let Some(joint) = model.joints.iter().find(|joint| joint.child == link) else {
        return model.base.to_homogeneous();
    };
    let value = value_of(model, values, &joint.name);
    let n = joint.axis.normalize();
    let mut motion = Matrix4::identity();
    match joint.kind {
        JointKind::Fixed => {}
        JointKind::Prismatic { .. } => motion.fixed_view_mut::<3, 1>(0, 3).copy_from(&(n * value)),
        JointKind::Revolute { .. } | JointKind::Continuous => {
            // Rodrigues.
            let k = n.cross_matrix();
            let r =
                nalgebra::Matrix3::identity() + k * mp_math::sin(value) + k * k * (1.0 - mp_math::cos(value));
            motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&r);
        }
    }
    matrix(model, values, &joint.parent) * joint.origin.to_homogeneous() * motion
}

fn value_of(model: &ArmModel, values: &dyn Fn(&str) -> f64, name: &str) -> f64 {
    let joint = model.joints.iter().find(|joint| joint.name == name).unwrap();
    match &joint.mimic {
        Some(mimic) => value_of(model, values, &mimic.joint) * mimic.multiplier + mimic.offset,
        None if joint.kind == JointKind::Fixed => 0.0,
        None => values(name),
    }
}
