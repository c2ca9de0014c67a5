//! Angles and rotations, in radians.

use nalgebra::{Quaternion, UnitQuaternion, Vector4};
use std::f64::consts::{PI, TAU};

/// The angle (rad) wrapped to (-π, π].
#[inline]
#[must_use]
pub fn wrap_angle(angle: f64) -> f64 {
    if -PI < angle && angle <= PI {
        return angle;
    }
    let wrapped = angle.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

/// The signed angle (rad) of the shorter arc from `from` to `to`, in \[-π, π\]. Reversing the arguments
/// changes only the sign, for half turns too.
///
/// ```
/// # use mp_cspace::angle::angle_difference;
/// assert!((angle_difference(3.0, -3.0) - 0.2831853071795862).abs() < 1e-15);
/// ```
#[inline]
#[must_use]
pub fn angle_difference(from: f64, to: f64) -> f64 {
    let d = to - from;
    if d.abs() <= PI {
        d
    } else if d.abs() <= TAU {
        d - TAU.copysign(d)
    } else {
        let r = d.abs().rem_euclid(TAU);
        (if r > PI { r - TAU } else { r }) * d.signum()
    }
}

/// The angle at fraction `t` along the shorter arc; exact at both ends.
#[inline]
pub(crate) fn angle_lerp(from: f64, to: f64, t: f64) -> f64 {
    let d = angle_difference(from, to);
    wrap_angle(if t < 0.5 { from + d * t } else { to - d * (1.0 - t) })
}

/// The angle at `u` ∈ \[0, 1): uniform on (-π, π].
#[inline]
pub(crate) fn angle_at(u: f64) -> f64 {
    wrap_angle(PI - TAU * u)
}

/// `b` or `-b`, whichever is nearer to `a`.
#[inline]
pub(crate) fn nearer(a: &Vector4<f64>, b: &Vector4<f64>) -> Vector4<f64> {
    if a.dot(b) < 0.0 { -b } else { *b }
}

/// Half the chord between two unit vectors at most a right angle apart: the sine of half their
/// angle.
#[inline]
pub(crate) fn half_chord(a: &Vector4<f64>, b: &Vector4<f64>) -> f64 {
    ((a - b).norm() * 0.5).min(std::f64::consts::FRAC_1_SQRT_2)
}

/// The angle (rad, in \[0, π\]) of the rotation from `a` to `b`.
///
/// Computed from the chord between the quaternions, `4·asin(|a ∓ b| / 2)`, whose argument stays
/// below √½: accurate to a few units in the last place at every angle, where the arc cosine of
/// the dot product loses half the digits near zero.
#[inline]
#[must_use]
pub fn rotation_angle(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    let (a, b) = (&a.as_ref().coords, &b.as_ref().coords);
    (4.0 * mp_math::asin(half_chord(a, &nearer(a, b)))).min(PI)
}

/// The rotation at fraction `t` along the shorter turn from `a` to `b`; exact at both ends. From `b` to
/// `a` it is the same rotation at `1 - t`.
#[inline]
#[must_use]
pub fn slerp(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>, t: f64) -> UnitQuaternion<f64> {
    if t <= 0.0 {
        return *a;
    }
    if t >= 1.0 {
        return *b;
    }
    let (va, vb) = (&a.as_ref().coords, &b.as_ref().coords);
    let vb = nearer(va, vb);
    // The angle between the quaternions, half that of the rotation: at most a right angle, so
    // its sine is well away from zero unless the angle itself is.
    let angle = 2.0 * mp_math::asin(half_chord(va, &vb));
    let sine = mp_math::sin(angle);
    if sine < 1e-150 {
        return *a;
    }
    let q = (va * mp_math::sin(angle * (1.0 - t)) + vb * mp_math::sin(angle * t)) / sine;
    // One Newton step toward unit length, so that errors do not add up along a path.
    let q = q * (1.5 - 0.5 * q.norm_squared());
    UnitQuaternion::new_unchecked(Quaternion::from(q))
}
