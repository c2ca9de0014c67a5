//! Nearest neighbours behind a pointer.

use super::AnySpace;
use crate::{
    AsVectors, Configuration, DefaultNn, Hit, Joints, KdTree, MetricTree, NearestNeighbors, NodeId, Rn, Rng,
    Se2, Se3, Space, TrueMetric,
    nn::{Embed, Layout},
    space::as_inside,
};
use std::fmt::{self, Debug};
use std::sync::Arc;

/// The methods of [`NearestNeighbors`] as a trait object, the space inside.
trait ErasedIndex<S>: Send + Sync {
    fn boxed(&self) -> Box<dyn ErasedIndex<S>>;
    fn inserted(&mut self, points: &[S], id: NodeId);
    fn clear(&mut self);
    fn nearest(&self, points: &[S], q: &S) -> Option<Hit>;
    fn k_nearest(&self, points: &[S], q: &S, k: usize, out: &mut Vec<Hit>);
    fn within(&self, points: &[S], q: &S, radius: f64, out: &mut Vec<Hit>);
}

/// An index with the space it searches.
struct IndexWithSpace<C, N> {
    space: Arc<C>,
    index: N,
}

impl<S, C, N> ErasedIndex<S> for IndexWithSpace<C, N>
where
    C: Space<State = S> + Send + 'static,
    N: NearestNeighbors<C> + Clone + Send + Sync + 'static,
{
    fn boxed(&self) -> Box<dyn ErasedIndex<S>> {
        Box::new(Self { space: Arc::clone(&self.space), index: self.index.clone() })
    }
    fn inserted(&mut self, points: &[S], id: NodeId) {
        self.index.inserted(&self.space, points, id);
    }
    fn clear(&mut self) {
        self.index.clear();
    }
    fn nearest(&self, points: &[S], q: &S) -> Option<Hit> {
        self.index.nearest(&self.space, points, q)
    }
    fn k_nearest(&self, points: &[S], q: &S, k: usize, out: &mut Vec<Hit>) {
        self.index.k_nearest(&self.space, points, q, k, out);
    }
    fn within(&self, points: &[S], q: &S, radius: f64, out: &mut Vec<Hit>) {
        self.index.within(&self.space, points, q, radius, out);
    }
}

/// Any index of an [erased space](AnySpace). It keeps the space it was made for: the search runs on that
/// space itself, and answers are the same, to the bit. Use it only with the erasure of that space.
pub struct AnyIndex<S>(Box<dyn ErasedIndex<S>>);

impl<S> AnyIndex<S> {
    /// `index` for a copy of `space`, erased.
    pub fn new<C, N>(space: &C, index: N) -> Self
    where
        C: Space<State = S> + Clone + Send + 'static,
        N: NearestNeighbors<C> + Clone + Send + Sync + 'static,
    {
        Self(Box::new(IndexWithSpace { space: Arc::new(space.clone()), index }))
    }

    /// The [index that suits](DefaultNn) `space`, empty and erased.
    pub fn of<C: DefaultNn<State = S, Nn: 'static> + Clone + Send + 'static>(space: &C) -> Self {
        Self::new(space, C::Nn::default())
    }
}

/// For configurations the indexes of erased spaces are compiled in this crate.
impl AnyIndex<Configuration> {
    /// A [`KdTree`] for a copy of `space`, empty and erased. All spaces share its code: a little slower than
    /// [`of`](Self::of), but compiled once.
    pub fn by_coordinates<C: Embed<State = Configuration> + Clone + Send + 'static>(space: &C) -> Self {
        Self::embedded(Embedded(Arc::new(space.clone())))
    }

    fn embedded(space: Embedded<Configuration>) -> Self {
        Self(Box::new(IndexWithSpace { space: Arc::new(space), index: <KdTree>::default() }))
    }

    /// A [`MetricTree`] for a copy of `space`, empty and erased. All spaces share its code: for metrics whose
    /// distances cost more than a call through a pointer.
    pub fn by_metric<C: Space<State = Configuration> + TrueMetric + Clone + Send + 'static>(
        space: &C,
    ) -> Self {
        Self::by_distance(&AnySpace::new(space))
    }

    fn by_distance(space: &AnySpace<'static, Configuration>) -> Self {
        Self::new(space, MetricTree::default())
    }
}

/// A space with coordinates, behind a pointer.
struct Embedded<S>(Arc<dyn Embed<State = S> + Send>);

impl<S: Clone + Debug + PartialEq + Send + Sync> Space for Embedded<S> {
    type State = S;
    #[inline]
    fn distance(&self, from: &S, to: &S) -> f64 {
        self.0.distance(from, to)
    }
    fn extent(&self) -> f64 {
        self.0.extent()
    }
    as_inside!(0);
}

impl<S: Clone + Debug + PartialEq + Send + Sync> Embed for Embedded<S> {
    fn layout(&self) -> Layout {
        self.0.layout()
    }
    #[inline]
    fn embed(&self, state: &S, out: &mut [f64]) -> usize {
        self.0.embed(state, out)
    }
}

/// A space of robot states whose own index is compiled in this crate.
pub trait CompiledIndex: Space + Clone + Send + 'static {
    /// The [index that suits](DefaultNn) the space, empty and erased.
    fn compiled_index(&self) -> AnyIndex<Self::State>;
}

macro_rules! compiled {
    ($($space:ty: $index:ty),* $(,)?) => {
        $(impl CompiledIndex for $space {
            fn compiled_index(&self) -> AnyIndex<Self::State> {
                AnyIndex::new(self, <$index>::default())
            }
        })*
    };
}
compiled!(
    AsVectors<Se3>: KdTree<7>,
    AsVectors<Se2>: KdTree<3>,
    AsVectors<Rn<2>>: KdTree<2>,
    Joints<Configuration>: KdTree,
);

impl<S> Clone for AnyIndex<S> {
    fn clone(&self) -> Self {
        Self(self.0.boxed())
    }
}

impl<S> Debug for AnyIndex<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyIndex").finish_non_exhaustive()
    }
}

impl<S: Clone + Debug + PartialEq + Send + Sync> NearestNeighbors<AnySpace<'_, S>> for AnyIndex<S> {
    #[inline]
    fn inserted(&mut self, _: &AnySpace<'_, S>, points: &[S], id: NodeId) {
        self.0.inserted(points, id);
    }
    fn clear(&mut self) {
        self.0.clear();
    }
    #[inline]
    fn nearest(&self, _: &AnySpace<'_, S>, points: &[S], q: &S) -> Option<Hit> {
        self.0.nearest(points, q)
    }
    fn k_nearest(&self, _: &AnySpace<'_, S>, points: &[S], q: &S, k: usize, out: &mut Vec<Hit>) {
        self.0.k_nearest(points, q, k, out);
    }
    fn within(&self, _: &AnySpace<'_, S>, points: &[S], q: &S, radius: f64, out: &mut Vec<Hit>) {
        self.0.within(points, q, radius, out);
    }
}
