//! Slot: which configurations are tried as nodes.

use super::{EdgeChecker, MilestoneKind, Piece, Roadmap};
use mp_cspace::{LocalPlanner, Motion, NodeId, Reversible, Rng, Sampler, Space, Uniform};

/// A configuration that may become a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate<S, E> {
    /// The configuration: free, by [`EdgeChecker::admits`].
    pub state: S,
    /// What it will be in the roadmap.
    pub kind: MilestoneKind,
    /// The obstacle or region it belongs to, if any.
    pub obstacle: Option<u32>,
    /// The motion to it from another node, if it was found by one; the edge is kept.
    pub parent: Option<ParentMotion<S, E>>,
}

/// The motion by which a candidate was found.
#[derive(Clone, Debug, PartialEq)]
pub struct ParentMotion<S, E> {
    /// The node where the motion begins; `None` for the candidate before.
    pub from: Option<NodeId>,
    /// The motion, which ends in the candidate.
    pub motion: Motion<S, E>,
}

impl<S, E> Candidate<S, E> {
    /// A candidate without a parent.
    pub fn new(state: S, kind: MilestoneKind) -> Self {
        Self { state, kind, obstacle: None, parent: None }
    }

    /// The same candidate, belonging to an obstacle or a region.
    #[must_use]
    pub fn of(self, obstacle: u32) -> Self {
        Self { obstacle: Some(obstacle), ..self }
    }
}

/// Slot: which configurations are tried as nodes.
pub trait NodeGenerator<C: Space, L: LocalPlanner<C::State>> {
    /// Writes the candidates of attempt number `attempt`, in order, to `out`, which is empty: none when the
    /// attempt fails, and by default. Each must be [admitted](EdgeChecker::admits).
    ///
    /// `rng` is the stream of this attempt.
    fn generate(
        &mut self,
        _attempt: u64,
        _map: &Roadmap<C::State, L::Edge>,
        _checker: &mut EdgeChecker<'_, C, L>,
        _rng: &mut Rng,
        _out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
    }

    /// Called before attempt number `attempt` is made, with the roadmap as it is; on one thread, also where
    /// others make attempts.
    fn begin(&mut self, _attempt: u64, _map: &Roadmap<C::State, L::Edge>, _space: &C) {}

    /// A whole piece of the roadmap that attempt number `attempt` makes, beside its candidates. `checker`
    /// need not be the one that counts motions: those of the piece count when it joins the roadmap.
    fn piece(
        &mut self,
        _attempt: u64,
        _map: &Roadmap<C::State, L::Edge>,
        _checker: &mut EdgeChecker<'_, C, L>,
        _rng: &mut Rng,
    ) -> Option<Piece<C::State, L::Edge>> {
        None
    }

    /// How many of the next attempts are independent: they neither depend on what the others add to the roadmap
    /// nor change the generator, so clones of it may make them beforehand, in parallel. The planner asks again
    /// before it uses an attempt made so, and drops it if it is no longer independent, as other nodes were added
    /// meanwhile.
    fn independent(&self, _map: &Roadmap<C::State, L::Edge>) -> u64 {
        0
    }
}

/// Free samples: those of a sampler that the local planner admits.
#[derive(Clone, Copy, Debug)]
pub struct Free<T> {
    sampler: T,
    memory: bool,
}

impl<'c, C: Space> Free<Uniform<'c, C>> {
    /// Uniform samples.
    pub fn uniform(space: &'c C) -> Self {
        Self { sampler: Uniform(space), memory: false }
    }
}

impl<T> Free<T> {
    /// Samples of any sampler, one after the other. State that the sampler keeps from one to the next, as
    /// low-discrepancy sequences do, is kept.
    pub fn of(sampler: T) -> Self {
        Self { sampler, memory: true }
    }
}

impl<C, L, T> NodeGenerator<C, L> for Free<T>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    T: Sampler<C::State>,
{
    fn generate(
        &mut self,
        _: u64,
        _: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    ) {
        let state = self.sampler.sample(rng);
        if checker.admits(&state) {
            out.push(Candidate::new(state, MilestoneKind::Plain));
        }
    }

    fn independent(&self, _: &Roadmap<C::State, L::Edge>) -> u64 {
        if self.memory { 0 } else { u64::MAX }
    }
}
