//! The description of an arm: plain data, in which links and joints refer to each other by name.

use super::ArmError;
use mp_geom::{Aabb, TriMesh};
use nalgebra::{Isometry3, Vector3};

/// A rigid part of an arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The name of the link, one of a kind in its arm.
    pub name: String,
    /// The meshes that can collide, in the frame of the link. Empty for links that only carry joints.
    pub shapes: Vec<TriMesh>,
}

impl Link {
    /// A link without shapes.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), shapes: Vec::new() }
    }

    /// Adds a shape, at `pose` in the frame of the link.
    #[must_use]
    pub fn with(mut self, shape: &TriMesh, pose: &Isometry3<f64>) -> Self {
        self.shapes.push(shape.transformed(pose));
        self
    }
}

/// How a joint lets its child move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// Turns about its axis between two angles (rad). Does not move if they are equal.
    Revolute {
        /// The lower limit.
        low: f64,
        /// The upper limit.
        high: f64,
    },
    /// Turns about its axis without end.
    Continuous,
    /// Slides along its axis between two positions (m). Does not move if they are equal.
    Prismatic {
        /// The lower limit.
        low: f64,
        /// The upper limit.
        high: f64,
    },
}

impl JointKind {
    /// The lower and the upper limit, if the kind has limits.
    #[must_use]
    pub fn limits(self) -> Option<[f64; 2]> {
        match self {
            Self::Revolute { low, high } | Self::Prismatic { low, high } => Some([low, high]),
            Self::Fixed | Self::Continuous => None,
        }
    }

    /// The value of a joint that cannot move because its limits are equal.
    #[must_use]
    pub fn held(self) -> Option<f64> {
        self.limits().filter(|[low, high]| low == high).map(|[low, _]| low)
    }
}

/// How a joint follows another: its value is `multiplier` times the other's, plus `offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    /// The joint it follows.
    pub joint: String,
    /// The factor; negative for the opposite direction.
    pub multiplier: f64,
    /// The offset (rad or m).
    pub offset: f64,
}

/// A joint between two links.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The name of the joint, one of a kind in its arm.
    pub name: String,
    /// The parent link.
    pub parent: String,
    /// The child link, which it moves.
    pub child: String,
    /// The pose of the child's frame in the parent's frame at value zero.
    pub origin: Isometry3<f64>,
    /// The axis, in the frame of the child. Its length does not matter, but must not be zero.
    pub axis: Vector3<f64>,
    /// How the child moves.
    pub kind: JointKind,
    /// How it moved before it was [held](ArmModel::holding) or got [other limits](ArmModel::with_limits): which links must not touch does not
    /// depend on these.
    pub described: Option<JointKind>,
    /// The joint that it follows, if any. A joint that follows another is not a coordinate.
    pub mimic: Option<Mimic>,
    /// How fast it may move (rad/s or m/s), if that is known: for trajectories. Nothing else depends on it.
    pub max_velocity: Option<f64>,
    /// How fast its velocity may change (rad/s² or m/s²), if that is known.
    pub max_acceleration: Option<f64>,
    /// How fast its acceleration may change (rad/s³ or m/s³), if that is limited.
    pub max_jerk: Option<f64>,
}

/// What the rate of a joint is: how fast its position changes, its velocity, or its acceleration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rate {
    /// Of positions (rad/s or m/s).
    Velocity,
    /// Of velocities (rad/s² or m/s²).
    Acceleration,
    /// Of accelerations (rad/s³ or m/s³).
    Jerk,
}

impl Rate {
    /// All, in the order in which limits have them.
    pub const ALL: [Self; 3] = [Self::Velocity, Self::Acceleration, Self::Jerk];
}

impl Joint {
    /// A joint about or along X. The frames of both links coincide.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        parent: impl Into<String>,
        child: impl Into<String>,
        kind: JointKind,
    ) -> Self {
        Self {
            name: name.into(),
            parent: parent.into(),
            child: child.into(),
            origin: Isometry3::identity(),
            axis: Vector3::x(),
            kind,
            described: None,
            mimic: None,
            max_velocity: None,
            max_acceleration: None,
            max_jerk: None,
        }
    }

    /// Sets the pose of the child's frame in the parent's frame.
    #[must_use]
    pub fn at(mut self, origin: Isometry3<f64>) -> Self {
        self.origin = origin;
        self
    }

    /// Sets the axis, in the frame of the child. Its length does not matter, but must not be zero.
    #[must_use]
    pub fn axis(mut self, axis: Vector3<f64>) -> Self {
        self.axis = axis;
        self
    }

    /// Makes it follow `joint`.
    #[must_use]
    pub fn mimic(mut self, joint: impl Into<String>, multiplier: f64, offset: f64) -> Self {
        self.mimic = Some(Mimic { joint: joint.into(), multiplier, offset });
        self
    }
}

/// The description of an arm, or of any tree of links: plain data, checked by [`Arm::new`](crate::Arm::new).
///
/// ```
/// use mp_geom::primitives::cuboid;
/// use mp_robot::{Arm, ArmModel, Joint, JointKind, Link};
/// use nalgebra::{Isometry3, Vector3};
///
/// // Two bars of 1 m in a plane.
/// let bar = cuboid(0.9, 0.1, 0.1)?;
/// let along = Isometry3::translation(0.5, 0.0, 0.0);
/// let turn = JointKind::Revolute { low: -3.0, high: 3.0 };
/// let model = ArmModel {
///     links: vec![Link::new("base"), Link::new("upper").with(&bar, &along), Link::new("lower").with(&bar, &along)],
///     joints: vec![
///         Joint::new("shoulder", "base", "upper", turn).axis(Vector3::z()),
///         Joint::new("elbow", "upper", "lower", turn)
///             .axis(Vector3::z())
///             .at(Isometry3::translation(1.0, 0.0, 0.0)),
///     ],
///     ..ArmModel::default()
/// };
/// let arm = Arm::new(&model, [])?;
/// assert_eq!(arm.dof(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ArmModel {
    /// The links. Exactly one has no parent: the root, which stands still unless it floats.
    pub links: Vec<Link>,
    /// The joints. Those that move and mimic no other are the coordinates, in this order. Joints whose limits are
    /// equal do not move.
    pub joints: Vec<Joint>,
    /// The pose of the root in the world. Without use if the root floats.
    pub base: Isometry3<f64>,
    /// The box (m) in which the origin of the root moves, if the root floats: it moves and turns freely, and its pose is part
    /// of a configuration. With `None` the root stands still.
    pub floating: Option<Aabb>,
    /// Pairs of links that may touch and overlap, besides those of rigid bodies that a joint connects. With `None`, the pairs
    /// that always touch are found by sampling.
    pub may_touch: Option<Vec<(String, String)>>,
    /// Pairs of links that may touch besides, whether pairs are given or found.
    pub may_also_touch: Vec<(String, String)>,
    /// Pairs of links that must not touch, whatever else is said of them, unless they never move relative to each other.
    pub kept_apart: Vec<(String, String)>,
    /// What was ignored when the model was read from a file, in sentences for people. Empty for models made in code.
    pub notes: Vec<String>,
}

impl Default for ArmModel {
    fn default() -> Self {
        Self {
            links: Vec::new(),
            joints: Vec::new(),
            base: Isometry3::identity(),
            floating: None,
            may_touch: None,
            may_also_touch: Vec::new(),
            kept_apart: Vec::new(),
            notes: Vec::new(),
        }
    }
}

impl ArmModel {
    /// The limits of velocity, acceleration and jerk of the joint of that name: its own, and those of the joints that mimic it, also by way of
    /// others. `None` where nothing is known.
    #[must_use]
    pub fn rates(&self, joint: &str) -> [Option<f64>; 3] {
        let mut moved: Vec<_> = self.joints.iter().filter(|j| j.name == joint).map(|j| (j, 1.0)).collect();
        let mut next = 0;
        // Those that follow it, and those that follow these. In a model that is not valid joints may follow each other: the walk ends even so.
        while let Some(&(leader, factor)) = moved.get(next).filter(|_| next <= self.joints.len()) {
            moved.extend(self.joints.iter().filter_map(|j| {
                let mimic = j.mimic.as_ref()?;
                (mimic.joint == leader.name && mimic.multiplier != 0.0)
                    .then_some((j, factor * mimic.multiplier.abs()))
            }));
            next += 1;
        }
        moved.into_iter().fold([None; 3], |least, (joint, factor)| {
            let all = [joint.max_velocity, joint.max_acceleration, joint.max_jerk]
                .map(|limit| limit.map(|limit| limit / factor));
            std::array::from_fn(|i| match (least[i], all[i]) {
                (Some(a), Some(b)) => Some(f64::min(a, b)),
                (a, b) => a.or(b),
            })
        })
    }

    /// Sets a limit of the joint of that name, or of all joints.
    ///
    /// # Errors
    /// [`ArmError::NoSuchCoordinate`] when there is no such joint, or it is fixed.
    pub fn with_rate(mut self, joint: Option<&str>, rate: Rate, limit: f64) -> Result<Self, ArmError> {
        let is_it = |j: &Joint| j.kind != JointKind::Fixed && joint.is_none_or(|name| j.name == name);
        if let Some(name) = joint
            && !self.joints.iter().any(is_it)
        {
            let moving = self.joints.iter().filter(|j| j.kind != JointKind::Fixed);
            let names: Vec<_> = moving.map(|j| format!("\"{}\"", j.name)).collect();
            let why = format!("the joints that move are {}", names.join(", "));
            return Err(ArmError::NoSuchCoordinate { joint: name.to_owned(), why });
        }
        for joint in self.joints.iter_mut().filter(|j| is_it(j)) {
            let place = match rate {
                Rate::Velocity => &mut joint.max_velocity,
                Rate::Acceleration => &mut joint.max_acceleration,
                Rate::Jerk => &mut joint.max_jerk,
            };
            *place = Some(limit);
        }
        Ok(self)
    }

    /// Sets the limits (rad or m) of a joint that has limits, or of a continuous joint, which becomes revolute.
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
        let joint = &mut self.joints[found];
        joint.described.get_or_insert(joint.kind);
        joint.kind = match joint.kind {
            JointKind::Fixed => return Err(wrong("it is fixed".to_owned())),
            JointKind::Prismatic { .. } => JointKind::Prismatic { low, high },
            JointKind::Revolute { .. } | JointKind::Continuous => JointKind::Revolute { low, high },
        };
        Ok(self)
    }

    /// Widens the limits of joints so that `joint`, which mimics no other, can be at `value` (rad or m), and those that mimic it where
    /// that puts them.
    #[must_use]
    pub fn with_room_for(mut self, joint: &str, value: f64) -> Self {
        let is_leader = self.joints.iter().any(|j| j.name == joint && j.mimic.is_none());
        let mut open = if is_leader { vec![(joint.to_owned(), value)] } else { Vec::new() };
        while let Some((name, value)) = open.pop() {
            for joint in &mut self.joints {
                if let Some(mimic) = joint.mimic.as_ref().filter(|mimic| mimic.joint == name) {
                    open.push((joint.name.clone(), value * mimic.multiplier + mimic.offset));
                }
                if joint.name == name
                    && let JointKind::Revolute { low, high } | JointKind::Prismatic { low, high } =
                        &mut joint.kind
                {
                    (*low, *high) = (low.min(value), high.max(value));
                }
            }
        }
        self
    }
}
