//! Samplers.

use crate::{Rng, Space};

/// A source of states.
pub trait Sampler<S> {
    /// The next state.
    fn sample(&mut self, rng: &mut Rng) -> S;
}

/// Uniform samples of a space.
#[derive(Clone, Debug)]
pub struct Uniform<'c, C>(pub &'c C);

impl<C: Space> Sampler<C::State> for Uniform<'_, C> {
    #[inline]
    fn sample(&mut self, rng: &mut Rng) -> C::State {
        self.0.sample_uniform(rng)
    }
}
