//! Collision tests of the motion to a successor, and what its edge stores.

use crate::{Flow, Input};
use mp_cspace::{Direction, Extension, Length, LocalPlanner, Motion, ParameterError, Reach, Space, Validity};
use std::fmt::Debug;

/// An edge that stores its input: applied for `duration` from the state before the edge, it leads to the
/// state after the edge, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlSegment<U> {
    /// The input of the system.
    pub input: U,
    /// How long it is applied, seconds.
    pub duration: f64,
}

/// A motion from a node to a successor of it. In a backward tree the successor comes first in time.
#[derive(Debug)]
pub struct SuccessorMotion<'a, S, U> {
    /// The node, which is free.
    pub node: &'a S,
    /// The state the motion leads to, in a backward tree the state it comes from. Within the space.
    pub successor: &'a S,
    /// The input that is held along the motion.
    pub input: &'a U,
    /// How long it is applied, seconds.
    pub duration: f64,
    /// Which of the two comes first.
    pub direction: Direction,
}

impl<'a, S, U> SuccessorMotion<'a, S, U> {
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
    /// What an edge stores.
    type Edge: Clone + Debug + Send + Sync;

    /// Whether edges are replayed: running one forward must then lead to the same state, bit for bit.
    const REPLAYED: bool;

    /// The edge and its cost where the motion is free.
    fn test(&mut self, flow: &F, motion: &SuccessorMotion<'_, S, U>) -> Option<(Self::Edge, f64)>;

    /// Whether any motion may begin or end at `q`.
    fn admits(&mut self, q: &S) -> bool;

    /// A motion that ends exactly at a given state, whatever the inputs. `None`, the default, where the
    /// check can make none.
    fn connect(&mut self, _node: &S, _to: &S, _direction: Direction) -> Option<Extension<S, Self::Edge>> {
        None
    }
}

/// Uses another local planner for the motion between node and successor, and stores its edge: for
/// [`Kinematic`](crate::Kinematic) motions with [`Straight`](mp_cspace::Straight), whose edges are the
/// space's interpolation.
#[derive(Clone, Debug)]
pub struct LocalFlowCheck<L>(pub L);

impl<S, U, F, L: LocalPlanner<S>> FlowCheck<S, U, F> for LocalFlowCheck<L> {
    type Edge = L::Edge;
    const REPLAYED: bool = false;

    #[inline]
    fn test(&mut self, _: &F, motion: &SuccessorMotion<'_, S, U>) -> Option<(L::Edge, f64)> {
        match self.0.extend(motion.node, motion.successor, motion.direction, Reach::Full) {
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

/// As [`LocalFlowCheck`], with edges that store the input. Their cost is time.
#[derive(Clone, Debug)]
pub struct RecordedFlowCheck<L>(pub L);

impl<S, U: Input, F, L: LocalPlanner<S>> FlowCheck<S, U, F> for RecordedFlowCheck<L> {
    type Edge = ControlSegment<U>;
    const REPLAYED: bool = true;

    #[inline]
    fn test(&mut self, _: &F, motion: &SuccessorMotion<'_, S, U>) -> Option<(ControlSegment<U>, f64)> {
        let free = self.0.extend(motion.node, motion.successor, motion.direction, Reach::Full);
        matches!(free, Extension::Reached(_)).then(|| segment(motion))
    }
    fn admits(&mut self, q: &S) -> bool {
        self.0.admits(q)
    }
}

fn segment<S, U: Input>(motion: &SuccessorMotion<'_, S, U>) -> (ControlSegment<U>, f64) {
    (ControlSegment { input: motion.input.clone(), duration: motion.duration }, motion.duration)
}

/// Samples motions along any flow: the successor first, then states between, no farther apart than a
/// resolution. Edges store the input; their cost is time.
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
    /// The sampled states of a motion.
    samples: Vec<C::State>,
}

/// Motions that need more states than this count as not free.
const MAX_STATES: usize = 1 << 20;

/// Number of straight parts by which the length of a motion is measured.
const LENGTH_PARTS: u32 = 8;

impl<'c, C: Space, V: Validity<C::State>> DiscreteFlowCheck<'c, C, V> {
    /// Tests states by `valid` every `resolution`.
    ///
    /// # Errors
    /// When the resolution is not positive and finite, or below 10⁻⁹ of the extent.
    pub fn new(space: &'c C, valid: V, resolution: Length) -> Result<Self, ParameterError> {
        Ok(Self { space, valid, step: resolution.resolution_in(space)?, samples: Vec::new() })
    }

    /// The length of the motion as a polyline: the distance of its ends alone may be too short.
    fn length<U, F: Flow<C::State, U>>(&self, flow: &F, motion: &SuccessorMotion<'_, C::State, U>) -> f64 {
        let (from, to) = motion.ends();
        let (mut length, mut last) = (0.0, from.clone());
        for i in 1..LENGTH_PARTS {
            let time = motion.duration * (f64::from(i) / f64::from(LENGTH_PARTS));
            let next = flow.integrate(from, motion.input, time);
            length += self.space.distance(&last, &next);
            last = next;
        }
        length + self.space.distance(&last, to)
    }

    /// Writes states of the motion into `samples`, both ends included, no neighbours farther apart than the
    /// step: at as many equal parts of the duration as this needs. `false` where it needs too many.
    fn sample<U, F: Flow<C::State, U>>(
        &mut self,
        flow: &F,
        motion: &SuccessorMotion<'_, C::State, U>,
    ) -> bool {
        let (from, to) = motion.ends();
        let mut parts = (self.length(flow, motion) / self.step).ceil().clamp(1.0, MAX_STATES as f64) as usize;
        while parts < MAX_STATES {
            self.samples.clear();
            self.samples.push(from.clone());
            for i in 1..parts {
                let time = motion.duration * (i as f64 / parts as f64);
                self.samples.push(flow.integrate(from, motion.input, time));
            }
            self.samples.push(to.clone());
            let mut widest = 0.0_f64;
            for pair in self.samples.windows(2) {
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

    fn test(
        &mut self,
        flow: &F,
        motion: &SuccessorMotion<'_, C::State, U>,
    ) -> Option<(ControlSegment<U>, f64)> {
        if !self.valid.is_valid(motion.successor) || !self.sample(flow, motion) {
            return None;
        }
        let inner = 1..self.samples.len() - 1;
        let inside = self.samples[inner.clone()].iter().all(|q| self.space.contains(q));
        (inside && self.valid.first_invalid(&self.samples[inner]).is_none()).then(|| segment(motion))
    }
    fn admits(&mut self, q: &C::State) -> bool {
        self.valid.is_valid(q)
    }
}

/// A state that is a position and something else, such as a velocity, is free where its position is free.
#[derive(Clone, Debug)]
pub struct OnPosition<V>(pub V);

impl<Q, W, V: Validity<Q>> Validity<(Q, W)> for OnPosition<V> {
    #[inline]
    fn is_valid(&mut self, q: &(Q, W)) -> bool {
        self.0.is_valid(&q.0)
    }
}
