//! Arms from URDF text.

mod read;

use super::compile::MAX_LENGTH;
use super::groups::planar_parts;
use super::xml::{Text, some};
use super::{ArmModel, Joint, JointKind, Link, UrdfError};
use mp_cspace::Interrupt;
use mp_geom::{MeshError, Shape, TriMesh};
use nalgebra::{Isometry3, Point3, Vector3};
use read::{Geometry, LeftOut, Reader, attribute, child, is_own};
use roxmltree::Node;
use std::collections::{HashMap, HashSet};

/// How far (m) a planar joint goes from its origin along x and along y.
const PLANAR_ROOM: f64 = 10.0;

/// A revolute joint whose limits are farther apart than this (rad) turns without end: no cable bears a hundred thousand turns. With such
/// limits this joint alone would make up the distance between two configurations.
const ENDLESS: f64 = 1e6;

/// Sides of the sheet in place of a cylinder without height, which contains it.
const SEGMENTS: u32 = 32;

impl ArmModel {
    /// Reads a URDF. It takes links, their collision shapes (box, cylinder, capsule, sphere, mesh; each with its origin) and joints
    /// (revolute, continuous, prismatic, fixed, planar; limits and mimics). A link without collision shapes cannot collide, whatever
    /// its visual shapes are. Everything else is left out, so that errors in it do not matter. Of what versions 1.1 and 1.2 added, it
    /// knows quaternions of origins, capsules, and that a limit that is not written is none.
    ///
    /// [`ArmModel::notes`] says what was left out although it is incomplete or of another name space, and also:
    ///
    /// - which joints have narrower limits by the soft limits of a `safety_controller`, which count as for MoveIt;
    /// - which joints do not move because their limits are equal. They are not coordinates until
    ///   [`with_limits`](Self::with_limits) gives them other limits;
    /// - which joint floats between the world, a link without shapes, and the robot: it is fixed;
    /// - which joints are planar: each becomes three joints, two that slide and one that turns;
    /// - which revolute joints turn without end, for their limits are more than 1e6 rad apart;
    /// - which joints that mimic others had their limits ignored, because neither joint could move within both limits.
    ///
    /// A shape without volume is a sheet or a line, which can be hit; one of no extent at all is left out, as is a mesh without triangles,
    /// and a note says so. Round
    /// shapes become meshes of flat faces that contain them. They are larger by less than 1% of the radius (2% for
    /// spheres). A link of spheres alone has these themselves, as [balls](TriMesh::balls).
    ///
    /// `mesh` is called with each mesh file name as written, often `package://robot/part.stl`. It returns the mesh, or a
    /// message for people; one that has the text of [`MeshError::Empty`] says that there are no triangles.
    ///
    /// # Errors
    /// [`UrdfError`], which names the line and the joint or link.
    pub fn from_urdf(
        text: &str,
        mesh: impl FnMut(&str) -> Result<TriMesh, String>,
    ) -> Result<Self, UrdfError> {
        Self::from_urdf_until(text, mesh, &Interrupt::never())
    }

    /// As [`from_urdf`](Self::from_urdf), unless `interrupt` says to end. Takes time in proportion to the length of the text.
    ///
    /// # Errors
    /// As [`from_urdf`](Self::from_urdf), and [`UrdfError::Interrupted`] when it was interrupted.
    pub fn from_urdf_until(
        text: &str,
        mut mesh: impl FnMut(&str) -> Result<TriMesh, String>,
        interrupt: &Interrupt,
    ) -> Result<Self, UrdfError> {
        let _span = tracing::debug_span!("urdf", bytes = text.len()).entered();
        let mut interrupt = interrupt.clone();
        let mut ask = || if interrupt.ask() { Err(UrdfError::Interrupted) } else { Ok(()) };
        let text = Text::new("a URDF", text)?;
        let document = text.parse()?;
        let reader = Reader::new(&text, &document);
        let elements = document.root_element();
        let elements = elements.children().filter(Node::is_element);
        let mut left_out = LeftOut::default();
        for node in elements.clone() {
            ask()?;
            left_out.look_at(&node, &reader)?;
        }
        // Materials, transmissions and the elements of simulators are left out.
        let called = |name| elements.clone().filter(move |n| is_own(n) && n.tag_name().name() == name);
        let mut model = Self::default();
        let mut empty: Vec<String> = Vec::new();
        for node in called("link") {
            let mut link = Link::new(reader.word(&node, "name")?);
            let inner = node.children().filter(|c| c.is_element() && is_own(c));
            let collisions = inner.filter(|c| c.tag_name().name() == "collision");
            for (i, collision) in collisions.enumerate() {
                ask()?;
                let fail = |message: String| UrdfError::Shape {
                    line: reader.line(&collision),
                    link: link.name.clone(),
                    number: i + 1,
                    message,
                };
                let origin = reader.origin(&collision)?;
                let geometry = reader.geometry(&collision)?;
                let made = match without_volume(&geometry) {
                    Some(thin) => thin,
                    None => shape(&geometry, &mut mesh),
                };
                let Some(shape) = made.map_err(fail)? else {
                    empty.extend((empty.last() != Some(&link.name)).then(|| link.name.clone()));
                    continue;
                };
                if !super::kinematics::is_pose(&origin, MAX_LENGTH) {
                    return Err(fail("its origin is no pose: numbers must be finite".to_owned()));
                }
                link = link.with(&shape, &origin);
            }
            model.links.push(link);
        }
        for node in called("joint") {
            ask()?;
            model.add_joint(&node, &reader)?;
        }
        let mut notes = left_out.notes();
        notes.extend(reader.surplus.into_inner());
        let [within, aside] = reader.soft.into_inner();
        for (joints, note) in [
            (
                within,
                "the limits of these joints are the soft limits of their safety controllers, as for MoveIt",
            ),
            (aside, "soft limits that leave a joint no room are not taken"),
        ] {
            notes.extend((!joints.is_empty()).then(|| format!("{note}: {}", some(&joints))));
        }
        if !empty.is_empty() {
            let note = "shapes of size 0 and meshes without triangles are left out, for there is nothing to touch, in";
            notes.push(format!("{note} {}", some(&empty)));
        }
        model.notes.splice(0..0, notes);
        model.drop_conflicting_limits();
        model.drop_endless_limits();
        let held = model.joints.iter().filter(|j| j.kind.held().is_some() && j.mimic.is_none());
        let held: Vec<_> = held.map(|j| j.name.clone()).collect();
        if !held.is_empty() {
            let note = format!("these joints do not move, for their limits are equal: {}", some(&held));
            model.notes.push(note);
        }
        Ok(model)
    }

    /// Adds a joint as it is written.
    fn add_joint(&mut self, node: &Node<'_, '_>, reader: &Reader<'_, '_>) -> Result<(), UrdfError> {
        let written = reader.joint_type(node)?;
        let name = reader.word(node, "name")?;
        let origin = reader.origin(node)?;
        let parent = reader.word(&reader.needed(node, "parent")?, "link")?;
        let end = reader.word(&reader.needed(node, "child")?, "link")?;
        let limits = || reader.limits(node);
        let kind = match written {
            "fixed" => JointKind::Fixed,
            "continuous" => JointKind::Continuous,
            "revolute" => limits().map(|[low, high]| JointKind::Revolute { low, high })?,
            "prismatic" => limits().map(|[low, high]| JointKind::Prismatic { low, high })?,
            "planar" => {
                self.add_planar(name, [parent, end], origin);
                return Ok(());
            }
            "floating" if reader.is_first(node) && !self.collides(parent) => {
                self.notes.push(format!(
                    "\"{name}\" floats between the world and the robot: it is fixed, unless `base = \"floating\"` of a robot problem moves the \
                     whole robot"
                ));
                JointKind::Fixed
            }
            written => {
                let kind = if written == "floating" { "floating" } else { "spherical" };
                return Err(UrdfError::Kind { line: reader.line(node), joint: name.to_owned(), kind });
            }
        };
        let mut joint = Joint::new(name, parent, end, kind).at(origin);
        if kind == JointKind::Fixed {
            self.joints.push(joint);
            return Ok(());
        }
        if let Some(axis) = child(node, "axis") {
            joint = joint.axis(Vector3::from(reader.needed_numbers(&axis, "xyz")?));
        }
        let limit = child(node, "limit");
        let rate = |name: &str| {
            let rate = attribute(limit.as_ref()?, name)?.trim().parse().ok();
            rate.filter(|rate: &f64| *rate > 0.0 && rate.is_finite())
        };
        joint.max_velocity = rate("velocity");
        // Since URDF 1.2. Joints speed up and slow down by one limit here.
        joint.max_acceleration =
            [rate("acceleration"), rate("deceleration")].into_iter().flatten().reduce(f64::min);
        joint.max_jerk = rate("jerk");
        if let Some(mimic) = child(node, "mimic") {
            let multiplier = reader.number(&mimic, "multiplier")?.unwrap_or(1.0);
            let offset = reader.number(&mimic, "offset")?.unwrap_or(0.0);
            joint = joint.mimic(reader.word(&mimic, "joint")?, multiplier, offset);
        }
        self.joints.push(joint);
        Ok(())
    }

    /// Whether the link of that name has shapes.
    fn collides(&self, link: &str) -> bool {
        self.links.iter().any(|known| known.name == link && !known.shapes.is_empty())
    }

    /// Adds three joints in place of one that is planar, called as MoveIt calls them: `NAME/x` and `NAME/y`, which slide in the plane of
    /// its frame, and `NAME/theta`, which turns about z. A URDF has no limits for them: see [`PLANAR_ROOM`].
    fn add_planar(&mut self, name: &str, [parent, child]: [&str; 2], origin: Isometry3<f64>) {
        let [x, y, turn] = planar_parts(name);
        let slide = JointKind::Prismatic { low: -PLANAR_ROOM, high: PLANAR_ROOM };
        self.links.extend([Link::new(&x), Link::new(&y)]);
        self.joints.extend([
            Joint::new(&x, parent, &x, slide).at(origin).axis(Vector3::x()),
            Joint::new(&y, &x, &y, slide).axis(Vector3::y()),
            Joint::new(&turn, &y, child, JointKind::Continuous).axis(Vector3::z()),
        ]);
        self.notes.push(format!(
            "\"{name}\" is planar: \"{x}\" and \"{y}\" slide from -{PLANAR_ROOM} to {PLANAR_ROOM} m, unless `limits` of a robot \
             problem say how far, and \"{turn}\" turns"
        ));
    }

    /// Drops the limits of joints that mimic others where they leave no range to move in. The joint that is followed keeps
    /// its own limits.
    fn drop_conflicting_limits(&mut self) {
        let leaders = self.joints.iter().filter(|j| j.mimic.is_none());
        let leaders: HashMap<String, _> = leaders.map(|j| (j.name.clone(), j.kind.limits())).collect();
        let mut aside = Vec::new();
        for i in 0..self.joints.len() {
            let Some(mimic) = &self.joints[i].mimic else { continue };
            let (Some([own_low, own_high]), Some(&Some([low, high]))) =
                (self.joints[i].kind.limits(), leaders.get(&mimic.joint))
            else {
                continue;
            };
            let ends = [low, high].map(|x| x * mimic.multiplier + mimic.offset);
            let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
            let can_move = match low == high {
                true => (own_low..=own_high).contains(&low),
                false => own_low.max(low) < own_high.min(high),
            };
            // Also for a leader that is held: its followers must be able to move once it gets other limits.
            if own_low > own_high || (can_move && own_low < own_high) {
                continue;
            }
            self.joints[i].kind = match self.joints[i].kind {
                JointKind::Prismatic { .. } => JointKind::Prismatic { low: -MAX_LENGTH, high: MAX_LENGTH },
                _ => JointKind::Continuous,
            };
            aside.push(self.joints[i].name.clone());
        }
        if !aside.is_empty() {
            let note = "the limits of joints that mimic others are set aside, for they leave them no room";
            self.notes.push(format!("{note}: {}", some(&aside)));
        }
    }

    /// Makes revolute joints continuous whose limits mean none. Those that others mimic keep them, as what mimics a continuous joint may not
    /// have limits.
    fn drop_endless_limits(&mut self) {
        let leaders = self.joints.iter().filter_map(|joint| Some(joint.mimic.as_ref()?.joint.clone()));
        let leaders: HashSet<_> = leaders.collect();
        let mut endless = Vec::new();
        for joint in self.joints.iter_mut().filter(|joint| !leaders.contains(&joint.name)) {
            if let JointKind::Revolute { low, high } = joint.kind
                && high - low > ENDLESS
            {
                joint.kind = JointKind::Continuous;
                endless.push(joint.name.clone());
            }
        }
        if !endless.is_empty() {
            let note = format!(
                "these joints turn without end, for their limits are more than {ENDLESS:e} rad apart"
            );
            self.notes.push(format!("{note}: {}", some(&endless)));
        }
    }
}

/// What there is of a shape with lengths of zero, in its own frame: a sheet or a line, for these can be hit, or `None` for a
/// point. The whole is `None` for all other shapes.
fn without_volume(geometry: &Geometry<'_>) -> Option<Result<Option<TriMesh>, String>> {
    let Geometry::Primitive(name, lengths) = geometry else { return None };
    let sides = match (*name, lengths.as_slice()) {
        ("box", &[x, y, z]) => [x, y, z],
        ("sphere", &[radius]) => [2.0 * radius; 3],
        (_, &[radius, length]) => [2.0 * radius, 2.0 * radius, length],
        _ => return None,
    };
    if !sides.contains(&0.0) || sides.iter().any(|side| !side.is_finite() || *side < 0.0) {
        return None;
    }
    let axes: Vec<usize> = (0..3).filter(|&axis| sides[axis] > 0.0).collect();
    let corners: Vec<Point3<f64>> = match (axes.as_slice(), *name) {
        ([], _) => return Some(Ok(None)),
        (&[x, y], "cylinder") => (0..SEGMENTS)
            .map(|i| {
                let turn = std::f64::consts::TAU / f64::from(SEGMENTS);
                let (sin, cos) = mp_math::sin_cos(turn * f64::from(i));
                let around = lengths[0] / mp_math::cos(0.5 * turn);
                let mut corner = Point3::origin();
                (corner[x], corner[y]) = (around * cos, around * sin);
                corner
            })
            .collect(),
        (axes, _) => [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]][..2 * axes.len()]
            .iter()
            .map(|signs| {
                let mut corner = Point3::origin();
                axes.iter().zip(signs).for_each(|(&axis, sign)| corner[axis] = 0.5 * sign * sides[axis]);
                corner
            })
            .collect(),
    };
    // A line is a triangle with two corners in one place.
    let triangles = match corners.len() as u32 {
        2 => vec![[0, 1, 1]],
        n => (1..n - 1).map(|i| [0, i, i + 1]).collect(),
    };
    Some(TriMesh::new(corners, triangles).map(Some).map_err(|error| error.to_string()))
}

/// The shape as a mesh, in its own frame; `None` for a mesh without triangles, or one that is scaled to a point.
fn shape(
    geometry: &Geometry<'_>,
    mesh: &mut impl FnMut(&str) -> Result<TriMesh, String>,
) -> Result<Option<TriMesh>, String> {
    let shape = match geometry {
        Geometry::Primitive(name, lengths) => Shape::primitive(name, lengths),
        Geometry::Mesh(file, scale) => {
            let read = match mesh(file) {
                Err(message) if message.contains(&MeshError::Empty.to_string()) => return Ok(None),
                read => read?,
            };
            let [x, y, z] = *scale;
            if !scale.iter().all(|s| s.is_finite()) {
                return Err(format!("the scale of {file} is {x} {y} {z}: it must be finite"));
            }
            if *scale == [0.0; 3] {
                return Ok(None);
            }
            let mut scaled = read.scaled(*scale);
            if scale.contains(&0.0) {
                // A sheet or a line is no solid.
                scaled =
                    scaled.and_then(|flat| TriMesh::new(flat.vertices().to_vec(), flat.triangles().to_vec()));
            }
            Some(scaled.map_err(|error| error.to_string())?.into())
        }
    };
    let made = shape.map(|shape| shape.mesh()).transpose().map_err(|error| error.to_string())?;
    made.map(Some).ok_or_else(|| "this shape is not known".to_owned())
}
