//! SE(3): poses in space.

use super::poses::pose_space;
use super::so3::{is_unit, rotation_at, turn, turned, twice};
use super::{Factored, Rn, Space, TrueMetric};
use crate::angle::{rotation_angle, slerp};
use crate::{Rng, layout::Layout};
use nalgebra::{Isometry3, Vector3};
use rand::RngExt;
use std::f64::consts::PI;

/// Poses in space, their translation in a box.
///
/// Distance: `‖Δp‖ + w·θ`, θ the angle of the rotation between in \[0, π\] and `w` in metres per
/// radian, 0.5 unless set. Interpolation moves the origin of the body on a straight line and
/// turns the body about a fixed axis, both at constant speed.
///
/// ```
/// use mp_cspace::{Se3, Space};
/// use nalgebra::{Isometry3, Vector3};
/// let space = Se3::new([-1.0; 3], [1.0; 3])?;
/// let a = Isometry3::identity();
/// let b = Isometry3::new(Vector3::new(0.3, 0.0, 0.4), Vector3::new(0.0, 0.0, 1.0));
/// assert!((space.distance(&a, &b) - 1.0).abs() < 1e-15);
/// let middle = space.interpolate(&a, &b, 0.5);
/// assert!((middle.rotation.angle() - 0.5).abs() < 1e-15);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Se3 {
    translations: Rn<3>,
    rotation_weight: f64,
}

pose_space!(Se3, 3);

impl TrueMetric for Se3 {}

impl Space for Se3 {
    type State = Isometry3<f64>;
    #[inline]
    fn distance(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        self.translations.distance(&from.translation.vector, &to.translation.vector)
            + self.rotation_weight * rotation_angle(&from.rotation, &to.rotation)
    }

    #[inline]
    fn dim(&self) -> usize {
        6
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.translations.extent() + self.rotation_weight * PI
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        let (a, b) = (&from.translation.vector, &to.translation.vector);
        self.translations.interpolate_into(a, b, t, &mut out.translation.vector);
        out.rotation = slerp(&from.rotation, &to.rotation, t);
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        let translation = self.translations.unit_cube_to_state(u);
        Isometry3::from_parts(translation.into(), rotation_at([u[3], u[4], u[5]]))
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        let translation = self.translations.sample_uniform(rng);
        let rotation = rotation_at([rng.random(), rng.random(), rng.random()]);
        Isometry3::from_parts(translation.into(), rotation)
    }
    #[inline]
    fn contains(&self, q: &Self::State) -> bool {
        self.translations.contains(&q.translation.vector) && is_unit(&q.rotation)
    }
    #[inline]
    fn with_rotation_of(&self, position: &Isometry3<f64>, rotation: &Isometry3<f64>) -> Isometry3<f64> {
        Isometry3::from_parts(position.translation, rotation.rotation)
    }
    #[inline]
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let &[x, y, z, a, b, c] = velocity else { return None };
        let to = from.translation.vector + Vector3::new(x, y, z) * time;
        Some(Isometry3::from_parts(to.into(), turned(&from.rotation, Vector3::new(a, b, c) * time)))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let fits = out.len() == 6;
        if fits {
            let (translation, rotation) = out.split_at_mut(3);
            translation.copy_from_slice((to.translation.vector - from.translation.vector).as_slice());
            rotation.copy_from_slice(turn(&from.rotation, &to.rotation).as_slice());
        }
        fits
    }
}

/// Factors: x, y, z, rotation.
impl Factored for Se3 {
    fn factors(&self) -> usize {
        4
    }
    #[inline]
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        self.translations.each_factor(&from.translation.vector, &to.translation.vector, f);
        f(3, rotation_angle(&from.rotation, &to.rotation));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor == 3 { PI } else { self.translations.factor_extent(factor) }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if factor == 3 {
            out.rotation = slerp(&from.rotation, &to.rotation, t);
        } else {
            let (a, b) = (&from.translation.vector, &to.translation.vector);
            self.translations.interpolate_factor(factor, a, b, t, &mut out.translation.vector);
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::euclidean(1), Layout::euclidean(1), Layout::euclidean(1), Layout::antipodal(4)]
    }
    #[inline]
    fn embed_factors(&self, state: &Isometry3<f64>, put: &mut impl FnMut(usize, f64)) {
        (0..).zip(state.translation.vector.iter()).for_each(|(i, &x)| put(i, x));
        twice(&state.rotation).into_iter().for_each(|x| put(3, x));
    }
}
