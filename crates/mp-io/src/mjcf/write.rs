//! The URDF and the SRDF of a model.

use super::document::Element;
use super::geom::Geometry;
use super::tree::{MjJoint, Moves, Reader};
use mp_formats::error::Error;
use mp_formats::number::Row;
use mp_geom::six_from_pose;
use nalgebra::Isometry3;
use std::fmt::Write as _;

/// The group of the states that keyframes are.
const GROUP: &str = "keyframe";

/// The text, and for each line the number of the file and the line there that it comes from.
struct Lines<'a, 'm> {
    reader: &'a Reader<'a, 'm>,
    text: String,
    lines: Vec<(usize, usize)>,
    /// Where the lines of each file end.
    ends: Vec<Vec<usize>>,
}

impl<'m> Lines<'_, 'm> {
    fn push(&mut self, node: Element<'m>, line: &str) {
        let file = self.reader.model.source(node);
        let start = node.range().start;
        self.lines.push((file, self.ends[file].partition_point(|end| *end < start) + 1));
        self.text.push_str(line);
        self.text.push('\n');
    }
}

/// A text as the value of an attribute.
fn quoted(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
    text.replace('\n', "&#10;").replace('\r', "&#13;").replace('\t', "&#9;")
}

fn origin(pose: &Isometry3<f64>) -> String {
    let [x, y, z, yaw, pitch, roll] = six_from_pose(pose).map(|x| x + 0.0); // no −0
    format!("<origin xyz=\"{}\" rpy=\"{}\"/>", Row(&[x, y, z]), Row(&[roll, pitch, yaw]))
}

fn robot(reader: &Reader<'_, '_>) -> String {
    let root = reader.model.documents[0].root_element();
    format!("<robot name=\"{}\">", quoted(root.attribute("model").unwrap_or("MuJoCo Model")))
}

/// The URDF, and where its lines come from.
pub(super) fn urdf(reader: &Reader<'_, '_>) -> (String, Vec<(usize, usize)>) {
    let ends = |text: &str| text.match_indices('\n').map(|(at, _)| at).collect();
    let ends = reader.model.sources.iter().map(|source| ends(&source.text)).collect();
    let mut lines = Lines { reader, text: String::new(), lines: Vec::new(), ends };
    let root = reader.model.documents[0].root_element();
    lines.push(root, &robot(reader));
    for link in &reader.links {
        lines.push(link.node, &format!("<link name=\"{}\">", quoted(&link.name)));
        for shape in &link.shapes {
            let geometry = match &shape.geometry {
                Geometry::Cuboid(size) => format!("<box size=\"{}\"/>", Row(size)),
                Geometry::Sphere(radius) => format!("<sphere radius=\"{}\"/>", Row(&[*radius])),
                Geometry::Capsule([radius, length]) => {
                    format!("<capsule radius=\"{}\" length=\"{}\"/>", Row(&[*radius]), Row(&[*length]))
                }
                Geometry::Cylinder([radius, length]) => {
                    format!("<cylinder radius=\"{}\" length=\"{}\"/>", Row(&[*radius]), Row(&[*length]))
                }
                Geometry::Mesh(name, scale) => {
                    format!("<mesh filename=\"{}\" scale=\"{}\"/>", quoted(name), Row(scale))
                }
            };
            lines.push(
                shape.node,
                &format!("<collision>{}<geometry>{geometry}</geometry></collision>", origin(&shape.pose)),
            );
        }
        lines.push(link.node, "</link>");
    }
    for joint in &reader.joints {
        lines.push(joint.node, &joint_text(reader, joint));
    }
    lines.push(root, "</robot>");
    (lines.text, lines.lines)
}

fn joint_text(reader: &Reader<'_, '_>, joint: &MjJoint<'_>) -> String {
    let kind = match (joint.moves, joint.range) {
        (Moves::Fixed, _) => "fixed",
        (Moves::Turns, None) => "continuous",
        (Moves::Turns, Some(_)) => "revolute",
        (Moves::Slides, _) => "prismatic",
    };
    let [parent, child] = [joint.parent, joint.child].map(|link| quoted(&reader.links[link].name));
    let mut text = format!(
        "<joint name=\"{}\" type=\"{kind}\">{}<parent link=\"{parent}\"/><child link=\"{child}\"/>",
        quoted(&joint.name),
        origin(&joint.origin)
    );
    if joint.moves != Moves::Fixed {
        let axis = joint.axis;
        let _ = write!(text, "<axis xyz=\"{}\"/>", Row(&[axis.x, axis.y, axis.z])); // never fails for strings
        if let Some([low, high]) = joint.range {
            let _ = write!(text, "<limit lower=\"{}\" upper=\"{}\"/>", Row(&[low]), Row(&[high]));
        }
        if let Some((leader, [constant, factor])) = reader.couplings.of.get(joint.name.as_str())
            && let Some(followed) = reader.joints.iter().find(|other| other.name == **leader)
        {
            let offset = constant + joint.reference - factor * followed.reference;
            let _ = write!(
                text,
                "<mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>",
                quoted(leader),
                Row(&[*factor]),
                Row(&[offset])
            );
        }
    }
    text + "</joint>"
}

pub(super) fn srdf(reader: &mut Reader<'_, '_>) -> Result<String, Error> {
    let [may_touch, kept_apart] = reader.link_pairs()?;
    let states = reader.keyframes()?;
    let mut text = robot(reader) + "\n";
    for (element, pairs) in [("disable_collisions", may_touch), ("enable_collisions", kept_apart)] {
        for (a, b) in pairs {
            let [a, b] = [a, b].map(|link| quoted(&reader.links[link].name));
            let _ = writeln!(text, "<{element} link1=\"{a}\" link2=\"{b}\" reason=\"MJCF\"/>"); // never fails for strings
        }
    }
    for (name, values) in states {
        let _ = writeln!(text, "<group_state name=\"{}\" group=\"{GROUP}\">", quoted(&name));
        for (joint, value) in values {
            let joint = quoted(&reader.joints[joint].name);
            let _ = writeln!(text, "<joint name=\"{joint}\" value=\"{}\"/>", Row(&[value + 0.0]));
        }
        text += "</group_state>\n";
    }
    Ok(text + "</robot>\n")
}
