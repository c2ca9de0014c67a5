//! `six.urdf`, an arm of boxes and cylinders with six joints, and `arm`: it reaches from one compartment of a shelf
//! into the next.

use super::scene::Files;
use std::fmt::Write as _;

/// A collision shape: its geometry in URDF, and its position in the frame of the link.
type CollisionShape = (&'static str, [f64; 3]);

/// A link, the height of its joint above the previous one, the axis, and the limits (none for a continuous joint).
struct LinkEntry {
    link: &'static str,
    height: f64,
    axis: &'static str,
    limits: Option<[f64; 2]>,
    shapes: &'static [CollisionShape],
}

const BASE: CollisionShape = (r#"<cylinder radius="0.1" length="0.12"/>"#, [0.0, 0.0, 0.06]);

const LINKS: [LinkEntry; 6] = [
    LinkEntry {
        link: "turret",
        height: 0.13,
        axis: "0 0 1",
        limits: Some([-2.9, 2.9]),
        shapes: &[
            (r#"<cylinder radius="0.08" length="0.12"/>"#, [0.0, 0.0, 0.07]),
            (r#"<box size="0.1 0.14 0.1"/>"#, [0.0, 0.0, 0.18]),
        ],
    },
    LinkEntry {
        link: "upper",
        height: 0.2,
        axis: "0 1 0",
        limits: Some([-1.9, 1.9]),
        shapes: &[(r#"<box size="0.08 0.08 0.42"/>"#, [0.0, 0.0, 0.2])],
    },
    LinkEntry {
        link: "elbow",
        height: 0.42,
        axis: "0 1 0",
        limits: Some([-2.5, 2.5]),
        shapes: &[(r#"<box size="0.08 0.1 0.12"/>"#, [0.0, 0.0, 0.04])],
    },
    LinkEntry {
        link: "fore",
        height: 0.12,
        axis: "0 0 1",
        limits: Some([-3.0, 3.0]),
        shapes: &[(r#"<cylinder radius="0.035" length="0.24"/>"#, [0.0, 0.0, 0.12])],
    },
    LinkEntry {
        link: "wrist",
        height: 0.28,
        axis: "0 1 0",
        limits: Some([-2.0, 2.0]),
        shapes: &[(r#"<box size="0.05 0.06 0.08"/>"#, [0.0, 0.0, 0.03])],
    },
    LinkEntry {
        link: "hand",
        height: 0.09,
        axis: "0 0 1",
        limits: None,
        shapes: &[
            (r#"<cylinder radius="0.035" length="0.04"/>"#, [0.0, 0.0, 0.02]),
            (r#"<box size="0.02 0.015 0.06"/>"#, [0.0, 0.025, 0.07]),
            (r#"<box size="0.02 0.015 0.06"/>"#, [0.0, -0.025, 0.07]),
        ],
    },
];

/// Adds the robot and the problem.
pub(super) fn add(files: &mut Files) {
    files.insert("robots/six.urdf".into(), urdf().into_bytes());
    files.insert("scenes/arm.toml".into(), PROBLEM.into());
}

fn urdf() -> String {
    let mut out = String::from(
        "<?xml version=\"1.0\"?>\n<!-- Six joints, boxes and cylinders. -->\n<robot name=\"six\">\n",
    );
    let link = |out: &mut String, name: &str, shapes: &[CollisionShape]| {
        let _ = writeln!(out, "  <link name=\"{name}\">");
        for (geometry, [x, y, z]) in shapes {
            let _ = writeln!(
                out,
                "    <collision><origin xyz=\"{x} {y} {z}\"/><geometry>{geometry}</geometry></collision>"
            );
        }
        out.push_str("  </link>\n");
    };
    link(&mut out, "base", &[BASE]);
    let mut parent = "base";
    for (i, entry) in LINKS.iter().enumerate() {
        let LinkEntry { link: child, height, axis, limits, shapes } = entry;
        link(&mut out, child, shapes);
        let kind = if limits.is_some() { "revolute" } else { "continuous" };
        let _ = writeln!(out, "  <joint name=\"joint{}\" type=\"{kind}\">", i + 1);
        let _ = writeln!(out, "    <parent link=\"{parent}\"/><child link=\"{child}\"/>");
        let _ = writeln!(out, "    <origin xyz=\"0 0 {height}\"/><axis xyz=\"{axis}\"/>");
        if let Some([low, high]) = limits {
            let _ =
                writeln!(out, "    <limit lower=\"{low}\" upper=\"{high}\" effort=\"10\" velocity=\"1\"/>");
        }
        out.push_str("  </joint>\n");
        parent = child;
    }
    out.push_str("</robot>\n");
    out
}

const PROBLEM: &str = r#"# An arm on a table reaches from one compartment of a shelf into the next.

[robot]
urdf = "../robots/six.urdf"

[motion]
start = [-0.1, 1.2, 0.9, 0, -0.53, 0.5]
goals = [
  [0.2, 0.9276, 0.6737, 0, -0.03, 3],
  [0.2, 0.9276, 0.6737, 0, -0.03, -1],
]

[[obstacle]]
name = "table"
box = [2.4, 1.6, 0.04]
pose = [0.3, 0, -0.022, 0, 0, 0]

[[obstacle]]
name = "lower board"
box = [0.4, 0.6, 0.02]
pose = [0.92, 0, 0.12, 0, 0, 0]

[[obstacle]]
name = "middle board"
box = [0.4, 0.6, 0.02]
pose = [0.92, 0, 0.42, 0, 0, 0]

[[obstacle]]
name = "upper board"
box = [0.4, 0.6, 0.02]
pose = [0.92, 0, 0.72, 0, 0, 0]

[[obstacle]]
name = "left side"
box = [0.4, 0.02, 0.74]
pose = [0.92, 0.31, 0.36, 0, 0, 0]

[[obstacle]]
name = "right side"
box = [0.4, 0.02, 0.74]
pose = [0.92, -0.31, 0.36, 0, 0, 0]

[[obstacle]]
name = "lamp post"
cylinder = [0.025, 0.6]
pose = [0.45, 0.3, 0.3, 0, 0, 0]

[[obstacle]]
name = "lamp"
sphere = 0.08
pose = [0.4, 0.3, 0.65, 0, 0, 0]
"#;
