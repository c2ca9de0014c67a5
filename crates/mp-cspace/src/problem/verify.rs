//! The independent check of finished paths.

use crate::{MotionCheck, MotionValidity, PolylineEdge};

/// Verifies states and edges of a candidate path, sharing nothing with the local planner.
///
/// Every [`MotionValidity`] verifies edges that are the space's own interpolation (`E = ()`), also through
/// vertices ([`PolylineEdge`]). Local planners with other edges need a verifier that replays them.
pub trait Verify<S, E> {
    /// Checks the motion from `q` to itself: whether the state is free.
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
