//! Reading the elements of a URDF that planning needs: names, numbers, origins and shapes. Errors name the line.

use super::super::UrdfError;
use super::super::xml::{Text, some};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Attribute, Document, Node};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// A collision shape as it is written, in its own frame.
pub(super) enum Geometry<'a> {
    /// Its name, and its lengths (m): the sides of a box; the radius, then the length, of everything else.
    Primitive(&'static str, Vec<f64>),
    /// The name of a mesh file, and by what the mesh is scaled along x, y and z.
    Mesh(&'a str, [f64; 3]),
}

/// The names of the types that joints may have.
const JOINTS: [&str; 7] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];

/// Reads elements of one document.
pub(super) struct Reader<'t, 'a> {
    text: &'t Text<'a>,
    /// Where lines end.
    ends: Vec<usize>,
    /// The version of URDF, major and minor. From 1.2 on a joint whose limit is left out has none.
    version: (u32, u32),
    /// Notes about attributes with too many numbers.
    pub(super) surplus: RefCell<BTreeSet<String>>,
    /// Joints whose soft limits are within their limits, and those whose soft limits are not taken.
    pub(super) soft: RefCell<[Vec<String>; 2]>,
}

impl<'t, 'a> Reader<'t, 'a> {
    pub(super) fn new(text: &'t Text<'a>, document: &Document<'_>) -> Self {
        let version = attribute(&document.root_element(), "version");
        let mut parts = version.unwrap_or("1.0").split('.').map(|part| part.parse().ok());
        let version = parts.next().flatten().map(|major| (major, parts.next().flatten().unwrap_or(0)));
        Self {
            text,
            ends: document.input_text().match_indices('\n').map(|(at, _)| at).collect(),
            version: version.unwrap_or((1, 0)),
            surplus: RefCell::default(),
            soft: RefCell::default(),
        }
    }

    /// The line of `node`, counted from 1.
    pub(super) fn line(&self, node: &Node<'_, '_>) -> u32 {
        let start = node.range().start;
        self.ends.partition_point(|&end| end < start) as u32 + 1
    }

    /// An attribute that must exist and not be empty.
    pub(super) fn word<'n>(&self, node: &Node<'n, '_>, key: &str) -> Result<&'n str, UrdfError> {
        attribute(node, key)
            .filter(|value| !value.trim().is_empty())
            .ok_or_else(|| self.text.error(node, format!("<{}> has no {key}", node.tag_name().name())))
    }

    /// An attribute of `N` numbers, if it is there. Commas between them are taken for blanks. Where several are wanted and there are more, the
    /// first ones are taken, with a note, unless there are commas: they may be those of decimals.
    pub(super) fn numbers<const N: usize>(
        &self,
        node: &Node<'_, '_>,
        key: &str,
    ) -> Result<Option<[f64; N]>, UrdfError> {
        let Some(value) = attribute(node, key) else { return Ok(None) };
        let words = value.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
        let found = words.clone().count();
        let read: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
        match read {
            Some(read) if found == N || (found > N && N > 1 && !value.contains(',')) => {
                if found > N {
                    let note = format!("{found} numbers where {N} count: the first ones are taken");
                    self.surplus.borrow_mut().insert(note);
                }
                Ok(Some(std::array::from_fn(|i| read[i])))
            }
            _ => {
                let shown: String = value.chars().take(40).collect();
                let numbers = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
                let why = if value.contains(',') { ": decimals have a point, no comma" } else { "" };
                let message =
                    format!("{key} of <{}> is \"{shown}\", not {numbers}{why}", node.tag_name().name());
                Err(self.text.error(node, message))
            }
        }
    }

    /// As [`numbers`](Self::numbers), of an attribute that must exist.
    pub(super) fn needed_numbers<const N: usize>(
        &self,
        node: &Node<'_, '_>,
        key: &str,
    ) -> Result<[f64; N], UrdfError> {
        self.word(node, key)?;
        Ok(self.numbers(node, key)?.unwrap_or([0.0; N]))
    }

    /// An attribute that is one number, if it is there.
    pub(super) fn number(&self, node: &Node<'_, '_>, key: &str) -> Result<Option<f64>, UrdfError> {
        Ok(self.numbers::<1>(node, key)?.map(|[value]| value))
    }

    /// The `<origin>` of an element: the identity where there is none.
    pub(super) fn origin(&self, node: &Node<'_, '_>) -> Result<Isometry3<f64>, UrdfError> {
        let Some(origin) = child(node, "origin") else { return Ok(Isometry3::identity()) };
        let xyz = self.numbers(&origin, "xyz")?.unwrap_or([0.0; 3]);
        let rpy = self.numbers(&origin, "rpy")?;
        // Of version 1.1, but it means nothing else in a file of another one.
        let quaternion = self.numbers(&origin, "quat_xyzw")?;
        let turn = match (rpy, quaternion) {
            (Some(_), Some(_)) => {
                return Err(self.text.error(&origin, "<origin> has both rpy and quat_xyzw: leave one out"));
            }
            (None, Some([0.0, 0.0, 0.0, 0.0])) => UnitQuaternion::identity(),
            (None, Some([x, y, z, w])) => UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
            (rpy, None) => {
                let [roll, pitch, yaw] = rpy.unwrap_or([0.0; 3]);
                UnitQuaternion::from_euler_angles(roll, pitch, yaw)
            }
        };
        Ok(Isometry3::from_parts(Translation3::from(Vector3::from(xyz)), turn))
    }

    /// The shape of a `<collision>`.
    pub(super) fn geometry<'n>(&self, collision: &Node<'n, '_>) -> Result<Geometry<'n>, UrdfError> {
        let shape = child(collision, "geometry")
            .and_then(|geometry| geometry.children().find(|c| c.is_element() && is_own(c)));
        let Some(shape) = shape else {
            return Err(self.text.error(collision, "this <collision> has no <geometry> with a shape"));
        };
        let length = |key| self.needed_numbers(&shape, key).map(|[length]| length);
        Ok(match shape.tag_name().name() {
            "box" => Geometry::Primitive("box", self.needed_numbers::<3>(&shape, "size")?.to_vec()),
            "sphere" => Geometry::Primitive("sphere", vec![length("radius")?]),
            "cylinder" => Geometry::Primitive("cylinder", vec![length("radius")?, length("length")?]),
            "capsule" => match (length("radius")?, length("length")?) {
                (radius, 0.0) => Geometry::Primitive("sphere", vec![radius]),
                (radius, length) => Geometry::Primitive("capsule", vec![radius, length]),
            },
            "mesh" => {
                // As SDF has them: the mesh would be of another size.
                if let Some(inner) = child(&shape, "scale") {
                    let message =
                        "<scale> inside of <mesh> is of SDF: write <mesh filename=\"…\" scale=\"x y z\"/>";
                    return Err(self.text.error(&inner, message));
                }
                let scale = self.numbers(&shape, "scale")?.unwrap_or([1.0; 3]);
                Geometry::Mesh(self.word(&shape, "filename")?, scale)
            }
            name => {
                let message =
                    format!("<{name}> is no shape: write <box>, <cylinder>, <sphere>, <capsule> or <mesh>");
                return Err(self.text.error(&shape, message));
            }
        })
    }

    /// The type of a joint. It is one of [`JOINTS`].
    pub(super) fn joint_type<'n>(&self, joint: &Node<'n, '_>) -> Result<&'n str, UrdfError> {
        let name = self.word(joint, "name")?;
        let kind = self.word(joint, "type")?;
        if !JOINTS.contains(&kind) {
            let message = format!("joint \"{name}\" is of type \"{kind}\", not one of {}", JOINTS.join(", "));
            return Err(self.text.error(joint, message));
        }
        Ok(kind)
    }

    /// The limits of a joint, within its soft limits.
    pub(super) fn limits(&self, joint: &Node<'_, '_>) -> Result<[f64; 2], UrdfError> {
        let limit = self.needed(joint, "limit")?;
        let unlimited = if self.version >= (1, 2) { f64::INFINITY } else { 0.0 };
        let lower = self.number(&limit, "lower")?.unwrap_or(-unlimited);
        let limits = [lower, self.number(&limit, "upper")?.unwrap_or(unlimited)];
        self.within_soft(joint, limits)
    }

    /// The part of the limits that is within the soft limits of the safety controller, as for MoveIt. Soft limits that are equal are none, for
    /// what is not written is 0; those of a joint that mimics another count no more than for MoveIt.
    fn within_soft(&self, joint: &Node<'_, '_>, [low, high]: [f64; 2]) -> Result<[f64; 2], UrdfError> {
        let Some(safety) = child(joint, "safety_controller").filter(|_| child(joint, "mimic").is_none())
        else {
            return Ok([low, high]);
        };
        let soft = |key| self.number(&safety, key).map(|limit| limit.unwrap_or(0.0));
        let [soft_low, soft_high] = [soft("soft_lower_limit")?, soft("soft_upper_limit")?];
        let within = [low.max(soft_low), high.min(soft_high)];
        let taken = soft_low < soft_high && within[0] < within[1];
        if soft_low != soft_high && low < high && within != [low, high] {
            let name = self.word(joint, "name")?.to_owned();
            self.soft.borrow_mut()[usize::from(!taken)].push(name);
        }
        Ok(if taken { within } else { [low, high] })
    }

    /// Whether a joint is the only one at a link above which there is none: that between the world and a robot.
    pub(super) fn is_first(&self, joint: &Node<'_, '_>) -> bool {
        let end = |joint: &Node<'_, '_>, end: &str| {
            child(joint, end).and_then(|node| attribute(&node, "link").map(str::to_owned))
        };
        let Some(parent) = end(joint, "parent") else { return false };
        let robot = joint.document().root_element();
        let mut others =
            robot.children().filter(|n| n.tag_name().name() == "joint" && is_own(n) && n != joint);
        !others
            .any(|other| ["parent", "child"].iter().any(|name| end(&other, name).as_ref() == Some(&parent)))
    }

    /// A child element that a joint must have.
    pub(super) fn needed<'n, 'i>(&self, joint: &Node<'n, 'i>, name: &str) -> Result<Node<'n, 'i>, UrdfError> {
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
}

/// Whether the element is in the name space of the document, as elements of URDF are.
pub(super) fn is_own(node: &Node<'_, '_>) -> bool {
    node.tag_name().namespace() == node.document().root_element().tag_name().namespace()
}

fn space(node: &Node<'_, '_>) -> String {
    node.tag_name().namespace().unwrap_or_default().to_owned()
}

/// The first child element of that name. Others are ignored.
pub(super) fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|c| c.is_element() && is_own(c) && c.tag_name().name() == name)
}

/// The value of an attribute without a name space, without blanks around it.
pub(super) fn attribute<'a>(node: &Node<'a, '_>, name: &str) -> Option<&'a str> {
    let own = |a: &Attribute<'_, '_>| a.namespace().is_none() && a.name() == name;
    node.attributes().find(own).map(|a| a.value().trim())
}

/// Parts that were left out although they are incomplete or of another name space.
#[derive(Default)]
pub(super) struct LeftOut {
    /// Name spaces of elements.
    elements: BTreeSet<String>,
    /// Name spaces of attributes.
    attributes: BTreeSet<String>,
    /// What is wrong, with the names of the links.
    links: BTreeMap<&'static str, Vec<String>>,
}

impl LeftOut {
    /// Looks at an element of `<robot>`.
    ///
    /// # Errors
    /// If it is a xacro macro, or a link or joint that has one in what is read.
    pub(super) fn look_at(&mut self, node: &Node<'_, '_>, reader: &Reader<'_, '_>) -> Result<(), UrdfError> {
        if !is_own(node) {
            reader.refuse_macro(node)?;
            self.elements.insert(space(node));
        } else if matches!(node.tag_name().name(), "link" | "joint") {
            for inner in node.descendants().filter(Node::is_element) {
                if !is_own(&inner) {
                    let unread =
                        |n: Node<'_, '_>| is_own(&n) && matches!(n.tag_name().name(), "visual" | "inertial");
                    if !inner.ancestors().any(unread) {
                        reader.refuse_macro(&inner)?;
                    }
                    self.elements.insert(space(&inner));
                }
                self.attributes.extend(inner.attributes().filter_map(|a| a.namespace().map(str::to_owned)));
            }
            self.unread(node);
        }
        Ok(())
    }

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

    pub(super) fn notes(self) -> Vec<String> {
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
