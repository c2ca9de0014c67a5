//! SO(2): planar rotations as angles.

use super::{Factored, Metric, Space, TrueMetric};
use crate::Rng;
use rand::RngExt;
use std::f64::consts::{PI, TAU};

/// The planar rotations. States are angles in radians in (-π, π]; the distance is the angle of
/// the shorter arc, in \[0, π\].
///
/// Angles outside that range are measured and interpolated rightly but not
/// [contained](Space::contains): wrap them by [`wrap_angle`].
///
/// ```
/// use mp_cspace::{Metric, So2, Space};
/// assert!((So2.distance(&3.0, &-3.0) - 0.2831853071795862).abs() < 1e-15);
/// assert!(So2.interpolate(&3.0, &-3.0, 0.75) < 0.0);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct So2;

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

/// The signed angle of the shorter arc from `from` to `to`. Reversing the arguments changes only
/// the sign, for half turns too.
#[inline]
pub(crate) fn arc(from: f64, to: f64) -> f64 {
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
    let d = arc(from, to);
    wrap_angle(if t < 0.5 { from + d * t } else { to - d * (1.0 - t) })
}

/// The angle at `u` ∈ \[0, 1): uniform on (-π, π].
#[inline]
pub(crate) fn angle_at(u: f64) -> f64 {
    wrap_angle(PI - TAU * u)
}

impl Metric<f64> for So2 {
    #[inline]
    fn distance(&self, from: &f64, to: &f64) -> f64 {
        arc(*from, *to).abs()
    }
}
impl TrueMetric<f64> for So2 {}

impl Space for So2 {
    type State = f64;

    #[inline]
    fn dim(&self) -> usize {
        1
    }
    #[inline]
    fn extent(&self) -> f64 {
        PI
    }
    #[inline]
    fn interpolate_into(&self, from: &f64, to: &f64, t: f64, out: &mut f64) {
        *out = angle_lerp(*from, *to, t);
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> f64 {
        angle_at(u[0])
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> f64 {
        angle_at(rng.random())
    }
    #[inline]
    fn contains(&self, q: &f64) -> bool {
        -PI < *q && *q <= PI
    }
    #[inline]
    fn moved(&self, from: &f64, velocity: &[f64], time: f64) -> Option<f64> {
        (velocity.len() == 1).then(|| wrap_angle(from + velocity[0] * time))
    }
    #[inline]
    fn velocity_into(&self, from: &f64, to: &f64, out: &mut [f64]) -> bool {
        let [out] = out else { return false };
        *out = arc(*from, *to);
        true
    }
}

impl Factored for So2 {
    fn factors(&self) -> usize {
        1
    }
    #[inline]
    fn each_factor(&self, from: &f64, to: &f64, f: &mut impl FnMut(usize, f64)) {
        f(0, arc(*from, *to).abs());
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor == 0 { PI } else { 0.0 }
    }
    fn interpolate_factor(&self, factor: usize, from: &f64, to: &f64, t: f64, out: &mut f64) {
        if factor == 0 {
            *out = angle_lerp(*from, *to, t);
        }
    }
}
