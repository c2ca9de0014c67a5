//! A space of factors behind a reference.

use crate::{Factored, Rng, Space, nn::Layout};
use std::fmt::{self, Debug};

/// The methods of [`Space`] and [`Factored`] as a trait object.
trait ErasedFactored<S>: Sync {
    fn dim(&self) -> usize;
    fn extent(&self) -> f64;
    fn distance(&self, from: &S, to: &S) -> f64;
    fn interpolate_into(&self, from: &S, to: &S, t: f64, out: &mut S);
    fn unit_cube_to_state(&self, u: &[f64]) -> S;
    fn sample_uniform(&self, rng: &mut Rng) -> S;
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S>;
    fn contains(&self, q: &S) -> bool;
    fn moved(&self, from: &S, velocity: &[f64], time: f64) -> Option<S>;
    fn velocity_into(&self, from: &S, to: &S, out: &mut [f64]) -> bool;
    fn with_rotation_of(&self, position: &S, rotation: &S) -> S;
    fn interpolate(&self, from: &S, to: &S, t: f64) -> S;
    fn factors(&self) -> usize;
    fn each_factor(&self, from: &S, to: &S, f: &mut dyn FnMut(usize, f64));
    fn factor_extent(&self, factor: usize) -> f64;
    fn interpolate_factor(&self, factor: usize, from: &S, to: &S, t: f64, out: &mut S);
    fn factor_layouts(&self) -> Vec<Layout>;
    fn embed_factors(&self, state: &S, put: &mut dyn FnMut(usize, f64));
}

impl<S, C: Factored<State = S>> ErasedFactored<S> for C {
    fn dim(&self) -> usize {
        Space::dim(self)
    }
    fn extent(&self) -> f64 {
        Space::extent(self)
    }
    fn distance(&self, from: &S, to: &S) -> f64 {
        Space::distance(self, from, to)
    }
    fn interpolate_into(&self, from: &S, to: &S, t: f64, out: &mut S) {
        Space::interpolate_into(self, from, to, t, out);
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> S {
        Space::unit_cube_to_state(self, u)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> S {
        Space::sample_uniform(self, rng)
    }
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S> {
        Space::sample_between(self, from, to, sum, rng)
    }
    fn contains(&self, q: &S) -> bool {
        Space::contains(self, q)
    }
    fn moved(&self, from: &S, velocity: &[f64], time: f64) -> Option<S> {
        Space::moved(self, from, velocity, time)
    }
    fn velocity_into(&self, from: &S, to: &S, out: &mut [f64]) -> bool {
        Space::velocity_into(self, from, to, out)
    }
    fn with_rotation_of(&self, position: &S, rotation: &S) -> S {
        Space::with_rotation_of(self, position, rotation)
    }
    fn interpolate(&self, from: &S, to: &S, t: f64) -> S {
        Space::interpolate(self, from, to, t)
    }
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
        f.debug_struct("AnyFactored").field("dim", &self.0.dim()).finish_non_exhaustive()
    }
}

// A reference to what threads share is sent between them.
impl<S: Clone + Debug + PartialEq + Send + Sync> Space for AnyFactored<'_, S> {
    type State = S;
    fn distance(&self, from: &S, to: &S) -> f64 {
        self.0.distance(from, to)
    }
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn extent(&self) -> f64 {
        self.0.extent()
    }
    fn interpolate_into(&self, from: &S, to: &S, t: f64, out: &mut S) {
        self.0.interpolate_into(from, to, t, out);
    }
    fn unit_cube_to_state(&self, u: &[f64]) -> S {
        self.0.unit_cube_to_state(u)
    }
    fn sample_uniform(&self, rng: &mut Rng) -> S {
        self.0.sample_uniform(rng)
    }
    fn sample_between(&self, from: &S, to: &S, sum: f64, rng: &mut Rng) -> Option<S> {
        self.0.sample_between(from, to, sum, rng)
    }
    fn contains(&self, q: &S) -> bool {
        self.0.contains(q)
    }
    fn moved(&self, from: &S, velocity: &[f64], time: f64) -> Option<S> {
        self.0.moved(from, velocity, time)
    }
    fn velocity_into(&self, from: &S, to: &S, out: &mut [f64]) -> bool {
        self.0.velocity_into(from, to, out)
    }
    fn with_rotation_of(&self, position: &S, rotation: &S) -> S {
        self.0.with_rotation_of(position, rotation)
    }
    fn interpolate(&self, from: &S, to: &S, t: f64) -> S {
        self.0.interpolate(from, to, t)
    }
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
