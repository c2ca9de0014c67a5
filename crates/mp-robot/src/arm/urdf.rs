//! Arms from URDF and SRDF text.

use super::{ArmError, ArmModel, Joint, JointKind, Link};
use mp_geom::{TriMesh, primitives};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use thiserror::Error;
use urdf_rs::{Geometry, JointType};

/// Why no arm could be made of a URDF or SRDF.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum UrdfError {
    /// Not XML, or not a URDF.
    #[error("this is not a URDF: {message}")]
    Syntax {
        /// What the parser says.
        message: String,
    },
    /// A joint of a kind that is not handled.
    #[error(
        "joint \"{joint}\" is {kind}: only revolute, continuous, prismatic and fixed joints are handled; a floating \
         base can be placed by the base pose and a fixed joint"
    )]
    Kind {
        /// The joint.
        joint: String,
        /// Its kind.
        kind: &'static str,
    },
    /// A shape that is none.
    #[error("collision shape {number} of link \"{link}\": {message}")]
    Shape {
        /// The link.
        link: String,
        /// Which of its shapes, counted from 1.
        number: usize,
        /// What is wrong.
        message: String,
    },
    /// What was read makes no arm.
    #[error(transparent)]
    Arm(#[from] ArmError),
}

/// Segments of a cylinder or capsule, subdivisions of a ball: they contain the shape they stand for.
const SEGMENTS: u32 = 32;

impl ArmModel {
    /// Reads a URDF through the crate `urdf-rs`. Of it count links, their collision shapes (box, cylinder, capsule,
    /// sphere, mesh; each with its origin) and joints (revolute, continuous, prismatic, fixed; limits and mimics).
    /// Links without collision shapes have none, whatever they look like.
    ///
    /// Round shapes become meshes of flat faces that contain them: larger by less than 1% of the radius (2% for
    /// spheres).
    ///
    /// `mesh` is given each mesh file name as written, often `package://robot/part.stl`, and returns the mesh, or a
    /// message for people.
    ///
    /// # Errors
    /// [`UrdfError`], naming the joint or link.
    pub fn from_urdf(
        text: &str,
        mut mesh: impl FnMut(&str) -> Result<TriMesh, String>,
    ) -> Result<Self, UrdfError> {
        sound(text, "robot")?;
        let robot = urdf_rs::read_from_string(text)
            .map_err(|error| UrdfError::Syntax { message: error.to_string() })?;
        let mut model = Self::default();
        for link in &robot.links {
            let mut made = Link::new(&link.name);
            for (i, collision) in link.collision.iter().enumerate() {
                let fail =
                    |message: String| UrdfError::Shape { link: link.name.clone(), number: i + 1, message };
                let shape = shape(&collision.geometry, &mut mesh).map_err(fail)?;
                let origin = pose(&collision.origin);
                if !super::kinematics::is_pose(&origin, super::compile::MAX_LENGTH) {
                    return Err(fail("its origin is no pose: numbers must be finite".to_owned()));
                }
                made = made.with(&shape, &origin);
            }
            model.links.push(made);
        }
        for joint in &robot.joints {
            let limits = (joint.limit.lower, joint.limit.upper);
            let refused = |kind| Err(UrdfError::Kind { joint: joint.name.clone(), kind });
            let kind = match joint.joint_type {
                JointType::Fixed => JointKind::Fixed,
                JointType::Continuous => JointKind::Continuous,
                JointType::Revolute => JointKind::Revolute { low: limits.0, high: limits.1 },
                JointType::Prismatic => JointKind::Prismatic { low: limits.0, high: limits.1 },
                JointType::Floating => return refused("floating"),
                JointType::Planar => return refused("planar"),
                JointType::Spherical => return refused("spherical"),
            };
            let mut made = Joint::new(&joint.name, &joint.parent.link, &joint.child.link, kind)
                .at(pose(&joint.origin))
                .axis(Vector3::from(joint.axis.xyz.0));
            if let Some(mimic) = &joint.mimic {
                let (multiplier, offset) = (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0));
                made = made.mimic(&mimic.joint, multiplier, offset);
            }
            model.joints.push(made);
        }
        Ok(model)
    }

    /// The same with other limits (rad or m) for a joint that moves and has some, or that turns without end and
    /// becomes revolute.
    ///
    /// # Errors
    /// [`ArmError::NoSuchCoordinate`] when there is no such joint, or it is fixed or mimics another.
    pub fn with_limits(mut self, joint: &str, low: f64, high: f64) -> Result<Self, ArmError> {
        let wrong = |why: String| ArmError::NoSuchCoordinate { joint: joint.to_owned(), why };
        let names = || {
            let moving = self.joints.iter().filter(|j| j.kind != JointKind::Fixed && j.mimic.is_none());
            moving.map(|j| format!("\"{}\"", j.name)).collect::<Vec<_>>().join(", ")
        };
        let Some(found) = self.joints.iter().position(|j| j.name == joint) else {
            return Err(wrong(format!("the joints that move are {}", names())));
        };
        if let Some(mimic) = &self.joints[found].mimic {
            return Err(wrong(format!("it mimics \"{}\"", mimic.joint)));
        }
        self.joints[found].kind = match self.joints[found].kind {
            JointKind::Fixed => return Err(wrong("it is fixed".to_owned())),
            JointKind::Prismatic { .. } => JointKind::Prismatic { low, high },
            JointKind::Revolute { .. } | JointKind::Continuous => JointKind::Revolute { low, high },
        };
        Ok(self)
    }

    /// Takes the pairs of links that may touch from an SRDF: its `disable_collisions`. All else in it is left
    /// aside.
    ///
    /// # Errors
    /// [`UrdfError::Syntax`] when it is no SRDF; links that are missing are found by [`Arm::new`](crate::Arm::new).
    pub fn with_srdf(mut self, text: &str) -> Result<Self, UrdfError> {
        let document = sound(text, "robot")?;
        let mut pairs = Vec::new();
        for node in document.root_element().children().filter(|n| n.has_tag_name("disable_collisions")) {
            let link = |name: &str| {
                node.attribute(name).map(str::to_owned).ok_or_else(|| {
                    let line = document.text_pos_at(node.range().start).row;
                    let message = format!("line {line}: <disable_collisions> has no attribute {name}");
                    UrdfError::Syntax { message }
                })
            };
            pairs.push((link("link1")?, link("link2")?));
        }
        self.may_touch = Some(pairs);
        Ok(self)
    }
}

/// Elements may be nested no deeper than this.
const MAX_DEPTH: usize = 64;

/// The document, if it is XML with that root and not too deep for parsers that recurse.
fn sound<'a>(text: &'a str, root: &str) -> Result<roxmltree::Document<'a>, UrdfError> {
    let syntax = |message: String| UrdfError::Syntax { message };
    let document = roxmltree::Document::parse(text).map_err(|error| syntax(error.to_string()))?;
    let found = document.root_element().tag_name().name();
    if found != root {
        return Err(syntax(format!(
            "its first element is <{found}>, not <{root}>; xacro must be expanded first"
        )));
    }
    let mut deepest = 0;
    let mut stack = vec![(document.root_element(), 1)];
    while let Some((node, depth)) = stack.pop() {
        deepest = deepest.max(depth);
        stack.extend(node.children().filter(roxmltree::Node::is_element).map(|child| (child, depth + 1)));
    }
    if deepest > MAX_DEPTH {
        return Err(syntax(format!("its elements are nested {deepest} deep; {MAX_DEPTH} is the most")));
    }
    Ok(document)
}

fn pose(pose: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = pose.rpy.0;
    let turn = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
    Isometry3::from_parts(Translation3::from(Vector3::from(pose.xyz.0)), turn)
}

/// The shape as a mesh, in its own frame.
fn shape(
    geometry: &Geometry,
    mesh: &mut impl FnMut(&str) -> Result<TriMesh, String>,
) -> Result<TriMesh, String> {
    let grown = 1.0 / (std::f64::consts::PI / f64::from(SEGMENTS)).cos();
    let made = match geometry {
        Geometry::Box { size } => primitives::cuboid(size[0], size[1], size[2]),
        Geometry::Cylinder { radius, length } => primitives::cylinder(radius * grown, *length, SEGMENTS),
        Geometry::Sphere { radius } => return ball(*radius),
        Geometry::Capsule { radius, length } => {
            // Flat both ways round.
            primitives::capsule(radius * grown * grown, *length, SEGMENTS, SEGMENTS / 4)
        }
        Geometry::Mesh { filename, scale } => {
            let read = mesh(filename)?;
            let [x, y, z] = scale.map_or([1.0; 3], |scale| scale.0);
            if ![x, y, z].iter().all(|s| s.is_finite() && *s != 0.0) {
                return Err(format!(
                    "the scale of {filename} is {x} {y} {z}: it must be finite and not zero"
                ));
            }
            let scaled = read.vertices().iter().map(|p| [p.x * x, p.y * y, p.z * z].into()).collect();
            let mut triangles = read.triangles().to_vec();
            if x * y * z < 0.0 {
                triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            return TriMesh::new(scaled, triangles).map_err(|error| error.to_string());
        }
    };
    made.map_err(|error| error.to_string())
}

/// A mesh around a ball: grown until no face cuts it.
fn ball(radius: f64) -> Result<TriMesh, String> {
    let unit = primitives::sphere(1.0, 3).map_err(|error| error.to_string())?;
    let inner = (0..unit.triangles().len())
        .map(|i| {
            let [a, b, c] = unit.triangle(i);
            let normal = (b - a).cross(&(c - a));
            normal.dot(&a.coords) / normal.norm()
        })
        .fold(1.0, f64::min);
    primitives::sphere(radius / inner, 3).map_err(|error| error.to_string())
}
