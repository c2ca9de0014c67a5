//! Conversions of points and poses: nalgebra's here, those of `glamx` in parry.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use std::f64::consts::FRAC_PI_2;

use super::ParryError;

/// The same point as a vector of parry (metres).
#[must_use]
pub fn point_to_parry(point: &Point3<f64>) -> Vector {
    Vector::new(point.x, point.y, point.z)
}

/// The same point (metres), finite or not.
#[must_use]
pub fn point_from_parry(point: Vector) -> Point3<f64> {
    Point3::new(point.x, point.y, point.z)
}

/// The same pose as one of parry, to the bit.
#[must_use]
pub fn pose_to_parry(pose: &Isometry3<f64>) -> Pose {
    let q = pose.rotation.quaternion();
    let rotation = Rotation::from_xyzw(q.i, q.j, q.k, q.w);
    Pose::from_parts(point_to_parry(&pose.translation.vector.into()), rotation)
}

/// The same pose, to the bit.
///
/// # Errors
/// [`ParryError::BadPose`].
pub fn pose_from_parry(pose: &Pose) -> Result<Isometry3<f64>, ParryError> {
    let (at, turn) = (pose.translation, pose.rotation);
    let quaternion = Quaternion::new(turn.w, turn.x, turn.y, turn.z);
    let unit = (quaternion.norm() - 1.0).abs() <= 1e-6;
    if !(unit && at.is_finite()) {
        return Err(ParryError::BadPose);
    }
    let rotation = UnitQuaternion::new_unchecked(quaternion);
    Ok(Isometry3::from_parts(Translation3::new(at.x, at.y, at.z), rotation))
}

/// The rotation from our Z to parry's Y.
pub(super) fn upright() -> UnitQuaternion<f64> {
    UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -FRAC_PI_2)
}

/// A rotation from Z to the direction `way`; `None` when `way` has no direction.
pub(super) fn toward(way: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    // Divided by the largest coordinate first, as squares of large coordinates overflow and of small ones underflow.
    let way = (way / way.amax()).try_normalize(0.0).filter(|way| way.iter().all(|c| c.is_finite()))?;
    // By a quarter turn at most, which is well conditioned; for downward directions after half a turn.
    let (up, first) = if way.z < 0.0 {
        (-Vector3::z(), UnitQuaternion::new_unchecked(Quaternion::new(0.0, 1.0, 0.0, 0.0)))
    } else {
        (Vector3::z(), UnitQuaternion::identity())
    };
    let turn = Quaternion::from_parts(1.0 + up.dot(&way), up.cross(&way));
    Some(UnitQuaternion::new_normalize(turn) * first)
}
