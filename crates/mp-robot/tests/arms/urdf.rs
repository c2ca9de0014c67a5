//! Arms from URDF and SRDF.

use crate::common::cases_of;
use mp_cspace::{Configuration, JointRange};
use mp_geom::{TriMesh, primitives::cuboid};
use mp_robot::{Arm, ArmModel, JointKind, Kinematics, Rate, SrdfGroups, UrdfError};
use nalgebra::{Point3, Vector3};

const GRIPPER: &str = r#"<?xml version="1.0"?>
<robot name="gripper">
  <!-- links and joints in any order -->
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="carriage"/>
    <origin xyz="0 0 0.1" rpy="0 0 1.5707963267948966"/>
    <axis xyz="0 0 2"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/>
  </joint>
  <link name="base">
    <visual><geometry><box size="9 9 9"/></geometry></visual>
    <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision>
  </link>
  <link name="carriage">
    <collision><origin xyz="0.1 0 0" rpy="0 1.5707963267948966 0"/><geometry><cylinder radius="0.05" length="0.2"/></geometry></collision>
    <collision><geometry><sphere radius="0.06"/></geometry></collision>
  </link>
  <link name="left"><collision><geometry><mesh filename="package://gripper/finger.stl" scale="1 -1 2"/></geometry></collision></link>
  <link name="right"/>
  <link name="spin"/>
  <joint name="open" type="revolute">
    <parent link="carriage"/><child link="left"/><origin xyz="0.3 0 0"/>
    <limit lower="-0.5" upper="0.5" velocity="1"/>
  </joint>
  <joint name="close" type="revolute">
    <parent link="carriage"/><child link="right"/>
    <axis xyz="0 1 0"/><mimic joint="open" multiplier="-1"/><limit lower="-0.25" upper="1" velocity="1"/>
  </joint>
  <joint name="turn" type="continuous"><parent link="left"/><child link="spin"/></joint>
</robot>"#;

fn finger(name: &str) -> Result<TriMesh, String> {
    if name == "package://gripper/finger.stl" {
        Ok(cuboid(0.1, 0.2, 0.3).unwrap().transformed(&nalgebra::Isometry3::translation(0.0, 0.1, 0.0)))
    } else {
        Err(format!("no file {name}"))
    }
}

fn read(text: &str) -> Result<ArmModel, UrdfError> {
    ArmModel::from_urdf(text, finger)
}

#[test]
fn everything_that_counts_is_read() {
    let model = read(GRIPPER).unwrap();
    let arm = Arm::new(&model, []).unwrap();
    let coordinates: Vec<_> = arm.coordinates().iter().map(|c| (c.name.as_str(), c.range)).collect();
    // The follower narrows its leader: -0.25 … 1 the other way round.
    assert_eq!(
        coordinates,
        [
            ("lift", JointRange::Interval { low: 0.0, high: 0.5 }),
            ("open", JointRange::Interval { low: -0.5, high: 0.25 }),
            ("turn", JointRange::Circle),
        ]
    );
    // Up by 0.1 + 0.25 and a quarter turn to the left, then 0.3 along what is Y now.
    let poses = arm.kinematics().link_poses(&[0.25, 0.0, 1.0]).unwrap();
    let left = arm.kinematics().links().position(|name| name == "left").unwrap();
    assert!((poses[left].translation.vector - Vector3::new(0.0, 0.3, 0.35)).norm() < 1e-15);
    let mesh = |name: &str| {
        let link = model.links.iter().find(|link| link.name == name).unwrap();
        link.shapes.iter().map(TriMesh::aabb).collect::<Vec<_>>()
    };
    assert_eq!(mesh("base")[0].max, Point3::new(0.1, 0.1, 0.05));
    // The cylinder lies along X, and the mesh around it is a little larger than it.
    let [rod, ball] = mesh("carriage")[..] else { panic!() };
    assert!((rod.max.x - 0.2).abs() < 1e-12 && rod.min.x.abs() < 1e-12);
    assert!(rod.max.z >= 0.05 && rod.max.z < 0.0505, "{}", rod.max.z);
    assert!((ball.max.x - 0.06).abs() < 1e-12);
    // Scaled by 1, -1, 2: mirrored, still facing outward.
    assert_eq!((mesh("left")[0].min.y, mesh("left")[0].max.z), (-0.2, 0.3));
    assert!(model.links.iter().find(|l| l.name == "left").unwrap().shapes[0].signed_volume() > 0.0);
    assert!(mesh("right").is_empty());
}

/// Spheres are balls, alone in a link and beside other shapes.
#[test]
fn links_of_spheres_are_balls() {
    let ball = |x: f64, radius: &str| {
        format!(
            "<collision><origin xyz=\"{x} 0 0\"/><geometry><sphere radius=\"{radius}\"/></geometry></collision>"
        )
    };
    let text = |shapes: &str| {
        format!(
            "<robot name=\"r\"><link name=\"a\">{shapes}</link><link name=\"b\"/><joint name=\"j\" type=\"continuous\">\
             <parent link=\"b\"/><child link=\"a\"/></joint></robot>"
        )
    };
    let shapes = |text: String| read(&text).unwrap().links.remove(0).shapes;
    let balls = shapes(text(&format!("{}{}{}", ball(0.1, "0.06"), ball(0.3, "0.04"), ball(0.5, "0"))));
    let found: Vec<_> = balls.iter().flat_map(TriMesh::each_ball).map(|b| (b.center.x, b.radius)).collect();
    assert_eq!(found, [(0.1, 0.06), (0.3, 0.04)]);
    let merged = TriMesh::merged(&balls).unwrap();
    assert!(merged.is_balls() && merged.rounding() == Some(0.06));
    let around = merged.bounding_sphere();
    assert!((around.center.x - 0.2).abs() < 1e-12 && (around.radius - 0.16).abs() < 1e-12, "{around:?}");
    let boxed = "<collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>";
    let mixed = shapes(text(&format!("{}{boxed}", ball(0.1, "0.06"))));
    assert!(mixed[0].is_balls() && mixed[1].balls().is_empty());
    assert!(read(&text(&ball(0.1, "-1"))).unwrap_err().to_string().contains("radius"));
}

/// Limits of 1e16 are written for wheels that turn without end.
#[test]
fn limits_that_mean_none() {
    let joint = |name: &str, kind: &str, limit: &str, mimic: &str| {
        format!(
            "<link name=\"{name}\"/><joint name=\"{name}\" type=\"{kind}\"><parent link=\"base\"/><child link=\"{name}\"/>\
             <limit lower=\"-{limit}\" upper=\"{limit}\"/>{mimic}</joint>"
        )
    };
    let joints = [
        joint("wheel", "revolute", "1e16", ""),
        joint("inf", "revolute", "INF", ""),
        joint("winch", "revolute", "1000", ""),
        joint("leader", "revolute", "1e16", ""),
        joint("follower", "revolute", "1", "<mimic joint=\"leader\"/>"),
    ];
    let model = read(&format!("<robot name=\"r\"><link name=\"base\"/>{}</robot>", joints.concat())).unwrap();
    let ranges: Vec<_> =
        Kinematics::new(&model).unwrap().coordinates().iter().map(|coordinate| coordinate.range).collect();
    let between = |x: f64| JointRange::Interval { low: -x, high: x };
    assert_eq!(ranges, [JointRange::Circle, JointRange::Circle, between(1000.0), between(1.0)]);
    let note =
        "these joints turn without end, for their limits are more than 1e6 rad apart: \"wheel\", \"inf\"";
    assert!(model.notes.iter().any(|said| said.starts_with(&note[..60])), "{:?}", model.notes);
}

/// A mesh without triangles cannot be touched, and neither can one that is scaled to a point. A sheet can.
#[test]
fn meshes_without_extent_are_left_out() {
    let text = |scale: &str| {
        format!(
            "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"m.stl\" scale=\"{scale}\"/></geometry>\
             </collision></link><link name=\"b\"/><joint name=\"j\" type=\"continuous\"><parent link=\"b\"/><child link=\"a\"/>\
             </joint></robot>"
        )
    };
    let read =
        |scale: &str, mesh: Result<TriMesh, String>| ArmModel::from_urdf(&text(scale), |_| mesh.clone());
    let cube = || Ok(cuboid(1.0, 1.0, 1.0).unwrap());
    let empty = TriMesh::new(vec![], vec![]).unwrap_err();
    for (scale, mesh) in [("1 1 1", Err(format!("m.stl: {empty} (a body needs one)"))), ("0 0 0", cube())] {
        let model = read(scale, mesh).unwrap();
        assert!(model.links[0].shapes.is_empty());
        assert!(
            model.notes[0].contains("meshes without triangles are left out")
                && model.notes[0].contains("\"a\"")
        );
    }
    let sheet = read("1 1 0", cube()).unwrap().links[0].shapes[0].clone();
    assert_eq!((sheet.aabb().max.x, sheet.aabb().max.z, sheet.solids().len()), (0.5, 0.0, 0));
    for (scale, mesh) in [("1 inf 1", cube()), ("1 1 1", Err("m.stl: cut short".to_owned()))] {
        assert!(read(scale, mesh).is_err());
    }
}

#[test]
fn velocities_are_read_and_those_of_followers_count() {
    let limit = "<joint name=\"turn\" type=\"continuous\"><limit effort=\"1\" velocity=\" 2.5 \"/>";
    let text = GRIPPER.replace("<joint name=\"turn\" type=\"continuous\">", limit);
    let text = text.replace("upper=\"1\" velocity=\"1\"", "upper=\"1\" velocity=\"0.75\"");
    let model = read(&text.replace("multiplier=\"-1\"", "multiplier=\"-1.5\"")).unwrap();
    let rates = ["lift", "open", "turn", "close"].map(|joint| model.rates(joint));
    assert_eq!(rates, [1.0, 0.5, 2.5, 0.75].map(|velocity| [Some(velocity), None, None]));
    // What follows a follower counts too: it turns 1.5 · 4 times as fast as `open`.
    let more = "<link name=\"last\"/><joint name=\"last\" type=\"continuous\"><parent link=\"base\"/><child link=\"last\"/>\
                <mimic joint=\"close\" multiplier=\"4\"/><limit effort=\"1\" velocity=\"1.5\"/></joint></robot>";
    let deep =
        read(&text.replace("multiplier=\"-1\"", "multiplier=\"-1.5\"").replace("</robot>", more)).unwrap();
    assert_eq!(deep.rates("open"), [Some(0.25), None, None]);
    let slow = model
        .with_rate(None, Rate::Acceleration, 3.0)
        .unwrap()
        .with_rate(Some("turn"), Rate::Velocity, 0.1)
        .unwrap();
    assert_eq!(slow.rates("turn"), [Some(0.1), Some(3.0), None]);
    assert_eq!(slow.rates("open"), [Some(0.5), Some(2.0), None]);
    let error = slow.with_rate(Some("up"), Rate::Jerk, 1.0).unwrap_err().to_string();
    assert!(error.contains("\"up\"") && error.contains("\"lift\""), "{error}");
    for none in ["0", "-1", "inf", "NaN", "", "fast"] {
        let text = GRIPPER.replacen("velocity=\"1\"", &format!("velocity=\"{none}\""), 1);
        assert_eq!(read(&text).unwrap().rates("lift"), [None; 3], "{none}");
    }
}

/// URDF 1.2 has limits of acceleration and jerk too. A joint brakes no harder than it may.
#[test]
fn accelerations_and_jerk_are_read() {
    let rates = |more: &str| {
        let text = GRIPPER.replacen("velocity=\"1\"", &format!("velocity=\"1\" {more}"), 1);
        read(&text).unwrap().rates("lift")
    };
    let all = "acceleration=\"5\" deceleration=\"3\" jerk=\"100\"";
    assert_eq!(rates(all), [Some(1.0), Some(3.0), Some(100.0)]);
    assert_eq!(rates("acceleration=\"0.5\" deceleration=\"3\""), [Some(1.0), Some(0.5), None]);
    assert_eq!(rates("deceleration=\"2\""), [Some(1.0), Some(2.0), None]);
    assert_eq!(rates("acceleration=\"inf\" jerk=\"0\""), [Some(1.0), None, None]);
}

#[test]
fn limits_can_be_set_and_pairs_given() {
    let model = read(GRIPPER).unwrap();
    let set = model.clone().with_limits("turn", -1.0, 2.0).unwrap();
    assert_eq!(set.joints[3].kind, JointKind::Revolute { low: -1.0, high: 2.0 });
    let error = model.clone().with_limits("close", 0.0, 1.0).unwrap_err().to_string();
    assert!(error.contains("close") && error.contains("mimics \"open\""), "{error}");
    let error = model.clone().with_limits("up", 0.0, 1.0).unwrap_err().to_string();
    assert!(error.contains("\"up\"") && error.contains("\"lift\", \"open\", \"turn\""), "{error}");
    let pairs = |model: &ArmModel| Arm::new(model, []).unwrap().checked_pairs().len();
    assert_eq!(pairs(&model), 1);
    let srdf = r#"<robot name="gripper"><group name="all"/>
        <disable_collisions link1="left" link2="base" reason="Never"/></robot>"#;
    assert_eq!(pairs(&model.clone().with_srdf(srdf).unwrap()), 0);
    assert_eq!(pairs(&model.clone().with_srdf("<robot/>").unwrap()), 1);
    let half = srdf.replace("link2", "link3");
    let noted = model.clone().with_srdf(&half).unwrap();
    assert_eq!(pairs(&noted), 1);
    assert!(noted.notes.iter().any(|n| n.contains("link1 or link2 is not read: 1 in")), "{:?}", noted.notes);
    // What would compare more is not passed over.
    let error = model.clone().with_srdf(&half.replace("disable", "enable")).unwrap_err().to_string();
    assert!(error.contains("line 2") && error.contains("link2"), "{error}");
    // Blanks around names mean nothing.
    assert_eq!(pairs(&model.clone().with_srdf(&srdf.replace("\"left\"", "\" left\t\"")).unwrap()), 0);
    assert_eq!(read(&GRIPPER.replace("\"left\"", "\" left \"")).unwrap().links, model.links);
    let unknown = model.clone().with_srdf(&srdf.replace("\"base\"", "\"foot\"")).unwrap();
    assert_eq!(pairs(&unknown), 1);
    assert!(unknown.notes.iter().any(|n| n.contains("the SRDF names links") && n.contains("\"foot\"")));
    assert!(model.clone().with_srdf("<srdf/>").is_err());
    // A base that should move by a virtual joint.
    let moving = r#"<robot><virtual_joint name="world" type="floating" parent_frame="map" child_link="base"/></robot>"#;
    let noted = |model: ArmModel| {
        model.with_srdf(moving).unwrap().notes.iter().any(|n| n.contains("base = \"floating\""))
    };
    let bounds = mp_geom::Aabb::new([0.0; 3].into(), [1.0; 3].into());
    assert!(noted(model.clone()) && !noted(ArmModel { floating: Some(bounds), ..model }));
}

/// An arm that slides along X, with this collision geometry.
fn slider(geometry: &str) -> String {
    format!(
        "<robot name=\"r\"><link name=\"base\"><collision><geometry>{geometry}</geometry></collision></link><link name=\"arm\">\
         <collision><geometry>{geometry}</geometry></collision></link><joint name=\"j\" type=\"prismatic\"><parent link=\"base\"/>\
         <child link=\"arm\"/><axis xyz=\"1 0 0\"/><limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/></joint></robot>"
    )
}

#[test]
fn shapes_without_volume_are_sheets_and_lines_and_points_are_left_out() {
    for point in [
        "<box size=\"0 0 0\"/>",
        "<sphere radius=\"0\"/>",
        "<cylinder radius=\"0.0\" length=\"0\"/>",
        "<capsule radius=\"0\" length=\"0\"/>",
        "<box size=\"0 -0.0 0e3\"/>",
    ] {
        let model = read(&slider(point)).unwrap();
        assert!(model.links.iter().all(|link| link.shapes.is_empty()), "{point}");
        assert!(
            model.notes.iter().any(|n| n.contains("size 0") && n.contains("\"base\", \"arm\"")),
            "{:?}",
            model.notes
        );
        Arm::new(&model, []).unwrap();
    }
    // What has an extent can be hit: by a post at x = 1, where the arm is with j = 1, and not with j = 0.
    for (thin, size) in [
        ("<box size=\"0.2 0.2 0\"/>", [0.2, 0.2, 0.0]),
        ("<box size=\"0 0.2 0.4\"/>", [0.0, 0.2, 0.4]),
        ("<box size=\"0.2 0 0\"/>", [0.2, 0.0, 0.0]),
        ("<cylinder radius=\"0\" length=\"0.4\"/>", [0.0, 0.0, 0.4]),
        ("<cylinder radius=\"0.1\" length=\"0\"/>", [0.2, 0.2, 0.0]),
        ("<capsule radius=\"0\" length=\"0.4\"/>", [0.0, 0.0, 0.4]),
        ("<capsule radius=\"0.1\" length=\"0\"/>", [0.2, 0.2, 0.2]),
    ] {
        let model = read(&slider(thin)).unwrap();
        assert!(model.notes.is_empty(), "{:?}", model.notes);
        let aabb = model.links[1].shapes[0].aabb();
        for (found, wanted) in (aabb.max - aabb.min).iter().zip(size) {
            // Round shapes are a little larger.
            assert!(*found >= wanted - 1e-15 && *found <= 1.03 * wanted, "{thin}: {aabb:?}");
        }
        let post = cuboid(0.05, 0.05, 0.3).unwrap();
        let mut arm =
            Arm::new(&model, [("post".to_owned(), post, nalgebra::Isometry3::translation(1.0, 0.0, 0.0))])
                .unwrap();
        for (j, free) in [(1.0, false), (0.95, size[0] == 0.0), (0.0, true)] {
            let q = Configuration::from(vec![j]);
            assert_eq!(mp_cspace::Validity::is_valid(&mut arm, &q), free, "{thin} at {j}");
        }
    }
    // Other lengths are wrong.
    for bad in [
        "<box size=\"0 0 -1\"/>",
        "<sphere radius=\"-0.1\"/>",
        "<cylinder radius=\"0\" length=\"nan\"/>",
        "<box size=\"0 inf 1\"/>",
    ] {
        assert!(read(&slider(bad)).is_err(), "{bad}");
    }
}

/// Readings of the clock.
static READ: std::sync::atomic::AtomicU64 = std::sync::atomic::AtomicU64::new(0);

#[test]
fn long_descriptions_hear_the_token_and_take_time_in_proportion() {
    use std::fmt::Write as _;
    use std::sync::atomic::Ordering::SeqCst;
    use std::time::Duration;
    // Steps of two milliseconds between readings, so that each question is one.
    let until = |n: u64| {
        READ.store(0, SeqCst);
        let clock = mp_cspace::Clock::new(|| Duration::from_millis(2 * READ.fetch_add(1, SeqCst)));
        mp_cspace::Interrupt::by(mp_cspace::Cancel::new(), clock, Duration::from_millis(2 * n))
    };
    let of = |n: usize| {
        let mut text = String::from("<robot name=\"r\"><link name=\"l\"/>");
        for i in 0..n {
            let _ = writeln!(
                text,
                "<link name=\"l{i}\"><collision><geometry><box size=\".1 .1 .1\"/></geometry></collision></link>\n<joint \
                 name=\"j{i}\" type=\"revolute\"><parent link=\"l\"/><child link=\"l{i}\"/><limit lower=\"-1\" upper=\"1\"/></joint>"
            );
        }
        text + "</robot>"
    };
    let text = of(400);
    let whole = ArmModel::from_urdf_until(&text, finger, &until(u64::from(u32::MAX))).unwrap();
    let questions = READ.load(SeqCst);
    assert!(questions > 1000, "one for each element and each shape, and some more: {questions}");
    // The parts that are read one after the other make the same robot.
    assert_eq!((whole.links.len(), whole.joints.len()), (401, 400));
    assert!(
        whole.joints.iter().enumerate().all(|(i, j)| j.name == format!("j{i}") && j.child == format!("l{i}"))
    );
    for part in [0.0, 0.1, 0.5, 0.7, 0.99] {
        let n = 1 + (part * (questions - 1) as f64) as u64;
        let error = ArmModel::from_urdf_until(&text, finger, &until(n)).unwrap_err();
        assert_eq!(error, UrdfError::Interrupted, "at {n} of {questions}");
        assert_eq!(READ.load(SeqCst), n + 1, "the clock is read after the end");
    }
    // Lines of errors are those of the text, whatever part they are in.
    let wrong = text.replace("name=\"j399\" type=\"revolute\"", "name=\"j399\" type=\"spherical\"");
    assert_eq!(read(&wrong).unwrap_err().line(), Some(800));
}

/// A planar joint is three joints, called as MoveIt calls them, in the place of the one: along x and y of its frame, and about z.
#[test]
fn planar_joints_slide_and_turn() {
    let base = "<robot name='r'><link name='world'/><link name='base'/><joint name='drive' type='planar'><origin xyz='0 0 0.5' rpy='0 0 \
                1.5707963267948966'/><parent link='world'/><child link='base'/></joint></robot>";
    let arm = Arm::new(&read(base).unwrap().with_limits("drive/x", -1.0, 2.0).unwrap(), []).unwrap();
    let coordinates: Vec<_> = arm.coordinates().iter().map(|c| (c.name.as_str(), c.range)).collect();
    let interval = |low, high| JointRange::Interval { low, high };
    assert_eq!(
        coordinates,
        [
            ("drive/x", interval(-1.0, 2.0)),
            ("drive/y", interval(-10.0, 10.0)),
            ("drive/theta", JointRange::Circle)
        ]
    );
    assert!(arm.model().notes[0].contains("\"drive\" is planar"), "{:?}", arm.model().notes);
    let poses = arm.kinematics().link_poses(&[1.0, 2.0, std::f64::consts::FRAC_PI_2]).unwrap();
    let at = arm.kinematics().links().position(|name| name == "base").unwrap();
    let [x, y] = [Vector3::new(-2.0, 1.0, 0.5), Vector3::new(-1.0, 0.0, 0.0)];
    assert!((poses[at].translation.vector - x).norm() < 1e-12, "{}", poses[at]);
    assert!((poses[at].rotation * Vector3::x() - y).norm() < 1e-12, "{}", poses[at]);
}

/// An SRDF knows a planar joint by its own name: in groups, and with three numbers in states. Joints that are not there are said.
#[test]
fn planar_joints_in_an_srdf() {
    let model = read(
        "<robot name='r'><link name='world'/><link name='base'/><link name='arm'/><joint name='drive' type='planar'><parent link='world'/>\
         <child link='base'/></joint><joint name='turn' type='continuous'><parent link='base'/><child link='arm'/></joint></robot>",
    )
    .unwrap();
    let srdf = "<robot name='r'><virtual_joint name='odom' type='fixed' parent_frame='map' child_link='world'/>\
                <group name='all'><joint name='odom'/><joint name='drive'/><joint name='turn'/><joint name='lost'/></group>\
                <group_state name='home' group='all'><joint name='drive' value='1 2 0.5'/><joint name='turn' value='3'/><joint name='gone' value='4'/>\
                </group_state></robot>";
    let groups = SrdfGroups::from_srdf(srdf).unwrap();
    assert_eq!(groups.joints(&model, "all").unwrap(), ["drive/x", "drive/y", "drive/theta", "turn"]);
    let values: Vec<_> =
        groups.states()[0].values.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let drive = [("drive/x", 1.0), ("drive/y", 2.0), ("drive/theta", 0.5)];
    assert_eq!(values, [&drive[..], &[("turn", 3.0), ("gone", 4.0)]].concat());
    let notes = model.clone().with_srdf(srdf).unwrap().notes;
    assert!(notes.iter().any(|note| note.ends_with("does not have: \"gone\", \"lost\"")), "{notes:?}");
    // A virtual joint is said where the base stands still.
    let moves = srdf.replace("type='fixed'", "type='planar'");
    let said = |model: ArmModel| {
        model.with_srdf(&moves).unwrap().notes.iter().any(|note| note.contains("the base stands still"))
    };
    assert!(said(model.clone()) && !said(model.with_planar_base([-1.0; 2], [1.0; 2]).unwrap()));
}

/// Humanoids and drones hang on the world by a joint that floats.
#[test]
fn a_joint_that_floats_between_the_world_and_the_robot_is_fixed() {
    let text = |more: &str| {
        format!(
            "<robot name=\"r\"><link name=\"world\"/><link name=\"base\"/><link name=\"arm\"/>{more}\n\
             <joint name=\"fb\" type=\"floating\"><origin xyz=\"0 0 2\"/><parent link=\"world\"/><child link=\"base\"/></joint>\
             <joint name=\"pan\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/></joint></robot>"
        )
    };
    let model = read(&text("")).unwrap();
    assert!(model.joints[0].kind == JointKind::Fixed && model.joints[0].origin.translation.z == 2.0);
    assert!(model.notes.len() == 1 && model.notes[0].contains("\"fb\" floats"), "{:?}", model.notes);
    let names = |model: &ArmModel| Kinematics::new(model).unwrap().coordinates().len();
    assert_eq!(names(&model), 1);
    let bounds = mp_geom::Aabb::new(Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0));
    assert!(Kinematics::new(&ArmModel { floating: Some(bounds), ..model }).unwrap().floats());
    // Not where the world has shapes, or more hangs on it, or in the middle of the robot.
    let shape = "<collision><geometry><box size=\"1 1 1\"/></geometry></collision>";
    let walls = text("").replace("<link name=\"world\"/>", &format!("<link name=\"world\">{shape}</link>"));
    let fixed = |parent: &str, child: &str| {
        format!(
            "<link name=\"more\"/><joint name=\"f\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>"
        )
    };
    for text in [walls, text(&fixed("world", "more")), text(&fixed("more", "world"))] {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains("line 2: joint \"fb\" is floating"), "{error}");
    }
}

/// Commas between numbers are blanks. Of too many numbers the first three count, and a note says so, unless the commas may be those
/// of decimals.
#[test]
fn commas_part_numbers_and_the_first_ones_count() {
    let commas =
        GRIPPER.replace("xyz=\"0.3 0 0\"", "xyz=\"0.3, 0,0\"").replace("0.2 0.2 0.1", "0.2,0.2, 0.1");
    assert_eq!(read(&commas).unwrap(), read(GRIPPER).unwrap());
    let many = read(&GRIPPER.replace("xyz=\"0.3 0 0\"", "xyz=\"0.3 0 0 7\"")).unwrap();
    assert_eq!(many.joints, read(GRIPPER).unwrap().joints);
    assert!(many.notes.iter().any(|note| note.starts_with("4 numbers where 3 count")), "{:?}", many.notes);
    for decimals in ["0,3 0 0", "0,3 0,0 0,0", "0,3, 0, 0"] {
        let error = read(&GRIPPER.replace("0.3 0 0", decimals)).unwrap_err().to_string();
        assert!(
            error.contains(&format!(
                "xyz of <origin> is \"{decimals}\", not 3 numbers: decimals have a point"
            )),
            "{error}"
        );
    }
}

#[test]
fn faults_are_named() {
    let says = |from: &str, to: &str, words: &[&str]| {
        assert!(GRIPPER.contains(from), "{from}");
        let error = match read(&GRIPPER.replacen(from, to, 1)) {
            Ok(model) => match Arm::new(&model, []) {
                Ok(_) => panic!("{to} is accepted"),
                Err(error) => error.to_string(),
            },
            Err(error) => error.to_string(),
        };
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    };
    says("</robot>", "", &["not a URDF"]);
    says("<robot name", "<model name", &["not a URDF"]);
    says("type=\"continuous\"", "type=\"floating\"", &["turn", "floating", "base = \"floating\""]);
    says("type=\"continuous\"", "type=\"spherical\"", &["turn", "spherical"]);
    says("type=\"continuous\"", "type=\"screw\"", &["not a URDF", "line 29", "turn", "screw", "prismatic"]);
    says("finger.stl", "thumb.stl", &["line 18", "left", "shape 1", "thumb.stl"]);
    says("1 -1 2", "1 inf 2", &["left", "scale"]);
    says("radius=\"0.05\"", "radius=\"-0.05\"", &["carriage", "shape 1", "radius"]);
    says("0.1 0 0\" rpy", "0.1 nan 0\" rpy", &["carriage", "origin"]);
    says("0 0 0.1\" rpy", "0 0 inf\" rpy", &["lift", "origin"]);
    says("0 0 2", "0 0 0", &["lift", "axis"]);
    says("lower=\"0\" upper=\"0.5\"", "lower=\"1\" upper=\"0.5\"", &["lift", "1 to 0.5", "lower limit"]);
    says("mimic joint=\"open\"", "mimic joint=\"shut\"", &["close", "shut"]);
    says("mimic joint=\"open\"", "mimic joint=\"close\"", &["close", "itself"]);
    says("child link=\"right\"", "child link=\"left\"", &["left", "open", "close"]);
    says("<link name=\"spin\"/>", "", &["turn", "child", "spin"]);
    says(" name=\"lift\"", "", &["line 4", "<joint> has no name"]);
    says("<parent link=\"base\"/>", "", &["line 4", "\"lift\"", "prismatic", "no <parent>"]);
    says(
        "<limit lower=\"0\" upper=\"0.5\" effort=\"1\" velocity=\"1\"/>",
        "",
        &["line 4", "lift", "no <limit>"],
    );
    says("lower=\"0\"", "lower=\"zero\"", &["line 8", "lower of <limit>", "zero", "a number"]);
    says("0 0 0.1\" rpy", "0 0.1\" rpy", &["line 6", "xyz of <origin>", "3 numbers"]);
    says("<axis xyz=\"0 0 2\"/>", "<axis/>", &["line 7", "<axis> has no xyz"]);
    says("<sphere radius=\"0.06\"/>", "<cone radius=\"0.06\"/>", &["line 16", "<cone>", "<capsule>"]);
    says("<geometry><sphere radius=\"0.06\"/></geometry>", "", &["line 16", "<geometry>"]);
    says(" filename=\"package://gripper/finger.stl\"", "", &["line 18", "<mesh> has no filename"]);
    says(
        "<link name=\"spin\"/>",
        "<link name=\"spin\"/><xacro:wheel xmlns:xacro=\"http://ros.org/wiki/xacro\"/>",
        &["line 20", "<xacro:wheel>", "run xacro"],
    );
    says("<link name=\"spin\"/>", "<link name=\"spin\"/><xacro:wheel/>", &["line 20", "run xacro"]);
    let deep = format!("<robot name=\"x\">{}{}</robot>", "<link>".repeat(100), "</link>".repeat(100));
    assert!(matches!(read(&deep), Err(UrdfError::Syntax { .. })));
    assert!(matches!(read(""), Err(UrdfError::Syntax { .. })));
}

/// What stands in files of robots that others publish.
#[test]
fn what_no_planner_reads_may_be_anything() {
    // Limits of velocity are for trajectories.
    let read = |text: &str| {
        let mut model = read(text)?;
        model.joints.iter_mut().for_each(|joint| joint.max_velocity = None);
        Ok::<_, UrdfError>(model)
    };
    let plain = read(GRIPPER).unwrap();
    assert!(plain.notes.is_empty(), "{:?}", plain.notes);
    let notes = |from: &str, to: &str, words: &[&str]| {
        assert!(GRIPPER.contains(from), "{from}");
        let model = read(&GRIPPER.replacen(from, to, 1)).unwrap_or_else(|error| panic!("{to}: {error}"));
        assert_eq!((&model.links, &model.joints), (&plain.links, &plain.joints), "{to}");
        let all = model.notes.join("\n");
        assert!(words.iter().all(|word| all.contains(word)), "{to}: {all}");
        assert_eq!(model.notes.len(), usize::from(!words.is_empty()), "{to}: {all}");
    };
    // Name spaces that are declared and that are not.
    notes(
        "velocity=\"1\"",
        "velocity=\"1\" drake:acceleration=\"15\"",
        &["attributes of other", "\"drake\""],
    );
    let declared = "<robot xmlns:drake=\"http://drake.mit.edu\" name=\"gripper\">";
    notes("<robot name=\"gripper\">", declared, &[]);
    let used = format!("{declared}<drake:collision_filter_group><member/></drake:collision_filter_group>");
    notes("<robot name=\"gripper\">", &used, &["elements", "\"http://drake.mit.edu\""]);
    notes(
        "<axis xyz=\"0 0 2\"/>",
        "<sim:axis xyz=\"1 0 0\"/><axis xyz=\"0 0 2\"/>",
        &["elements", "\"sim\""],
    );
    notes("name=\"lift\"", "sim:name=\"drop\" name=\"lift\"", &["\"sim\""]);
    // Masses, visual shapes, materials.
    let spin = "<link name=\"spin\"/>";
    let with = |inside: &str| format!("<link name=\"spin\">{inside}</link>");
    notes(spin, &with("<inertial><mass value=\"1\"/></inertial>"), &["masses", "\"spin\""]);
    notes(spin, &with("<inertial/><inertial/>"), &["masses", "\"spin\""]);
    notes(spin, &with("<inertial><mass value=\"?\"/><inertia/></inertial>"), &[]);
    notes(spin, &with("<visual><geometry><mesh/></geometry></visual>"), &["visual", "\"spin\""]);
    notes(spin, &with("<visual><geometry><mesh filename=\"lost.stl\"/></geometry></visual>"), &[]);
    notes(spin, &with("<visual><material><texture/></material></visual><visual/>"), &[]);
    notes(spin, &with("<visual><xacro:grey/></visual>"), &["elements", "\"xacro\""]);
    notes(
        spin,
        &format!("{spin}<material/><gazebo><joint/><link/></gazebo><transmission><joint/></transmission>"),
        &[],
    );
    // Limits without velocity, or with one that is no number; second elements.
    notes("velocity=\"1\"", "", &[]);
    notes("velocity=\"1\"", "velocity=\"fast\"", &[]);
    notes(
        "<axis xyz=\"0 0 2\"/>",
        "<axis xyz=\"0 0 2\"/><axis xyz=\"1 0 0\"/><dynamics damping=\"?\"/>",
        &[],
    );
    notes("<child link=\"spin\"/>", "<child link=\"spin\"/><limit effort=\"1\" lower=\"?\"/>", &[]);
    // Characters that XML has words for.
    let odd = GRIPPER.replace("\"spin\"", "\"a &lt;&amp;&quot; b\"");
    assert!(read(&odd).unwrap().links.iter().any(|link| link.name == "a <&\" b"));
}

#[test]
fn many_undeclared_prefixes_are_refused() {
    let many: String = (0..100).map(|i| format!("<p{i}:x/>")).collect();
    let error = read(&GRIPPER.replace("<link name=\"spin\"/>", &many)).unwrap_err().to_string();
    assert!(error.contains("prefixes"), "{error}");
}

#[test]
fn joints_without_room_are_held() {
    // As many published files have it: a limit without lower and upper, which stand for 0.
    let model = read(&GRIPPER.replace("lower=\"0\" upper=\"0.5\"", "")).unwrap();
    assert!(model.notes.len() == 1 && model.notes[0].contains("\"lift\""), "{:?}", model.notes);
    let names = |model: &ArmModel| {
        let arm = Arm::new(model, []).unwrap();
        arm.coordinates().iter().map(|c| c.name.clone()).collect::<Vec<_>>()
    };
    assert_eq!(names(&model), ["open", "turn"]);
    assert_eq!(names(&model.clone().with_limits("lift", 0.0, 0.1).unwrap()), ["lift", "open", "turn"]);
    let none = r#"<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>
        <child link="b"/><limit lower="0.5" upper="0.5"/></joint></robot>"#;
    let error = Arm::new(&read(none).unwrap(), []).unwrap_err().to_string();
    assert!(error.contains("\"j\"") && error.contains("equal"), "{error}");
}

/// As for MoveIt, limits are within those of a safety controller.
#[test]
fn soft_limits_are_limits() {
    let read = |limits: &str, soft: &str| {
        let text = format!(
            "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"revolute\"><parent link=\"a\"/>\
             <child link=\"b\"/><limit {limits}/><safety_controller k_velocity=\"1\" {soft}/></joint></robot>"
        );
        let model = read(&text).unwrap();
        (model.joints[0].kind.limits().unwrap(), model.notes)
    };
    let hard = "lower=\"-3\" upper=\"3\"";
    for (soft, expected, note) in [
        ("soft_lower_limit=\"-1\" soft_upper_limit=\"2\"", [-1.0, 2.0], "soft limits of their safety"),
        ("soft_lower_limit=\"-9\" soft_upper_limit=\"2\"", [-3.0, 2.0], "soft limits of their safety"),
        ("soft_lower_limit=\"-1\"", [-1.0, 0.0], "soft limits of their safety"),
        ("soft_lower_limit=\"-9\" soft_upper_limit=\"9\"", [-3.0, 3.0], ""),
        ("soft_lower_limit=\"-3\" soft_upper_limit=\"3\"", [-3.0, 3.0], ""),
        ("", [-3.0, 3.0], ""),
        ("soft_lower_limit=\"4\" soft_upper_limit=\"5\"", [-3.0, 3.0], "no room"),
        ("soft_lower_limit=\"1\" soft_upper_limit=\"-1\"", [-3.0, 3.0], "no room"),
    ] {
        let (limits, notes) = read(hard, soft);
        assert_eq!((limits, notes.len()), (expected, usize::from(!note.is_empty())), "{soft}: {notes:?}");
        assert!(notes.iter().all(|said| said.contains(note) && said.contains("\"j\"")), "{notes:?}");
    }
    // What follows another has no limits for MoveIt.
    let close = "<mimic joint=\"open\" multiplier=\"-1\"/>";
    let soft = format!("{close}<safety_controller soft_lower_limit=\"0\" soft_upper_limit=\"0.1\"/>");
    assert_eq!(self::read(&GRIPPER.replace(close, &soft)).unwrap(), self::read(GRIPPER).unwrap());
}

#[test]
fn followers_without_room_are_followed_no_less() {
    // The other way from what it follows, but with the limits of that.
    let text = GRIPPER.replace("lower=\"-0.25\" upper=\"1\"", "lower=\"0.5\" upper=\"1\"");
    let model = read(&text).unwrap();
    assert!(model.notes.len() == 1 && model.notes[0].contains("\"close\""), "{:?}", model.notes);
    let arm = Arm::new(&model, []).unwrap();
    assert_eq!(arm.coordinates()[1].range, JointRange::Interval { low: -0.5, high: 0.5 });
    // Neither has room, until the leader is given some.
    let still =
        GRIPPER.replace("lower=\"-0.25\" upper=\"1\"", "").replace("lower=\"-0.5\" upper=\"0.5\"", "");
    let model = read(&still).unwrap();
    assert_eq!(Arm::new(&model, []).unwrap().dof(), 2);
    let arm = Arm::new(&model.with_limits("open", -0.4, 0.3).unwrap(), []).unwrap();
    assert_eq!(arm.coordinates()[1].range, JointRange::Interval { low: -0.4, high: 0.3 });
}

#[test]
fn later_versions_mean_what_they_say() {
    let turned = |version: &str| {
        let text = r#"<robot name="r" version="V"><link name="a"/><link name="b"/><joint name="j" type="continuous">
            <parent link="a"/><child link="b"/><origin xyz="0 0 0" quat_xyzw="0 0 1 0"/></joint></robot>"#;
        read(&text.replace('V', version)).unwrap().joints[0].origin.rotation.angle()
    };
    for version in ["1.0", "1.1", "1.1.0", "2", "", "new"] {
        assert!((turned(version) - std::f64::consts::PI).abs() < 1e-9, "{version}");
    }
    let slide = |version: &str, limit: &str, origin: &str| {
        read(&format!(
            r#"<robot name="r" version="{version}"><link name="a"/><link name="b"/><joint name="j" type="prismatic">
            <parent link="a"/><child link="b"/>
            {origin}<limit {limit}/></joint></robot>"#
        ))
    };
    // A limit that is not written is zero, and none from 1.2 on.
    let none = [f64::NEG_INFINITY, 2.0];
    for (version, limits) in
        [("1.0", [0.0, 2.0]), ("1", [0.0, 2.0]), ("1.2", none), ("1.2.0", none), ("2", none)]
    {
        let [low, high] = limits;
        let kind = &slide(version, r#"upper="2""#, "").unwrap().joints[0].kind;
        assert_eq!(*kind, JointKind::Prismatic { low, high });
    }
    let both = slide("1.1", r#"upper="2""#, r#"<origin rpy="0 0 1" quat_xyzw="0 0 0 1"/>"#).unwrap_err();
    assert!(both.to_string().contains("line 3") && both.to_string().contains("leave one out"), "{both}");
    let bad = slide("1.1", r#"upper="2""#, r#"<origin quat_xyzw="0 0 1"/>"#).unwrap_err();
    assert!(bad.to_string().contains("quat_xyzw of <origin> is \"0 0 1\", not 4 numbers"), "{bad}");
}

/// As in SDF: it was passed over, and the mesh was as large as its file.
#[test]
fn an_element_that_scales_is_an_error() {
    let text = r#"<robot name="r"><link name="a"/><link name="b"><collision><geometry>
        <mesh filename="b.stl"><scale>0.001 0.001 0.001</scale></mesh></geometry></collision></link>
        <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#;
    let said = read(text).unwrap_err().to_string();
    assert!(said.contains("line 2") && said.contains("scale=\"x y z\""), "{said}");
    // What is only looked at is not read so strictly.
    assert!(read(&text.replace("collision", "visual")).is_ok());
}

#[test]
fn damaged_files_are_errors_or_robots() {
    for start in (0..GRIPPER.len()).step_by(GRIPPER.len() / cases_of(GRIPPER.len())) {
        let without = |n: usize| [&GRIPPER[..start], &GRIPPER[(start + n).min(GRIPPER.len())..]].concat();
        for text in [without(1), without(9), GRIPPER[..start].to_owned()] {
            let _ = read(&text).map(|model| Arm::new(&model, []).map(|arm| arm.dof()));
        }
    }
}
