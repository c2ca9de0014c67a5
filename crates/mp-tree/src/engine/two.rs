//! The loop with two trees, grown from the start and from the goal.

use super::core::joined;
use super::{
    Core, Extender, Grown, Inserter, Purpose, SearchTree, Selector, TargetSampler, Tree, TreePlannerParts,
};
use mp_cspace::{
    BuildError, Direction, Event, LocalPlanner, NodeId, Observer, PathOf, Planner, Problem, Progress, Rng,
    Space,
};

/// A planner that grows one tree from the start and one from the goal until they meet.
///
/// The first iteration tries a straight motion from the start to each listed goal state, unless one of the extenders
/// [declines](Extender::allows_direct). Each iteration then grows one tree toward a sampled target, and the other toward
/// the node that was added; the trees take turns, unless the larger one is to [wait](crate::Tuning::balance). Where they meet, the path is
/// verified. The goal tree has a root for each listed
/// goal state; where goals come from a sampler, a root is added with probability
/// [`goal_bias`](crate::Tuning::goal_bias) per iteration, and in every iteration until there is one. Stepping on after a
/// solution continues with the same trees.
#[derive(Debug)]
pub struct TwoTrees<'c, C: Space, L: LocalPlanner<C::State>, P, Se, GA, GB, A> {
    core: Core<'c, C, L>,
    trees: [SearchTree<C, L, Se, A>; 2],
    /// How many listed goal states were considered as roots, how many roots that gave, and to how many of those a straight
    /// motion from the start was tried.
    rooted: usize,
    roots: NodeId,
    tried: NodeId,
    target_sampler: P,
    explore: GA,
    join: GB,
    turn: usize,
    balance: f64,
}

impl<'c, C, L, P, Se, GA, GB, A> TwoTrees<'c, C, L, P, Se, GA, GB, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    GA: Extender<C, L>,
    GB: Extender<C, L>,
    A: Inserter<C, L>,
{
    /// A planner for a problem. `planner` is its name in errors.
    ///
    /// # Errors
    /// When a parameter is out of range, or there is no state to root the goal tree at.
    pub fn assemble(
        planner: &'static str,
        problem: Problem<'c, C, L>,
        parts: TreePlannerParts<P, Se, (GA, GB), A>,
    ) -> Result<Self, BuildError>
    where
        Se: Clone,
        A: Clone,
    {
        if !problem.goals().can_aim() {
            return Err(BuildError::NoGoalState { planner });
        }
        let forward = SearchTree::new(0, Direction::Forward, parts.selector.clone(), parts.inserter.clone());
        let backward = SearchTree::new(1, Direction::Backward, parts.selector, parts.inserter);
        Ok(Self {
            core: Core::new(problem, &parts.tuning)?,
            trees: [forward, backward],
            rooted: 0,
            roots: 0,
            tried: 0,
            target_sampler: parts.target_sampler,
            explore: parts.extender.0,
            join: parts.extender.1,
            turn: 0,
            balance: parts.tuning.checked_balance()?,
        })
    }

    /// The trees from the start and from the goal; empty before the first step.
    #[must_use]
    pub fn trees(&self) -> [&Tree<C::State, L::Edge>; 2] {
        [self.trees[0].nodes(), self.trees[1].nodes()]
    }

    /// Adds the roots and tries the straight motions to the goals. After a panic of the user's code the next step
    /// continues behind the motion that panicked.
    fn begin(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
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
        while self.explore.allows_direct() && self.join.allows_direct() && self.tried < self.roots {
            let goal_root = self.tried;
            self.tried += 1;
            let [forward, backward] = &mut self.trees;
            let goal = backward.nodes().state(goal_root);
            let grown = forward.connect_directly(0, goal, &mut self.core.checker, rng, observer);
            let Grown::Reached(id) = grown else { continue };
            if let Some(path) = self.candidate([id, goal_root], observer) {
                return Some(path);
            }
        }
        None
    }

    /// Which tree explores now: the one whose turn it is, or the other one while that is too small.
    fn next_turn(&mut self) -> usize {
        let size = |tree: usize| self.trees[tree].nodes().len() as f64;
        let other = self.turn ^ 1;
        let waits = self.balance > 0.0 && size(self.turn) > self.balance * size(other);
        let turn = if waits { other } else { self.turn };
        self.turn = turn ^ 1;
        turn
    }

    /// The path through two nodes with the same state, if it passes verification; otherwise the part from the failed edge
    /// on is pruned.
    fn candidate(
        &mut self,
        meeting: [NodeId; 2],
        observer: &mut dyn Observer<C::State>,
    ) -> Option<PathOf<C, L>> {
        for (tree, id) in self.trees.iter_mut().zip(meeting) {
            let direction = tree.nodes().direction();
            let pruned = |survivors: &[NodeId]| {
                self.explore.pruned(direction, survivors);
                self.join.pruned(direction, survivors);
            };
            if !tree.verify(id, &mut self.core.checker, observer, pruned) {
                return None;
            }
        }
        Some(joined([0, 1].map(|i| self.trees[i].nodes().path(meeting[i]))))
    }
}

impl<C, L, P, Se, GA, GB, A> Planner<C::State> for TwoTrees<'_, C, L, P, Se, GA, GB, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: TargetSampler<C>,
    Se: Selector<C>,
    GA: Extender<C, L>,
    GB: Extender<C, L>,
    A: Inserter<C, L>,
{
    type Edge = L::Edge;

    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.core.iterations += 1;
        if let Some(path) = self.begin(rng, observer) {
            return Some(path);
        }
        if self.core.goals.has_sampler() {
            self.core.sample_goal(&mut self.trees[1], rng, observer);
        }
        let turn = self.next_turn();
        let [forward, backward] = &mut self.trees;
        let (a, b) = if turn == 0 { (forward, backward) } else { (backward, forward) };
        let (points, selector) = a.parts();
        let target = self.target_sampler.next_target(rng, self.core.checker.space(), points, selector);
        observer.on(Event::Sampled(&target));
        let grown =
            a.toward(&target, Purpose::Explore, &mut self.core.checker, &mut self.explore, rng, observer);
        let (Grown::Advanced(i) | Grown::Reached(i)) = grown else { return None };
        let joined = b.toward(
            a.nodes().state(i),
            Purpose::Join,
            &mut self.core.checker,
            &mut self.join,
            rng,
            observer,
        );
        let Grown::Reached(j) = joined else { return None };
        self.candidate(if turn == 0 { [i, j] } else { [j, i] }, observer)
    }

    fn progress(&self) -> Progress {
        let nodes = self.trees.iter().map(|tree| tree.nodes().len()).sum();
        self.core.progress(nodes)
    }
}
