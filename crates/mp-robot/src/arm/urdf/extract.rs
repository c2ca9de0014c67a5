//! The parts of a URDF that planning needs: links with collision shapes, and joints. Everything else is left out before the
//! document is parsed, so that errors in it do not matter.

use super::super::UrdfError;
use super::super::xml::{Text, some};
use mp_cspace::Interrupt;
use roxmltree::{Attribute, Node};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// A URDF reduced to the parts that planning needs.
pub(super) struct Extract {
    /// The reduced document, in parts that are documents themselves: a reader cannot be interrupted within one.
    pub(super) parts: Vec<String>,
    /// For each link, the lines of its collision shapes in the original text.
    pub(super) links: Vec<Vec<u32>>,
    /// The lines of the joints.
    pub(super) joints: Vec<u32>,
    /// Messages about parts that were left out although they are incomplete or of another name space.
    pub(super) notes: Vec<String>,
}

/// The shapes, and the attributes that each must have with their count of numbers (0 for text).
const SHAPES: [(&str, &[(&str, usize)]); 5] = [
    ("box", &[("size", 3)]),
    ("cylinder", &[("radius", 1), ("length", 1)]),
    ("sphere", &[("radius", 1)]),
    ("capsule", &[("radius", 1), ("length", 1)]),
    ("mesh", &[("filename", 0)]),
];
/// Attributes of several numbers. Some programs put commas between them.
const NUMBERS: [&str; 4] = ["xyz", "rpy", "size", "scale"];

/// The first three numbers of a text.
fn first_three(value: &str) -> String {
    let words = value.split(is_between).filter(|word| !word.is_empty());
    words.take(3).collect::<Vec<_>>().join(" ")
}

/// Whether it is between two numbers.
fn is_between(c: char) -> bool {
    c.is_whitespace() || c == ','
}

const JOINTS: [&str; 7] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];

/// About how long (bytes) a part of a document becomes.
const PART: usize = 1 << 14;

/// Extracts from `text` the parts that planning needs, unless `interrupt` says to end.
pub(super) fn extract(text: &str, interrupt: &mut Interrupt) -> Result<Extract, UrdfError> {
    let text = Text::new("a URDF", text)?;
    let document = text.parse()?;
    let ends = document.input_text().match_indices('\n').map(|(at, _)| at).collect();
    let mut writer = Writer {
        text: &text,
        ends,
        head: 0,
        out: String::new(),
        parts: Vec::new(),
        links: Vec::new(),
        joints: Vec::new(),
        surplus: RefCell::default(),
    };
    let mut left_out = LeftOut::default();
    let robot = document.root_element();
    writer.open(&robot, "robot", &["name", "version"]);
    writer.head = writer.out.len();
    for node in robot.children().filter(Node::is_element) {
        if interrupt.ask() {
            return Err(UrdfError::Interrupted);
        }
        if !is_own(&node) {
            writer.refuse_macro(&node)?;
            left_out.elements.insert(space(&node));
            continue;
        }
        match node.tag_name().name() {
            "link" => writer.link(&node)?,
            "joint" => writer.joint(&node)?,
            _ => continue, // materials, transmissions, the elements of simulators
        }
        for inner in node.descendants().filter(Node::is_element) {
            if !is_own(&inner) {
                writer.refuse_macro(&inner)?;
                left_out.elements.insert(space(&inner));
            }
            left_out.attributes.extend(inner.attributes().filter_map(|a| a.namespace().map(str::to_owned)));
        }
        left_out.unread(&node);
        if writer.out.len() > writer.head + PART {
            writer.end_part();
        }
    }
    writer.end_part();
    let Writer { parts, links, joints, surplus, .. } = writer;
    let notes = left_out.notes().into_iter().chain(surplus.into_inner()).collect();
    Ok(Extract { parts, links, joints, notes })
}

/// Whether the element is in the name space of the document, as elements of URDF are.
fn is_own(node: &Node<'_, '_>) -> bool {
    node.tag_name().namespace() == node.document().root_element().tag_name().namespace()
}

fn space(node: &Node<'_, '_>) -> String {
    node.tag_name().namespace().unwrap_or_default().to_owned()
}

/// The first child element of that name. Others are ignored.
fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|c| c.is_element() && is_own(c) && c.tag_name().name() == name)
}

/// The value of an attribute without a name space.
fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    let own = |a: &Attribute<'_, '_>| a.namespace().is_none() && a.name() == name;
    node.attributes().find(own).map(|a| a.value())
}

struct Writer<'t, 'a> {
    text: &'t Text<'a>,
    /// Where lines end.
    ends: Vec<usize>,
    /// The part that is being written, and how much of it opens the document.
    out: String,
    head: usize,
    parts: Vec<String>,
    links: Vec<Vec<u32>>,
    joints: Vec<u32>,
    /// Notes about attributes with too many numbers.
    surplus: RefCell<BTreeSet<String>>,
}

impl Writer<'_, '_> {
    fn link(&mut self, node: &Node<'_, '_>) -> Result<(), UrdfError> {
        self.words(node, &["name"])?;
        self.open(node, "link", &["name"]);
        let mut lines = Vec::new();
        let shapes = node.children().filter(|c| c.is_element() && is_own(c));
        for collision in shapes.filter(|c| c.tag_name().name() == "collision") {
            lines.push(self.line(&collision));
            self.open(&collision, "collision", &[]);
            self.origin(&collision)?;
            self.geometry(&collision)?;
            self.out.push_str("</collision>");
        }
        self.out.push_str("</link>");
        self.links.push(lines);
        Ok(())
    }

    /// Ends a part, and begins the next one as this one began.
    fn end_part(&mut self) {
        let next = self.out[..self.head].to_owned();
        self.out.push_str("</robot>");
        self.parts.push(std::mem::replace(&mut self.out, next));
    }

    /// The line of `node`, counted from 1.
    fn line(&self, node: &Node<'_, '_>) -> u32 {
        let start = node.range().start;
        self.ends.partition_point(|&end| end < start) as u32 + 1
    }

    fn geometry(&mut self, collision: &Node<'_, '_>) -> Result<(), UrdfError> {
        let shape = child(collision, "geometry")
            .and_then(|geometry| geometry.children().find(|c| c.is_element() && is_own(c)));
        let Some(shape) = shape else {
            return Err(self.text.error(collision, "this <collision> has no <geometry> with a shape"));
        };
        let name = shape.tag_name().name();
        let Some((name, needs)) = SHAPES.into_iter().find(|(known, _)| *known == name) else {
            let message =
                format!("<{name}> is no shape: write <box>, <cylinder>, <sphere>, <capsule> or <mesh>");
            return Err(self.text.error(&shape, message));
        };
        for &(key, count) in needs {
            match count {
                0 => self.words(&shape, &[key])?,
                _ => self.numbers(&shape, key, count, true)?,
            }
        }
        self.numbers(&shape, "scale", 3, false)?;
        self.out.push_str("<geometry>");
        self.whole(&shape, name, &["size", "radius", "length", "filename", "scale"]);
        self.out.push_str("</geometry>");
        Ok(())
    }

    fn origin(&mut self, node: &Node<'_, '_>) -> Result<(), UrdfError> {
        let Some(origin) = child(node, "origin") else { return Ok(()) };
        self.numbers(&origin, "xyz", 3, false)?;
        self.numbers(&origin, "rpy", 3, false)?;
        self.whole(&origin, "origin", &["xyz", "rpy", "quat_xyzw"]);
        Ok(())
    }

    fn joint(&mut self, node: &Node<'_, '_>) -> Result<(), UrdfError> {
        self.words(node, &["name", "type"])?;
        let kind = attribute(node, "type").unwrap_or_default();
        if !JOINTS.contains(&kind) {
            let name = attribute(node, "name").unwrap_or_default();
            let message = format!("joint \"{name}\" is of type \"{kind}\", not one of {}", JOINTS.join(", "));
            return Err(self.text.error(node, message));
        }
        self.open(node, "joint", &["name", "type"]);
        self.origin(node)?;
        for end in ["parent", "child"] {
            let found = self.needed(node, end)?;
            self.words(&found, &["link"])?;
            self.whole(&found, end, &["link"]);
        }
        if kind != "fixed" {
            if let Some(axis) = child(node, "axis") {
                self.numbers(&axis, "xyz", 3, true)?;
                self.whole(&axis, "axis", &["xyz"]);
            }
            if let Some(mimic) = child(node, "mimic") {
                self.words(&mimic, &["joint"])?;
                self.numbers(&mimic, "multiplier", 1, false)?;
                self.numbers(&mimic, "offset", 1, false)?;
                self.whole(&mimic, "mimic", &["joint", "multiplier", "offset"]);
            }
        }
        if matches!(kind, "revolute" | "prismatic") {
            let limit = self.needed(node, "limit")?;
            self.numbers(&limit, "lower", 1, false)?;
            self.numbers(&limit, "upper", 1, false)?;
            self.limit(&limit, &["lower", "upper"]);
        } else if let Some(limit) = child(node, "limit").filter(|_| kind == "continuous") {
            self.limit(&limit, &[]);
        }
        self.out.push_str("</joint>");
        self.joints.push(self.line(node));
        Ok(())
    }

    /// Writes a limit with these of its attributes, and its velocity; zero where that is no number.
    fn limit(&mut self, limit: &Node<'_, '_>, keys: &[&str]) {
        let velocity = attribute(limit, "velocity").and_then(|v| v.trim().parse::<f64>().ok());
        let _ = write!(self.out, "<limit effort=\"0\" velocity=\"{}\"", velocity.unwrap_or(0.0)); // never fails for strings
        self.attributes(limit, keys);
        self.out.push_str("/>");
    }

    /// A child element that a joint must have.
    fn needed<'n, 'i>(&self, joint: &Node<'n, 'i>, name: &str) -> Result<Node<'n, 'i>, UrdfError> {
        child(joint, name).ok_or_else(|| {
            let (joint_name, kind) = (attribute(joint, "name"), attribute(joint, "type"));
            let (joint_name, kind) = (joint_name.unwrap_or_default(), kind.unwrap_or_default());
            self.text.error(joint, format!("joint \"{joint_name}\" is {kind} and has no <{name}>"))
        })
    }

    /// An error for a xacro macro that is not expanded: what it stands for would be missing from the robot.
    fn refuse_macro(&self, node: &Node<'_, '_>) -> Result<(), UrdfError> {
        if !space(node).contains("xacro") {
            return Ok(());
        }
        let name = node.tag_name().name();
        Err(self.text.error(node, format!("<xacro:{name}> is not expanded: run xacro on the file first")))
    }

    /// Checks attributes that must exist and not be empty.
    fn words(&self, node: &Node<'_, '_>, keys: &[&str]) -> Result<(), UrdfError> {
        for key in keys {
            if attribute(node, key).is_none_or(|value| value.trim().is_empty()) {
                return Err(self.text.error(node, format!("<{}> has no {key}", node.tag_name().name())));
            }
        }
        Ok(())
    }

    /// Checks an attribute of `count` numbers.
    fn numbers(&self, node: &Node<'_, '_>, key: &str, count: usize, needed: bool) -> Result<(), UrdfError> {
        let Some(value) = attribute(node, key) else {
            return if needed { self.words(node, &[key]) } else { Ok(()) };
        };
        let words = value.split(is_between);
        let words = words.filter(|word| !word.is_empty());
        let found = words.clone().count();
        if found > count && count > 1 {
            let message = format!("{found} numbers where {count} count: the first ones are taken");
            self.surplus.borrow_mut().insert(message);
        }
        if (found == count || (found > count && count > 1))
            && words.clone().all(|word| word.parse::<f64>().is_ok())
        {
            return Ok(());
        }
        let shown: String = value.chars().take(40).collect();
        let numbers = if count == 1 { "a number".to_owned() } else { format!("{count} numbers") };
        let message = format!("{key} of <{}> is \"{shown}\", not {numbers}", node.tag_name().name());
        Err(self.text.error(node, message))
    }

    fn open(&mut self, node: &Node<'_, '_>, name: &str, keys: &[&str]) {
        self.out.push('<');
        self.out.push_str(name);
        self.attributes(node, keys);
        self.out.push('>');
    }

    /// Writes an element without children.
    fn whole(&mut self, node: &Node<'_, '_>, name: &str, keys: &[&str]) {
        self.open(node, name, keys);
        self.out.push_str("</");
        self.out.push_str(name);
        self.out.push('>');
    }

    /// Writes the attributes of `node` that are among `keys`.
    fn attributes(&mut self, node: &Node<'_, '_>, keys: &[&str]) {
        for key in keys {
            if let Some(value) = attribute(node, key) {
                let value = value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
                let value = if NUMBERS.contains(key) { first_three(&value) } else { value };
                let _ = write!(self.out, " {key}=\"{value}\""); // never fails for strings
            }
        }
    }
}

/// Parts that were left out although they are incomplete or of another name space.
#[derive(Default)]
struct LeftOut {
    /// Name spaces of elements.
    elements: BTreeSet<String>,
    /// Name spaces of attributes.
    attributes: BTreeSet<String>,
    /// What is wrong, with the names of the links.
    links: BTreeMap<&'static str, Vec<String>>,
}

impl LeftOut {
    /// Notes incomplete parts of `link` that planning does not use.
    fn unread(&mut self, link: &Node<'_, '_>) {
        let mut note = |what| {
            let names = self.links.entry(what).or_default();
            let name = attribute(link, "name").unwrap_or_default();
            if names.last().is_none_or(|last| last != name) {
                names.push(name.to_owned());
            }
        };
        for part in link.children().filter(|c| c.is_element() && is_own(c)) {
            match part.tag_name().name() {
                "inertial" if child(&part, "mass").is_none() || child(&part, "inertia").is_none() => {
                    note("masses are not read: <inertial> is incomplete");
                }
                "visual" => {
                    let mesh = child(&part, "geometry").and_then(|geometry| child(&geometry, "mesh"));
                    if mesh.is_some_and(|mesh| attribute(&mesh, "filename").is_none()) {
                        note("visual shapes are not read: a mesh has no file name");
                    }
                }
                _ => {}
            }
        }
    }

    fn notes(self) -> Vec<String> {
        let mut notes = Vec::new();
        let spaces: Vec<String> = self.elements.union(&self.attributes).cloned().collect();
        if !spaces.is_empty() {
            let what = if self.elements.is_empty() { "attributes" } else { "elements and attributes" };
            notes.push(format!("{what} of other name spaces are not read: {}", some(&spaces)));
        }
        notes.extend(self.links.into_iter().map(|(what, links)| format!("{what}, in {}", some(&links))));
        notes
    }
}
