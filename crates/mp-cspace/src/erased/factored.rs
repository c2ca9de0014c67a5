//! A space of factors behind a reference.

use crate::{Factored, Rng, Space, nn::Layout, space::as_inside};
use std::fmt::{self, Debug};

/// The methods of [`Factored`] as a trait object.
trait ErasedFactored<S>: Space<State = S> {
    fn factors(&self) -> usize;
    fn each_factor(&self, from: &S, to: &S, f: &mut dyn FnMut(usize, f64));
    fn factor_extent(&self, factor: usize) -> f64;
    fn interpolate_factor(&self, factor: usize, from: &S, to: &S, t: f64, out: &mut S);
    fn factor_layouts(&self) -> Vec<Layout>;
    fn embed_factors(&self, state: &S, put: &mut dyn FnMut(usize, f64));
}

impl<S, C: Factored<State = S>> ErasedFactored<S> for C {
    fn factors(&self) -> usize {
        Factored::factors(self)
    }
    fn each_factor(&self, from: &S, to: &S, f: &mut dyn FnMut(usize, f64)) {
        Factored::each_factor(self, from, to, &mut |factor, distance| f(factor, distance));
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        Factored::factor_extent(self, factor)
    }
    fn interpolate_factor(&self, factor: usize, from: &S, to: &S, t: f64, out: &mut S) {
        Factored::interpolate_factor(self, factor, from, to, t, out);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        Factored::factor_layouts(self)
    }
    fn embed_factors(&self, state: &S, put: &mut dyn FnMut(usize, f64)) {
        Factored::embed_factors(self, state, &mut |factor, x| put(factor, x));
    }
}

/// Any [`Factored`] space whose states are `S`, behind a reference: the same numbers, to the bit.
pub struct AnyFactored<'c, S>(&'c dyn ErasedFactored<S>);

impl<'c, S> AnyFactored<'c, S> {
    /// `space`, erased.
    pub fn new<C: Factored<State = S>>(space: &'c C) -> Self {
        Self(space)
    }
}

// Derived, they would require the same of `S`.
impl<S> Clone for AnyFactored<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S> Copy for AnyFactored<'_, S> {}

impl<S> Debug for AnyFactored<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyFactored").finish_non_exhaustive()
    }
}

// A reference to what threads share is sent between them.
impl<S: Clone + Debug + PartialEq + Send + Sync> Space for AnyFactored<'_, S> {
    type State = S;
    fn distance(&self, from: &S, to: &S) -> f64 {
        self.0.distance(from, to)
    }
    fn extent(&self) -> f64 {
        self.0.extent()
    }
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S> {
        self.0.sample_between(from, to, sum, rng)
    }
    as_inside!(0);
}

impl<S: Clone + Debug + PartialEq + Send + Sync> Factored for AnyFactored<'_, S> {
    fn factors(&self) -> usize {
        self.0.factors()
    }
    fn each_factor(&self, from: &S, to: &S, f: &mut impl FnMut(usize, f64)) {
        self.0.each_factor(from, to, f);
    }
    fn factor_extent(&self, factor: usize) -> f64 {
        self.0.factor_extent(factor)
    }
    fn interpolate_factor(&self, factor: usize, from: &S, to: &S, t: f64, out: &mut S) {
        self.0.interpolate_factor(factor, from, to, t, out);
    }
    fn factor_layouts(&self) -> Vec<Layout> {
        self.0.factor_layouts()
    }
    fn embed_factors(&self, state: &S, put: &mut impl FnMut(usize, f64)) {
        self.0.embed_factors(state, put);
    }
}
