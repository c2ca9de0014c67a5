//! Verifying edges by running them again.

use crate::{ControlSegment, Flow};
use mp_cspace::{MotionCheck, MotionValidity, ParameterError, Resolution, Space, Validity, Verify};

/// Not the motion it is said to be: refused at its end.
const FALSE: MotionCheck = MotionCheck::Unproven { at: 1.0 };

/// Whether running the edge leads from `from` to `to`, bit for bit.
fn replays<S: PartialEq, U, F: Flow<S, U>>(flow: &F, from: &S, segment: &ControlSegment<U>, to: &S) -> bool {
    let runs = segment.duration > 0.0 && segment.duration.is_finite();
    runs && flow.integrate(from, &segment.input, segment.duration) == *to
}

/// Verifies the edges of [`Recorded`](crate::Recorded): runs each again, which must end in the very state
/// after it, and verifies the straight motion between.
#[derive(Clone, Debug)]
pub struct ReplayMotions<F, V> {
    flow: F,
    /// The verifier of straight motions.
    pub check: V,
}

impl<F, V> ReplayMotions<F, V> {
    /// Runs edges by `flow` and verifies what is between by `check`, which should share no code with
    /// that of the local planner.
    pub fn new(flow: F, check: V) -> Self {
        Self { flow, check }
    }

    /// Verifies one edge, in forward time.
    pub fn check_segment<S: PartialEq, U>(
        &mut self,
        from: &S,
        segment: &ControlSegment<U>,
        to: &S,
    ) -> MotionCheck
    where
        F: Flow<S, U>,
        V: MotionValidity<S>,
    {
        if replays(&self.flow, from, segment, to) { self.check.check_motion(from, to) } else { FALSE }
    }

    /// Verifies one state.
    pub fn check_state<S>(&mut self, q: &S) -> MotionCheck
    where
        V: MotionValidity<S>,
    {
        self.check.check_motion(q, q)
    }
}

/// Verifies any edge that remembers its input: runs it again, which must end in the very state after it,
/// and walks along it in steps of a resolution, some twenty times finer than that of the local planner. Shares only the
/// flow with [`DiscreteFlowCheck`](crate::DiscreteFlowCheck): the flow is what a motion *is*.
#[derive(Clone, Debug)]
pub struct ReplayFinely<'c, C, F, V> {
    space: &'c C,
    flow: F,
    /// Whether a state is free.
    pub valid: V,
    step: f64,
}

/// Steps of a walk shorter than this part of its duration are not taken.
const SHORTEST: f64 = 1e-9;

/// No step takes more than this part of a duration, however little it moves: it may have come round.
const LONGEST: f64 = 1.0 / 32.0;

impl<'c, C: Space, F, V: Validity<C::State>> ReplayFinely<'c, C, F, V> {
    /// Runs edges by `flow` and tests states by `valid` every `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, flow: F, valid: V, resolution: Resolution) -> Result<Self, ParameterError> {
        Ok(Self { space, flow, valid, step: resolution.length_in(space)? })
    }

    /// Verifies one edge, in forward time.
    pub fn check_segment<U>(
        &mut self,
        from: &C::State,
        segment: &ControlSegment<U>,
        to: &C::State,
    ) -> MotionCheck
    where
        F: Flow<C::State, U>,
    {
        if !replays(&self.flow, from, segment, to) {
            return FALSE;
        }
        let (mut at, mut pace, mut q) = (0.0_f64, 0.01_f64, from.clone());
        loop {
            if !self.is_free(&q) {
                return MotionCheck::Collision { at };
            }
            if at >= 1.0 {
                return MotionCheck::Free { clearance: 0.0 };
            }
            // As far as one step of the resolution goes; a little farther next time.
            let next = loop {
                let ahead = (at + pace).min(1.0);
                let state = match ahead < 1.0 {
                    true => self.flow.integrate(from, &segment.input, segment.duration * ahead),
                    false => to.clone(),
                };
                if self.space.distance(&q, &state) <= self.step {
                    break (ahead, state);
                }
                pace *= 0.5;
                if pace <= SHORTEST {
                    return MotionCheck::Unproven { at };
                }
            };
            (at, q) = next;
            pace = (pace * 1.25).min(LONGEST);
        }
    }

    /// Verifies one state.
    pub fn check_state(&mut self, q: &C::State) -> MotionCheck {
        if self.is_free(q) {
            MotionCheck::Free { clearance: 0.0 }
        } else {
            MotionCheck::Collision { at: 0.0 }
        }
    }

    fn is_free(&mut self, q: &C::State) -> bool {
        self.space.contains(q) && self.valid.is_valid(q)
    }
}

impl<S: PartialEq, U, F: Flow<S, U>, V: MotionValidity<S>> Verify<S, ControlSegment<U>>
    for ReplayMotions<F, V>
{
    fn verify_state(&mut self, q: &S) -> MotionCheck {
        self.check_state(q)
    }
    fn verify_edge(&mut self, from: &S, edge: &ControlSegment<U>, to: &S) -> MotionCheck {
        self.check_segment(from, edge, to)
    }
}

impl<C, U, F, V> Verify<C::State, ControlSegment<U>> for ReplayFinely<'_, C, F, V>
where
    C: Space,
    F: Flow<C::State, U>,
    V: Validity<C::State>,
{
    fn verify_state(&mut self, q: &C::State) -> MotionCheck {
        self.check_state(q)
    }
    fn verify_edge(&mut self, from: &C::State, edge: &ControlSegment<U>, to: &C::State) -> MotionCheck {
        self.check_segment(from, edge, to)
    }
}
