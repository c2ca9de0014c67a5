//! How the edges of trees and roadmaps are made and checked.

use crate::erased::AnyObjective;
use crate::{
    BoxedVerify, Direction, Extension, Goals, Interrupt, LocalPlanner, Motion, Problem, ProblemParts, Reach,
    Space, Verify,
};
use std::fmt;

/// The space, the local planner that makes edges, and the verifier of paths, with counts of what they were
/// asked.
///
/// After `patience` rejected paths the checker no longer trusts the local planner: then every new edge is
/// verified too.
///
/// Once the [interrupt](Problem::with_interrupt) of the problem says so, nothing is computed any more: there
/// are no motions, and nothing passes.
pub struct EdgeChecker<'c, C: Space, L: LocalPlanner<C::State>> {
    space: &'c C,
    local: L,
    verifier: BoxedVerify<'c, C, L>,
    step: f64,
    patience: u64,
    motions: u64,
    rejected: u64,
    interrupt: Interrupt,
    objective: Option<AnyObjective<'c, C::State>>,
}

impl<'c, C: Space, L: LocalPlanner<C::State>> EdgeChecker<'c, C, L> {
    /// The checker of motions of `local` in `space`. The verifier should share no code with the check inside
    /// `local`.
    pub fn new(
        space: &'c C,
        local: L,
        verifier: impl Verify<C::State, L::Edge> + Send + 'c,
        patience: u64,
    ) -> Self {
        Self::boxed(space, local, Box::new(verifier), patience)
    }

    /// The checker of a problem, with the problem's start and goals.
    #[must_use]
    pub fn of(problem: Problem<'c, C, L>, patience: u64) -> (Self, C::State, Goals<'c, C::State>) {
        let ProblemParts { space, local, verify, start, goals, interrupt } = problem.into_parts();
        (Self { interrupt, ..Self::boxed(space, local, verify, patience) }, start, goals)
    }

    fn boxed(space: &'c C, local: L, verifier: BoxedVerify<'c, C, L>, patience: u64) -> Self {
        let (step, interrupt) = (f64::INFINITY, Interrupt::never());
        Self { space, local, verifier, step, patience, motions: 0, rejected: 0, interrupt, objective: None }
    }

    /// The same with another longest [step](Self::step).
    #[must_use]
    pub fn with_step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// The same, whose motions cost what this objective says of the straight motion between their ends.
    #[must_use]
    pub fn with_objective(self, objective: Option<AnyObjective<'c, C::State>>) -> Self {
        Self { objective, ..self }
    }

    /// The space whose states the edges join.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.space
    }

    /// The longest step by which trees grow, in the metric of the space; infinite by default.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The local planner. Motions asked of it directly are not counted.
    pub fn local(&mut self) -> &mut L {
        &mut self.local
    }

    /// The states between the ends of an edge at which it bends, in forward time.
    #[must_use]
    pub fn vertices<'e>(&self, edge: &'e L::Edge) -> &'e [C::State]
    where
        C::State: 'e,
    {
        self.local.vertices(edge)
    }

    /// What is asked whether to end.
    #[must_use]
    pub fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    /// Whether to end now: for loops that do much between two motions.
    #[inline]
    pub fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }

    /// How many motions the local planner was asked for.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.motions
    }

    /// How many paths the verifier rejected.
    #[must_use]
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Counts a path that the verifier rejected.
    pub fn count_rejected(&mut self) {
        self.rejected += 1;
    }

    /// Whether a state may be a node: it is in the space, and the local planner lets motions begin and end
    /// there.
    pub fn admits(&mut self, q: &C::State) -> bool {
        !self.interrupt.ask() && self.space.contains(q) && self.local.admits(q)
    }

    /// Whether a state may be an end of a path: [admitted](Self::admits) and verified.
    pub fn accepts(&mut self, q: &C::State) -> bool {
        self.admits(q) && self.verifier.verify_state(q).is_free()
    }

    /// Asks the local planner for a motion from `from`, which is free, toward `toward`, and counts it.
    #[inline]
    pub fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<C::State, L::Edge> {
        self.motions += 1;
        if self.interrupt.ask() {
            return Extension::Trapped;
        }
        let mut extension = self.local.extend(from, toward, direction, reach);
        if let (Some(objective), Extension::Advanced(motion) | Extension::Reached(motion)) =
            (&mut self.objective, &mut extension)
        {
            motion.cost = match direction {
                Direction::Forward => objective.cost(from, &motion.end),
                Direction::Backward => objective.cost(&motion.end, from),
            };
        }
        extension
    }

    /// The whole motion from `from`, which is free, to `to`, if the local planner has one; verified where the
    /// local planner is [not trusted](Self::distrusts).
    pub fn reach(
        &mut self,
        from: &C::State,
        to: &C::State,
        direction: Direction,
    ) -> Option<Motion<C::State, L::Edge>> {
        let Extension::Reached(motion) = self.extend(from, to, direction, Reach::Full) else { return None };
        (!self.distrusts() || self.passes(from, &motion.edge, to, direction)).then_some(motion)
    }

    /// What [`reach`](Self::reach) returns in forward time when the answer of the local planner, `motion`, is
    /// known already. Counts it.
    pub fn replay(
        &mut self,
        from: &C::State,
        motion: Option<Motion<C::State, L::Edge>>,
        to: &C::State,
    ) -> Option<Motion<C::State, L::Edge>> {
        self.motions += 1;
        motion.filter(|motion| !self.distrusts() || self.passes(from, &motion.edge, to, Direction::Forward))
    }

    /// Whether `patience` paths were rejected, so that each new edge is verified.
    #[inline]
    #[must_use]
    pub fn distrusts(&self) -> bool {
        self.rejected >= self.patience
    }

    /// Whether the verifier passes a motion from `from` to `to`; with [`Direction::Backward`] it runs from
    /// `to` to `from`.
    pub fn passes(&mut self, from: &C::State, edge: &L::Edge, to: &C::State, direction: Direction) -> bool {
        let (start, end) = match direction {
            Direction::Forward => (from, to),
            Direction::Backward => (to, from),
        };
        !self.interrupt.ask() && self.verifier.verify_edge(start, edge, end).is_free()
    }
}

impl<C: Space + fmt::Debug, L: LocalPlanner<C::State> + fmt::Debug> fmt::Debug for EdgeChecker<'_, C, L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EdgeChecker")
            .field("space", &self.space)
            .field("local", &self.local)
            .field("step", &self.step)
            .field("patience", &self.patience)
            .field("motions", &self.motions)
            .field("rejected", &self.rejected)
            .finish_non_exhaustive()
    }
}
