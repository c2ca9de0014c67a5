//! Slot: what to grow toward next.

use crate::Selector;
use mp_cspace::{Rng, Sampler, Space};

/// Proposes the next target of exploration, seeing the tree that is about to grow.
pub trait Propose<C: Space> {
    /// The next target.
    fn propose<Se: Selector<C>>(
        &mut self,
        rng: &mut Rng,
        space: &C,
        points: &[C::State],
        select: &mut Se,
    ) -> C::State;
    /// A verified path of this cost was found: from now on only cheaper ones are of interest.
    fn improved(&mut self, _cost: f64) {}
}

/// The samples of a [`Sampler`], whatever the tree looks like.
#[derive(Clone, Debug, Default)]
pub struct Samples<Sa>(pub Sa);

impl<C: Space, Sa: Sampler<C::State>> Propose<C> for Samples<Sa> {
    #[inline]
    fn propose<Se: Selector<C>>(&mut self, rng: &mut Rng, _: &C, _: &[C::State], _: &mut Se) -> C::State {
        self.0.sample(rng)
    }
}
