//! Forward kinematics: where a configuration places the links.

use super::{ArmError, ArmModel, JointKind};
use crate::arm::compile;
use mp_cspace::{Coordinates, JointRange, Joints, angle::wrap_angle};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// A joint that moves, and the frame behind it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    /// The frame above it.
    pub(crate) parent: usize,
    /// Its pose in that frame at value zero.
    pub(crate) origin: Isometry3<f64>,
    pub(crate) axis: Unit<Vector3<f64>>,
    pub(crate) slides: bool,
    /// The value of the joint is this coordinate times `scale` plus `offset`.
    pub(crate) coordinate: usize,
    pub(crate) scale: f64,
    pub(crate) offset: f64,
    /// The largest absolute value (m) of a prismatic joint; zero for others.
    pub(crate) slide: f64,
}

/// A coordinate of the arm: a joint that moves and mimics no other.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinate {
    /// The name of the joint.
    pub name: String,
    /// Its range: its own limits, narrowed by those of the joints that mimic it.
    pub range: JointRange,
}

/// A link, and where it is fixed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct AttachedLink {
    pub(crate) name: String,
    /// The frame it is fixed to: 0 is the base, `i + 1` the frame of the joint `i`.
    pub(crate) frame: usize,
    pub(crate) pose: Isometry3<f64>,
}

/// The checked kinematic tree of an arm. Parents come before children.
///
/// Configurations are lists of joint values, one for each [`Coordinate`], in radians and metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics {
    pub(crate) base: Isometry3<f64>,
    pub(crate) frames: Vec<Frame>,
    pub(crate) coordinates: Vec<Coordinate>,
    /// In the order of the model.
    pub(crate) attached: Vec<AttachedLink>,
    /// The two links of each joint.
    pub(crate) joined: Vec<[usize; 2]>,
}

impl Kinematics {
    /// The tree of `model`. O(links + joints), up to a logarithm.
    ///
    /// # Errors
    /// When the model is not a tree, or a joint is not valid: see [`ArmError`].
    pub fn new(model: &ArmModel) -> Result<Self, ArmError> {
        compile::kinematics(model)
    }

    /// The coordinates, in the order of the joints of the model.
    #[must_use]
    pub fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    /// How many coordinates a configuration has.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.coordinates.len()
    }

    /// The names of the links, in the order of the model.
    pub fn links(&self) -> impl ExactSizeIterator<Item = &str> {
        self.attached.iter().map(|link| link.name.as_str())
    }

    /// The space of configurations: an interval for each coordinate with limits, a circle for each without.
    ///
    /// # Errors
    /// When `Q` has another number of coordinates.
    pub fn space<Q: Coordinates>(&self) -> Result<Joints<Q>, ArmError> {
        Ok(Joints::new(self.coordinates.iter().map(|c| c.range).collect::<Vec<_>>())?)
    }

    /// Whether `q` is a configuration: as many numbers as there are coordinates, all finite.
    #[must_use]
    pub fn is_configuration(&self, q: &[f64]) -> bool {
        q.len() == self.dof() && q.iter().all(|x| x.is_finite())
    }

    /// The configuration nearest to zero in the ranges of the joints.
    #[must_use]
    pub fn neutral(&self) -> Vec<f64> {
        let nearest = |range: JointRange| match range {
            JointRange::Interval { low, high } => 0.0_f64.clamp(low, high),
            JointRange::Circle => 0.0,
        };
        self.coordinates.iter().map(|c| nearest(c.range)).collect()
    }

    /// The pose of each link in the world, in the order of the model.
    ///
    /// `None` when `q` is not a configuration.
    #[must_use]
    pub fn link_poses(&self, q: &[f64]) -> Option<Vec<Isometry3<f64>>> {
        let mut frames = Vec::new();
        self.is_configuration(q).then(|| {
            self.frames_into(q, &mut frames);
            self.attached.iter().map(|link| frames[link.frame] * link.pose).collect()
        })
    }

    /// The poses of the base and of the frames behind the joints that move. `q` must be a configuration.
    pub(crate) fn frames_into(&self, q: &[f64], out: &mut Vec<Isometry3<f64>>) {
        out.clear();
        out.push(self.base);
        for frame in &self.frames {
            let mut pose = out[frame.parent] * frame.origin;
            let value = q[frame.coordinate] * frame.scale + frame.offset;
            if frame.slides {
                pose.translation.vector += pose.rotation * (frame.axis.into_inner() * value);
            } else {
                pose.rotation *= UnitQuaternion::from_axis_angle(&frame.axis, value);
            }
            out.push(pose);
        }
    }

    /// How far the coordinate `i` goes from `from` to `to` in the [space](Self::space) of the arm.
    #[inline]
    pub(crate) fn travel(&self, i: usize, from: &[f64], to: &[f64]) -> f64 {
        self.displacement(i, from, to).abs()
    }

    /// How far the coordinate `i` goes, with its sign.
    #[inline]
    pub(crate) fn displacement(&self, i: usize, from: &[f64], to: &[f64]) -> f64 {
        let d = to[i] - from[i];
        match self.coordinates[i].range {
            JointRange::Circle if !(-std::f64::consts::PI..=std::f64::consts::PI).contains(&d) => {
                wrap_angle(d)
            }
            _ => d,
        }
    }
}

/// The range of the values of a kind of joint; `None` for fixed joints.
pub(crate) fn range(kind: JointKind) -> Option<JointRange> {
    match kind {
        JointKind::Fixed => None,
        JointKind::Continuous => Some(JointRange::Circle),
        JointKind::Revolute { low, high } | JointKind::Prismatic { low, high } => {
            Some(JointRange::Interval { low, high })
        }
    }
}

/// Whether a pose is finite, with no coordinate above `max` and a rotation of unit length.
pub(crate) fn is_pose(pose: &Isometry3<f64>, max: f64) -> bool {
    let Translation3 { vector } = pose.translation;
    vector.iter().all(|x| x.abs() <= max) && (pose.rotation.quaternion().norm() - 1.0).abs() < 1e-6
}
