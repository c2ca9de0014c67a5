//! Instances as files: scenes and a robot in the formats of docs/formats, so that every program opens them.

use super::boxes::Obstacle;
use mp_geom::{Aabb, TriMesh, short_six_from_pose};
use mp_robot::{ArmModel, JointKind};
use std::fmt::Write as _;

/// Numbers with `between` them, each in the shortest form that reads back exactly.
fn joined(numbers: &[f64], between: &str) -> String {
    let texts: Vec<String> = numbers.iter().map(f64::to_string).collect();
    texts.join(between)
}

/// A list of numbers in TOML.
pub(super) fn list(numbers: &[f64]) -> String {
    format!("[{}]", joined(numbers, ", "))
}

/// The sides of a box, and its centre.
fn sides_and_centre(cuboid: &TriMesh) -> [[f64; 3]; 2] {
    let bounds = Aabb::of_points(cuboid.vertices());
    [(bounds.max - bounds.min).into(), bounds.center().into()]
}

/// The obstacles of a scene.
pub(super) fn obstacles(all: &[Obstacle]) -> String {
    let mut out = String::new();
    for (name, cuboid, pose) in all {
        let [sides, _] = sides_and_centre(cuboid);
        let (sides, pose) = (list(&sides), list(&short_six_from_pose(pose)));
        let _ = write!(out, "\n[[obstacle]]\nname = \"{name}\"\nbox = {sides}\npose = {pose}\n");
    }
    out
}

/// The URDF of an arm of boxes and revolute joints, none of which turns the frame of its child.
pub(super) fn urdf(name: &str, about: &str, model: &ArmModel) -> String {
    let mut out = format!("<?xml version=\"1.0\"?>\n<!-- {about} -->\n<robot name=\"{name}\">\n");
    let words = |numbers: &[f64]| joined(numbers, " ");
    for link in &model.links {
        let _ = writeln!(out, "  <link name=\"{}\">", link.name);
        for shape in &link.shapes {
            let [sides, centre] = sides_and_centre(shape);
            let _ = writeln!(
                out,
                "    <collision><origin xyz=\"{}\"/><geometry><box size=\"{}\"/></geometry></collision>",
                words(&centre),
                words(&sides)
            );
        }
        out += "  </link>\n";
    }
    for joint in &model.joints {
        let JointKind::Revolute { low, high } = joint.kind else { continue };
        let (at, axis) = (joint.origin.translation.vector, joint.axis);
        let _ = write!(
            out,
            "  <joint name=\"{}\" type=\"revolute\">
    <parent link=\"{}\"/><child link=\"{}\"/>
    <origin xyz=\"{}\"/><axis xyz=\"{}\"/>
    <limit lower=\"{low}\" upper=\"{high}\" effort=\"10\" velocity=\"1\"/>
  </joint>\n",
            joint.name,
            joint.parent,
            joint.child,
            words(at.as_slice()),
            words(axis.as_slice()),
        );
    }
    out + "</robot>\n"
}
