//! Local planners: they propose and check the motion from one configuration to another.

mod polyline;

pub use polyline::PolylineEdge;

use crate::{KnownFree, MotionCheck, MotionValidity, Path, Space};
use std::fmt::Debug;

/// Which end of an edge is the parent. Edges are always stored in forward time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Direction {
    /// The tree grows from the start: parent first.
    Forward,
    /// The tree grows from the goal: child first.
    Backward,
}

/// A path in a space, along the edges of a local planner.
pub type PathOf<C, L> = Path<<C as Space>::State, <L as LocalPlanner<<C as Space>::State>>::Edge>;

/// How far an extension may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// At most this distance, in the metric of the space.
    Step(f64),
    /// All the way or not at all.
    Full,
}

/// An accepted motion: where it ends, how it gets there, what it costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<S, E> {
    /// Where the motion ends (in a backward extension: where it starts in time).
    pub end: S,
    /// How it gets there; `()` for the space's own interpolation.
    pub edge: E,
    /// Cost in forward time: the distance of the space, unless the local planner says otherwise.
    pub cost: f64,
}

/// The outcome of one extension.
#[derive(Clone, Debug, PartialEq)]
pub enum Extension<S, E> {
    /// No motion was accepted.
    Trapped,
    /// Moved toward the target without reaching it.
    Advanced(Motion<S, E>),
    /// Reached the target; `end` equals it exactly.
    Reached(Motion<S, E>),
}

/// Extends from one state toward another. Straight lines (sampled or certified), input sets of
/// kinodynamic systems and snakes implement it.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not plan motions between states `{S}`",
    label = "not a `LocalPlanner<{S}>`",
    note = "a motion check becomes a local planner by `Straight::new(&space, check)`"
)]
pub trait LocalPlanner<S> {
    /// What an edge stores, enough to replay it exactly.
    type Edge: Clone + Debug + Send + Sync;
    /// Tries to move from `from`, which is free, toward `toward`, at most as far as `reach` allows.
    fn extend(
        &mut self,
        from: &S,
        toward: &S,
        direction: Direction,
        reach: Reach,
    ) -> Extension<S, Self::Edge>;
    /// Whether any motion may begin or end at `q`. A start that no motion can leave is then bad input,
    /// not an endless search. The default is `true`.
    fn admits(&mut self, _q: &S) -> bool {
        true
    }
    /// The states between the ends of an edge at which it bends, in forward time: for pictures. The default
    /// is none: such an edge is the space's own interpolation, or knows only how to replay it.
    fn vertices<'e>(&self, _edge: &'e Self::Edge) -> &'e [S]
    where
        S: 'e,
    {
        &[]
    }
}

/// An edge that can be run backward. Roadmaps need this, as their edges have no direction.
pub trait Reversible {
    /// The edge of the same motion from its end to its beginning.
    #[must_use]
    fn reversed(&self) -> Self;
}

impl Reversible for () {
    fn reversed(&self) {}
}

impl<S, L: LocalPlanner<S> + ?Sized> LocalPlanner<S> for &mut L {
    type Edge = L::Edge;
    fn extend(&mut self, from: &S, toward: &S, direction: Direction, reach: Reach) -> Extension<S, L::Edge> {
        (**self).extend(from, toward, direction, reach)
    }
    fn admits(&mut self, q: &S) -> bool {
        (**self).admits(q)
    }
    fn vertices<'e>(&self, edge: &'e L::Edge) -> &'e [S]
    where
        S: 'e,
    {
        (**self).vertices(edge)
    }
}

/// The straight local planner: the space's own interpolation, accepted when `check` finds the
/// whole motion free.
///
/// A step is a fraction of the motion: `step / distance`. Under a metric without constant speed
/// (maximum displacement) the distance covered is only near the step.
#[derive(Clone, Debug)]
pub struct Straight<'c, C, M> {
    /// The space to interpolate in.
    pub space: &'c C,
    /// The motion check: discrete, certified or a user's own.
    pub check: M,
}

impl<'c, C: Space, M: MotionValidity<C::State>> Straight<'c, C, M> {
    /// Straight motions in `space`, checked by `check`.
    pub fn new(space: &'c C, check: M) -> Self {
        Self { space, check }
    }
}

/// Checks the motion that extends the free state `from` to `end`, in forward time.
fn check_toward<S>(
    check: &mut impl MotionValidity<S>,
    from: &S,
    end: &S,
    direction: Direction,
) -> MotionCheck {
    match direction {
        Direction::Forward => check.check_extension(from, end, KnownFree::From),
        Direction::Backward => check.check_extension(end, from, KnownFree::To),
    }
}

impl<C: Space, M: MotionValidity<C::State>> LocalPlanner<C::State> for Straight<'_, C, M> {
    type Edge = ();
    fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<C::State, ()> {
        let distance = self.space.distance(from, toward);
        // A metric need not be symmetric.
        let whole = match direction {
            Direction::Forward => distance,
            Direction::Backward => self.space.distance(toward, from),
        };
        let (end, cost, reached) = match reach {
            Reach::Step(step) if step < distance => {
                (self.space.interpolate(from, toward, step / distance), step * (whole / distance), false)
            }
            _ => (toward.clone(), whole, true),
        };
        let check = check_toward(&mut self.check, from, &end, direction);
        let motion = Motion { end, edge: (), cost };
        match (check.is_free(), reached) {
            (false, _) => Extension::Trapped,
            (true, true) => Extension::Reached(motion),
            (true, false) => Extension::Advanced(motion),
        }
    }
    fn admits(&mut self, q: &C::State) -> bool {
        self.check.check_motion(q, q).is_free()
    }
}
