//! Metrics made of the distances in each factor.

use super::{Metric, WithMetric};
use crate::error::weight;
use crate::nn::{Embed, Layout};
use crate::{Factored, KdTree, SpaceError, TrueMetric};

/// Calls `f(i, extent)` for each factor `i` in order.
fn over_extents<C: Factored>(space: &C, mut f: impl FnMut(usize, f64)) {
    for i in 0..space.factors() {
        f(i, space.factor_extent(i));
    }
}

/// The Euclidean norm over the [factors](Factored) of the space, a radian counting as a metre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Euclidean;

impl<C: Factored> Metric<C> for Euclidean {
    type Nn = KdTree;

    #[inline]
    fn distance(&self, space: &C, from: &C::State, to: &C::State) -> f64 {
        let mut sum = 0.0;
        space.each_factor(from, to, &mut |_, d| sum += d * d);
        sum.sqrt()
    }
    fn extent(&self, space: &C) -> f64 {
        let mut sum = 0.0;
        over_extents(space, |_, d| sum += d * d);
        sum.sqrt()
    }
}
impl<C: Factored> TrueMetric<C> for Euclidean {}

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

    /// One weight for each factor, in the order of the factors.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    #[inline]
    fn weight(&self, factor: usize) -> f64 {
        self.weights.get(factor).copied().unwrap_or(1.0)
    }
}

impl<C: Factored> Metric<C> for ScaledEuclidean {
    type Nn = KdTree;

    #[inline]
    fn distance(&self, space: &C, from: &C::State, to: &C::State) -> f64 {
        let mut sum = 0.0;
        space.each_factor(from, to, &mut |i, d| sum += mp_math::powi(self.weight(i) * d, 2));
        sum.sqrt()
    }
    fn extent(&self, space: &C) -> f64 {
        let mut sum = 0.0;
        over_extents(space, |i, d| sum += mp_math::powi(self.weight(i) * d, 2));
        sum.sqrt()
    }
}
impl<C: Factored> TrueMetric<C> for ScaledEuclidean {}

/// The sum over the [factors](Factored) of the space, a radian counting as a metre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Manhattan;

impl<C: Factored> Metric<C> for Manhattan {
    type Nn = KdTree;

    #[inline]
    fn distance(&self, space: &C, from: &C::State, to: &C::State) -> f64 {
        let mut sum = 0.0;
        space.each_factor(from, to, &mut |_, d| sum += d);
        sum
    }
    fn extent(&self, space: &C) -> f64 {
        let mut sum = 0.0;
        over_extents(space, |_, d| sum += d);
        sum
    }
}
impl<C: Factored> TrueMetric<C> for Manhattan {}

/// Writes all coordinates, those of factor `i` multiplied by `weight(i)`; returns their number.
#[inline]
fn embed_weighted<C: Factored>(
    space: &C,
    state: &C::State,
    out: &mut [f64],
    weight: impl Fn(usize) -> f64,
) -> usize {
    let mut n = 0;
    space.embed_factors(state, &mut |i, x| {
        out[n] = x * weight(i);
        n += 1;
    });
    n
}

impl<C: Factored> Embed for WithMetric<C, Euclidean> {
    fn layout(&self) -> Layout {
        self.space().factor_layouts().into_iter().reduce(Layout::beside).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &C::State, out: &mut [f64]) -> usize {
        embed_weighted(self.space(), state, out, |_| 1.0)
    }
}

impl<C: Factored> Embed for WithMetric<C, ScaledEuclidean> {
    fn layout(&self) -> Layout {
        let weighted = (0..).zip(self.space().factor_layouts());
        let weighted = weighted.map(|(i, layout)| layout.scaled(self.metric().weight(i)));
        weighted.reduce(Layout::beside).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &C::State, out: &mut [f64]) -> usize {
        embed_weighted(self.space(), state, out, |i| self.metric().weight(i))
    }
}

impl<C: Factored> Embed for WithMetric<C, Manhattan> {
    fn layout(&self) -> Layout {
        self.space().factor_layouts().into_iter().reduce(Layout::plus).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &C::State, out: &mut [f64]) -> usize {
        embed_weighted(self.space(), state, out, |_| 1.0)
    }
}
