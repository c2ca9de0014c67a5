//! Testing the motion to a successor, and what its edge remembers.

use crate::{Flow, Input};
use mp_cspace::{
    Direction, Extension, LocalPlanner, Motion, ParameterError, Reach, Resolution, Space, Validity,
};
use std::fmt::Debug;

/// An edge that remembers how it was made: run from the state before it, the input leads in `duration`
/// to the state after it, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlSegment<U> {
    /// What the system is told.
    pub input: U,
    /// For how long, seconds.
    pub duration: f64,
}

/// A motion from a node to a successor of it. In a backward tree the successor comes first in time.
#[derive(Debug)]
pub struct Drive<'a, S, U> {
    /// The node, which is free.
    pub node: &'a S,
    /// Where the motion leads; in a backward tree where it comes from. In the space.
    pub successor: &'a S,
    /// The input.
    pub input: &'a U,
    /// How long it is applied, seconds.
    pub duration: f64,
    /// Which of the two comes first.
    pub direction: Direction,
}

impl<'a, S, U> Drive<'a, S, U> {
    /// The states before and after the motion, in forward time.
    #[must_use]
    pub fn ends(&self) -> (&'a S, &'a S) {
        match self.direction {
            Direction::Forward => (self.node, self.successor),
            Direction::Backward => (self.successor, self.node),
        }
    }
}

/// The collision test of successors in an [`InputPlanner`](crate::InputPlanner).
pub trait FlowCheck<S, U, F> {
    /// What an edge remembers.
    type Edge: Clone + Debug + Send + Sync;

    /// Whether edges are replayed, so that running them forward must lead to the very same state.
    const REPLAYED: bool;

    /// The edge and its cost where the motion is free.
    fn test(&mut self, flow: &F, drive: &Drive<'_, S, U>) -> Option<(Self::Edge, f64)>;

    /// Whether a motion may begin or end at `q` at all.
    fn admits(&mut self, q: &S) -> bool;

    /// A motion to a state exactly, whatever the inputs: `None` where there is no such thing, which is
    /// the default.
    fn connect(&mut self, _node: &S, _to: &S, _direction: Direction) -> Option<Extension<S, Self::Edge>> {
        None
    }
}

/// Motions to successors are what another local planner does between the two states, and so are the
/// edges: for [`Kinematic`](crate::Kinematic) motions and [`Straight`](mp_cspace::Straight), whose edges are
/// the space's interpolation.
#[derive(Clone, Debug)]
pub struct Between<L>(pub L);

impl<S, U, F, L: LocalPlanner<S>> FlowCheck<S, U, F> for Between<L> {
    type Edge = L::Edge;
    const REPLAYED: bool = false;

    #[inline]
    fn test(&mut self, _: &F, drive: &Drive<'_, S, U>) -> Option<(L::Edge, f64)> {
        match self.0.extend(drive.node, drive.successor, drive.direction, Reach::Full) {
            Extension::Reached(Motion { edge, cost, .. }) => Some((edge, cost)),
            Extension::Advanced(_) | Extension::Trapped => None,
        }
    }
    fn admits(&mut self, q: &S) -> bool {
        self.0.admits(q)
    }
    fn connect(&mut self, node: &S, to: &S, direction: Direction) -> Option<Extension<S, L::Edge>> {
        Some(self.0.extend(node, to, direction, Reach::Full))
    }
}

/// As [`Between`], with edges that remember the input. Their cost is time.
#[derive(Clone, Debug)]
pub struct Recorded<L>(pub L);

impl<S, U: Input, F, L: LocalPlanner<S>> FlowCheck<S, U, F> for Recorded<L> {
    type Edge = ControlSegment<U>;
    const REPLAYED: bool = true;

    #[inline]
    fn test(&mut self, _: &F, drive: &Drive<'_, S, U>) -> Option<(ControlSegment<U>, f64)> {
        let free = self.0.extend(drive.node, drive.successor, drive.direction, Reach::Full);
        matches!(free, Extension::Reached(_)).then(|| segment(drive))
    }
    fn admits(&mut self, q: &S) -> bool {
        self.0.admits(q)
    }
}

fn segment<S, U: Input>(drive: &Drive<'_, S, U>) -> (ControlSegment<U>, f64) {
    (ControlSegment { input: drive.input.clone(), duration: drive.duration }, drive.duration)
}

/// Motions are sampled along the flow, whatever it is: the successor first, then states on the way no
/// farther apart than a resolution. Edges remember the input; their cost is time.
///
/// **What it does not promise:** as with [`Discrete`](mp_cspace::Discrete), between tested states anything
/// may be hit.
#[derive(Clone, Debug)]
pub struct DiscreteFlowCheck<'c, C: Space, V> {
    /// The space to measure in.
    pub space: &'c C,
    /// Whether a state is free.
    pub valid: V,
    step: f64,
    way: Vec<C::State>,
}

/// Motions that take more states than this are not free.
const MAX_STATES: usize = 1 << 20;

/// Parts in which the length of a motion is measured.
const LENGTH_PARTS: u32 = 8;

impl<'c, C: Space, V: Validity<C::State>> DiscreteFlowCheck<'c, C, V> {
    /// Tests states by `valid` every `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, valid: V, resolution: Resolution) -> Result<Self, ParameterError> {
        Ok(Self { space, valid, step: resolution.length_in(space)?, way: Vec::new() })
    }

    /// The length of the motion, as that of a polyline: its ends alone may be near each other.
    fn length<U, F: Flow<C::State, U>>(&self, flow: &F, drive: &Drive<'_, C::State, U>) -> f64 {
        let (from, to) = drive.ends();
        let (mut length, mut last) = (0.0, from.clone());
        for i in 1..LENGTH_PARTS {
            let time = drive.duration * (f64::from(i) / f64::from(LENGTH_PARTS));
            let next = flow.integrate(from, drive.input, time);
            length += self.space.distance(&last, &next);
            last = next;
        }
        length + self.space.distance(&last, to)
    }

    /// Writes states of the motion into `way`, both ends included, no neighbours farther apart than the
    /// step: the duration in as many equal parts as that takes. False where it takes too many.
    fn walk<U, F: Flow<C::State, U>>(&mut self, flow: &F, drive: &Drive<'_, C::State, U>) -> bool {
        let (from, to) = drive.ends();
        let mut parts = (self.length(flow, drive) / self.step).ceil().clamp(1.0, MAX_STATES as f64) as usize;
        while parts < MAX_STATES {
            self.way.clear();
            self.way.push(from.clone());
            for i in 1..parts {
                let time = drive.duration * (i as f64 / parts as f64);
                self.way.push(flow.integrate(from, drive.input, time));
            }
            self.way.push(to.clone());
            let mut widest = 0.0_f64;
            for pair in self.way.windows(2) {
                let gap = self.space.distance(&pair[0], &pair[1]);
                if !gap.is_finite() {
                    return false;
                }
                widest = widest.max(gap);
            }
            if widest <= self.step * (1.0 + 1e-9) {
                return true;
            }
            parts = ((parts as f64 * widest / self.step).ceil() as usize).max(parts + 1);
        }
        false
    }
}

impl<C, U, F, V> FlowCheck<C::State, U, F> for DiscreteFlowCheck<'_, C, V>
where
    C: Space,
    U: Input,
    F: Flow<C::State, U>,
    V: Validity<C::State>,
{
    type Edge = ControlSegment<U>;
    const REPLAYED: bool = true;

    fn test(&mut self, flow: &F, drive: &Drive<'_, C::State, U>) -> Option<(ControlSegment<U>, f64)> {
        if !self.valid.is_valid(drive.successor) || !self.walk(flow, drive) {
            return None;
        }
        let inner = 1..self.way.len() - 1;
        let inside = self.way[inner.clone()].iter().all(|q| self.space.contains(q));
        (inside && self.valid.first_invalid(&self.way[inner]).is_none()).then(|| segment(drive))
    }
    fn admits(&mut self, q: &C::State) -> bool {
        self.valid.is_valid(q)
    }
}

/// A state with more to it than its position is free where its position is.
#[derive(Clone, Debug)]
pub struct OnPosition<V>(pub V);

impl<Q, W, V: Validity<Q>> Validity<(Q, W)> for OnPosition<V> {
    #[inline]
    fn is_valid(&mut self, q: &(Q, W)) -> bool {
        self.0.is_valid(&q.0)
    }
}
