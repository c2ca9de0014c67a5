//! R^n, its dimension known at compile time.

use super::{Factored, Space, TrueMetric, ellipsoid, lerp, scale};
use crate::{Rng, SpaceError, error::diagonal, layout::Layout};
use nalgebra::SVector;
use rand::RngExt;

/// A box of R^N with the Euclidean metric.
///
/// ```
/// use mp_cspace::{Rn, Space};
/// let square = Rn::<2>::new([0.0, 0.0], [3.0, 4.0])?;
/// assert_eq!(square.extent(), 5.0);
/// let (a, b) = ([0.0, 0.0].into(), [3.0, 0.0].into());
/// assert_eq!(square.interpolate(&a, &b, 0.5).x, 1.5);
/// assert_eq!(square.distance(&a, &b), 3.0);
/// # Ok::<(), mp_cspace::SpaceError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Rn<const N: usize> {
    low: SVector<f64, N>,
    high: SVector<f64, N>,
    extent: f64,
}

impl<const N: usize> Rn<N> {
    /// The box from `low` to `high`.
    ///
    /// # Errors
    /// When `N` is zero, a bound is not finite, or some `low` is not below its `high`.
    pub fn new(
        low: impl Into<SVector<f64, N>>,
        high: impl Into<SVector<f64, N>>,
    ) -> Result<Self, SpaceError> {
        let (low, high) = (low.into(), high.into());
        let extent = diagonal(low.as_slice(), high.as_slice())?;
        Ok(Self { low, high, extent })
    }

    /// The lower corner.
    #[must_use]
    pub fn low(&self) -> &SVector<f64, N> {
        &self.low
    }

    /// The upper corner.
    #[must_use]
    pub fn high(&self) -> &SVector<f64, N> {
        &self.high
    }
}

impl<const N: usize> TrueMetric for Rn<N> {}

impl<const N: usize> Space for Rn<N> {
    type State = SVector<f64, N>;
    #[inline]
    fn distance(&self, from: &SVector<f64, N>, to: &SVector<f64, N>) -> f64 {
        let mut sum = 0.0;
        for i in 0..N {
            let d = to[i] - from[i];
            sum += d * d;
        }
        sum.sqrt()
    }

    #[inline]
    fn dim(&self) -> usize {
        N
    }
    #[inline]
    fn extent(&self) -> f64 {
        self.extent
    }
    #[inline]
    fn interpolate_into(&self, from: &Self::State, to: &Self::State, t: f64, out: &mut Self::State) {
        for i in 0..N {
            out[i] = lerp(from[i], to[i], t);
        }
    }
    #[inline]
    fn unit_cube_to_state(&self, u: &[f64]) -> Self::State {
        SVector::from_fn(|i, _| scale(self.low[i], self.high[i], u[i]))
    }
    #[inline]
    fn sample_uniform(&self, rng: &mut Rng) -> Self::State {
        SVector::from_fn(|i, _| scale(self.low[i], self.high[i], rng.random()))
    }
    fn sample_between(
        &self,
        from: &Self::State,
        to: &Self::State,
        sum: f64,
        rng: &mut Rng,
    ) -> Option<Self::State> {
        let mut q = *from;
        (0..100).find_map(|_| {
            ellipsoid::sample(from.as_slice(), to.as_slice(), sum, rng, q.as_mut_slice());
            self.contains(&q).then_some(q)
        })
    }
    #[inline]
    fn contains(&self, q: &Self::State) -> bool {
        (0..N).all(|i| self.low[i] <= q[i] && q[i] <= self.high[i])
    }
    #[inline]
    fn moved(&self, from: &Self::State, velocity: &[f64], time: f64) -> Option<Self::State> {
        (velocity.len() == N).then(|| SVector::from_fn(|i, _| from[i] + velocity[i] * time))
    }
    #[inline]
    fn velocity_into(&self, from: &Self::State, to: &Self::State, out: &mut [f64]) -> bool {
        if out.len() == N {
            (0..N).for_each(|i| out[i] = to[i] - from[i]);
        }
        out.len() == N
    }
}

impl<const N: usize> Factored for Rn<N> {
    #[inline]
    fn factors(&self) -> usize {
        N
    }
    #[inline]
    fn each_factor(&self, from: &Self::State, to: &Self::State, f: &mut impl FnMut(usize, f64)) {
        for i in 0..N {
            f(i, (to[i] - from[i]).abs());
        }
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        if factor < N { self.high[factor] - self.low[factor] } else { 0.0 }
    }
    fn interpolate_factor(
        &self,
        factor: usize,
        from: &Self::State,
        to: &Self::State,
        t: f64,
        out: &mut Self::State,
    ) {
        if factor < N {
            out[factor] = lerp(from[factor], to[factor], t);
        }
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        vec![Layout::euclidean(1); N]
    }
    #[inline]
    fn embed_factors(&self, state: &SVector<f64, N>, put: &mut impl FnMut(usize, f64)) {
        (0..).zip(state.iter()).for_each(|(i, &x)| put(i, x));
    }
}
