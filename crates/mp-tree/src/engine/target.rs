//! Slot: what to grow toward next.

use super::{Purpose, Selector};
use mp_cspace::{Hit, Rng, Sampler, Space};

/// Proposes the next target of exploration, seeing the tree that is about to grow.
pub trait TargetSampler<C: Space> {
    /// The next target.
    fn next_target<Se: Selector<C>>(
        &mut self,
        rng: &mut Rng,
        space: &C,
        points: &[C::State],
        selector: &mut Se,
    ) -> C::State;
    /// A verified path of this cost was found: from now on only cheaper ones are of interest.
    fn improved(&mut self, _cost: f64) {}
}

/// The samples of a [`Sampler`], whatever the tree looks like.
#[derive(Clone, Debug, Default)]
pub struct Samples<Sa>(pub Sa);

impl<C: Space, Sa: Sampler<C::State>> TargetSampler<C> for Samples<Sa> {
    #[inline]
    fn next_target<Se: Selector<C>>(&mut self, rng: &mut Rng, _: &C, _: &[C::State], _: &mut Se) -> C::State {
        self.0.sample(rng)
    }
}

/// The proposals of another, without those for which the selector has no candidate: for selectors
/// that refuse targets. The selector decides when to give in; after 10,000 refusals in a row the
/// last proposal is passed on all the same.
#[derive(Clone, Debug, Default)]
pub struct Acceptable<P> {
    inner: P,
    hits: Vec<Hit>,
}

impl<P> Acceptable<P> {
    /// The proposals of `inner` that are accepted.
    pub fn new(inner: P) -> Self {
        Self { inner, hits: Vec::new() }
    }
}

impl<C: Space, P: TargetSampler<C>> TargetSampler<C> for Acceptable<P> {
    fn next_target<Se: Selector<C>>(
        &mut self,
        rng: &mut Rng,
        space: &C,
        points: &[C::State],
        selector: &mut Se,
    ) -> C::State {
        let mut target = self.inner.next_target(rng, space, points, selector);
        for _ in 0..10_000 {
            selector.select(space, points, &target, Purpose::Explore, rng, &mut self.hits);
            if points.is_empty() || !self.hits.is_empty() {
                break;
            }
            target = self.inner.next_target(rng, space, points, selector);
        }
        target
    }
}
