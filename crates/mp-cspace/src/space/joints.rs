//! Joints: intervals and circles side by side.

use super::{Factored, Space, TrueMetric, lerp, scale};
use crate::angle::{angle_at, angle_difference, angle_lerp, wrap_angle};
use crate::{Rng, SpaceError, layout::Layout};
use nalgebra::SVector;
use rand::RngExt;
use std::f64::consts::PI;
use std::fmt::Debug;

/// A list of coordinates: `SVector<f64, N>` where their number is known when compiling, else
/// [`Configuration`](crate::Configuration).
pub trait Coordinates: Clone + Debug + PartialEq + Send + Sync {
    /// The number of coordinates; `None` when it is known only at run time.
    const COUNT: Option<usize>;
    /// The list of `f(0)`, `f(1)`, …, `f(count - 1)`; where [`COUNT`](Self::COUNT) is a number, of that many.
    fn from_fn(count: usize, f: impl FnMut(usize) -> f64) -> Self;
    /// The coordinates, in the order of the degrees of freedom.
    fn as_slice(&self) -> &[f64];
    /// The coordinates, mutable.
    fn as_mut_slice(&mut self) -> &mut [f64];
}

impl<const N: usize> Coordinates for SVector<f64, N> {
    const COUNT: Option<usize> = Some(N);
    #[inline]
    fn from_fn(_: usize, mut f: impl FnMut(usize) -> f64) -> Self {
        SVector::from_fn(|i, _| f(i))
    }
    #[inline]
    fn as_slice(&self) -> &[f64] {
        self.as_slice()
    }
    #[inline]
    fn as_mut_slice(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}

/// The values that a joint may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointRange {
    /// From `low` to `high`: radians or metres.
    Interval {
        /// The lower bound.
        low: f64,
        /// The upper bound.
        high: f64,
    },
    /// Any angle, in (-π, π] rad; motions take the shorter arc.
    Circle,
}

impl JointRange {
    fn bounds(self) -> [f64; 2] {
        match self {
            Self::Interval { low, high } => [low, high],
            Self::Circle => [-PI, PI],
        }
    }

    fn layout(self) -> Layout {
        match self {
            Self::Interval { .. } => Layout::euclidean(1),
            Self::Circle => Layout::angles(1),
        }
    }

    fn extent(self) -> f64 {
        match self {
            Self::Interval { low, high } => high - low,
            Self::Circle => PI,
        }
    }
}

/// The space of an arm: each joint an interval or a circle, with the Euclidean norm of the differences, on
/// circles that of the shorter arc. Radians and metres count alike; a
/// [`ScaledEuclidean`](crate::ScaledEuclidean) weighs them.
///
/// With [`Configuration`](crate::Configuration) as states the number of joints is known at run time. Where
/// all joints are intervals and their number is known when compiling, [`Rn`](crate::Rn) is the same space,
/// and faster.
///
/// ```
/// use mp_cspace::{JointRange, Joints, Space};
/// use nalgebra::Vector2;
/// let lift = JointRange::Interval { low: 0.0, high: 0.5 };
/// let space = Joints::<Vector2<f64>>::new([lift, JointRange::Circle])?;
/// let (a, b) = ([0.1, 3.0].into(), [0.1, -3.0].into());
/// assert!((space.distance(&a, &b) - 0.2831853071795862).abs() < 1e-15);
/// assert!(space.interpolate(&a, &b, 0.75).y < 0.0);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Joints<Q> {
    ranges: Vec<JointRange>,
    /// Differences up to these need no wrapping: π on circles, infinite on intervals.
    unwrapped: Q,
    extent: f64,
}

impl<Q: Coordinates> Joints<Q> {
    /// The space of joints with these ranges.
    ///
    /// # Errors
    /// When there is no range, or not as many as `Q` has coordinates; when a bound is not finite, or some
    /// `low` is not below its `high`.
    pub fn new(ranges: impl Into<Vec<JointRange>>) -> Result<Self, SpaceError> {
        let ranges = ranges.into();
        if let Some(expected) = Q::COUNT
            && expected != ranges.len()
        {
            return Err(SpaceError::Count { what: "joint ranges", expected, found: ranges.len() });
        }
        let bounds = |end: usize| ranges.iter().map(|r| r.bounds()[end]).collect::<Vec<_>>();
        crate::error::diagonal(&bounds(0), &bounds(1))?;
        let extent = ranges.iter().map(|r| mp_math::powi(r.extent(), 2)).sum::<f64>().sqrt();
        let unwrapped = Q::from_fn(ranges.len(), |i| match ranges[i] {
            JointRange::Interval { .. } => f64::INFINITY,
            JointRange::Circle => PI,
        });
        Ok(Self { ranges, unwrapped, extent })
    }

    /// A box of R^n: every joint an interval.
    ///
    /// # Errors
    /// As [`new`](Self::new), and when the bounds differ in number.
    ///
    /// ```
    /// use mp_cspace::{Configuration, Joints, Space};
    /// let space = Joints::<Configuration>::intervals(&[0.0; 7], &[1.0; 7])?;
    /// assert_eq!(space.dim(), 7);
    /// # Ok::<(), mp_cspace::SpaceError>(())
    /// ```
    pub fn intervals(low: &[f64], high: &[f64]) -> Result<Self, SpaceError> {
        if low.len() != high.len() {
            return Err(SpaceError::Count { what: "upper bounds", expected: low.len(), found: high.len() });
        }
        let range = |(&low, &high)| JointRange::Interval { low, high };
        Self::new(low.iter().zip(high).map(range).collect::<Vec<_>>())
    }

    /// The torus of `count` angles: the space of an arm of unlimited revolute joints. One angle is SO(2).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn circles(count: usize) -> Result<Self, SpaceError> {
        Self::new(vec![JointRange::Circle; count])
    }

    /// The values that each joint may take, in the order of a state's numbers.
    #[must_use]
    pub fn ranges(&self) -> &[JointRange] {
        &self.ranges
    }

    /// `q` with the angles of circles wrapped to (-π, π]; other joints are left alone.
    #[must_use]
    pub fn wrapped(&self, q: &Q) -> Q {
        let q = q.as_slice();
        Q::from_fn(q.len(), |i| match self.ranges.get(i) {
            Some(JointRange::Circle) => wrap_angle(q[i]),
            _ => q[i],
        })
    }

    /// The signed difference of joint `i`, on circles along the shorter arc.
    #[inline]
    pub(super) fn difference(&self, i: usize, from: f64, to: f64) -> f64 {
        let d = to - from;
        if d.abs() <= self.unwrapped.as_slice()[i] { d } else { angle_difference(from, to) }
    }

    fn state(&self, mut u: impl FnMut(usize) -> f64) -> Q {
        Q::from_fn(self.ranges.len(), |i| match self.ranges[i] {
            JointRange::Interval { low, high } => scale(low, high, u(i)),
            JointRange::Circle => angle_at(u(i)),
        })
    }

    /// The coordinate of joint `i` for an index.
    #[inline]
    pub(crate) fn coordinate(&self, i: usize, x: f64) -> f64 {
        match self.ranges[i] {
            JointRange::Interval { .. } => x,
            JointRange::Circle => wrap_angle(x),
        }
    }

    /// Whether there is a value for each joint, within its range.
    pub(super) fn holds(&self, q: &[f64]) -> bool {
        q.len() == self.ranges.len()
            && self.ranges.iter().zip(q).all(|(range, x)| match *range {
                JointRange::Interval { low, high } => low <= *x && *x <= high,
                JointRange::Circle => -PI < *x && *x <= PI,
            })
    }

    #[inline]
    pub(super) fn joint_between(&self, i: usize, from: f64, to: f64, t: f64) -> f64 {
        match self.ranges[i] {
            JointRange::Interval { .. } => lerp(from, to, t),
            JointRange::Circle => angle_lerp(from, to, t),
        }
    }
}

impl<Q: Coordinates> TrueMetric for Joints<Q> {}

impl<Q: Coordinates> Space for Joints<Q> {
    type State = Q;
    #[inline]
    fn distance(&self, from: &Q, to: &Q) -> f64 {
        let (from, to) = (from.as_slice(), to.as_slice());
        let count = self.ranges.len().min(from.len()).min(to.len());
        (0..count).map(|i| self.difference(i, from[i], to[i])).map(|d| d * d).sum::<f64>().sqrt()
    }

    #[inline]
    fn dim(&self) -> usize {
        self.ranges.len()
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    #[inline]
    fn interpolate_into(&self, from: &Q, to: &Q, t: f64, out: &mut Q) {
        if out.as_slice().len() != from.as_slice().len() {
            out.clone_from(from);
        }
        let (from, to) = (from.as_slice(), to.as_slice());
        let count = self.ranges.len().min(from.len()).min(to.len());
        for (i, o) in out.as_mut_slice().iter_mut().enumerate().take(count) {
            *o = self.joint_between(i, from[i], to[i], t);
        }
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Q {
        self.state(|i| u[i])
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Q {
        self.state(|_| rng.random())
    }
    fn contains(&self, q: &Q) -> bool {
        self.holds(q.as_slice())
    }
    #[inline]
    fn moved(&self, from: &Q, velocity: &[f64], time: f64) -> Option<Q> {
        let (n, from) = (self.ranges.len(), from.as_slice());
        let fits = velocity.len() == n && from.len() == n;
        fits.then(|| self.wrapped(&Q::from_fn(n, |i| from[i] + velocity[i] * time)))
    }
    #[inline]
    fn velocity_into(&self, from: &Q, to: &Q, out: &mut [f64]) -> bool {
        let (n, from, to) = (self.ranges.len(), from.as_slice(), to.as_slice());
        let fits = [from.len(), to.len(), out.len()] == [n; 3];
        if fits {
            (0..n).for_each(|i| out[i] = self.difference(i, from[i], to[i]));
        }
        fits
    }
}

impl<Q: Coordinates> Factored for Joints<Q> {
    fn factors(&self) -> usize {
        self.ranges.len()
    }
    #[inline]
    fn each_factor(&self, from: &Q, to: &Q, f: &mut impl FnMut(usize, f64)) {
        let (from, to) = (from.as_slice(), to.as_slice());
        let count = self.ranges.len().min(from.len()).min(to.len());
        (0..count).for_each(|i| f(i, self.difference(i, from[i], to[i]).abs()));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        self.ranges.get(factor).map_or(0.0, |range| range.extent())
    }
    fn interpolate_factor(&self, factor: usize, from: &Q, to: &Q, t: f64, out: &mut Q) {
        let (from, to) = (from.as_slice(), to.as_slice());
        if factor < self.ranges.len()
            && let (Some(a), Some(b), Some(o)) =
                (from.get(factor), to.get(factor), out.as_mut_slice().get_mut(factor))
        {
            *o = self.joint_between(factor, *a, *b, t);
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        self.ranges.iter().map(|range| range.layout()).collect()
    }
    #[inline]
    fn embed_factors(&self, state: &Q, put: &mut impl FnMut(usize, f64)) {
        let n = self.ranges.len();
        state.as_slice().iter().take(n).enumerate().for_each(|(i, x)| put(i, self.coordinate(i, *x)));
    }
}
