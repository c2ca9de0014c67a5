//! SO(3): spatial rotations as unit quaternions.

use super::{Factored, Space, TrueMetric};
use crate::angle::{rotation_angle, slerp};
use crate::{Rng, layout::Layout};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use rand::RngExt;
use std::f64::consts::{PI, TAU};

/// The spatial rotations. States are unit quaternions, `q` and `-q` being the same rotation; the
/// distance is the angle of the rotation between two, in \[0, π\] rad; interpolation turns about a
/// fixed axis along the shorter arc (Shoemake 1985, *Animating rotation with quaternion curves*).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct So3;

/// `q` turned by the rotation vector `turn` (rad, in the world).
#[inline]
pub(crate) fn turned(q: &UnitQuaternion<f64>, turn: Vector3<f64>) -> UnitQuaternion<f64> {
    let q = UnitQuaternion::from_scaled_axis(turn).into_inner() * q.into_inner();
    // One Newton step toward unit length, so that errors do not add up along a path.
    UnitQuaternion::new_unchecked(q * (1.5 - 0.5 * q.norm_squared()))
}

/// The turn about a world axis that leads from `a` to `b` along the shorter arc, as the axis times the angle
/// (rad).
#[inline]
pub(crate) fn turn(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> Vector3<f64> {
    let (va, vb) = (&a.as_ref().coords, &b.as_ref().coords);
    let axis = (b.into_inner() * a.into_inner().conjugate()).imag();
    let sine = axis.norm();
    if sine < 1e-150 {
        return Vector3::zeros();
    }
    let axis = if va.dot(vb) < 0.0 { -axis } else { axis };
    axis * (rotation_angle(a, b) / sine)
}

/// The rotation at `u` of the unit cube, uniform (Shoemake 1992, *Uniform random rotations*, Graphics Gems
/// III).
#[inline]
pub(crate) fn rotation_at(u: [f64; 3]) -> UnitQuaternion<f64> {
    let (r1, r2) = ((1.0 - u[0]).sqrt(), u[0].sqrt());
    let ((s1, c1), (s2, c2)) = (mp_math::sin_cos(TAU * u[1]), mp_math::sin_cos(TAU * u[2]));
    UnitQuaternion::new_unchecked(Quaternion::new(c2 * r2, s1 * r1, c1 * r1, s2 * r2))
}

/// Whether the quaternion is finite and of unit length.
#[inline]
pub(crate) fn is_unit(q: &UnitQuaternion<f64>) -> bool {
    (q.as_ref().coords.norm_squared() - 1.0).abs() < 1e-9
}

/// Twice the quaternion, its scalar part not negative: twice the chord is at most the angle.
#[inline]
pub(crate) fn twice(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    let q = &rotation.as_ref().coords;
    let factor = 2.0_f64.copysign(q.w);
    [q.x * factor, q.y * factor, q.z * factor, q.w * factor]
}

impl TrueMetric for So3 {}

impl Space for So3 {
    type State = UnitQuaternion<f64>;
    #[inline]
    fn distance(&self, from: &UnitQuaternion<f64>, to: &UnitQuaternion<f64>) -> f64 {
        rotation_angle(from, to)
    }

    #[inline]
    fn dim(&self) -> usize {
        3
    }
    #[inline]
    fn extent(&self) -> f64 {
        PI
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        *out = slerp(from, to, t);
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        rotation_at([u[0], u[1], u[2]])
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        rotation_at([rng.random(), rng.random(), rng.random()])
    }
    #[inline]
    fn contains(&self, q: &Self::State) -> bool {
        is_unit(q)
    }
    #[inline]
    fn moved(&self, from: &UnitQuaternion<f64>, velocity: &[f64], time: f64) -> Option<UnitQuaternion<f64>> {
        let &[x, y, z] = velocity else { return None };
        Some(turned(from, Vector3::new(x, y, z) * time))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let fits = out.len() == 3;
        if fits {
            out.copy_from_slice(turn(from, to).as_slice());
        }
        fits
    }
}

impl Factored for So3 {
    fn factors(&self) -> usize {
        1
    }
    #[inline]
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        f(0, rotation_angle(from, to));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor == 0 { PI } else { 0.0 }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if factor == 0 {
            *out = slerp(from, to, t);
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::antipodal(4)]
    }
    #[inline]
    fn embed_factors(&self, state: &UnitQuaternion<f64>, put: &mut impl FnMut(usize, f64)) {
        twice(state).into_iter().for_each(|x| put(0, x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rng;
    use nalgebra::{Unit, Vector3};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn angle_is_accurate_everywhere(
            v in prop::array::uniform3(-1.0..1.0f64),
            u in prop::array::uniform3(0.0..1.0f64),
            angle in prop_oneof![0.0..PI, 0.0..1e-6f64, (PI - 1e-6)..PI],
        ) {
            prop_assume!(Vector3::from(v).norm() > 1e-3);
            let axis = Unit::new_normalize(Vector3::from(v));
            let a = rotation_at(u);
            let b = a * UnitQuaternion::from_axis_angle(&axis, angle);
            prop_assert!((rotation_angle(&a, &b) - angle).abs() < 4e-15);
            let negated = UnitQuaternion::new_unchecked(-b.into_inner());
            prop_assert_eq!(rotation_angle(&a, &b), rotation_angle(&a, &negated));
        }

        #[test]
        fn turns_about_the_axis(u in prop::array::uniform3(0.0..1.0f64), angle in 0.0..3.1f64, t in 0.0..1.0f64) {
            let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, -0.5));
            let a = rotation_at(u);
            let at = |s: f64| a * UnitQuaternion::from_axis_angle(&axis, s);
            prop_assert!(rotation_angle(&slerp(&a, &at(angle), t), &at(t * angle)) < 1e-14);
        }
    }

    #[test]
    fn long_chains_stay_unit() {
        let mut rng = Rng::seed(1);
        let mut q = So3.sample_uniform(&mut rng);
        for _ in 0..100_000 {
            q = slerp(&q, &So3.sample_uniform(&mut rng), 0.1);
        }
        assert!((q.as_ref().norm() - 1.0).abs() < 1e-14);
    }

    /// The angle of a uniform rotation has density (1 - cos θ)/π, hence mean π/2 + 2/π.
    #[test]
    fn samples_are_uniform() {
        let mut rng = Rng::seed(2);
        let n = 200_000;
        let one = UnitQuaternion::identity();
        let mean =
            (0..n).map(|_| rotation_angle(&one, &So3.sample_uniform(&mut rng))).sum::<f64>() / n as f64;
        assert!((mean - (PI / 2.0 + 2.0 / PI)).abs() < 5e-3, "mean {mean}");
    }
}
