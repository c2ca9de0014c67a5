//! Joints on a base that moves freely: the space of a free-flying articulated body.

use super::{Factored, Joints, Se3, Space, TrueMetric};
use crate::{Configuration, Rng, SpaceError, layout::Layout};
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// SE(3) × joints: the pose of a base that moves freely, and the joints of a body on it.
///
/// It is the product of [`Se3`] and [`Joints`], with their states in one list, so that planners that are
/// compiled for arms serve it too. The first seven numbers are the pose of the base: x, y, z (m), then the
/// unit quaternion as i, j, k and w. The values of the joints follow.
///
/// Distance: `√((‖Δp‖ + w·θ)² + ‖Δq‖²)`, the first term the distance of [`Se3`], the second that of
/// [`Joints`]. Interpolation is that of the two spaces.
///
/// ```
/// use mp_cspace::{FloatingJoints, JointRange, Joints, Se3, Space};
/// use nalgebra::Isometry3;
/// let jaw = Joints::new([JointRange::Interval { low: 0.0, high: 0.05 }])?;
/// let space = FloatingJoints::new(Se3::new([-1.0; 3], [1.0; 3])?, jaw)?;
/// let shut = space.state(&Isometry3::identity(), &[0.0]);
/// let open = space.state(&Isometry3::translation(0.0, 0.12, 0.0), &[0.05]);
/// assert_eq!(space.dim(), 7);
/// assert!((space.distance(&shut, &open) - 0.13).abs() < 1e-15);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FloatingJoints {
    base: Se3,
    joints: Joints<Configuration>,
    extent: f64,
}

/// How many numbers of a state are the pose of the base.
const POSE: usize = 7;
/// How many degrees of freedom the base has.
const FREE: usize = 6;
/// How many factors the space of the base has.
const FACTORS: usize = 4;

impl FloatingJoints {
    /// How many numbers of a state are the pose of the base: three for its origin, four for its rotation.
    pub const POSE: usize = POSE;

    /// The product of a space of poses and a space of joints.
    ///
    /// # Errors
    /// When the extent of the product is not finite.
    pub fn new(base: Se3, joints: Joints<Configuration>) -> Result<Self, SpaceError> {
        let extent = mp_math::hypot(base.extent(), joints.extent());
        let extent = crate::error::weight("the extent of the space", extent)?;
        Ok(Self { base, joints, extent })
    }

    /// The space of the base.
    #[must_use]
    pub fn base(&self) -> &Se3 {
        &self.base
    }

    /// The space of the joints.
    #[must_use]
    pub fn joints(&self) -> &Joints<Configuration> {
        &self.joints
    }

    /// The state with this pose of the base and these values of the joints. Joints without limits are wrapped
    /// to (-π, π].
    #[must_use]
    pub fn state(&self, base: &Isometry3<f64>, joints: &[f64]) -> Configuration {
        let joints = self.joints.wrapped(&Configuration::from(joints));
        joined(base, joints.as_slice())
    }

    /// The pose of the base and the values of the joints of a state; `None` for a list of fewer than seven
    /// numbers. The quaternion is taken as it is.
    #[inline]
    #[must_use]
    pub fn split(q: &[f64]) -> Option<(Isometry3<f64>, &[f64])> {
        let (&[x, y, z, i, j, k, w], joints) = q.split_first_chunk::<POSE>()?;
        let rotation = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        Some((Isometry3::from_parts(Translation3::new(x, y, z), rotation), joints))
    }
}

/// A list of the numbers of a pose and of joints.
fn joined(base: &Isometry3<f64>, joints: &[f64]) -> Configuration {
    let mut out = Configuration::zeros(POSE + joints.len());
    put(base, out.as_mut_slice());
    out.as_mut_slice()[POSE..].copy_from_slice(joints);
    out
}

/// Writes a pose to the front of a state.
#[inline]
fn put(base: &Isometry3<f64>, out: &mut [f64]) {
    if let Some((pose, _)) = out.split_first_chunk_mut::<POSE>() {
        let (p, r) = (&base.translation.vector, &base.rotation.as_ref().coords);
        *pose = [p.x, p.y, p.z, r.x, r.y, r.z, r.w];
    }
}

impl TrueMetric for FloatingJoints {}

impl Space for FloatingJoints {
    type State = Configuration;
    #[inline]
    fn distance(&self, from: &Configuration, to: &Configuration) -> f64 {
        let (Some((a, p)), Some((b, q))) = (Self::split(from.as_slice()), Self::split(to.as_slice())) else {
            return self.extent;
        };
        let base = self.base.distance(&a, &b);
        let count = self.joints.dim().min(p.len()).min(q.len());
        let joints = (0..count).map(|i| mp_math::powi(self.joints.difference(i, p[i], q[i]), 2));
        (base * base + joints.sum::<f64>()).sqrt()
    }

    #[inline]
    fn dim(&self) -> usize {
        FREE + self.joints.dim()
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        if out.len() != from.len() {
            out.clone_from(from);
        }
        let (Some((a, p)), Some((b, q))) = (Self::split(from.as_slice()), Self::split(to.as_slice())) else {
            return;
        };
        put(&self.base.interpolate(&a, &b, t), out.as_mut_slice());
        let count = self.joints.dim().min(p.len()).min(q.len());
        let out = out.as_mut_slice().get_mut(POSE..).unwrap_or_default();
        for (i, o) in out.iter_mut().enumerate().take(count) {
            *o = self.joints.joint_between(i, p[i], q[i], t);
        }
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        let (base, joints) = u.split_at(FREE);
        joined(&self.base.unit_cube_to_state(base), self.joints.unit_cube_to_state(joints).as_slice())
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        let base = self.base.sample_uniform(rng);
        joined(&base, self.joints.sample_uniform(rng).as_slice())
    }
    fn contains(&self, q: &Self::State) -> bool {
        let parts = Self::split(q.as_slice());
        parts.is_some_and(|(base, joints)| self.base.contains(&base) && self.joints.holds(joints))
    }
    /// The position is that of the base: rotation is that of the base, and all joints.
    fn with_rotation_of(&self, position: &Self::State, rotation: &Self::State) -> Self::State {
        let mut out = rotation.clone();
        for (o, x) in out.iter_mut().zip(position.iter()).take(3) {
            *o = *x;
        }
        out
    }
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let (base, joints) = Self::split(from.as_slice())?;
        let (of_base, of_joints) = velocity.split_at_checked(FREE)?;
        let joints = self.joints.moved(&Configuration::from(joints), of_joints, time)?;
        Some(joined(&self.base.moved(&base, of_base, time)?, joints.as_slice()))
    }
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let (Some((a, p)), Some((b, q))) = (Self::split(from.as_slice()), Self::split(to.as_slice())) else {
            return false;
        };
        let fits = [p.len() + FREE, q.len() + FREE, out.len()] == [self.dim(); 3];
        let Some((of_base, of_joints)) = out.split_at_mut_checked(FREE).filter(|_| fits) else {
            return false;
        };
        let differences = (0..p.len()).map(|i| self.joints.difference(i, p[i], q[i]));
        of_joints.iter_mut().zip(differences).for_each(|(slot, difference)| *slot = difference);
        self.base.velocity_into(&a, &b, of_base)
    }
}

/// Factors: x, y, z and rotation of the base, then the joints.
impl Factored for FloatingJoints {
    fn factors(&self) -> usize {
        FACTORS + self.joints.factors()
    }
    #[inline]
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        let (Some((a, p)), Some((b, q))) = (Self::split(from.as_slice()), Self::split(to.as_slice())) else {
            return;
        };
        self.base.each_factor(&a, &b, f);
        let count = self.joints.dim().min(p.len()).min(q.len());
        (0..count).for_each(|i| f(FACTORS + i, self.joints.difference(i, p[i], q[i]).abs()));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        match factor.checked_sub(FACTORS) {
            None => self.base.factor_extent(factor),
            Some(joint) => self.joints.factor_extent(joint),
        }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if let Some(joint) = factor.checked_sub(FACTORS) {
            let i = POSE + joint;
            if joint < self.joints.dim()
                && let (Some(a), Some(b), Some(o)) = (from.get(i), to.get(i), out.get_mut(i))
            {
                *o = self.joints.joint_between(joint, *a, *b, t);
            }
        } else if let (Some((a, _)), Some((b, _)), Some((mut pose, _))) =
            (Self::split(from.as_slice()), Self::split(to.as_slice()), Self::split(out.as_slice()))
        {
            self.base.interpolate_factor(factor, &a, &b, t, &mut pose);
            put(&pose, out.as_mut_slice());
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        [self.base.factor_layouts(), self.joints.factor_layouts()].concat()
    }
    #[inline]
    fn embed_factors(&self, state: &Self::State, put: &mut impl FnMut(usize, f64)) {
        if let Some((base, joints)) = Self::split(state.as_slice()) {
            self.base.embed_factors(&base, put);
            let joints = joints.iter().take(self.joints.dim()).enumerate();
            joints.for_each(|(i, x)| put(FACTORS + i, self.joints.coordinate(i, *x)));
        }
    }
}
