//! Problems of our own in the form of OMPL.app's.

use super::{OmplExport, OmplProblem, export_ompl};
use crate::{RigidProblem, SpaceKind, write_off, write_stl};
use mp_formats::error::ErrorKind;
use mp_geom::{TriMesh, primitives};
use nalgebra::{Isometry3, Point3, Vector3};

const SPACE: &str = "\u{feff}[problem]\r\nname = Two boxes # of ours\nrobot=robot.off\nWorld = world.stl\n\nstart.x = 1.5
start.y=2\nstart.z=3\nstart.theta=0\nstart.axis.x=0\nstart.axis.y=0\nstart.axis.z=0\ngoal.x=-1\ngoal.y=0\ngoal.z=0
goal.theta=1.5707963267948966\ngoal.axis.x=0\ngoal.axis.y=0\ngoal.axis.z=-2\nthreshold = 1e-3\nsampler=uniform
[benchmark]\ntime_limit=20.0\n[planner]\nrrt=\nrrt.range=5\nrrt=\n";

const PLANE: &str =
    "[problem]\nrobot=robot.off\nworld=world.stl\nstart.x=0\nstart.y=0\nstart.theta=0\ngoal.x=30\ngoal.y=1
goal.theta=0.5\nvolume.min.x=-55\nvolume.min.y=-56\nvolume.max.x=25\nvolume.max.y=57\n";

/// A box of 1 × 2 × 3 with its lowest corner at (10, 0, 5), and a world of 8 × 8 × 8 around the origin.
fn folder() -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let robot = primitives::cuboid(1.0, 2.0, 3.0).unwrap();
    let robot = robot.transformed(&Isometry3::translation(10.5, 1.0, 6.5));
    write_off(dir.path().join("robot.off"), &robot).unwrap();
    write_stl(dir.path().join("world.stl"), &primitives::cuboid(8.0, 8.0, 8.0).unwrap()).unwrap();
    dir
}

fn load(text: &str) -> Result<RigidProblem, crate::Error> {
    let dir = folder();
    let path = dir.path().join("boxes.cfg");
    std::fs::write(&path, text).unwrap();
    RigidProblem::load(&path)
}

fn lowest(mesh: &TriMesh) -> Point3<f64> {
    mesh.aabb().min
}

#[test]
fn in_space() {
    let p = load(SPACE).unwrap();
    assert_eq!((p.name.as_str(), p.space, p.obstacles.len()), ("Two boxes", SpaceKind::Se3, 1));
    assert_eq!(p.start, Isometry3::translation(1.5, 2.0, 3.0));
    let turned = p.goal.rotation * Vector3::x();
    assert!((turned + Vector3::y()).norm() < 1e-12, "turned by −90° about Z");
    assert_eq!(lowest(&p.robot.mesh), Point3::new(-0.5, -1.0, -1.5));
    let b = p.bounds.unwrap();
    assert_eq!((b.min, b.max), (Point3::new(-4.0, -4.0, -4.0), Point3::new(4.0, 4.0, 4.0)));
}

#[test]
fn in_the_plane() {
    let p = load(PLANE).unwrap();
    assert_eq!((p.name.as_str(), p.space), ("boxes", SpaceKind::Se2));
    assert_eq!(lowest(&p.robot.mesh), Point3::new(-0.5, -1.0, 5.0));
    assert!((p.goal.rotation.angle() - 0.5).abs() < 1e-12);
    let b = p.bounds.unwrap();
    assert_eq!((b.min, b.max), (Point3::new(-55.0, -56.0, 0.0), Point3::new(30.0, 57.0, 0.0)));
}

#[test]
fn a_mixture_of_plane_and_space_is_refused() {
    let e = load(&PLANE.replace("start.theta=0", "start.theta=0\nstart.z=1")).unwrap_err();
    assert_eq!(e.message(), "[problem] has no `start.axis.x`");
    assert!(e.remedy().unwrap().starts_with("in space"));
    let e = load(&PLANE.replace("robot=", "control=kinematic_car\nrobot=")).unwrap_err();
    assert_eq!((e.kind(), e.line()), (ErrorKind::Unsupported, Some(2)));
}

#[test]
fn the_document_keeps_what_the_file_says() {
    let read = OmplProblem::parse("a.cfg", SPACE.as_bytes()).unwrap();
    assert_eq!((read.threshold, read.volume, read.control.as_deref()), (Some(1e-3), None, None));
    assert_eq!(read.world.as_deref(), Some("world.stl"));
    assert_eq!(read.goal.axis, Vector3::new(0.0, 0.0, -2.0));
}

#[test]
fn exports_one_json_and_two_off_files() {
    let dir = folder();
    let mut problem = load(SPACE).unwrap();
    let mut second = problem.obstacles[0].clone();
    second.pose = Isometry3::translation(100.0, 0.0, 0.0);
    problem.obstacles.push(second);
    let json = export_ompl(&problem, dir.path(), "boxes", &OmplExport::default()).unwrap();
    insta::assert_snapshot!(std::fs::read_to_string(&json).unwrap(), @r#"
    {
      "name": "Two boxes",
      "space": "SE3",
      "start": {
        "position": [
          1.5,
          2.0,
          3.0
        ],
        "quaternion": {
          "x": 0.0,
          "y": 0.0,
          "z": 0.0,
          "w": 1.0
        }
      },
      "goal": {
        "position": [
          -1.0,
          0.0,
          0.0
        ],
        "quaternion": {
          "x": 0.0,
          "y": 0.0,
          "z": -0.7071067811865475,
          "w": 0.7071067811865476
        }
      },
      "bounds": {
        "low": [
          -4.0,
          -4.0,
          -4.0
        ],
        "high": [
          4.0,
          4.0,
          4.0
        ]
      },
      "goal_threshold": 1e-6,
      "resolution_fraction": 0.01,
      "robot": {
        "mesh": "boxes_robot.off"
      },
      "env": {
        "mesh": "boxes_env.off"
      }
    }
    "#);
    let env = crate::read_mesh(dir.path().join("boxes_env.off")).unwrap();
    assert_eq!((env.triangles().len(), env.aabb().max.x), (24, 104.0));
    assert_eq!(crate::read_mesh(dir.path().join("boxes_robot.off")).unwrap(), problem.robot.mesh);

    let json = export_ompl(&load(PLANE).unwrap(), dir.path(), "flat", &OmplExport::default()).unwrap();
    let text = std::fs::read_to_string(&json).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["space"], "SE2");
    assert_eq!(value["start"]["yaw"], 0.0);
    assert_eq!(value["goal"]["position"], serde_json::json!([30.0, 1.0]));
    assert_eq!(value["bounds"]["low"], serde_json::json!([-55.0, -56.0]));
    problem.obstacles.clear();
    assert!(export_ompl(&problem, dir.path(), "none", &OmplExport::default()).is_err());
    assert!(!dir.path().join("none_robot.off").exists());
}
