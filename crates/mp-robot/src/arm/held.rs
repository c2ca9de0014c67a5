//! Joints that are held, so that fewer joints move.

use super::{ArmError, ArmModel, Joint, JointKind, Kinematics};
use std::collections::HashMap;

/// A joint that is to be held beyond a limit by no more than this (rad or m) is held at the limit.
const HAIR: f64 = 1e-5;

impl ArmModel {
    /// The same robot with the joint held at `value` (rad or m): it has no number in a configuration.
    ///
    /// # Errors
    /// [`ArmError::NoSuchCoordinate`] when there is no such joint, or it is fixed or mimics another; [`ArmError::Held`] when the
    /// value is beyond its limits.
    pub fn holding(self, joint: &str, value: f64) -> Result<Self, ArmError> {
        let known = self.joints.iter().find(|known| known.name == joint);
        let [low, high] = known.and_then(|joint| joint.kind.limits()).unwrap_or([value; 2]);
        let at = value.max(low).min(high);
        // Written so that NaN is refused.
        let near = (at - value).abs() <= HAIR;
        if near {
            self.with_limits(joint, at, at)
        } else {
            Err(ArmError::Held { joint: joint.to_owned(), value, low, high })
        }
    }

    /// The same robot as it was described, with no joint held, and with the limits that it had and has; `None` when that is the same. With an SRDF, which
    /// says of all links which may touch, joints whose limits are equal have a hair of room. Where all this is not sound, no joint mimics another.
    pub(super) fn as_described(&self) -> Option<Self> {
        let mut free = self.clone();
        for joint in &mut free.joints {
            joint.kind = joint.described.map_or(joint.kind, |before| with_both_limits(before, joint.kind));
            if self.may_touch.is_some() && joint.mimic.is_none() {
                joint.kind = with_room(joint.kind);
            }
        }
        if free.joints.iter().zip(&self.joints).all(|(free, own)| free.kind == own.kind) {
            return None;
        }
        if Kinematics::new(&free).is_err() {
            free.joints.iter_mut().for_each(|joint| joint.mimic = None);
        }
        Some(free)
    }

    /// The same robot of which no other joints move than those of `joints`, and where the others are held: where `at` says, else at
    /// zero, or at the limit nearest to zero.
    ///
    /// # Errors
    /// As [`holding`](Self::holding), and when the model is not valid.
    pub fn with_only(
        self,
        joints: &[String],
        at: impl Fn(&str) -> Option<f64>,
    ) -> Result<(Self, Vec<(String, f64)>), ArmError> {
        let is_other = |joint: &&Joint| {
            let moves =
                joint.kind != JointKind::Fixed && joint.mimic.is_none() && joint.kind.held().is_none();
            moves && !joints.contains(&joint.name)
        };
        // A joint with limits may mimic one without end only while that is held, so these are held first.
        let mut endless =
            self.joints.iter().filter(is_other).filter(|joint| joint.kind == JointKind::Continuous);
        let still = endless
            .try_fold(self.clone(), |model, j| model.holding(&j.name, at(&j.name).unwrap_or_default()))?;
        let kinematics = Kinematics::new(&self).or_else(|_| Kinematics::new(&still))?;
        let coordinates = kinematics.coordinates();
        if let Some(stray) = joints.iter().find(|name| coordinates.iter().all(|c| c.name != **name)) {
            // What is wrong with it is known there.
            let known = self.joints.iter().find(|joint| joint.name == *stray);
            let held = known.and_then(|joint| joint.kind.held());
            return self.holding(stray, held.unwrap_or_default()).and_then(|_| {
                let why = "its limits are equal, so that it does not move".to_owned();
                Err(ArmError::NoSuchCoordinate { joint: stray.clone(), why })
            });
        }
        let names = coordinates.iter().map(|c| c.name.as_str());
        let neutral: HashMap<_, _> = names.zip(kinematics.neutral()).collect();
        let zero = |name: &str| neutral.get(name).copied().unwrap_or_default();
        let value = |name: &str| at(name).unwrap_or_else(|| zero(name));
        let others = self.joints.iter().filter(is_other);
        let held: Vec<_> = others.map(|joint| (joint.name.clone(), value(&joint.name))).collect();
        let model = held.iter().try_fold(self, |model, (joint, value)| model.holding(joint, *value))?;
        Ok((model, held))
    }
}

/// A joint with the room that it had and has.
fn with_both_limits(before: JointKind, now: JointKind) -> JointKind {
    let (Some([a, b]), Some([c, d])) = (before.limits(), now.limits()) else {
        return if before.limits().is_none() { before } else { now };
    };
    match (a <= b, now) {
        (true, JointKind::Prismatic { .. }) => JointKind::Prismatic { low: a.min(c), high: b.max(d) },
        (true, JointKind::Revolute { .. }) => JointKind::Revolute { low: a.min(c), high: b.max(d) },
        _ => now,
    }
}

/// A joint whose limits are equal, with a hair of room: it has a frame of its own then.
fn with_room(kind: JointKind) -> JointKind {
    let Some(at) = kind.held() else { return kind };
    let hair = 1e-9 * (1.0 + at.abs());
    match kind {
        JointKind::Prismatic { .. } => JointKind::Prismatic { low: at - hair, high: at + hair },
        _ => JointKind::Revolute { low: at - hair, high: at + hair },
    }
}
