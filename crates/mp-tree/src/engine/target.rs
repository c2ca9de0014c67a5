//! Slot: what to grow toward next.

use super::{Purpose, Selector};
use mp_cspace::{Hit, Interrupt, Rng, Sampler, Space};

/// Slot: samples the next target of exploration, given the tree that is about to grow.
pub trait TargetSampler<C: Space> {
    /// Draws the state toward which the tree grows next; `points` are the states of the tree.
    fn next_target<Se: Selector<C>>(
        &mut self,
        rng: &mut Rng,
        space: &C,
        points: &[C::State],
        selector: &mut Se,
    ) -> C::State;
    /// A verified path of this cost was found: only cheaper ones are wanted from now on.
    fn improved(&mut self, _cost: f64) {}
}

/// The samples of a [`Sampler`], independent of the tree.
#[derive(Clone, Debug, Default)]
pub struct Samples<Sa>(pub Sa);

impl<C: Space, Sa: Sampler<C::State>> TargetSampler<C> for Samples<Sa> {
    #[inline]
    fn next_target<Se: Selector<C>>(&mut self, rng: &mut Rng, _: &C, _: &[C::State], _: &mut Se) -> C::State {
        self.0.sample(rng)
    }
}

/// The targets of another target sampler for which the selector has a candidate: for selectors that refuse
/// targets. The selector decides when to stop refusing; after 10,000 refusals in a row the last target is
/// returned all the same.
#[derive(Clone, Debug, Default)]
pub struct Acceptable<P> {
    inner: P,
    hits: Vec<Hit>,
    interrupt: Interrupt,
}

impl<P> Acceptable<P> {
    /// The targets of `inner` that are accepted.
    pub fn new(inner: P) -> Self {
        Self { inner, hits: Vec::new(), interrupt: Interrupt::never() }
    }

    /// The same, which takes any target once `interrupt` says to end.
    #[must_use]
    pub fn with_interrupt(self, interrupt: Interrupt) -> Self {
        Self { interrupt, ..self }
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
            if points.is_empty() || !self.hits.is_empty() || self.interrupt.ask() {
                break;
            }
            target = self.inner.next_target(rng, space, points, selector);
        }
        target
    }
}
