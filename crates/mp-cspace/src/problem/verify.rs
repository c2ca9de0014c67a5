//! The independent check of finished paths.

use crate::inputs::{ControlSegment, Flow, ReplayFinely, ReplayMotions};
use crate::{MotionCheck, MotionValidity, PolylineEdge, Space, Validity};

/// Verifies states and edges of a candidate path, sharing nothing with the local planner.
///
/// Every [`MotionValidity`] verifies edges that are the space's own interpolation (`E = ()`), also by way of other
/// states ([`PolylineEdge`]).
/// Local planners with other edges bring a verifier that replays them.
pub trait Verify<S, E> {
    /// Checks one state.
    fn verify_state(&mut self, q: &S) -> MotionCheck;
    /// Checks the motion along `edge` from `from` to `to`, in forward time, both ends included.
    fn verify_edge(&mut self, from: &S, edge: &E, to: &S) -> MotionCheck;
}

impl<S, V: MotionValidity<S>> Verify<S, ()> for V {
    fn verify_state(&mut self, q: &S) -> MotionCheck {
        self.check_motion(q, q)
    }
    fn verify_edge(&mut self, from: &S, _: &(), to: &S) -> MotionCheck {
        self.check_motion(from, to)
    }
}

impl<S, V: MotionValidity<S>> Verify<S, PolylineEdge<S>> for V {
    fn verify_state(&mut self, q: &S) -> MotionCheck {
        self.check_motion(q, q)
    }
    fn verify_edge(&mut self, from: &S, edge: &PolylineEdge<S>, to: &S) -> MotionCheck {
        edge.check(from, to, self)
    }
}

impl<S: PartialEq, U, F: Flow<S, U>, V: MotionValidity<S>> Verify<S, ControlSegment<U>>
    for ReplayMotions<F, V>
{
    fn verify_state(&mut self, q: &S) -> MotionCheck {
        self.check_state(q)
    }
    fn verify_edge(&mut self, from: &S, edge: &ControlSegment<U>, to: &S) -> MotionCheck {
        self.check_leg(from, edge, to)
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
        self.check_leg(from, edge, to)
    }
}
