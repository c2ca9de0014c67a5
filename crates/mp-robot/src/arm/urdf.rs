//! Arms from URDF text.

mod extract;

use super::compile::MAX_LENGTH;
use super::xml::some;
use super::{ArmModel, Joint, JointKind, Link, UrdfError};
use extract::{Extract, extract};
use mp_cspace::Interrupt;
use mp_geom::{Shape, TriMesh};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use std::collections::HashMap;
use urdf_rs::{Geometry, JointType};

/// How far (m) a planar joint goes from its origin along x and along y.
const PLANAR_ROOM: f64 = 10.0;

/// Sides of the sheet in place of a cylinder without height, which contains it.
const SEGMENTS: u32 = 32;

impl ArmModel {
    /// Reads a URDF, with the crate `urdf-rs`. It takes links, their collision shapes (box, cylinder, capsule,
    /// sphere, mesh; each with its origin) and joints (revolute, continuous, prismatic, fixed; limits and mimics).
    /// A link without collision shapes cannot collide, whatever its visual shapes are. Everything else is left out before the
    /// text is parsed, so that errors in it do not matter.
    ///
    /// [`ArmModel::notes`] says what was left out although it is incomplete or of another name space, and also:
    ///
    /// - which joints do not move because their limits are equal. They are not coordinates until
    ///   [`with_limits`](Self::with_limits) gives them other limits;
    /// - which joints are planar: each becomes three joints, two that slide and one that turns;
    /// - which joints that mimic others had their limits ignored, because neither joint could move within both limits.
    ///
    /// A shape without volume is a sheet or a line, which can be hit; one of no extent at all is left out, and a note says so. Round
    /// shapes become meshes of flat faces that contain them. They are larger by less than 1% of the radius (2% for
    /// spheres).
    ///
    /// `mesh` is called with each mesh file name as written, often `package://robot/part.stl`. It returns the mesh, or a
    /// message for people.
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
        let Extract { parts, links, joints, notes } = extract(text, &mut interrupt)?;
        let (mut read_links, mut read_joints) = (Vec::new(), Vec::new());
        for part in parts {
            if interrupt.ask() {
                return Err(UrdfError::Interrupted);
            }
            let part = urdf_rs::read_from_string(&part).map_err(|error| UrdfError::Syntax {
                what: "a URDF",
                line: None,
                message: error.to_string(),
            })?;
            read_links.extend(part.links);
            read_joints.extend(part.joints);
        }
        let mut model = Self { notes, ..Self::default() };
        let mut empty: Vec<String> = Vec::new();
        for (link, lines) in read_links.iter().zip(&links) {
            let mut made = Link::new(&link.name);
            for (i, (collision, &line)) in link.collision.iter().zip(lines).enumerate() {
                if interrupt.ask() {
                    return Err(UrdfError::Interrupted);
                }
                let fail = |message: String| UrdfError::Shape {
                    line,
                    link: link.name.clone(),
                    number: i + 1,
                    message,
                };
                let made_shape = match without_volume(&collision.geometry) {
                    Some(thin) => thin,
                    None => shape(&collision.geometry, &mut mesh).map(Some),
                };
                let Some(shape) = made_shape.map_err(fail)? else {
                    empty.extend((empty.last() != Some(&link.name)).then(|| link.name.clone()));
                    continue;
                };
                let origin = pose(&collision.origin);
                if !super::kinematics::is_pose(&origin, MAX_LENGTH) {
                    return Err(fail("its origin is no pose: numbers must be finite".to_owned()));
                }
                made = made.with(&shape, &origin);
            }
            model.links.push(made);
        }
        if !empty.is_empty() {
            let note =
                format!("shapes of size 0 are left out, for there is nothing to touch, in {}", some(&empty));
            model.notes.push(note);
        }
        for (joint, &line) in read_joints.iter().zip(&joints) {
            let limits = (joint.limit.lower, joint.limit.upper);
            if joint.joint_type == JointType::Planar {
                model.add_planar(joint);
                continue;
            }
            let refused = |kind| Err(UrdfError::Kind { line, joint: joint.name.clone(), kind });
            let kind = match joint.joint_type {
                JointType::Fixed => JointKind::Fixed,
                JointType::Continuous => JointKind::Continuous,
                JointType::Revolute => JointKind::Revolute { low: limits.0, high: limits.1 },
                JointType::Prismatic => JointKind::Prismatic { low: limits.0, high: limits.1 },
                JointType::Floating => return refused("floating"),
                JointType::Planar | JointType::Spherical => return refused("spherical"),
            };
            let mut made = Joint::new(&joint.name, &joint.parent.link, &joint.child.link, kind)
                .at(pose(&joint.origin))
                .axis(Vector3::from(joint.axis.xyz.0));
            let velocity = joint.limit.velocity;
            made.max_velocity = (velocity > 0.0 && velocity.is_finite()).then_some(velocity);
            if let Some(mimic) = &joint.mimic {
                let (multiplier, offset) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
                made = made.mimic(&mimic.joint, multiplier, offset);
            }
            model.joints.push(made);
        }
        model.drop_conflicting_limits();
        let held = model.joints.iter().filter(|j| j.kind.held().is_some() && j.mimic.is_none());
        let held: Vec<_> = held.map(|j| j.name.clone()).collect();
        if !held.is_empty() {
            let note = format!("these joints do not move, for their limits are equal: {}", some(&held));
            model.notes.push(note);
        }
        Ok(model)
    }

    /// Adds three joints in place of one that is planar, called as MoveIt calls them: `NAME/x` and `NAME/y`, which slide in the plane of
    /// its frame, and `NAME/theta`, which turns about z. A URDF has no limits for them: see [`PLANAR_ROOM`].
    fn add_planar(&mut self, joint: &urdf_rs::Joint) {
        let part = |axis: &str| format!("{}/{axis}", joint.name);
        let (x, y, turn) = (part("x"), part("y"), part("theta"));
        let slide = JointKind::Prismatic { low: -PLANAR_ROOM, high: PLANAR_ROOM };
        self.links.extend([Link::new(&x), Link::new(&y)]);
        self.joints.extend([
            Joint::new(&x, &joint.parent.link, &x, slide).at(pose(&joint.origin)).axis(Vector3::x()),
            Joint::new(&y, &x, &y, slide).axis(Vector3::y()),
            Joint::new(&turn, &y, &joint.child.link, JointKind::Continuous).axis(Vector3::z()),
        ]);
        self.notes.push(format!(
            "\"{}\" is planar: \"{x}\" and \"{y}\" slide from -{PLANAR_ROOM} to {PLANAR_ROOM} m, unless `limits` of a robot problem \
             say how far, and \"{turn}\" turns",
            joint.name
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
}

fn pose(pose: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = pose.rpy.0;
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::from(Vector3::from(pose.xyz.0)), turn)
}

/// What there is of a shape with lengths of zero, in its own frame: a sheet or a line, for these can be hit, or `None` for a
/// point. The whole is `None` for all other shapes.
fn without_volume(geometry: &Geometry) -> Option<Result<Option<TriMesh>, String>> {
    let sides = match geometry {
        Geometry::Box { size } => size.0,
        Geometry::Sphere { radius } => [2.0 * radius; 3],
        Geometry::Cylinder { radius, length } => [2.0 * radius, 2.0 * radius, *length],
        // A ball.
        Geometry::Capsule { radius, length } if *length == 0.0 && *radius > 0.0 => return None,
        Geometry::Capsule { radius, length } => [2.0 * radius, 2.0 * radius, *length],
        Geometry::Mesh { .. } => return None,
    };
    if !sides.contains(&0.0) || sides.iter().any(|side| !side.is_finite() || *side < 0.0) {
        return None;
    }
    let axes: Vec<usize> = (0..3).filter(|&axis| sides[axis] > 0.0).collect();
    let corners: Vec<Point3<f64>> = match (axes.as_slice(), geometry) {
        ([], _) => return Some(Ok(None)),
        (&[x, y], Geometry::Cylinder { radius, .. }) => (0..SEGMENTS)
            .map(|i| {
                let turn = std::f64::consts::TAU / f64::from(SEGMENTS);
                let (sin, cos) = mp_math::sin_cos(turn * f64::from(i));
                let around = radius / mp_math::cos(0.5 * turn);
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

/// The shape as a mesh, in its own frame.
fn shape(
    geometry: &Geometry,
    mesh: &mut impl FnMut(&str) -> Result<TriMesh, String>,
) -> Result<TriMesh, String> {
    let shape = match geometry {
        Geometry::Box { size } => Shape::primitive("box", &size.0),
        Geometry::Cylinder { radius, length } => Shape::primitive("cylinder", &[*radius, *length]),
        Geometry::Sphere { radius } => Shape::primitive("sphere", &[*radius]),
        Geometry::Capsule { radius, length } if *length == 0.0 => Shape::primitive("sphere", &[*radius]),
        Geometry::Capsule { radius, length } => Shape::primitive("capsule", &[*radius, *length]),
        Geometry::Mesh { filename, scale } => {
            let read = mesh(filename)?;
            let [x, y, z] = scale.map_or([1.0; 3], |scale| scale.0);
            if ![x, y, z].iter().all(|s| s.is_finite() && *s != 0.0) {
                return Err(format!(
                    "the scale of {filename} is {x} {y} {z}: it must be finite and not zero"
                ));
            }
            Some(read.scaled([x, y, z]).map_err(|error| error.to_string())?.into())
        }
    };
    let made = shape.map(|shape| shape.mesh()).transpose().map_err(|error| error.to_string())?;
    made.ok_or_else(|| "this shape is not known".to_owned())
}
