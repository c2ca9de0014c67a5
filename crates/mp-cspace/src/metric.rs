//! Other metrics, and how to put one on a space.

mod swept;

pub use swept::SweptVolume;

use crate::{Factored, Metric, Rng, Se2, Se2State, Se3, Space, SpaceError, TrueMetric, error::weight};
use nalgebra::{Isometry3, Point2, Point3};

/// A metric that needs its space to measure.
pub trait MetricOn<C: Space>: Sync {
    /// The distance from `from` to `to`; as [`Metric::distance`].
    fn distance_on(&self, space: &C, from: &C::State, to: &C::State) -> f64;
    /// An upper bound on the distance between any two states of the space.
    fn extent_on(&self, space: &C) -> f64;
}

/// Marker: [`TrueMetric`] for metrics that need their space.
pub trait TrueMetricOn<C: Space>: MetricOn<C> {}

/// A space under another metric: same states, same interpolation, other distances.
///
/// ```
/// use mp_cspace::{Manhattan, Metric, Rn, Space, WithMetric};
/// let space = WithMetric::new(Rn::<2>::new([0.0, 0.0], [3.0, 4.0])?, Manhattan);
/// assert_eq!(space.extent(), 7.0);
/// assert_eq!(space.distance(&[0.0, 0.0].into(), &[1.0, 1.0].into()), 2.0);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct WithMetric<C, M> {
    space: C,
    metric: M,
    extent: f64,
}

impl<C: Space, M: MetricOn<C>> WithMetric<C, M> {
    /// `space` under `metric`.
    pub fn new(space: C, metric: M) -> Self {
        let extent = metric.extent_on(&space);
        Self { space, metric, extent }
    }

    /// The space, with its own metric.
    #[must_use]
    pub fn space(&self) -> &C {
        &self.space
    }

    /// The metric put on it.
    #[must_use]
    pub fn metric(&self) -> &M {
        &self.metric
    }
}

impl<C: Space, M: MetricOn<C>> Metric<C::State> for WithMetric<C, M> {
    #[inline]
    fn distance(&self, from: &C::State, to: &C::State) -> f64 {
        self.metric.distance_on(&self.space, from, to)
    }
}
impl<C: Space, M: TrueMetricOn<C>> TrueMetric<C::State> for WithMetric<C, M> {}

impl<C: Space, M: MetricOn<C>> Space for WithMetric<C, M> {
    type State = C::State;

    #[inline]
    fn dim(&self) -> usize {
        self.space.dim()
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    #[inline]
    fn interpolate_into(&self, from: &C::State, to: &C::State, t: f64, out: &mut C::State) {
        self.space.interpolate_into(from, to, t, out);
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> C::State {
        self.space.unit_cube_to_state(u)
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> C::State {
        self.space.sample_uniform(rng)
    }
    #[inline]
    fn contains(&self, q: &C::State) -> bool {
        self.space.contains(q)
    }
    #[inline]
    fn moved(&self, from: &C::State, velocity: &[f64], time: f64) -> Option<C::State> {
        self.space.moved(from, velocity, time)
    }
    #[inline]
    fn velocity_into(&self, from: &C::State, to: &C::State, out: &mut [f64]) -> bool {
        self.space.velocity_into(from, to, out)
    }
    #[inline]
    fn interpolate(&self, from: &C::State, to: &C::State, t: f64) -> C::State {
        self.space.interpolate(from, to, t)
    }
}

impl<C: Factored, M: MetricOn<C>> Factored for WithMetric<C, M> {
    fn factors(&self) -> usize {
        self.space.factors()
    }
    #[inline]
    fn each_factor(&self, from: &C::State, to: &C::State, f: &mut impl FnMut(usize, f64)) {
        self.space.each_factor(from, to, f);
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        self.space.factor_extent(factor)
    }
    fn interpolate_factor(&self, factor: usize, from: &C::State, to: &C::State, t: f64, out: &mut C::State) {
        self.space.interpolate_factor(factor, from, to, t, out);
    }
}

fn over_extents<C: Factored>(space: &C, mut f: impl FnMut(usize, f64)) {
    for i in 0..space.factors() {
        f(i, space.factor_extent(i));
    }
}

/// The Euclidean norm over the [factors](Factored) of the space, a radian counting as a metre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Euclidean;

impl<C: Factored> MetricOn<C> for Euclidean {
    #[inline]
    fn distance_on(&self, space: &C, from: &C::State, to: &C::State) -> f64 {
        let mut sum = 0.0;
        space.each_factor(from, to, &mut |_, d| sum += d * d);
        sum.sqrt()
    }
    fn extent_on(&self, space: &C) -> f64 {
        let mut sum = 0.0;
        over_extents(space, |_, d| sum += d * d);
        sum.sqrt()
    }
}
impl<C: Factored> TrueMetricOn<C> for Euclidean {}

/// The Euclidean norm over the [factors](Factored) of the space, each multiplied by its weight.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaledEuclidean {
    weights: Vec<f64>,
}

impl ScaledEuclidean {
    /// One weight for each factor of `space`: in SE(3) those of x, y, z and rotation.
    ///
    /// # Errors
    /// When there are not as many weights as factors, or one is not positive and finite.
    pub fn new<C: Factored>(space: &C, weights: impl Into<Vec<f64>>) -> Result<Self, SpaceError> {
        let weights = weights.into();
        let expected = space.factors();
        if weights.len() != expected {
            return Err(SpaceError::Count { what: "weights of factors", expected, found: weights.len() });
        }
        for &w in &weights {
            weight("the weight of a factor", w)?;
        }
        Ok(Self { weights })
    }

    /// The weights.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    #[inline]
    pub(crate) fn weight(&self, factor: usize) -> f64 {
        self.weights.get(factor).copied().unwrap_or(1.0)
    }
}

impl<C: Factored> MetricOn<C> for ScaledEuclidean {
    #[inline]
    fn distance_on(&self, space: &C, from: &C::State, to: &C::State) -> f64 {
        let mut sum = 0.0;
        space.each_factor(from, to, &mut |i, d| sum += (self.weight(i) * d).powi(2));
        sum.sqrt()
    }
    fn extent_on(&self, space: &C) -> f64 {
        let mut sum = 0.0;
        over_extents(space, |i, d| sum += (self.weight(i) * d).powi(2));
        sum.sqrt()
    }
}
impl<C: Factored> TrueMetricOn<C> for ScaledEuclidean {}

/// The sum over the [factors](Factored) of the space, a radian counting as a metre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Manhattan;

impl<C: Factored> MetricOn<C> for Manhattan {
    #[inline]
    fn distance_on(&self, space: &C, from: &C::State, to: &C::State) -> f64 {
        let mut sum = 0.0;
        space.each_factor(from, to, &mut |_, d| sum += d);
        sum
    }
    fn extent_on(&self, space: &C) -> f64 {
        let mut sum = 0.0;
        over_extents(space, |_, d| sum += d);
        sum
    }
}
impl<C: Factored> TrueMetricOn<C> for Manhattan {}

/// Any metric over the states, with the extent the space has under it.
///
/// This is how a user's own metric goes on a space, and maximum displacement for robots other
/// than rigid bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounded<M> {
    metric: M,
    extent: f64,
}

impl<M> Bounded<M> {
    /// `metric`, under which no two states of the space are farther apart than `extent`.
    ///
    /// # Errors
    /// When `extent` is not positive and finite.
    pub fn new(metric: M, extent: f64) -> Result<Self, SpaceError> {
        Ok(Self { metric, extent: weight("the extent under the metric", extent)? })
    }
}

impl<C: Space, M: Metric<C::State> + Sync> MetricOn<C> for Bounded<M> {
    #[inline]
    fn distance_on(&self, _: &C, from: &C::State, to: &C::State) -> f64 {
        self.metric.distance(from, to)
    }
    fn extent_on(&self, _: &C) -> f64 {
        self.extent
    }
}
impl<C: Space, M: TrueMetric<C::State> + Sync> TrueMetricOn<C> for Bounded<M> {}

/// A closure as a metric.
#[derive(Clone, Copy, Debug)]
pub struct MetricFn<F>(pub F);

impl<S, F: Fn(&S, &S) -> f64> Metric<S> for MetricFn<F> {
    #[inline]
    fn distance(&self, from: &S, to: &S) -> f64 {
        (self.0)(from, to)
    }
}

/// The maximum displacement of any point of a rigid robot, `max ‖x(q) - x(q')‖` over its points
/// `x` (Benitez et al. 2010, *Key Elements for Motion Planning Algorithms*, eq. 6), in metres.
///
/// The displacement is a convex function of the point, so the maximum over a body is attained at
/// a vertex of its convex hull: give these (or all vertices of its mesh) and the value is exact.
/// Cost grows with the number of points. A true metric; it measures chords, so moving at constant
/// speed does not change it at a constant rate.
#[derive(Clone, Debug, PartialEq)]
pub struct MaxDisplacement<P> {
    points: Vec<P>,
    radius: f64,
}

impl MaxDisplacement<Point3<f64>> {
    /// Of a body in space, `points` in the frame of the body.
    ///
    /// # Errors
    /// When there is no point, or one is not finite.
    pub fn new(points: impl Into<Vec<Point3<f64>>>) -> Result<Self, SpaceError> {
        let points = points.into();
        let radius = max_radius(points.iter().map(|p| p.coords.norm()))?;
        Ok(Self { points, radius })
    }
}

impl MaxDisplacement<Point2<f64>> {
    /// Of a body in the plane, `points` in the frame of the body.
    ///
    /// # Errors
    /// When there is no point, or one is not finite.
    pub fn planar(points: impl Into<Vec<Point2<f64>>>) -> Result<Self, SpaceError> {
        let points = points.into();
        let radius = max_radius(points.iter().map(|p| p.coords.norm()))?;
        Ok(Self { points, radius })
    }
}

fn max_radius(norms: impl Iterator<Item = f64>) -> Result<f64, SpaceError> {
    let mut max = None;
    for norm in norms {
        if !norm.is_finite() {
            return Err(SpaceError::Weight { name: "the distance of a point from the origin", value: norm });
        }
        max = Some(norm.max(max.unwrap_or(0.0)));
    }
    max.ok_or(SpaceError::Empty { what: "the set of points" })
}

impl Metric<Isometry3<f64>> for MaxDisplacement<Point3<f64>> {
    fn distance(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        let (ra, rb) = (from.rotation.to_rotation_matrix(), to.rotation.to_rotation_matrix());
        let turn = rb.matrix() - ra.matrix();
        let shift = to.translation.vector - from.translation.vector;
        self.points.iter().map(|p| (turn * p.coords + shift).norm_squared()).fold(0.0, f64::max).sqrt()
    }
}
impl TrueMetric<Isometry3<f64>> for MaxDisplacement<Point3<f64>> {}

impl Metric<Se2State> for MaxDisplacement<Point2<f64>> {
    fn distance(&self, from: &Se2State, to: &Se2State) -> f64 {
        let ((sa, ca), (sb, cb)) = (from.angle.sin_cos(), to.angle.sin_cos());
        let (c, s) = (cb - ca, sb - sa);
        let shift = to.translation - from.translation;
        let squared =
            |p: &Point2<f64>| (c * p.x - s * p.y + shift.x).powi(2) + (s * p.x + c * p.y + shift.y).powi(2);
        self.points.iter().map(squared).fold(0.0, f64::max).sqrt()
    }
}
impl TrueMetric<Se2State> for MaxDisplacement<Point2<f64>> {}

impl MetricOn<Se3> for MaxDisplacement<Point3<f64>> {
    fn distance_on(&self, _: &Se3, from: &Isometry3<f64>, to: &Isometry3<f64>) -> f64 {
        self.distance(from, to)
    }
    /// Across the box, and each point to the other side of the body's origin.
    fn extent_on(&self, space: &Se3) -> f64 {
        space.translations().extent() + 2.0 * self.radius
    }
}
impl TrueMetricOn<Se3> for MaxDisplacement<Point3<f64>> {}

impl MetricOn<Se2> for MaxDisplacement<Point2<f64>> {
    fn distance_on(&self, _: &Se2, from: &Se2State, to: &Se2State) -> f64 {
        self.distance(from, to)
    }
    /// Across the box, and each point to the other side of the body's origin.
    fn extent_on(&self, space: &Se2) -> f64 {
        space.translations().extent() + 2.0 * self.radius
    }
}
impl TrueMetricOn<Se2> for MaxDisplacement<Point2<f64>> {}
