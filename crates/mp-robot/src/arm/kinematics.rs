//! Forward kinematics: where a configuration places the links.

use super::{ArmError, ArmModel, JointKind};
use crate::arm::compile;
use crate::arm::travel::ROUND_UP;
use mp_cspace::{Coordinates, FloatingJoints, JointRange, Joints, Se3, Space, angle::wrap_angle};
use mp_geom::Sphere;
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// The names of the numbers of the pose of a floating base, as six-tuples have them.
pub(crate) const BASE_NUMBERS: [&str; 6] = ["x", "y", "z", "alpha", "beta", "gamma"];

/// A joint that moves, and the frame behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFrame {
    /// The frame above it: 0 is the base, `i + 1` the frame of the joint `i`.
    pub parent: usize,
    /// Its pose in that frame at value zero.
    pub origin: Isometry3<f64>,
    /// The axis, in its own frame.
    pub axis: Unit<Vector3<f64>>,
    /// Whether it slides along the axis; otherwise it turns about it.
    pub slides: bool,
    /// The value of the joint is this coordinate times `scale` plus `offset`.
    pub coordinate: usize,
    /// The factor.
    pub scale: f64,
    /// The offset (rad or m).
    pub offset: f64,
    /// The largest absolute value (m) of a prismatic joint; zero for others.
    pub slide: f64,
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
pub struct AttachedLink {
    /// The name of the link.
    pub name: String,
    /// The frame it is fixed to: 0 is the base, `i + 1` the frame of the joint `i`.
    pub frame: usize,
    /// Its pose there.
    pub pose: Isometry3<f64>,
}

/// The checked kinematic tree of an arm. Parents come before children.
///
/// Configurations are lists of joint values, one for each [`Coordinate`], in radians and metres. If the base floats, its pose
/// comes first, as seven numbers: see [`FloatingJoints`].
#[derive(Clone, Debug, PartialEq)]
pub struct Kinematics {
    pub(crate) base: Isometry3<f64>,
    /// The space of the base, if it floats.
    pub(crate) floating: Option<Se3>,
    pub(crate) frames: Vec<JointFrame>,
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

    /// The number of degrees of freedom: one for each coordinate, and six more if the base floats.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.coordinates.len() + if self.floats() { 6 } else { 0 }
    }

    /// Whether the base floats.
    #[must_use]
    pub fn floats(&self) -> bool {
        self.floating.is_some()
    }

    /// The number of the first joint in a configuration.
    #[inline]
    pub(crate) fn first(&self) -> usize {
        if self.floats() { FloatingJoints::POSE } else { 0 }
    }

    /// The joints that move, parents before children.
    #[must_use]
    pub fn joint_frames(&self) -> &[JointFrame] {
        &self.frames
    }

    /// Where each link is fixed, in the order of the model.
    #[must_use]
    pub fn attached(&self) -> &[AttachedLink] {
        &self.attached
    }

    /// The names of the links, in the order of the model.
    pub fn links(&self) -> impl ExactSizeIterator<Item = &str> {
        self.attached.iter().map(|link| link.name.as_str())
    }

    /// The space of configurations: an interval for each coordinate with limits, a circle for each without.
    ///
    /// # Errors
    /// When `Q` has another number of coordinates, or the base floats.
    pub fn space<Q: Coordinates>(&self) -> Result<Joints<Q>, ArmError> {
        if self.floats() { Err(ArmError::Floats) } else { self.joints() }
    }

    /// The space of configurations of a robot whose base floats.
    ///
    /// # Errors
    /// When the base stands still.
    pub fn floating_space(&self) -> Result<FloatingJoints, ArmError> {
        match &self.floating {
            Some(base) => Ok(FloatingJoints::new(base.clone(), self.joints()?)?),
            None => Err(ArmError::StandsStill),
        }
    }

    /// The space of the joints.
    pub(crate) fn joints<Q: Coordinates>(&self) -> Result<Joints<Q>, ArmError> {
        Ok(Joints::new(self.coordinates.iter().map(|c| c.range).collect::<Vec<_>>())?)
    }

    /// Whether `q` is a configuration: as many numbers as needed, all finite. The quaternion of a floating base must be of unit
    /// length.
    #[must_use]
    pub fn is_configuration(&self, q: &[f64]) -> bool {
        q.len() == self.first() + self.coordinates.len()
            && q.iter().all(|x| x.is_finite())
            && (!self.floats() || FloatingJoints::split(q).is_some_and(|(pose, _)| is_unit(&pose.rotation)))
    }

    /// The values of the joints nearest to zero in their ranges.
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

    /// The pose of the base and the values of the joints of `q`, a configuration.
    #[inline]
    pub(crate) fn parts<'q>(&self, q: &'q [f64]) -> (Isometry3<f64>, &'q [f64]) {
        match FloatingJoints::split(q).filter(|_| self.floats()) {
            Some(parts) => parts,
            None => (self.base, q),
        }
    }

    /// The poses of the base and of the frames behind the joints that move. `q` must be a configuration.
    pub(crate) fn frames_into(&self, q: &[f64], out: &mut Vec<Isometry3<f64>>) {
        let (base, joints) = self.parts(q);
        self.frames_from(&base, joints, out);
    }

    /// As [`frames_into`](Self::frames_into), from the pose of the base and the values of the joints.
    pub(crate) fn frames_from(&self, base: &Isometry3<f64>, q: &[f64], out: &mut Vec<Isometry3<f64>>) {
        out.clear();
        out.push(*base);
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
        let d = to[self.first() + i] - from[self.first() + i];
        match self.coordinates[i].range {
            JointRange::Circle if !(-std::f64::consts::PI..=std::f64::consts::PI).contains(&d) => {
                wrap_angle(d)
            }
            _ => d,
        }
    }

    /// How far the base goes from `from` to `to`; not at all unless it floats.
    #[inline]
    pub(crate) fn base_travel(&self, from: &[f64], to: &[f64]) -> BaseTravel {
        let ends = self.floating.as_ref().zip(FloatingJoints::split(from)).zip(FloatingJoints::split(to));
        let Some(((space, (from, _)), (to, _))) = ends else { return BaseTravel::default() };
        let mut velocity = [0.0; 6];
        space.velocity_into(&from, &to, &mut velocity);
        let [x, y, z, a, b, c] = velocity;
        let turn = Vector3::new(a, b, c);
        BaseTravel { slide: Vector3::new(x, y, z).norm(), turn: turn.norm(), axis: turn }
    }

    /// `q` moved by as much as from `from` to `to`: a floating base by its translation and its turn in the world, the joints
    /// by the shorter way.
    pub(crate) fn moved_by<Q: Coordinates>(&self, q: &Q, from: &Q, to: &Q) -> Q {
        let (at, from, to) = (q.as_slice(), from.as_slice(), to.as_slice());
        let first = self.first();
        let joint = |i: usize| match i.checked_sub(first) {
            Some(joint) => at[i] + self.displacement(joint, from, to),
            None => at[i],
        };
        let mut out = Q::from_fn(at.len(), joint);
        if let (true, Some((pose, _)), Some((a, _)), Some((b, _))) =
            (self.floats(), FloatingJoints::split(at), FloatingJoints::split(from), FloatingJoints::split(to))
        {
            let place = pose.translation.vector + b.translation.vector - a.translation.vector;
            let mut rotation = b.rotation * a.rotation.inverse() * pose.rotation;
            rotation.renormalize();
            put_pose(&Isometry3::from_parts(place.into(), rotation), out.as_mut_slice());
        }
        out
    }
}

/// Writes the pose of a floating base to the front of a configuration.
fn put_pose(pose: &Isometry3<f64>, out: &mut [f64]) {
    let (p, r) = (&pose.translation.vector, &pose.rotation.as_ref().coords);
    let numbers = [p.x, p.y, p.z, r.x, r.y, r.z, r.w];
    out.iter_mut().zip(numbers).for_each(|(slot, number)| *slot = number);
}

/// How far a floating base goes over a motion: its origin on a straight line, turning about an axis of constant direction
/// through the origin, both at constant speed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BaseTravel {
    /// How far the origin goes, metres.
    pub(crate) slide: f64,
    /// By which angle it turns, radians.
    pub(crate) turn: f64,
    /// The axis of the turn in the world, of any length; zero without a turn.
    pub(crate) axis: Vector3<f64>,
}

impl BaseTravel {
    /// Whether it does not move.
    #[inline]
    pub(crate) fn is_still(&self) -> bool {
        self.slide == 0.0 && self.turn == 0.0
    }

    /// A bound (m) on how far a point of a link is moved by the base if it is never farther than `reach` from the origin of the
    /// base.
    #[inline]
    pub(crate) fn far(&self, reach: f64) -> f64 {
        (self.slide + self.turn * reach) * ROUND_UP
    }

    /// As [`far`](Self::far), over the fraction `half` of the motion to either side of a configuration at which the base is at
    /// `origin` and the link within `ball`. The joints move the points of the link by at most `by_joints` metres meanwhile.
    ///
    /// Turning about an axis does not change the distance from it, so only the joints do.
    #[inline]
    pub(crate) fn near(
        &self,
        half: f64,
        reach: f64,
        ball: &Sphere,
        origin: &Point3<f64>,
        by_joints: f64,
    ) -> f64 {
        let from_axis = match self.turn > 0.0 {
            true => (ball.center - origin).cross(&self.axis).norm() / self.turn,
            false => 0.0,
        };
        half * (self.slide + self.turn * reach.min(from_axis + ball.radius + by_joints)) * ROUND_UP
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

/// Whether a quaternion is of unit length.
fn is_unit(rotation: &UnitQuaternion<f64>) -> bool {
    (rotation.quaternion().norm() - 1.0).abs() < 1e-8
}

/// Whether a pose is finite, with no coordinate above `max` and a rotation of unit length.
pub(crate) fn is_pose(pose: &Isometry3<f64>, max: f64) -> bool {
    let Translation3 { vector } = pose.translation;
    vector.iter().all(|x| x.abs() <= max) && (pose.rotation.quaternion().norm() - 1.0).abs() < 1e-6
}
