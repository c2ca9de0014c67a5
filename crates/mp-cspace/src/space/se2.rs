//! SE(2): poses in the plane.

use super::poses::pose_space;
use super::{Factored, Rn, Space, TrueMetric};
use crate::angle::{angle_at, angle_difference, angle_lerp, wrap_angle};
use crate::{Rng, layout::Layout};
use nalgebra::{Isometry2, Isometry3, Point2, Translation3, UnitQuaternion, Vector2, Vector3};
use rand::RngExt;
use std::f64::consts::PI;

/// A pose in the plane: rotate by `angle`, then translate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Se2State {
    /// Translation, metres.
    pub translation: Vector2<f64>,
    /// Rotation, radians in (-π, π].
    pub angle: f64,
}

impl Se2State {
    /// The pose at (`x`, `y`) metres turned by `angle` radians, wrapped to (-π, π].
    #[must_use]
    pub fn new(x: f64, y: f64, angle: f64) -> Self {
        Self { translation: Vector2::new(x, y), angle: wrap_angle(angle) }
    }

    /// The place of a point of the body at this pose.
    #[inline]
    #[must_use]
    pub fn transform_point(&self, p: &Point2<f64>) -> Point2<f64> {
        let (s, c) = mp_math::sin_cos(self.angle);
        Point2::new(c * p.x - s * p.y + self.translation.x, s * p.x + c * p.y + self.translation.y)
    }

    /// The same pose as an isometry of the plane.
    #[must_use]
    pub fn to_isometry2(&self) -> Isometry2<f64> {
        Isometry2::new(self.translation, self.angle)
    }

    /// The same pose as an isometry of space, at height `z`, turned about the z axis.
    #[inline]
    #[must_use]
    pub fn to_isometry3(&self, z: f64) -> Isometry3<f64> {
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.angle);
        Isometry3::from_parts(Translation3::new(self.translation.x, self.translation.y, z), rotation)
    }
}

impl From<Isometry2<f64>> for Se2State {
    fn from(pose: Isometry2<f64>) -> Self {
        Self::new(pose.translation.x, pose.translation.y, pose.rotation.angle())
    }
}

/// Poses in the plane, their translation in a box.
///
/// Distance: `‖Δp‖ + w·|Δθ|`, `w` in metres per radian, 0.5 unless set.
#[derive(Clone, Debug, PartialEq)]
pub struct Se2 {
    translations: Rn<2>,
    rotation_weight: f64,
}

pose_space!(Se2, 2);

impl TrueMetric for Se2 {}

impl Space for Se2 {
    type State = Se2State;
    #[inline]
    fn distance(&self, from: &Se2State, to: &Se2State) -> f64 {
        self.translations.distance(&from.translation, &to.translation)
            + self.rotation_weight * angle_difference(from.angle, to.angle).abs()
    }

    #[inline]
    fn dim(&self) -> usize {
        3
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.translations.extent() + self.rotation_weight * PI
    }
    #[inline]
    fn interpolate_into(&self, from: &Se2State, to: &Se2State, t: f64, out: &mut Se2State) {
        self.translations.interpolate_into(&from.translation, &to.translation, t, &mut out.translation);
        out.angle = angle_lerp(from.angle, to.angle, t);
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> Se2State {
        Se2State { translation: self.translations.unit_cube_to_state(u), angle: angle_at(u[2]) }
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> Se2State {
        Se2State { translation: self.translations.sample_uniform(rng), angle: angle_at(rng.random()) }
    }
    #[inline]
    fn contains(&self, q: &Se2State) -> bool {
        self.translations.contains(&q.translation) && -PI < q.angle && q.angle <= PI
    }
    #[inline]
    fn with_rotation_of(&self, position: &Se2State, rotation: &Se2State) -> Se2State {
        Se2State { translation: position.translation, angle: rotation.angle }
    }
    #[inline]
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let &[x, y, turn] = velocity else { return None };
        let to = from.translation + Vector2::new(x, y) * time;
        Some(Se2State::new(to.x, to.y, from.angle + turn * time))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let [x, y, turn] = out else { return false };
        (*x, *y) = (to.translation.x - from.translation.x, to.translation.y - from.translation.y);
        *turn = angle_difference(from.angle, to.angle);
        true
    }
}

/// Factors: x, y, rotation.
impl Factored for Se2 {
    fn factors(&self) -> usize {
        3
    }
    #[inline]
    fn each_factor(&self, from: &Se2State, to: &Se2State, f: &mut impl FnMut(usize, f64)) {
        self.translations.each_factor(&from.translation, &to.translation, f);
        f(2, angle_difference(from.angle, to.angle).abs());
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor == 2 { PI } else { self.translations.factor_extent(factor) }
    }
    fn interpolate_factor(&self, factor: usize, from: &Se2State, to: &Se2State, t: f64, out: &mut Se2State) {
        if factor == 2 {
            out.angle = angle_lerp(from.angle, to.angle, t);
        } else {
            let (a, b) = (&from.translation, &to.translation);
            self.translations.interpolate_factor(factor, a, b, t, &mut out.translation);
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::euclidean(1), Layout::euclidean(1), Layout::angles(1)]
    }
    #[inline]
    fn embed_factors(&self, state: &Se2State, put: &mut impl FnMut(usize, f64)) {
        put(0, state.translation.x);
        put(1, state.translation.y);
        put(2, wrap_angle(state.angle));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn isometries_agree() {
        let q = Se2State::new(1.0, -2.0, 2.5);
        let p = Point2::new(0.3, 0.7);
        let (a, b) = (q.transform_point(&p), q.to_isometry2() * p);
        let c = q.to_isometry3(4.0) * nalgebra::Point3::new(p.x, p.y, 0.0);
        assert!((a - b).norm() < 1e-15 && (a - c.xy()).norm() < 1e-15 && c.z == 4.0);
        let back = Se2State::from(q.to_isometry2());
        assert!((back.angle - q.angle).abs() < 1e-15 && back.translation == q.translation);
    }
}
