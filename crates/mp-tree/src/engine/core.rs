//! What the loops have in common: the ends of the path, the straight motion between them, verified paths.

use super::{Grown, Inserter, SearchTree, Selector, Tuning};
use mp_cspace::{
    BuildError, EdgeChecker, Goals, LocalPlanner, NodeId, Observer, Path, PathOf, Problem, Progress, Rng,
    Space,
};
use rand::RngExt;

/// What a planner of the family has beside its trees: the ends of the problem, the edge checker, and
/// counters. The loops of this crate use it, and yours may.
#[derive(Debug)]
pub struct Core<'c, C: Space, L: LocalPlanner<C::State>> {
    /// Where paths begin.
    pub start: C::State,
    /// Where they end.
    pub goals: Goals<'c, C::State>,
    /// Makes and verifies the edges of the trees.
    pub checker: EdgeChecker<'c, C, L>,
    /// The probability of aiming at a goal; zero where there is no goal state to aim at.
    pub goal_bias: f64,
    /// Iterations so far.
    pub iterations: u64,
    /// How many listed goal states have been tried straight from the start.
    tried: usize,
}

impl<'c, C: Space, L: LocalPlanner<C::State>> Core<'c, C, L> {
    /// The core of a planner for a problem.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn new(problem: Problem<'c, C, L>, tuning: &Tuning) -> Result<Self, BuildError> {
        let goal_bias = tuning.checked_bias()?;
        let step = tuning.step.step_in(problem.space())?;
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

    /// As [`new`](Self::new), for planners that look for the path that costs least by the objective of the
    /// problem.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn optimising(mut problem: Problem<'c, C, L>, tuning: &Tuning) -> Result<Self, BuildError> {
        let objective = problem.take_objective();
        let core = Self::new(problem, tuning)?;
        Ok(Self { checker: core.checker.with_objective(objective), ..core })
    }

    /// Adds the start as the root of the first tree, if the tree is empty. Returns the root if it is in the
    /// goal.
    pub fn add_start<Se: Selector<C>, A: Inserter<C, L>>(
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

    /// Tries one motion of any length from the start to the next listed goal state; `None` when all have been
    /// tried. A motion that a panic of the user's code interrupts is not tried again.
    pub fn connect_directly<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        tree: &mut SearchTree<C, L, Se, A>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Grown> {
        let goal = self.goals.listed().get(self.tried)?;
        self.tried += 1;
        Some(tree.connect_directly(0, goal, &mut self.checker, rng, observer))
    }

    /// A goal to aim at instead of exploring, with probability `goal_bias`; none where the sample is outside of the space.
    pub fn aim(&mut self, rng: &mut Rng) -> Option<C::State> {
        let aims = self.goal_bias > 0.0 && rng.random_bool(self.goal_bias);
        let goal = if aims { self.goals.aim(rng) } else { None };
        goal.filter(|goal| self.checker.space().contains(goal))
    }

    /// Adds a new sample of the goal as a root of the tree from the goal: with probability `goal_bias`, and
    /// always where the tree is empty.
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
            && !tree.contains(space, &goal)
            && self.checker.accepts(&goal)
        {
            tree.add_root(space, goal, observer);
        }
    }

    /// The path from the root to `id`, if it passes verification. Otherwise the part from the failed edge on
    /// is pruned, and `pruned` is called as by [`SearchTree::verify`].
    pub fn path<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        tree: &mut SearchTree<C, L, Se, A>,
        id: NodeId,
        observer: &mut dyn Observer<C::State>,
        pruned: impl FnMut(&[NodeId]),
    ) -> Option<PathOf<C, L>> {
        let passed = tree.verify(id, &mut self.checker, observer, pruned);
        passed.then(|| tree.nodes().path(id))
    }

    /// The progress of a planner whose trees have this many nodes.
    #[must_use]
    pub fn progress(&self, nodes: usize) -> Progress {
        let mut progress = Progress::new(self.iterations, nodes, self.checker.motions());
        progress.rejected = self.checker.rejected();
        progress
    }
}

/// The path through two nodes with the same state, one of a tree from the start and one of a tree from the
/// goal.
pub(crate) fn joined<S, E>([mut path, rest]: [Path<S, E>; 2]) -> Path<S, E> {
    path.states.extend(rest.states.into_iter().skip(1));
    path.edges.extend(rest.edges);
    path
}
