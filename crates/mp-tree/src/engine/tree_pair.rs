//! Two trees that grow toward each other: what the loops with two trees share.

use super::core::joined;
use super::{Core, Grown, Inserter, SearchTree, Selector, Tuning};
use mp_cspace::{
    BuildError, Direction, LocalPlanner, NodeId, Observer, PathOf, Problem, Progress, Rng, Space,
};

/// A tree from the start and one from the goal, and which of them has the next turn.
#[derive(Debug)]
pub(crate) struct TreePair<'c, C: Space, L: LocalPlanner<C::State>, Se, A> {
    pub(crate) core: Core<'c, C, L>,
    pub(crate) trees: [SearchTree<C, L, Se, A>; 2],
    /// How many listed goal states were considered as roots, how many roots that gave, and to how many of
    /// those a straight motion from the start was tried.
    rooted: usize,
    roots: NodeId,
    tried: NodeId,
    turn: usize,
    balance: f64,
}

impl<'c, C, L, Se, A> TreePair<'c, C, L, Se, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    Se: Selector<C>,
    A: Inserter<C, L>,
{
    /// Two empty trees for a problem. `planner` is its name in errors.
    ///
    /// # Errors
    /// When a parameter is out of range, or there is no state to root the goal tree at.
    pub(crate) fn new(
        planner: &'static str,
        problem: Problem<'c, C, L>,
        tuning: &Tuning,
        (selector, inserter): (Se, A),
    ) -> Result<Self, BuildError>
    where
        Se: Clone,
        A: Clone,
    {
        if !problem.goals().can_aim() {
            return Err(BuildError::NoGoalState { planner });
        }
        let forward = SearchTree::new(0, Direction::Forward, selector.clone(), inserter.clone());
        let backward = SearchTree::new(1, Direction::Backward, selector, inserter);
        Ok(Self {
            core: Core::new(problem, tuning)?,
            trees: [forward, backward],
            rooted: 0,
            roots: 0,
            tried: 0,
            turn: 0,
            balance: tuning.checked_balance()?,
        })
    }

    /// Begins an iteration: adds the roots, tries the straight motions to the goals if it may, and adds a
    /// sampled goal as a root. After a panic of the user's code the next one continues behind the motion that
    /// panicked.
    pub(crate) fn begin(
        &mut self,
        may_connect: bool,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
        pruned: &mut dyn FnMut(Direction, &[NodeId]),
    ) -> Option<PathOf<C, L>> {
        self.core.iterations += 1;
        if let Some(root) = self.core.add_start(&mut self.trees[0], observer) {
            return Some(self.trees[0].nodes().path(root));
        }
        let space = self.core.checker.space();
        while let Some(goal) = self.core.goals.listed().get(self.rooted) {
            self.rooted += 1;
            if !self.trees[1].contains(space, goal) {
                self.trees[1].add_root(space, goal.clone(), observer);
            }
            self.roots = self.trees[1].nodes().len() as NodeId;
        }
        while may_connect && self.tried < self.roots {
            let goal_root = self.tried;
            self.tried += 1;
            let [forward, backward] = &mut self.trees;
            let goal = backward.nodes().state(goal_root);
            let grown = forward.connect_directly(0, goal, &mut self.core.checker, rng, observer);
            let Grown::Reached(id) = grown else { continue };
            if let Some(path) = self.candidate([id, goal_root], observer, pruned) {
                return Some(path);
            }
        }
        if self.core.goals.has_sampler() {
            self.core.sample_goal(&mut self.trees[1], rng, observer);
        }
        None
    }

    /// Which tree explores now: the one whose turn it is, or the other one while that is too small.
    pub(crate) fn next_turn(&mut self) -> usize {
        let size = |tree: usize| self.trees[tree].nodes().len() as f64;
        let other = self.turn ^ 1;
        let waits = self.balance > 0.0 && size(self.turn) > self.balance * size(other);
        let turn = if waits { other } else { self.turn };
        self.turn = turn ^ 1;
        turn
    }

    /// The path through two nodes with the same state, if it passes verification; otherwise the part from the
    /// failed edge on is pruned, and `pruned` is called with the direction of the tree, as by
    /// [`SearchTree::verify`].
    pub(crate) fn candidate(
        &mut self,
        meeting: [NodeId; 2],
        observer: &mut dyn Observer<C::State>,
        pruned: &mut dyn FnMut(Direction, &[NodeId]),
    ) -> Option<PathOf<C, L>> {
        for (tree, id) in self.trees.iter_mut().zip(meeting) {
            let direction = tree.nodes().direction();
            let mut pruned = |survivors: &[NodeId]| pruned(direction, survivors);
            if !tree.verify_and_tell(id, &mut self.core.checker, observer, &mut pruned) {
                return None;
            }
        }
        let [forward, backward] = &self.trees;
        Some(joined([forward.nodes().path(meeting[0]), backward.nodes().path(meeting[1])]))
    }

    pub(crate) fn progress(&self) -> Progress {
        let nodes = self.trees.iter().map(|tree| tree.nodes().len()).sum();
        self.core.progress(nodes)
    }
}
