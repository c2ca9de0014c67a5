//! What the loops have in common: the ends of the path, the straight way between them, verified paths.

use super::{Grown, Inserter, SearchTree, Selector, Tuning};
use mp_cspace::{
    BuildError, EdgeChecker, Goals, LocalPlanner, NodeId, Observer, Path, Problem, Progress, Rng, Space,
};
use rand::RngExt;

/// What a planner of the family has beside its trees: the ends of the problem, how it moves, and what it has done. The
/// loops here are made of it, and yours may be.
#[derive(Debug)]
pub struct Core<'c, C: Space, L: LocalPlanner<C::State>> {
    /// Where paths begin.
    pub start: C::State,
    /// Where they end.
    pub goals: Goals<'c, C::State>,
    /// How trees move, and the verifier.
    pub checker: EdgeChecker<'c, C, L>,
    /// The probability of aiming at a goal; zero where there is none to aim at.
    pub goal_bias: f64,
    /// Iterations so far.
    pub iterations: u64,
    /// How many listed goal states have been tried straight from the start.
    tried: usize,
}

impl<'c, C: Space, L: LocalPlanner<C::State>> Core<'c, C, L> {
    /// A problem to be planned.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(problem: Problem<'c, C, L>, tuning: &Tuning) -> Result<Self, BuildError> {
        let goal_bias = tuning.checked_bias()?;
        let step = tuning.step.length_in(problem.space())?;
        let (checker, start, goals) = EdgeChecker::of(problem, tuning.patience);
        Ok(Self {
            checker: checker.with_step(step),
            start,
            goal_bias: if goals.can_aim() { goal_bias } else { 0.0 },
            goals,
            iterations: 0,
            tried: 0,
        })
    }

    /// Plants the root of the first tree at the start, if there is none. The root, where that is in the goal.
    pub fn plant<Se: Selector<C>, A: Inserter<C, L>>(
        &self,
        tree: &mut SearchTree<C, L, Se, A>,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<NodeId> {
        if !tree.nodes().is_empty() {
            return None;
        }
        let arrived = self.goals.reached(&self.start);
        let root = tree.add_root(self.checker.space(), self.start.clone(), observer);
        arrived.then_some(root)
    }

    /// Tries to go straight from the start to the next listed goal state; `None` when all have been tried. What a
    /// panic of the user's code interrupts is not tried again.
    pub fn leap<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        tree: &mut SearchTree<C, L, Se, A>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Grown> {
        let goal = self.goals.listed().get(self.tried)?;
        self.tried += 1;
        Some(tree.leap(0, goal, &mut self.checker, rng, observer))
    }

    /// A goal to aim at instead of exploring, now and then.
    pub fn aim(&mut self, rng: &mut Rng) -> Option<C::State> {
        if self.goal_bias > 0.0 && rng.random_bool(self.goal_bias) { self.goals.aim(rng) } else { None }
    }

    /// Roots the tree from the goal at a new sample of the goal, now and then, and always where it has no root.
    pub fn sample_goal<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        tree: &mut SearchTree<C, L, Se, A>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) {
        let wanted = tree.nodes().is_empty() || rng.random_bool(self.goal_bias);
        let space = self.checker.space();
        if wanted
            && let Some(goal) = self.goals.sample(rng)
            && !tree.knows(space, &goal)
            && self.checker.accepts(&goal)
        {
            tree.add_root(space, goal, observer);
        }
    }

    /// The path from the root to `id`, if it passes verification; otherwise its bad part is pruned, of which `pruned`
    /// is told as by [`SearchTree::verify`].
    pub fn path<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        tree: &mut SearchTree<C, L, Se, A>,
        id: NodeId,
        observer: &mut dyn Observer<C::State>,
        pruned: impl FnMut(&[NodeId]),
    ) -> Option<Path<C::State, L::Edge>> {
        let passed = tree.verify(id, &mut self.checker, observer, pruned);
        passed.then(|| tree.nodes().path(id))
    }

    /// What has been done, with so many nodes.
    #[must_use]
    pub fn progress(&self, nodes: usize) -> Progress {
        let mut progress = Progress::new(self.iterations, nodes, self.checker.motions());
        progress.rejected = self.checker.rejected();
        progress
    }
}

/// The path through two nodes with the same state, one of a tree from the start and one of a tree from the goal.
pub(crate) fn joined<S, E>([mut path, rest]: [Path<S, E>; 2]) -> Path<S, E> {
    path.states.extend(rest.states.into_iter().skip(1));
    path.edges.extend(rest.edges);
    path
}
