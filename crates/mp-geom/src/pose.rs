//! Rigid poses from and to six numbers (as in the key-elements paper), quaternions and homogeneous matrices.
//!
//! A. Benitez, I. Huitzil, D. Vallejo, J. de la Calleja, M. A. Medina, "Key Elements for Motion Planning
//! Algorithms", 2010, section 2.2, equations 1 to 4. Equations 2 and 4 are garbled in print (signs and rows
//! are missing, and sines are printed as cosines). This module follows the paper's text and its equations 1
//! and 3: *yaw* α is a counter-clockwise rotation about Z, *pitch* β about Y, *roll* γ about X, and
//!
//! ```text
//! R(α, β, γ) = Rz(α) · Ry(β) · Rx(γ)
//!
//!     | cα·cβ   cα·sβ·sγ − sα·cγ   cα·sβ·cγ + sα·sγ   x |
//! T = | sα·cβ   sα·sβ·sγ + cα·cγ   sα·sβ·cγ − cα·sγ   y |
//!     | −sβ     cβ·sγ              cβ·cγ              z |
//!     | 0       0                  0                  1 |
//! ```

use nalgebra::{Isometry3, Matrix3, Matrix4, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use thiserror::Error;

/// How far the rotation part of a matrix may be from orthonormal: the largest entry of `RᵀR − I`.
/// Loose enough for files printed with six digits.
pub const ROTATION_TOLERANCE: f64 = 1e-5;

/// Below this cosine of the pitch, yaw and roll turn about the same axis (gimbal lock).
const GIMBAL_COSINE: f64 = 1e-12;

/// Why numbers are not a rigid pose.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A number is NaN or infinite.
    #[error("a number of the pose is not finite")]
    NotFinite,
    /// The upper left 3 × 3 part is not orthonormal: it scales or shears.
    #[error(
        "the 3 × 3 part is not a rotation: RᵀR differs from the identity by {deviation:e} \
         (it scales or shears)"
    )]
    NotOrthonormal {
        /// Largest entry of `RᵀR − I`, in absolute value.
        deviation: f64,
    },
    /// The upper left 3 × 3 part mirrors.
    #[error("the 3 × 3 part is a reflection (determinant −1), not a rotation")]
    Reflection,
    /// The bottom row is not (0, 0, 0, 1).
    #[error("the bottom row of a homogeneous matrix must be 0 0 0 1")]
    BottomRow,
    /// A quaternion of zero length has no direction.
    #[error("the quaternion is zero")]
    ZeroQuaternion,
}

/// The pose of (x, y, z, α, β, γ): metres and radians, α yaw about Z, β pitch about Y, γ roll about X,
/// `R = Rz(α)·Ry(β)·Rx(γ)`.
///
/// Numbers that are not finite give a pose that is not finite; readers of files check first.
#[must_use]
pub fn pose_from_six(six: [f64; 6]) -> Isometry3<f64> {
    let [x, y, z, alpha, beta, gamma] = six;
    // nalgebra's (roll, pitch, yaw) is Rz(yaw)·Ry(pitch)·Rx(roll).
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(gamma, beta, alpha))
}

/// The (x, y, z, α, β, γ) of a pose, inverse of [`pose_from_six`]: α and γ in (−π, π], β in \[−π/2, π/2\].
///
/// In gimbal lock (β = ±π/2), where only α ∓ γ is determined, γ is 0.
#[must_use]
pub fn six_from_pose(pose: &Isometry3<f64>) -> [f64; 6] {
    let r = pose.rotation.to_rotation_matrix().into_inner();
    let cos_beta = mp_math::hypot(r[(0, 0)], r[(1, 0)]);
    let beta = mp_math::atan2(-r[(2, 0)], cos_beta);
    let (alpha, gamma) = if cos_beta <= GIMBAL_COSINE {
        (mp_math::atan2(-r[(0, 1)], r[(1, 1)]), 0.0)
    } else {
        // Undo the yaw, then read the roll: accurate however small the cosine of the pitch.
        let alpha = mp_math::atan2(r[(1, 0)], r[(0, 0)]);
        let (s, c) = mp_math::sin_cos(alpha);
        (alpha, mp_math::atan2(s * r[(0, 2)] - c * r[(1, 2)], c * r[(1, 1)] - s * r[(0, 1)]))
    };
    let t = pose.translation.vector;
    [t.x, t.y, t.z, alpha, beta, gamma]
}

/// As [`six_from_pose`], for files that people read: an angle is rounded to twelve decimals if the pose stays
/// the same to the last bits, so that 0.5 is not written as 0.5000000000000001. No number is −0.
#[must_use]
pub fn short_six_from_pose(pose: &Isometry3<f64>) -> [f64; 6] {
    let six = six_from_pose(pose);
    let mut short = six;
    for angle in &mut short[3..] {
        *angle = (*angle * 1e12).round() / 1e12;
    }
    let [a, b] = [pose.rotation, pose_from_six(short).rotation].map(UnitQuaternion::into_inner);
    let is_same = (a.coords - b.coords).amax().min((a.coords + b.coords).amax()) <= 4.0 * f64::EPSILON;
    if is_same { short } else { six }.map(|v| v + 0.0)
}

/// The pose at `position` turned by the quaternion `w + xi + yj + zk`, which need not be of unit length.
///
/// # Errors
/// [`PoseError::NotFinite`] or [`PoseError::ZeroQuaternion`].
pub fn pose_from_quaternion(
    position: [f64; 3],
    w: f64,
    x: f64,
    y: f64,
    z: f64,
) -> Result<Isometry3<f64>, PoseError> {
    if position.iter().chain(&[w, x, y, z]).any(|v| !v.is_finite()) {
        return Err(PoseError::NotFinite);
    }
    // Scaling first keeps the norm from overflowing or vanishing.
    let scale = [w, x, y, z].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    if scale == 0.0 {
        return Err(PoseError::ZeroQuaternion);
    }
    let q = UnitQuaternion::new_normalize(Quaternion::new(w / scale, x / scale, y / scale, z / scale));
    Ok(Isometry3::from_parts(Translation3::from(Vector3::from(position)), q))
}

/// The homogeneous matrix of a pose (equation 4).
#[must_use]
pub fn matrix_from_pose(pose: &Isometry3<f64>) -> Matrix4<f64> {
    pose.to_homogeneous()
}

/// The pose of a homogeneous matrix.
///
/// The rotation part may be off by rounding, up to [`ROTATION_TOLERANCE`]; the nearest rotation is taken.
///
/// # Errors
/// [`PoseError`] when an entry is not finite, the bottom row is not 0 0 0 1, or the 3 × 3 part scales,
/// shears or mirrors.
pub fn pose_from_matrix(m: &Matrix4<f64>) -> Result<Isometry3<f64>, PoseError> {
    if m.iter().any(|v| !v.is_finite()) {
        return Err(PoseError::NotFinite);
    }
    if m.row(3).iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(a, b)| (a - b).abs() > ROTATION_TOLERANCE) {
        return Err(PoseError::BottomRow);
    }
    let rotation = rotation_from_matrix(&m.fixed_view::<3, 3>(0, 0).into_owned())?;
    Ok(Isometry3::from_parts(Translation3::new(m[(0, 3)], m[(1, 3)], m[(2, 3)]), rotation))
}

/// The rotation of a 3 × 3 matrix, with the tolerance of [`pose_from_matrix`].
///
/// # Errors
/// As [`pose_from_matrix`].
pub fn rotation_from_matrix(r: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, PoseError> {
    if r.iter().any(|v| !v.is_finite()) {
        return Err(PoseError::NotFinite);
    }
    let deviation = (r.transpose() * r - Matrix3::identity()).amax();
    // Written so that a NaN from overflow is refused too.
    if !matches!(deviation.partial_cmp(&ROTATION_TOLERANCE), Some(o) if o.is_le()) {
        return Err(PoseError::NotOrthonormal { deviation });
    }
    if r.determinant() < 0.0 {
        return Err(PoseError::Reflection);
    }
    // Two Newton steps of the polar decomposition, from within 1e-5 of it, reach full precision.
    let mut q = *r;
    for _ in 0..2 {
        q = q * (Matrix3::identity() * 1.5 - q.transpose() * q * 0.5);
    }
    Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(q)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn by_equations(six: [f64; 6]) -> Matrix4<f64> {
        let [x, y, z, a, b, g] = six;
        let [(sa, ca), (sb, cb), (sg, cg)] = [a, b, g].map(mp_math::sin_cos);
        let rz = Matrix3::new(ca, -sa, 0.0, sa, ca, 0.0, 0.0, 0.0, 1.0);
        let ry = Matrix3::new(cb, 0.0, sb, 0.0, 1.0, 0.0, -sb, 0.0, cb);
        let rx = Matrix3::new(1.0, 0.0, 0.0, 0.0, cg, -sg, 0.0, sg, cg);
        let mut t = (rz * ry * rx).to_homogeneous();
        t.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::new(x, y, z));
        t
    }

    fn angle() -> impl Strategy<Value = f64> {
        prop_oneof![-7.0..7.0, Just(0.0), Just(FRAC_PI_2), Just(-FRAC_PI_2), Just(PI), Just(-PI)]
    }

    fn six() -> impl Strategy<Value = [f64; 6]> {
        ([-1e3..1e3, -1e3..1e3, -1e3..1e3], [angle(), angle(), angle()])
            .prop_map(|([x, y, z], [a, b, g])| [x, y, z, a, b, g])
    }

    proptest! {
        #[test]
        fn six_follow_equations_one_to_three(six in six()) {
            let error = (matrix_from_pose(&pose_from_six(six)) - by_equations(six)).amax();
            prop_assert!(error < 1e-14 * 1e3, "{error:e}");
        }

        #[test]
        fn six_come_back_as_the_same_pose(six in six()) {
            let pose = pose_from_six(six);
            let back = six_from_pose(&pose);
            prop_assert!(back[4].abs() <= FRAC_PI_2 && back[3].abs() <= PI && back[5].abs() <= PI);
            let error = (pose.to_homogeneous() - pose_from_six(back).to_homogeneous()).amax();
            prop_assert!(error < 1e-14, "{error:e}");
        }

        #[test]
        fn near_gimbal_lock_too(alpha in -3.0..3.0, gamma in -3.0..3.0, exponent in -17.0..-1.0_f64, up in any::<bool>()) {
            let beta = (FRAC_PI_2 - mp_math::powf(10.0, exponent)) * if up { 1.0 } else { -1.0 };
            let pose = pose_from_six([0.0, 0.0, 0.0, alpha, beta, gamma]);
            let back = pose_from_six(six_from_pose(&pose));
            prop_assert!((pose.to_homogeneous() - back.to_homogeneous()).amax() < 4e-12);
        }

        #[test]
        fn matrices_come_back(six in six(), noise in -1e-7..1e-7_f64) {
            let pose = pose_from_six(six);
            let mut m = matrix_from_pose(&pose);
            prop_assert!((pose_from_matrix(&m).unwrap().to_homogeneous() - m).amax() < 1e-14);
            m[(1, 2)] += noise;
            let back = pose_from_matrix(&m).unwrap().to_homogeneous();
            prop_assert!((back - m).amax() <= noise.abs() * 2.0 + 1e-14);
        }

        #[test]
        fn matrices_that_scale_shear_or_mirror_are_refused(six in six(), scale in 1.0001..10.0, axis in 0_usize..3) {
            let m = matrix_from_pose(&pose_from_six(six));
            let mut d = Matrix4::identity();
            d[(axis, axis)] = scale;
            let refused = matches!(pose_from_matrix(&(m * d)), Err(PoseError::NotOrthonormal { .. }));
            prop_assert!(refused);
            d[(axis, axis)] = -1.0;
            prop_assert_eq!(pose_from_matrix(&(m * d)), Err(PoseError::Reflection));
            d[(axis, axis)] = 1.0;
            d[(axis, (axis + 1) % 3)] = scale;
            let refused = matches!(pose_from_matrix(&(m * d)), Err(PoseError::NotOrthonormal { .. }));
            prop_assert!(refused);
        }

        #[test]
        fn quaternions_of_any_length(six in six(), exponent in -300_i32..300) {
            let pose = pose_from_six(six);
            let (q, s) = (pose.rotation, mp_math::powi(10.0, exponent));
            let back = pose_from_quaternion([six[0], six[1], six[2]], q.w * s, q.i * s, q.j * s, q.k * s).unwrap();
            prop_assert!((back.to_homogeneous() - pose.to_homogeneous()).amax() < 1e-14);
        }
    }

    #[test]
    fn one_axis_at_a_time() {
        let turned = |six, v: Vector3<f64>| pose_from_six(six).rotation * v;
        assert!((turned([0.0, 0.0, 0.0, FRAC_PI_2, 0.0, 0.0], Vector3::x()) - Vector3::y()).norm() < 1e-15);
        assert!((turned([0.0, 0.0, 0.0, 0.0, FRAC_PI_2, 0.0], Vector3::z()) - Vector3::x()).norm() < 1e-15);
        assert!((turned([0.0, 0.0, 0.0, 0.0, 0.0, FRAC_PI_2], Vector3::y()) - Vector3::z()).norm() < 1e-15);
    }

    #[test]
    fn angles_that_people_wrote_are_written_as_they_were() {
        for i in -300..300 {
            let six = [1.0, -2.0, 0.0, 0.01 * f64::from(i), 0.005 * f64::from(i), -0.01 * f64::from(i)];
            let six = six.map(|v| (v * 1e3).round() / 1e3 + 0.0);
            assert_eq!(short_six_from_pose(&pose_from_six(six)), six);
        }
        // Any others, to the last bit.
        let six = [0.0, 0.0, 0.0, 0.123_456_789_012_345_6, -0.4, 1.1];
        let pose = pose_from_six(six);
        assert_eq!(short_six_from_pose(&pose), six_from_pose(&pose));
    }

    #[test]
    fn in_gimbal_lock_the_roll_is_zero() {
        let six = six_from_pose(&pose_from_six([1.0, 2.0, 3.0, 0.7, FRAC_PI_2, 0.2]));
        assert_eq!(six[5], 0.0);
        assert!((six[3] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_a_pose() {
        let mut m = Matrix4::identity();
        m[(3, 0)] = 0.5;
        assert_eq!(pose_from_matrix(&m), Err(PoseError::BottomRow));
        m[(0, 3)] = f64::NAN;
        assert_eq!(pose_from_matrix(&m), Err(PoseError::NotFinite));
        assert!(matches!(pose_from_matrix(&(Matrix4::identity() * 1e200)), Err(PoseError::BottomRow)));
        let huge = Matrix3::identity() * 1e200;
        assert!(matches!(rotation_from_matrix(&huge), Err(PoseError::NotOrthonormal { .. })));
        assert_eq!(pose_from_quaternion([0.0; 3], 0.0, 0.0, 0.0, 0.0), Err(PoseError::ZeroQuaternion));
        assert_eq!(pose_from_quaternion([f64::INFINITY; 3], 1.0, 0.0, 0.0, 0.0), Err(PoseError::NotFinite));
    }
}
