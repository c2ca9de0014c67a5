//! The loop with one tree, grown from the start.

use super::{
    Core, Extender, Grown, Inserter, Purpose, SearchTree, Selector, TargetSampler, Tree, TreePlannerParts,
};
use mp_cspace::{
    BuildError, Direction, EdgeChecker, Event, Goals, LocalPlanner, NodeId, Observer, PathOf, Planner,
    Problem, Progress, Rng, Space,
};

/// A planner that grows one tree from the start until it enters the goal.
///
/// The first iteration tries a straight motion from the start to each listed goal state, unless the extender
/// [declines](Extender::allows_direct). Each iteration then samples a target (with probability
/// [`goal_bias`](crate::Tuning::goal_bias) a goal), grows the tree toward it, and verifies the path to the
/// first new node in the goal. Stepping on after a solution continues with the same tree; the same path may
/// be found again.
#[derive(Debug)]
pub struct SingleTree<'c, C: Space, L: LocalPlanner<C::State>, P, Se, G, A> {
    core: Core<'c, C, L>,
    tree: SearchTree<C, L, Se, A>,
    target_sampler: P,
    extender: G,
}

/// A tree, its edge checker and its extender.
type Parts<'a, 'c, C, L, G> = (
    &'a Tree<<C as Space>::State, <L as LocalPlanner<<C as Space>::State>>::Edge>,
    &'a mut EdgeChecker<'c, C, L>,
    &'a mut G,
);

impl<'c, C, L, P, Se, G, A> SingleTree<'c, C, L, P, Se, G, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    G: Extender<C, L>,
    A: Inserter<C, L>,
{
    /// A planner for a problem.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn assemble(
        problem: Problem<'c, C, L>,
        parts: TreePlannerParts<P, Se, G, A>,
    ) -> Result<Self, BuildError> {
        Ok(Self {
            core: Core::new(problem, &parts.tuning)?,
            tree: SearchTree::new(0, Direction::Forward, parts.selector, parts.inserter),
            target_sampler: parts.target_sampler,
            extender: parts.extender,
        })
    }

    /// The tree; empty before the first step.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.tree.nodes()
    }

    /// The extender, which makes the motions that join the tree.
    #[must_use]
    pub fn extender(&self) -> &G {
        &self.extender
    }

    /// The tree, its edge checker and its extender.
    pub(crate) fn parts(&mut self) -> Parts<'_, 'c, C, L, G> {
        (self.tree.nodes(), &mut self.core.checker, &mut self.extender)
    }

    /// Adds the root and tries the straight motions to the goals. After a panic of the user's code the next
    /// step continues behind the motion that panicked.
    fn begin(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        if let Some(root) = self.core.add_start(&mut self.tree, observer) {
            return self.candidate(root, observer);
        }
        while self.extender.allows_direct()
            && let Some(grown) = self.core.connect_directly(&mut self.tree, rng, observer)
        {
            let Grown::Reached(id) = grown else { continue };
            if let Some(path) = self.candidate(id, observer) {
                return Some(path);
            }
        }
        None
    }

    /// Grows toward `target`, which is a goal when the purpose is to join.
    fn grow_toward(
        &mut self,
        target: &C::State,
        purpose: Purpose,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<PathOf<C, L>> {
        observer.on(Event::Sampled(target));
        let before = self.tree.nodes().len();
        let grown =
            self.tree.toward(target, purpose, &mut self.core.checker, &mut self.extender, rng, observer);
        if let (Purpose::Join, Grown::Reached(id)) = (purpose, grown) {
            return self.candidate(id, observer);
        }
        if self.core.goals.has_region() {
            let new = &self.tree.nodes().states()[before..];
            let entered = before + first_reached(&self.core.goals, new)?;
            return self.candidate(entered as NodeId, observer);
        }
        None
    }

    /// The path to `id` if it passes verification; otherwise the part from the failed edge on is pruned.
    fn candidate(&mut self, id: NodeId, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        let pruned = |survivors: &[NodeId]| self.extender.pruned(Direction::Forward, survivors);
        self.core.path(&mut self.tree, id, observer, pruned)
    }
}

/// The place of the first of some states that is in the goal.
fn first_reached<S>(goals: &Goals<'_, S>, states: &[S]) -> Option<usize> {
    states.iter().position(|q| goals.reached(q))
}

impl<C, L, P, Se, G, A> Planner<C::State> for SingleTree<'_, C, L, P, Se, G, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    G: Extender<C, L>,
    A: Inserter<C, L>,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.core.iterations += 1;
        if let Some(path) = self.begin(rng, observer) {
            return Some(path);
        }
        if let Some(goal) = self.core.aim(rng) {
            return self.grow_toward(&goal, Purpose::Join, rng, observer);
        }
        let (points, selector) = self.tree.parts();
        let target = self.target_sampler.next_target(rng, self.core.checker.space(), points, selector);
        self.grow_toward(&target, Purpose::Explore, rng, observer)
    }

    fn progress(&self) -> Progress {
        let mut progress = self.core.progress(self.tree.nodes().len());
        progress.exhausted = self.tree.is_exhausted();
        progress
    }
}
