//! The loop with one tree, grown from the start.

use crate::{
    Attach, Branch, BuildError, Goals, Grown, Growth, Problem, Propose, Purpose, Recipe, Selector, Steer,
    Tree,
};
use mp_cspace::{
    Direction, Event, LocalPlanner, NodeId, Observer, Path, Planner, ProblemParts, Progress, Rng, Space,
};
use rand::RngExt;

/// A planner that grows one tree from the start until it enters the goal.
///
/// The first iteration tries to go straight from the start to each listed goal state. Each one
/// then proposes a target (with probability [`goal_bias`](crate::Tuning::goal_bias) a goal),
/// grows the tree toward it, and verifies the path to what entered the goal. Stepping on after a
/// solution grows the same tree on; the same path may be found again.
#[derive(Debug)]
pub struct SingleTree<'c, C: Space, L: LocalPlanner<C::State>, P, Se, G, A> {
    start: C::State,
    /// How many listed goal states have been tried straight from the start.
    tried: usize,
    goals: Goals<'c, C::State>,
    steer: Steer<'c, C, L>,
    branch: Branch<C, L, Se, A>,
    propose: P,
    growth: G,
    goal_bias: f64,
    iterations: u64,
}

/// A tree, how it moves and how it grows.
type Parts<'a, 'c, C, L, G> = (
    &'a Tree<<C as Space>::State, <L as LocalPlanner<<C as Space>::State>>::Edge>,
    &'a mut Steer<'c, C, L>,
    &'a mut G,
);

impl<'c, C, L, P, Se, G, A> SingleTree<'c, C, L, P, Se, G, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: Propose<C>,
    Se: Selector<C>,
    G: Growth<C, L>,
    A: Attach<C, L>,
{
    /// The planner made by a recipe.
    ///
    /// # Errors
    /// When a parameter is out of range.
    pub fn assemble(problem: Problem<'c, C, L>, recipe: Recipe<P, Se, G, A>) -> Result<Self, BuildError> {
        let goal_bias = recipe.tuning.checked_bias()?;
        let ProblemParts { space, local, verify, start, goals } = problem.into_parts();
        Ok(Self {
            steer: Steer::new(space, local, verify, &recipe.tuning)?,
            start,
            tried: 0,
            goal_bias: if goals.can_aim() { goal_bias } else { 0.0 },
            goals,
            branch: Branch::new(0, Direction::Forward, recipe.select, recipe.attach),
            propose: recipe.propose,
            growth: recipe.grow,
            iterations: 0,
        })
    }

    /// The tree; empty before the first step.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.branch.tree()
    }

    /// How it grows.
    pub(crate) fn growth(&self) -> &G {
        &self.growth
    }

    /// The tree, how it moves and how it grows.
    pub(crate) fn parts(&mut self) -> Parts<'_, 'c, C, L, G> {
        (self.branch.tree(), &mut self.steer, &mut self.growth)
    }

    /// Plants the root and tries the straight way. What a panic of the user's code interrupts, the
    /// next step takes up behind the place.
    fn begin(
        &mut self,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Path<C::State, L::Edge>> {
        if self.branch.tree().is_empty() {
            let arrived = self.goals.reached(&self.start);
            let root = self.branch.add_root(self.steer.space(), self.start.clone(), observer);
            if arrived {
                return self.candidate(root, observer);
            }
        }
        while let Some(goal) = self.goals.listed().get(self.tried) {
            self.tried += 1;
            let grown = self.branch.leap(0, goal, &mut self.steer, rng, observer);
            let Grown::Reached(id) = grown else { continue };
            if let Some(path) = self.candidate(id, observer) {
                return Some(path);
            }
        }
        None
    }

    /// Grows toward `target`, which is a goal when the purpose is to join.
    fn grow(
        &mut self,
        target: &C::State,
        why: Purpose,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Path<C::State, L::Edge>> {
        observer.on(Event::Sampled(target));
        let before = self.branch.tree().len();
        let grown = self.branch.toward(target, why, &mut self.steer, &mut self.growth, rng, observer);
        if let (Purpose::Join, Grown::Reached(id)) = (why, grown) {
            return self.candidate(id, observer);
        }
        if self.goals.has_region() {
            let mut new = before as NodeId..self.branch.tree().len() as NodeId;
            let entered = new.find(|&id| self.goals.reached(self.branch.tree().state(id)))?;
            return self.candidate(entered, observer);
        }
        None
    }

    /// The path to `id` if it passes verification; otherwise its bad part is pruned.
    fn candidate(
        &mut self,
        id: NodeId,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<Path<C::State, L::Edge>> {
        let pruned = |survivors: &[NodeId]| self.growth.pruned(Direction::Forward, survivors);
        let passed = self.branch.verify(id, &mut self.steer, observer, pruned);
        passed.then(|| self.branch.tree().path(id))
    }
}

impl<C, L, P, Se, G, A> Planner<C::State> for SingleTree<'_, C, L, P, Se, G, A>
where
    C: Space,
    L: LocalPlanner<C::State>,
    P: Propose<C>,
    Se: Selector<C>,
    G: Growth<C, L>,
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
        if self.goal_bias > 0.0
            && rng.random_bool(self.goal_bias)
            && let Some(goal) = self.goals.aim(rng)
        {
            return self.grow(&goal, Purpose::Join, rng, observer);
        }
        let (points, select) = self.branch.parts();
        let target = self.propose.propose(rng, self.steer.space(), points, select);
        self.grow(&target, Purpose::Explore, rng, observer)
    }

    fn progress(&self) -> Progress {
        let nodes = self.branch.tree().len();
        let mut progress = Progress::new(self.iterations, nodes, self.steer.motions());
        progress.rejected = self.steer.rejected();
        progress.exhausted = self.branch.is_exhausted();
        progress
    }
}
