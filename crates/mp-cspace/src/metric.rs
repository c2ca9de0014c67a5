//! Metrics, and how to put one on a space.

mod displacement;
mod factors;
mod swept;

pub use displacement::MaxDisplacement;
pub use factors::{Euclidean, Manhattan, ScaledEuclidean};
pub use swept::SweptVolume;

use crate::error::weight;
use crate::space::as_inside;
use crate::{DefaultNn, Factored, Linear, NearestNeighbors, Rng, Space, SpaceError, TrueMetric, nn::Layout};
use std::fmt::{self, Debug};

/// A distance between the states of a space, other than the space's own: [`WithMetric`] puts it on the space.
///
/// A metric that is symmetric and satisfies the triangle inequality is marked [`TrueMetric<C>`](TrueMetric).
pub trait Metric<C: Space>: Sync + Sized {
    /// The index that serves the space best under this metric. [`Linear`] serves every metric;
    /// [`MetricTree`](crate::MetricTree) every true one.
    type Nn: NearestNeighbors<WithMetric<C, Self>> + Default + Clone + Debug + Send + Sync;

    /// The distance from `from` to `to`; as [`Space::distance`].
    fn distance(&self, space: &C, from: &C::State, to: &C::State) -> f64;

    /// An upper bound on the distance between any two states of the space.
    fn extent(&self, space: &C) -> f64;
}

/// A space under another metric: same states, same interpolation, other distances.
///
/// ```
/// use mp_cspace::{Manhattan, Rn, Space, WithMetric};
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

impl<C: Space, M: Metric<C>> WithMetric<C, M> {
    /// `space` under `metric`.
    pub fn new(space: C, metric: M) -> Self {
        let extent = metric.extent(&space);
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

impl<C: Space, M: Metric<C> + TrueMetric<C>> TrueMetric for WithMetric<C, M> {}

impl<C: Space, M: Metric<C>> DefaultNn for WithMetric<C, M> {
    type Nn = M::Nn;
}

impl<C: Space, M: Metric<C>> Space for WithMetric<C, M> {
    type State = C::State;
    #[inline]
    fn distance(&self, from: &C::State, to: &C::State) -> f64 {
        self.metric.distance(&self.space, from, to)
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    as_inside!(space);
}

impl<C: Factored, M: Metric<C>> Factored for WithMetric<C, M> {
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
    fn factor_layouts(&self) -> Vec<Layout> {
        self.space.factor_layouts()
    }
    #[inline]
    fn embed_factors(&self, state: &C::State, put: &mut impl FnMut(usize, f64)) {
        self.space.embed_factors(state, put);
    }
}

/// A closure as a metric.
///
/// Only its values are known, so nearest neighbours are found by a [`Linear`] scan. A type of your own that
/// implements [`Metric`] and is marked [`TrueMetric`] can use a [`MetricTree`](crate::MetricTree).
///
/// ```
/// use mp_cspace::{MetricFn, Rn, Space, WithMetric};
/// use nalgebra::Vector2;
/// let square = Rn::<2>::new([0.0; 2], [1.0; 2])?;
/// let greatest = MetricFn::new(|a: &Vector2<f64>, b: &Vector2<f64>| (b - a).amax(), 1.0)?;
/// let space = WithMetric::new(square, greatest);
/// assert_eq!(space.distance(&[0.0, 0.5].into(), &[0.25, 1.0].into()), 0.5);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Copy)]
pub struct MetricFn<F> {
    distance: F,
    extent: f64,
}

impl<F> MetricFn<F> {
    /// `distance`, under which no two states of the space are farther apart than `extent`.
    ///
    /// # Errors
    /// When `extent` is not positive and finite.
    pub fn new(distance: F, extent: f64) -> Result<Self, SpaceError> {
        Ok(Self { distance, extent: weight("the extent under the metric", extent)? })
    }
}

impl<F> Debug for MetricFn<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MetricFn").field("extent", &self.extent).finish_non_exhaustive()
    }
}

impl<C: Space, F: Fn(&C::State, &C::State) -> f64 + Sync> Metric<C> for MetricFn<F> {
    type Nn = Linear;

    #[inline]
    fn distance(&self, _: &C, from: &C::State, to: &C::State) -> f64 {
        (self.distance)(from, to)
    }
    fn extent(&self, _: &C) -> f64 {
        self.extent
    }
}
