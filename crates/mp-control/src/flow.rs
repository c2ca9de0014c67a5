//! Inputs, and how they move states.

use nalgebra::{DVector, SVector};
use std::fmt::Debug;

/// The input of a system: a list of numbers.
///
/// Numbers, arrays and vectors are inputs. The velocities of a [`DoubleIntegrator`](crate::DoubleIntegrator),
/// whose inputs are accelerations, implement it too.
pub trait Input: Clone + Debug + PartialEq + Send + Sync {
    /// Its numbers.
    fn entries(&self) -> &[f64];

    /// Its numbers, mutable.
    fn entries_mut(&mut self) -> &mut [f64];

    /// `self + factor · other`, number by number.
    #[inline]
    #[must_use]
    fn plus(&self, other: &impl Input, factor: f64) -> Self {
        let mut sum = self.clone();
        for (a, b) in sum.entries_mut().iter_mut().zip(other.entries()) {
            *a += b * factor;
        }
        sum
    }
}

impl Input for f64 {
    #[inline]
    fn entries(&self) -> &[f64] {
        std::slice::from_ref(self)
    }
    #[inline]
    fn entries_mut(&mut self) -> &mut [f64] {
        std::slice::from_mut(self)
    }
}
impl<const N: usize> Input for [f64; N] {
    #[inline]
    fn entries(&self) -> &[f64] {
        self
    }
    #[inline]
    fn entries_mut(&mut self) -> &mut [f64] {
        self
    }
}
impl<const N: usize> Input for SVector<f64, N> {
    #[inline]
    fn entries(&self) -> &[f64] {
        self.as_slice()
    }
    #[inline]
    fn entries_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}
impl Input for DVector<f64> {
    #[inline]
    fn entries(&self) -> &[f64] {
        self.as_slice()
    }
    #[inline]
    fn entries_mut(&mut self) -> &mut [f64] {
        self.as_mut_slice()
    }
}
impl Input for Vec<f64> {
    #[inline]
    fn entries(&self) -> &[f64] {
        self
    }
    #[inline]
    fn entries_mut(&mut self) -> &mut [f64] {
        self
    }
}

/// How an input, applied for a while, moves a state. Closures `Fn(&S, &U, f64) -> S` implement it.
///
/// Contract: the answer depends on the arguments only, to the bit; after zero time the state is the same;
/// over `time` from zero to a duration the answers trace the motion, so that it can be checked at any
/// state between. Users' flows may return states that are not finite or out of bounds: planners drop them.
pub trait Flow<S, U> {
    /// The state reached from `from` when `input` is applied for `time` seconds.
    fn integrate(&self, from: &S, input: &U, time: f64) -> S;

    /// The state from which `input` leads to `to` in `time` seconds, up to rounding; `None`, the
    /// default, where the flow cannot run backward.
    fn reversed(&self, _to: &S, _input: &U, _time: f64) -> Option<S> {
        None
    }
}

impl<S, U, F: Fn(&S, &U, f64) -> S> Flow<S, U> for F {
    #[inline]
    fn integrate(&self, from: &S, input: &U, time: f64) -> S {
        self(from, input, time)
    }
}
