//! What obstacles suggest: where to go along them.

use crate::Rng;

/// Suggests states along obstacles, for planners that grow by them, such as obstacle-based RRT.
///
/// What is suggested need be neither free nor within the space: planners check. States have a position, and
/// may have a rotation besides; for a point, position is all there is.
pub trait ObstacleHints<S> {
    /// Whether the robot at `q` touches an obstacle.
    fn touches(&mut self, q: &S) -> bool;

    /// `from` moved along an obstacle, with the same rotation, by as far as `toward` is from it in position:
    /// along the obstacle touched at `hit`, or when that is `None` along any. `None` where nothing is touched,
    /// or there is nothing along which to move.
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S>;

    /// The position of `position` with the rotation of `rotation`.
    fn turned(&self, position: &S, rotation: &S) -> S;

    /// `q` moved and turned by what leads from `from` to `to`.
    fn carried(&self, q: &S, from: &S, to: &S) -> S;
}

impl<S, H: ObstacleHints<S> + ?Sized> ObstacleHints<S> for &mut H {
    fn touches(&mut self, q: &S) -> bool {
        (**self).touches(q)
    }
    fn along(&mut self, from: &S, toward: &S, hit: Option<&S>, rng: &mut Rng) -> Option<S> {
        (**self).along(from, toward, hit, rng)
    }
    fn turned(&self, position: &S, rotation: &S) -> S {
        (**self).turned(position, rotation)
    }
    fn carried(&self, q: &S, from: &S, to: &S) -> S {
        (**self).carried(q, from, to)
    }
}
