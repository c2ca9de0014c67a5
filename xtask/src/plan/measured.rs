//! A space under a metric chosen at run time: one type, so that planners are compiled once for all.

use super::metrics::Kind;
use super::mover::Mover;
use miette::{Result, miette};
use mp::cspace::{
    Embed, Euclidean, Hit, KdTree, Layout, Linear, Manhattan, Metric, MetricTree, NearestNeighbors, NodeId,
    Rng, ScaledEuclidean, Space, TrueMetric, WithMetric,
};

/// The space of a mover under one of these metrics.
#[derive(Clone, Debug)]
pub(crate) enum Measured<M: Mover> {
    Euclidean(WithMetric<M::Space, Euclidean>),
    Scaled(WithMetric<M::Space, ScaledEuclidean>),
    Manhattan(WithMetric<M::Space, Manhattan>),
    Displacement(WithMetric<M::Space, M::Displacement>),
    Swept(WithMetric<M::Space, M::Swept>),
}

/// Calls a method of whichever it is.
macro_rules! each {
    ($self:expr, $space:ident => $body:expr) => {
        match $self {
            Self::Euclidean($space) => $body,
            Self::Scaled($space) => $body,
            Self::Manhattan($space) => $body,
            Self::Displacement($space) => $body,
            Self::Swept($space) => $body,
        }
    };
}

impl<M: Mover> Measured<M> {
    /// `space` under a metric that is not its own; `scaled`, `displacement` and `swept` make theirs.
    pub(crate) fn new(
        space: &M::Space,
        kind: Kind,
        scaled: impl FnOnce() -> Result<ScaledEuclidean>,
        displacement: impl FnOnce() -> Result<M::Displacement>,
        swept: impl FnOnce() -> Result<M::Swept>,
    ) -> Result<Self> {
        let space = space.clone();
        Ok(match kind {
            Kind::Default => return Err(miette!("the space has its own metric")),
            Kind::Euclidean => Self::Euclidean(WithMetric::new(space, Euclidean)),
            Kind::Manhattan => Self::Manhattan(WithMetric::new(space, Manhattan)),
            Kind::Scaled => Self::Scaled(WithMetric::new(space, scaled()?)),
            Kind::SweptVolume => Self::Swept(WithMetric::new(space, swept()?)),
            Kind::MaxDisplacement => Self::Displacement(WithMetric::new(space, displacement()?)),
        })
    }

    /// The index that suits the metric.
    pub(crate) fn index(&self) -> Index {
        match self {
            Self::Displacement(_) => Index::Metric(Box::default()),
            Self::Swept(_) => Index::Every(Linear::default()),
            _ => Index::Coordinates(Box::default()),
        }
    }
}

impl<M: Mover> Metric<M::State> for Measured<M> {
    #[inline]
    fn distance(&self, from: &M::State, to: &M::State) -> f64 {
        each!(self, space => space.distance(from, to))
    }
}
/// All but the swept volume, which [`Measured::index`] keeps from whatever relies on it.
impl<M: Mover> TrueMetric<M::State> for Measured<M> {}

impl<M: Mover> Space for Measured<M> {
    type State = M::State;

    fn dim(&self) -> usize {
        each!(self, space => space.dim())
    }
    fn extent(&self) -> f64 {
        each!(self, space => space.extent())
    }
    fn interpolate_into(&self, from: &M::State, to: &M::State, t: f64, out: &mut M::State) {
        each!(self, space => space.interpolate_into(from, to, t, out));
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> M::State {
        each!(self, space => space.unit_cube_to_state(u))
    }
    fn sample_uniform(&self, rng: &mut Rng) -> M::State {
        each!(self, space => space.sample_uniform(rng))
    }
    fn sample_between(&self, from: &M::State, to: &M::State, sum: f64, rng: &mut Rng) -> Option<M::State> {
        each!(self, space => space.sample_between(from, to, sum, rng))
    }
    fn contains(&self, q: &M::State) -> bool {
        each!(self, space => space.contains(q))
    }
    fn moved(&self, from: &M::State, velocity: &[f64], time: f64) -> Option<M::State> {
        each!(self, space => space.moved(from, velocity, time))
    }
    fn velocity_into(&self, from: &M::State, to: &M::State, out: &mut [f64]) -> bool {
        each!(self, space => space.velocity_into(from, to, out))
    }
    fn interpolate(&self, from: &M::State, to: &M::State, t: f64) -> M::State {
        each!(self, space => space.interpolate(from, to, t))
    }
}

impl<M: Mover> Embed for Measured<M> {
    fn layout(&self) -> Layout {
        match self {
            Self::Euclidean(space) => space.layout(),
            Self::Scaled(space) => space.layout(),
            Self::Manhattan(space) => space.layout(),
            Self::Displacement(_) | Self::Swept(_) => Layout::default(),
        }
    }
    #[inline]
    fn embed(&self, state: &M::State, out: &mut [f64]) -> usize {
        match self {
            Self::Euclidean(space) => space.embed(state, out),
            Self::Scaled(space) => space.embed(state, out),
            Self::Manhattan(space) => space.embed(state, out),
            Self::Displacement(_) | Self::Swept(_) => 0,
        }
    }
}

/// By coordinates where the metric has them, else by the metric alone; by looking at all where it is none.
#[derive(Clone, Debug)]
pub(crate) enum Index {
    Coordinates(Box<KdTree>),
    Metric(Box<MetricTree>),
    Every(Linear),
}

impl<M: Mover> NearestNeighbors<Measured<M>> for Index {
    fn inserted(&mut self, space: &Measured<M>, points: &[M::State], id: NodeId) {
        match self {
            Self::Coordinates(tree) => tree.inserted(space, points, id),
            Self::Metric(tree) => tree.inserted(space, points, id),
            Self::Every(all) => all.inserted(space, points, id),
        }
    }
    fn clear(&mut self) {
        match self {
            Self::Coordinates(tree) => NearestNeighbors::<Measured<M>>::clear(&mut **tree),
            Self::Metric(tree) => NearestNeighbors::<Measured<M>>::clear(&mut **tree),
            Self::Every(all) => NearestNeighbors::<Measured<M>>::clear(all),
        }
    }
    fn nearest(&self, space: &Measured<M>, points: &[M::State], q: &M::State) -> Option<Hit> {
        match self {
            Self::Coordinates(tree) => tree.nearest(space, points, q),
            Self::Metric(tree) => tree.nearest(space, points, q),
            Self::Every(all) => all.nearest(space, points, q),
        }
    }
    fn k_nearest(
        &self,
        space: &Measured<M>,
        points: &[M::State],
        q: &M::State,
        k: usize,
        out: &mut Vec<Hit>,
    ) {
        match self {
            Self::Coordinates(tree) => tree.k_nearest(space, points, q, k, out),
            Self::Metric(tree) => tree.k_nearest(space, points, q, k, out),
            Self::Every(all) => all.k_nearest(space, points, q, k, out),
        }
    }
    fn within(
        &self,
        space: &Measured<M>,
        points: &[M::State],
        q: &M::State,
        radius: f64,
        out: &mut Vec<Hit>,
    ) {
        match self {
            Self::Coordinates(tree) => tree.within(space, points, q, radius, out),
            Self::Metric(tree) => tree.within(space, points, q, radius, out),
            Self::Every(all) => all.within(space, points, q, radius, out),
        }
    }
}
