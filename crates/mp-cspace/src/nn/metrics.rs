//! Coordinates and the default index of spaces under another metric.

use super::{DefaultNn, Embed, EmbedFactors, KdTree, Layout, MetricTree, NearestNeighbors};
use crate::{
    Bounded, Euclidean, Manhattan, MaxDisplacement, MetricOn, ScaledEuclidean, Space, TrueMetric,
    TrueMetricOn, WithMetric,
};

/// A metric that names the index which serves a space under it best: what makes
/// [`WithMetric`] a space with a [default index](DefaultNn).
pub trait NnOn<C: Space>: MetricOn<C> + Sized {
    /// The index.
    type Nn: NearestNeighbors<WithMetric<C, Self>> + Default + Clone + std::fmt::Debug + Send + Sync;
}

impl<C: Space, M: NnOn<C>> DefaultNn for WithMetric<C, M> {
    type Nn = M::Nn;
}

/// Writes all coordinates, those of factor `i` multiplied by `weight(i)`.
#[inline]
fn embed_weighted<C: EmbedFactors>(
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

impl<C: EmbedFactors> Embed for WithMetric<C, Euclidean> {
    fn layout(&self) -> Layout {
        self.space().factor_layouts().into_iter().reduce(Layout::beside).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &C::State, out: &mut [f64]) -> usize {
        embed_weighted(self.space(), state, out, |_| 1.0)
    }
}
impl<C: EmbedFactors> NnOn<C> for Euclidean {
    type Nn = KdTree;
}

impl<C: EmbedFactors> Embed for WithMetric<C, ScaledEuclidean> {
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
impl<C: EmbedFactors> NnOn<C> for ScaledEuclidean {
    type Nn = KdTree;
}

impl<C: EmbedFactors> Embed for WithMetric<C, Manhattan> {
    fn layout(&self) -> Layout {
        self.space().factor_layouts().into_iter().reduce(Layout::plus).unwrap_or_default()
    }
    #[inline]
    fn embed(&self, state: &C::State, out: &mut [f64]) -> usize {
        embed_weighted(self.space(), state, out, |_| 1.0)
    }
}
impl<C: EmbedFactors> NnOn<C> for Manhattan {
    type Nn = KdTree;
}

impl<C: Space, P> NnOn<C> for MaxDisplacement<P>
where
    Self: TrueMetricOn<C>,
{
    type Nn = MetricTree;
}

impl<C: Space, M: TrueMetric<C::State> + Sync> NnOn<C> for Bounded<M> {
    type Nn = MetricTree;
}
