//! Where nodes come from.

use super::{EdgeChecker, MilestoneKind, Roadmap};
use mp_cspace::{LocalPlanner, Motion, NodeId, Reversible, Rng, Sampler, Space, Uniform};

/// A configuration that may become a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate<S, E> {
    /// The configuration: free, by [`EdgeChecker::admits`].
    pub state: S,
    /// What it is there for.
    pub kind: MilestoneKind,
    /// The obstacle it belongs to, if any.
    pub obstacle: Option<u32>,
    /// How it was come to, when from a node; that edge is kept.
    pub parent: Option<ParentMotion<S, E>>,
}

/// How a candidate was come to.
#[derive(Clone, Debug, PartialEq)]
pub struct ParentMotion<S, E> {
    /// From which node; `None`: from the candidate before it.
    pub from: Option<NodeId>,
    /// By which motion, which ends in the candidate.
    pub motion: Motion<S, E>,
}

impl<S, E> Candidate<S, E> {
    /// A configuration, come to by itself.
    pub fn new(state: S, kind: MilestoneKind) -> Self {
        Self { state, kind, obstacle: None, parent: None }
    }

    /// The same, belonging to an obstacle.
    #[must_use]
    pub fn of(self, obstacle: u32) -> Self {
        Self { obstacle: Some(obstacle), ..self }
    }
}

/// A slot: what configurations are tried as nodes.
pub trait NodeGenerator<C: Space, L: LocalPlanner<C::State>> {
    /// The candidates of attempt number `attempt`, in order, into `out`, which is empty: none when the
    /// attempt misses. Each must be [admitted](EdgeChecker::admits).
    ///
    /// `rng` is the stream of this attempt.
    fn generate(
        &mut self,
        attempt: u64,
        map: &Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        out: &mut Vec<Candidate<C::State, L::Edge>>,
    );

    /// How many attempts from now on neither look at the roadmap nor change the generator, so that they
    /// may be made ahead of their turn and at the same time by clones of it.
    fn independent(&self, _map: &Roadmap<C::State, L::Edge>) -> u64 {
        0
    }
}

/// Free samples: what a sampler yields and the local planner admits.
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
    /// Samples of any sampler, one after the other: what it remembers from one to the next (low-discrepancy
    /// sequences do) is kept.
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
