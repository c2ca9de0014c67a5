//! R^n, the dimension known at run time.

use super::{Factored, Metric, Space, TrueMetric, ellipsoid, lerp, scale};
use crate::{Rng, SpaceError, error::diagonal};
use nalgebra::DVector;
use rand::RngExt;

/// A box of R^n with the Euclidean metric, its dimension chosen at run time.
///
/// States of another dimension are not contained; nothing is promised of their distances.
/// Where the dimension is known when compiling, [`Rn`](crate::Rn) is several times faster.
#[derive(Clone, Debug, PartialEq)]
pub struct RnDyn {
    low: DVector<f64>,
    high: DVector<f64>,
    extent: f64,
}

impl RnDyn {
    /// The box from `low` to `high`.
    ///
    /// # Errors
    /// When the bounds are empty or differ in number, one is not finite, or some `low` is not
    /// below its `high`.
    pub fn new(low: impl Into<DVector<f64>>, high: impl Into<DVector<f64>>) -> Result<Self, SpaceError> {
        let (low, high) = (low.into(), high.into());
        let extent = diagonal(low.as_slice(), high.as_slice())?;
        Ok(Self { low, high, extent })
    }

    /// The lower corner.
    #[must_use]
    pub fn low(&self) -> &DVector<f64> {
        &self.low
    }

    /// The upper corner.
    #[must_use]
    pub fn high(&self) -> &DVector<f64> {
        &self.high
    }
}

impl Metric<DVector<f64>> for RnDyn {
    #[inline]
    fn distance(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        from.iter().zip(to.iter()).map(|(a, b)| (b - a) * (b - a)).sum::<f64>().sqrt()
    }
}
impl TrueMetric<DVector<f64>> for RnDyn {}

impl Space for RnDyn {
    type State = DVector<f64>;

    #[inline]
    fn dim(&self) -> usize {
        self.low.len()
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
        for ((o, a), b) in out.iter_mut().zip(from.iter()).zip(to.iter()) {
            *o = lerp(*a, *b, t);
        }
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        DVector::from_fn(self.dim(), |i, _| scale(self.low[i], self.high[i], u[i]))
    }
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        DVector::from_fn(self.dim(), |i, _| scale(self.low[i], self.high[i], rng.random()))
    }
    fn sample_between(
        &self,
        from: &Self::State,
        to: &Self::State,
        sum: f64,
        rng: &mut Rng,
    ) -> Option<Self::State> {
        let mut q = from.clone();
        (0..100).find_map(|_| {
            ellipsoid::sample(from.as_slice(), to.as_slice(), sum, rng, q.as_mut_slice());
            self.contains(&q).then(|| q.clone())
        })
    }
    fn contains(&self, q: &Self::State) -> bool {
        q.len() == self.dim() && (0..q.len()).all(|i| self.low[i] <= q[i] && q[i] <= self.high[i])
    }
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        let n = self.dim();
        let fits = velocity.len() == n && from.len() == n;
        fits.then(|| DVector::from_fn(n, |i, _| from[i] + velocity[i] * time))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        let n = self.dim();
        let fits = [from.len(), to.len(), out.len()] == [n; 3];
        if fits {
            (0..n).for_each(|i| out[i] = to[i] - from[i]);
        }
        fits
    }
}

impl Factored for RnDyn {
    fn factors(&self) -> usize {
        self.dim()
    }
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        for (i, (a, b)) in from.iter().zip(to.iter()).enumerate() {
            f(i, (b - a).abs());
        }
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor < self.dim() { self.high[factor] - self.low[factor] } else { 0.0 }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if factor < from.len().min(to.len()).min(out.len()) {
            out[factor] = lerp(from[factor], to[factor], t);
        }
    }
}
