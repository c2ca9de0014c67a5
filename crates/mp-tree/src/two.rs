//! The loop with two trees, grown from the start and from the goal.

use crate::{
    Attach, Branch, BuildError, Goals, Grown, Growth, Problem, Propose, Purpose, Recipe, Selector, Steer,
    Tree,
};
use mp_cspace::{
    Direction, Event, LocalPlanner, NodeId, Observer, Path, Planner, ProblemParts, Progress, Rng, Space,
};
use rand::RngExt;

/// A planner that grows one tree from the start and one from the goal until they meet.
///
/// The first iteration tries to go straight from the start to each listed goal state. Each one
/// then grows one tree toward a proposed target, and the other toward what was reached; the trees
/// take turns. Where they meet, the path is verified. The goal tree has a root for each listed
/// goal state; where goals come from a sampler, a root is added with probability
/// [`goal_bias`](crate::Tuning::goal_bias) per iteration, and in each one until there is any.
/// Stepping on after a solution grows the same trees on.
#[derive(Debug)]
pub struct TwoTrees<'c, C: Space, L: LocalPlanner<C::State>, P, Se, GA, GB, A> {
    start: C::State,
    /// How many listed goal states have been looked at, how many roots that gave, and how many of
    /// those have been tried straight from the start.
    planted: usize,
    roots: NodeId,
    tried: NodeId,
    goals: Goals<'c, C::State>,
    steer: Steer<'c, C, L>,
    trees: [Branch<C, L, Se, A>; 2],
    propose: P,
    explore: GA,
    join: GB,
    goal_bias: f64,
    turn: usize,
    iterations: u64,
}

impl<'c, C, L, P, Se, GA, GB, A> TwoTrees<'c, C, L, P, Se, GA, GB, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: Propose<C>,
    Se: Selector<C>,
    GA: Growth<C, L>,
    GB: Growth<C, L>,
    A: Attach<C, L>,
{
    /// The planner made by a recipe. `planner` names it in errors.
    ///
    /// # Errors
    /// When a parameter is out of range, or there is nothing to root the goal tree at.
    pub fn assemble(
        planner: &'static str,
        problem: Problem<'c, C, L>,
        recipe: Recipe<P, Se, (GA, GB), A>,
    ) -> Result<Self, BuildError>
    where
        Se: Clone,
        A: Clone,
    {
        if !problem.goals().can_aim() {
            return Err(BuildError::NoGoalState { planner });
        }
        let goal_bias = recipe.tuning.checked_bias()?;
        let forward = Branch::new(0, Direction::Forward, recipe.select.clone(), recipe.attach.clone());
        let backward = Branch::new(1, Direction::Backward, recipe.select, recipe.attach);
        let ProblemParts { space, local, verify, start, goals } = problem.into_parts();
        Ok(Self {
            steer: Steer::new(space, local, verify, &recipe.tuning)?,
            start,
            planted: 0,
            roots: 0,
            tried: 0,
            goals,
            trees: [forward, backward],
            propose: recipe.propose,
            explore: recipe.grow.0,
            join: recipe.grow.1,
            goal_bias,
            turn: 0,
            iterations: 0,
        })
    }

    /// The trees from the start and from the goal; empty before the first step.
    #[must_use]
    pub fn trees(&self) -> [&Tree<C::State, L::Edge>; 2] {
        [self.trees[0].tree(), self.trees[1].tree()]
    }

    /// Plants the roots and tries the straight way. What a panic of the user's code interrupts,
    /// the next step takes up behind the place.
    fn begin(
        &mut self,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Path<C::State, L::Edge>> {
        let space = self.steer.space();
        if self.trees[0].tree().is_empty() {
            let arrived = self.goals.reached(&self.start);
            let root = self.trees[0].add_root(space, self.start.clone(), observer);
            if arrived {
                return Some(self.trees[0].tree().path(root));
            }
        }
        while let Some(goal) = self.goals.listed().get(self.planted) {
            self.planted += 1;
            if !self.trees[1].knows(space, goal) {
                self.trees[1].add_root(space, goal.clone(), observer);
            }
            self.roots = self.trees[1].tree().len() as NodeId;
        }
        while self.tried < self.roots {
            let goal_root = self.tried;
            self.tried += 1;
            let [forward, backward] = &mut self.trees;
            let goal = backward.tree().state(goal_root);
            let grown = forward.leap(0, goal, &mut self.steer, rng, observer);
            let Grown::Reached(id) = grown else { continue };
            if let Some(path) = self.candidate([id, goal_root], observer) {
                return Some(path);
            }
        }
        None
    }

    /// Roots the goal tree at a new sample of the goal, now and then.
    fn sample_goal(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) {
        let wanted = self.trees[1].tree().is_empty() || rng.random_bool(self.goal_bias);
        if !wanted {
            return;
        }
        let space = self.steer.space();
        if let Some(goal) = self.goals.sample(rng)
            && !self.trees[1].knows(space, &goal)
            && self.steer.accepts(&goal)
        {
            self.trees[1].add_root(space, goal, observer);
        }
    }

    /// The path through two nodes with the same state, if it passes verification; otherwise its
    /// bad part is pruned.
    fn candidate(
        &mut self,
        meeting: [NodeId; 2],
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Path<C::State, L::Edge>> {
        for (tree, id) in self.trees.iter_mut().zip(meeting) {
            let direction = tree.tree().direction();
            let pruned = |survivors: &[NodeId]| {
                self.explore.pruned(direction, survivors);
                self.join.pruned(direction, survivors);
            };
            if !tree.verify(id, &mut self.steer, observer, pruned) {
                return None;
            }
        }
        let mut path = self.trees[0].tree().path(meeting[0]);
        let rest = self.trees[1].tree().path(meeting[1]);
        path.states.extend(rest.states.into_iter().skip(1));
        path.edges.extend(rest.edges);
        Some(path)
    }
}

impl<C, L, P, Se, GA, GB, A> Planner<C::State> for TwoTrees<'_, C, L, P, Se, GA, GB, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: Propose<C>,
    Se: Selector<C>,
    GA: Growth<C, L>,
    GB: Growth<C, L>,
    A: Attach<C, L>,
{
    type Edge = L::Edge;

    fn step(
        &mut self,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Path<C::State, L::Edge>> {
        self.iterations += 1;
        if let Some(path) = self.begin(rng, observer) {
            return Some(path);
        }
        if self.goals.has_sampler() {
            self.sample_goal(rng, observer);
        }
        let turn = self.turn;
        self.turn ^= 1;
        let [forward, backward] = &mut self.trees;
        let (a, b) = if turn == 0 { (forward, backward) } else { (backward, forward) };
        let (points, select) = a.parts();
        let target = self.propose.propose(rng, self.steer.space(), points, select);
        observer.on(Event::Sampled(&target));
        let grown = a.toward(&target, Purpose::Explore, &mut self.steer, &mut self.explore, rng, observer);
        let (Grown::Advanced(i) | Grown::Reached(i)) = grown else { return None };
        let joined =
            b.toward(a.tree().state(i), Purpose::Join, &mut self.steer, &mut self.join, rng, observer);
        let Grown::Reached(j) = joined else { return None };
        self.candidate(if turn == 0 { [i, j] } else { [j, i] }, observer)
    }

    fn progress(&self) -> Progress {
        let nodes = self.trees.iter().map(|branch| branch.tree().len()).sum();
        let mut progress = Progress::new(self.iterations, nodes, self.steer.motions());
        progress.rejected = self.steer.rejected();
        progress
    }
}
