//! Verifiers that replay edges.

use crate::{ControlSegment, Flow};
use mp_cspace::{Length, MotionCheck, MotionValidity, ParameterError, Space, Validity, Verify};

/// The answer for an edge whose replay does not end in the state after it.
const WRONG_END: MotionCheck = MotionCheck::Unproven { at: 1.0 };

/// Whether replaying the edge leads from `from` to `to`, bit for bit.
fn replays<S: PartialEq, U, F: Flow<S, U>>(flow: &F, from: &S, segment: &ControlSegment<U>, to: &S) -> bool {
    let runs = segment.duration > 0.0 && segment.duration.is_finite();
    runs && flow.integrate(from, &segment.input, segment.duration) == *to
}

/// Verifies the edges of [`RecordedFlowCheck`](crate::RecordedFlowCheck): replays each, which must end in the
/// state after it, bit for bit, and verifies the straight motion between.
#[derive(Clone, Debug)]
pub struct ReplayMotions<F, V> {
    flow: F,
    /// The verifier of straight motions.
    pub check: V,
}

impl<F, V> ReplayMotions<F, V> {
    /// Replays edges by `flow` and verifies the straight motions by `check`, which should share no code with
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
        if replays(&self.flow, from, segment, to) { self.check.check_motion(from, to) } else { WRONG_END }
    }

    /// Verifies one state.
    pub fn check_state<S>(&mut self, q: &S) -> MotionCheck
    where
        V: MotionValidity<S>,
    {
        self.check.check_motion(q, q)
    }
}

/// Verifies any edge that stores its input: replays it, which must end in the state after it, bit for bit,
/// and tests states along it at a resolution, some twenty times finer than that of the local planner. Shares
/// only the flow with [`DiscreteFlowCheck`](crate::DiscreteFlowCheck): the flow defines the motion.
#[derive(Clone, Debug)]
pub struct ReplayFinely<'c, C, F, V> {
    space: &'c C,
    flow: F,
    /// Whether a state is free.
    pub valid: V,
    step: f64,
}

/// The shortest step, as a part of the duration: a motion that needs shorter ones is not proved.
const SHORTEST: f64 = 1e-9;

/// The longest step, as a part of the duration, however little it moves: the motion may have come round.
const LONGEST: f64 = 1.0 / 32.0;

impl<'c, C: Space, F, V: Validity<C::State>> ReplayFinely<'c, C, F, V> {
    /// Replays edges by `flow` and tests states by `valid` every `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, flow: F, valid: V, resolution: Length) -> Result<Self, ParameterError> {
        Ok(Self { space, flow, valid, step: resolution.resolution_in(space)? })
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
            return WRONG_END;
        }
        let (mut at, mut pace, mut q) = (0.0_f64, 0.01_f64, from.clone());
        loop {
            if !self.is_free(&q) {
                return MotionCheck::Collision { at };
            }
            if at >= 1.0 {
                return MotionCheck::Free { clearance: 0.0 };
            }
            // Halves the pace until the next state is within the resolution; then tries a longer one.
            let next = loop {
                let next_at = (at + pace).min(1.0);
                let state = match next_at < 1.0 {
                    true => self.flow.integrate(from, &segment.input, segment.duration * next_at),
                    false => to.clone(),
                };
                if self.space.distance(&q, &state) <= self.step {
                    break (next_at, state);
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
