//! How roadmaps move: the space, the local planner and the verifier.

use mp_cspace::{
    BoxedVerify, Direction, Extension, LocalPlanner, Motion, Problem, Reach, Reversible, Space, Verify,
};
use std::fmt;

/// The space, the local planner with a count of what it was asked, and the verifier of what is answered.
pub struct EdgeChecker<'c, C: Space, L: LocalPlanner<C::State>> {
    space: &'c C,
    local: L,
    verify: BoxedVerify<'c, C, L>,
    patience: u64,
    pub(crate) motions: u64,
    pub(crate) rejected: u64,
}

impl<'c, C: Space, L: LocalPlanner<C::State, Edge: Reversible>> EdgeChecker<'c, C, L> {
    /// The verifier should share no code with the check inside `local`. After `patience` rejected
    /// paths every new motion is verified as well.
    pub fn new(
        space: &'c C,
        local: L,
        verify: impl Verify<C::State, L::Edge> + Send + 'c,
        patience: u64,
    ) -> Self {
        Self::boxed(space, local, Box::new(verify), patience)
    }

    /// How a problem is moved in.
    #[must_use]
    pub fn of(problem: Problem<'c, C, L>) -> Self {
        super::planner::taken_apart(problem).0
    }

    pub(crate) fn boxed(space: &'c C, local: L, verify: BoxedVerify<'c, C, L>, patience: u64) -> Self {
        Self { space, local, verify, patience, motions: 0, rejected: 0 }
    }

    /// The space.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.space
    }

    /// The local planner. Motions asked of it directly are not counted.
    pub fn local(&mut self) -> &mut L {
        &mut self.local
    }

    /// Motions asked of the local planner so far.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.motions
    }

    /// Paths that the verifier did not pass so far.
    #[must_use]
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Whether a state may be a node: within the space, and the local planner lets motions begin and
    /// end there.
    pub fn admits(&mut self, q: &C::State) -> bool {
        self.space.contains(q) && self.local.admits(q)
    }

    /// Whether a state may begin or end a path: [admitted](Self::admits) and verified.
    pub fn accepts(&mut self, q: &C::State) -> bool {
        self.admits(q) && self.verify.verify_state(q).is_free()
    }

    /// Asks the local planner for a motion from `from`, which is free, toward `toward`.
    pub fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        reach: Reach,
    ) -> Extension<C::State, L::Edge> {
        self.motions += 1;
        self.local.extend(from, toward, Direction::Forward, reach)
    }

    /// The whole motion from `from` to `to`, both free, if the local planner has one; verified too once
    /// too many paths were rejected.
    pub fn reach(&mut self, from: &C::State, to: &C::State) -> Option<Motion<C::State, L::Edge>> {
        let Extension::Reached(motion) = self.extend(from, to, Reach::Full) else { return None };
        (!self.distrusts() || self.passes(from, &motion.edge, to)).then_some(motion)
    }

    /// What [`reach`](Self::reach) returns when the local planner's answer is `motion`; counts as asked.
    pub(crate) fn answered(
        &mut self,
        from: &C::State,
        motion: Option<Motion<C::State, L::Edge>>,
        to: &C::State,
    ) -> Option<Motion<C::State, L::Edge>> {
        self.motions += 1;
        motion.filter(|motion| !self.distrusts() || self.passes(from, &motion.edge, to))
    }

    /// Whether so many paths were rejected that each new motion is verified.
    #[must_use]
    pub fn distrusts(&self) -> bool {
        self.rejected >= self.patience
    }

    /// Whether the verifier passes a motion.
    pub fn passes(&mut self, from: &C::State, edge: &L::Edge, to: &C::State) -> bool {
        self.verify.verify_edge(from, edge, to).is_free()
    }
}

impl<C: Space + fmt::Debug, L: LocalPlanner<C::State> + fmt::Debug> fmt::Debug for EdgeChecker<'_, C, L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EdgeChecker")
            .field("space", &self.space)
            .field("local", &self.local)
            .field("motions", &self.motions)
            .field("rejected", &self.rejected)
            .finish_non_exhaustive()
    }
}
