//! Checks of states that are written as vectors of numbers, so that the planners compiled for vectors serve more robots.

use super::Queries;
use mp_cspace::{
    Clearance, Interrupt, KnownFree, MotionCheck, MotionClearance, MotionValidity, StateVector, Validity,
};
use nalgebra::DVector;
use std::fmt::Debug;
use std::marker::PhantomData;

/// A check of states `S`, for the vectors of their numbers: see [`AsVectors`](mp_cspace::AsVectors). A vector that is not a
/// state is in collision.
#[derive(Debug)]
pub struct OnVectors<A, S> {
    check: A,
    state: PhantomData<fn(&S)>,
}

impl<A: Clone, S> Clone for OnVectors<A, S> {
    fn clone(&self) -> Self {
        Self::new(self.check.clone())
    }
}

impl<A, S> OnVectors<A, S> {
    /// `check` for vectors.
    pub(crate) fn new(check: A) -> Self {
        Self { check, state: PhantomData }
    }

    /// The check of states.
    pub(crate) fn inner(&self) -> &A {
        &self.check
    }

    /// The check of states, mutable.
    pub(crate) fn inner_mut(&mut self) -> &mut A {
        &mut self.check
    }
}

impl<A: Validity<S>, S: StateVector> Validity<DVector<f64>> for OnVectors<A, S> {
    fn is_valid(&mut self, q: &DVector<f64>) -> bool {
        S::read(q.as_slice()).is_some_and(|q| self.check.is_valid(&q))
    }
}

impl<A: Clearance<S>, S: StateVector> Clearance<DVector<f64>> for OnVectors<A, S> {
    fn clearance(&mut self, q: &DVector<f64>, enough: f64) -> f64 {
        S::read(q.as_slice()).map_or(0.0, |q| self.check.clearance(&q, enough))
    }
    fn in_contact(&mut self, q: &DVector<f64>) -> bool {
        S::read(q.as_slice()).is_none_or(|q| self.check.in_contact(&q))
    }
}

impl<A: MotionClearance<S>, S: StateVector> MotionClearance<DVector<f64>> for OnVectors<A, S> {
    fn motion_bound(&self, from: &DVector<f64>, to: &DVector<f64>) -> f64 {
        match [from, to].map(|q| S::read(q.as_slice())) {
            [Some(from), Some(to)] => self.check.motion_bound(&from, &to),
            _ => f64::INFINITY,
        }
    }
    fn contact_first(&self) -> bool {
        self.check.contact_first()
    }
}

impl<A: MotionValidity<S>, S: StateVector> MotionValidity<DVector<f64>> for OnVectors<A, S> {
    fn check_motion(&mut self, from: &DVector<f64>, to: &DVector<f64>) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }
    fn check_extension(&mut self, from: &DVector<f64>, to: &DVector<f64>, known: KnownFree) -> MotionCheck {
        match [from, to].map(|q| S::read(q.as_slice())) {
            [Some(from), Some(to)] => self.check.check_extension(&from, &to, known),
            _ => MotionCheck::Unproven { at: 0.0 },
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.check.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.check.is_interrupted()
    }
}

impl<A: Queries, S> Queries for OnVectors<A, S> {
    fn queries(&self) -> u64 {
        self.check.queries()
    }
}
