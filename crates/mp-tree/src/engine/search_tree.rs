//! One growing tree with its policies, and the loop body every planner of the family shares.

use super::{Extender, Grown, Inserted, Inserter, Purpose, Selector, Tree, Tuning};
use mp_cspace::{
    BuildError, Direction, Event, Extension, Hit, LocalPlanner, Motion, MotionCheck, NodeId, Observer, Reach,
    Rng, Space, Verify,
};
use std::fmt;

/// How trees move: the space, the local planner, the step; and the verifier of what they find.
pub struct TreeEdgeChecker<'c, C: Space, L: LocalPlanner<C::State>> {
    space: &'c C,
    local: L,
    verify: Box<dyn Verify<C::State, L::Edge> + Send + 'c>,
    step: f64,
    patience: u64,
    motions: u64,
    rejected: u64,
}

impl<'c, C: Space, L: LocalPlanner<C::State>> TreeEdgeChecker<'c, C, L> {
    /// To move in `space` by `local`.
    ///
    /// # Errors
    /// When the step is out of range.
    pub fn new(
        space: &'c C,
        local: L,
        verify: Box<dyn Verify<C::State, L::Edge> + Send + 'c>,
        tuning: &Tuning,
    ) -> Result<Self, BuildError> {
        let step = tuning.step.length_in(space)?;
        Ok(Self { space, local, verify, step, patience: tuning.patience, motions: 0, rejected: 0 })
    }

    /// The space.
    #[must_use]
    pub fn space(&self) -> &'c C {
        self.space
    }

    /// The longest step, in the metric of the space.
    #[must_use]
    pub fn step(&self) -> f64 {
        self.step
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

    /// Candidate paths rejected by the verifier so far.
    #[must_use]
    pub fn rejected(&self) -> u64 {
        self.rejected
    }

    /// Asks the local planner for a motion, and counts it.
    #[inline]
    pub fn extend(
        &mut self,
        from: &C::State,
        toward: &C::State,
        direction: Direction,
        reach: Reach,
    ) -> Extension<C::State, L::Edge> {
        self.motions += 1;
        self.local.extend(from, toward, direction, reach)
    }

    /// Whether a state is a possible end of a path: contained, verified, admitted.
    pub fn accepts(&mut self, q: &C::State) -> bool {
        self.space.contains(q) && self.local.admits(q) && self.verify.verify_state(q).is_free()
    }

    /// Whether the local planner's check has let through so much that each new edge is verified.
    #[inline]
    #[must_use]
    pub fn distrusts(&self) -> bool {
        self.rejected >= self.patience
    }

    /// Whether the verifier passes a motion in forward time.
    pub fn passes(&mut self, from: &C::State, edge: &L::Edge, to: &C::State) -> bool {
        self.verify.verify_edge(from, edge, to).is_free()
    }

    fn verify_edge(&mut self, tree: &Tree<C::State, L::Edge>, id: NodeId) -> MotionCheck {
        let (Some(parent), Some(edge)) = (tree.parent(id), tree.edge(id)) else {
            return self.verify.verify_state(tree.state(id));
        };
        self.verify_motion(tree, parent, edge, tree.state(id))
    }

    fn verify_motion(
        &mut self,
        tree: &Tree<C::State, L::Edge>,
        parent: NodeId,
        edge: &L::Edge,
        end: &C::State,
    ) -> MotionCheck {
        match tree.direction() {
            Direction::Forward => self.verify.verify_edge(tree.state(parent), edge, end),
            Direction::Backward => self.verify.verify_edge(end, edge, tree.state(parent)),
        }
    }

    /// The whole motion from `from`, a node or about to be one, to `to`, if the local planner has
    /// one. Once the local planner is [no longer believed](TreeEdgeChecker::distrusts) it is verified too.
    pub fn reach(
        &mut self,
        from: &C::State,
        to: &C::State,
        direction: Direction,
    ) -> Option<Motion<C::State, L::Edge>> {
        let Extension::Reached(motion) = self.extend(from, to, direction, Reach::Full) else { return None };
        if self.distrusts() {
            let (a, b) = if direction == Direction::Forward { (from, to) } else { (to, from) };
            if !self.verify.verify_edge(a, &motion.edge, b).is_free() {
                return None;
            }
        }
        Some(motion)
    }
}

impl<C: Space + fmt::Debug, L: LocalPlanner<C::State> + fmt::Debug> fmt::Debug for TreeEdgeChecker<'_, C, L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TreeEdgeChecker")
            .field("space", &self.space)
            .field("local", &self.local)
            .field("step", &self.step)
            .field("patience", &self.patience)
            .field("motions", &self.motions)
            .field("rejected", &self.rejected)
            .finish_non_exhaustive()
    }
}

/// A tree, the policies that belong to it, and its number in events.
#[derive(Clone, Debug)]
pub struct SearchTree<C: Space, L: LocalPlanner<C::State>, Se, A> {
    index: usize,
    tree: Tree<C::State, L::Edge>,
    select: Se,
    attach: A,
    candidates: Vec<Hit>,
}

impl<C: Space, L: LocalPlanner<C::State>, Se: Selector<C>, A: Inserter<C, L>> SearchTree<C, L, Se, A> {
    /// An empty tree. `index` is its number in events.
    pub fn new(index: usize, direction: Direction, select: Se, attach: A) -> Self {
        Self { index, tree: Tree::new(direction), select, attach, candidates: Vec::new() }
    }

    /// The tree.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        &self.tree
    }

    /// Whether some node has this very state.
    #[must_use]
    pub fn knows(&self, space: &C, q: &C::State) -> bool {
        let mut near = Vec::new();
        self.select.near(space, self.tree.states(), q, 0.0, &mut near);
        near.iter().any(|hit| self.tree.state(hit.id) == q)
    }

    /// Whether there are nodes and the selector has none left to grow from.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        !self.tree.is_empty() && self.select.exhausted()
    }

    /// The states of the tree and its selector.
    pub fn parts(&mut self) -> (&[C::State], &mut Se) {
        (self.tree.states(), &mut self.select)
    }

    /// Adds a root.
    pub fn add_root(&mut self, space: &C, state: C::State, observer: &mut dyn Observer<C::State>) -> NodeId {
        let id = self.tree.add_root(state);
        self.select.inserted(space, self.tree.states(), id, None);
        observer.on(Event::Rooted { tree: self.index, id, state: self.tree.state(id) });
        id
    }

    /// Grows toward `target`: selects candidates, tries them in order until one grows.
    #[inline]
    pub fn toward<G: Extender<C, L>>(
        &mut self,
        target: &C::State,
        why: Purpose,
        steer: &mut TreeEdgeChecker<'_, C, L>,
        growth: &mut G,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        self.select.select(steer.space, self.tree.states(), target, why, rng, &mut self.candidates);
        for i in 0..self.candidates.len() {
            let Hit { id, distance } = self.candidates[i];
            if distance == 0.0 && self.tree.state(id) == target {
                return Grown::Reached(id);
            }
            let grown = growth.grow(id, &mut self.growing(target, why, steer, rng, observer));
            let grew = grown != Grown::Trapped;
            self.select.feedback(id, why, grew);
            if grew {
                return grown;
            }
        }
        observer.on(Event::Trapped { tree: self.index });
        Grown::Trapped
    }

    /// The selector.
    #[must_use]
    pub fn selector(&self) -> &Se {
        &self.select
    }

    /// Grows from node `from` toward `target`, whatever the selector would choose.
    pub fn grow_from<G: Extender<C, L>>(
        &mut self,
        from: NodeId,
        target: &C::State,
        steer: &mut TreeEdgeChecker<'_, C, L>,
        growth: &mut G,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        if self.tree.state(from) == target {
            return Grown::Reached(from);
        }
        let grown = growth.grow(from, &mut self.growing(target, Purpose::Explore, steer, rng, observer));
        if grown == Grown::Trapped {
            observer.on(Event::Trapped { tree: self.index });
        }
        grown
    }

    /// Tries to go from node `from` to `target` in one motion of any length.
    pub fn leap(
        &mut self,
        from: NodeId,
        target: &C::State,
        steer: &mut TreeEdgeChecker<'_, C, L>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        if self.tree.state(from) == target {
            return Grown::Reached(from);
        }
        let extension = steer.extend(self.tree.state(from), target, self.tree.direction(), Reach::Full);
        self.growing(target, Purpose::Join, steer, rng, observer).settle(from, extension)
    }

    /// Verifies the path between a root and `id`, edge by edge from the root; edges that passed
    /// before are not asked again. `false` when an edge fails: what hangs on it is pruned, and
    /// `pruned` is given the former ids of the nodes that remain before anybody else hears of it.
    pub fn verify(
        &mut self,
        id: NodeId,
        steer: &mut TreeEdgeChecker<'_, C, L>,
        observer: &mut dyn Observer<C::State>,
        mut pruned: impl FnMut(&[NodeId]),
    ) -> bool {
        let doubtful: Vec<NodeId> =
            self.tree.lineage(id).filter(|&node| !self.tree.is_verified(node)).collect();
        for &node in doubtful.iter().rev() {
            if steer.verify_edge(&self.tree, node).is_free() {
                self.tree.set_verified(node);
                continue;
            }
            steer.rejected += 1;
            let survivors = self.tree.prune(node);
            self.select.pruned(steer.space, self.tree.states(), &survivors);
            pruned(&survivors);
            observer.on(Event::Rejected);
            observer.on(Event::Pruned { tree: self.index, survivors: &survivors });
            return false;
        }
        true
    }

    fn growing<'a, 'c>(
        &'a mut self,
        target: &'a C::State,
        why: Purpose,
        steer: &'a mut TreeEdgeChecker<'c, C, L>,
        rng: &'a mut Rng,
        observer: &'a mut dyn Observer<C::State>,
    ) -> Growing<'a, 'c, C, L, Se, A> {
        Growing {
            index: self.index,
            tree: &mut self.tree,
            select: &mut self.select,
            attach: &mut self.attach,
            target,
            why,
            steer,
            rng,
            observer,
        }
    }
}

/// A tree in the act of growing toward a target: what a [`Extender`] works with.
pub struct Growing<'a, 'c, C: Space, L: LocalPlanner<C::State>, Se, A> {
    index: usize,
    tree: &'a mut Tree<C::State, L::Edge>,
    select: &'a mut Se,
    attach: &'a mut A,
    target: &'a C::State,
    why: Purpose,
    steer: &'a mut TreeEdgeChecker<'c, C, L>,
    rng: &'a mut Rng,
    observer: &'a mut dyn Observer<C::State>,
}

impl<'c, C: Space, L: LocalPlanner<C::State>, Se: Selector<C>, A: Inserter<C, L>>
    Growing<'_, 'c, C, L, Se, A>
{
    /// What the tree grows toward.
    #[must_use]
    pub fn target(&self) -> &C::State {
        self.target
    }

    /// Why it grows: to explore, where the selector was not asked.
    #[must_use]
    pub fn purpose(&self) -> Purpose {
        self.why
    }

    /// The tree.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.tree
    }

    /// The local planner and its settings.
    pub fn steer(&mut self) -> &mut TreeEdgeChecker<'c, C, L> {
        self.steer
    }

    /// The selector.
    pub fn selector(&self) -> &Se {
        self.select
    }

    /// The random numbers.
    pub fn rng(&mut self) -> &mut Rng {
        self.rng
    }

    /// The distance from a node to the target.
    #[must_use]
    pub fn distance(&self, from: NodeId) -> f64 {
        self.steer.space.distance(self.tree.state(from), self.target)
    }

    /// Moves one step from a node toward the target and adds where it ends.
    #[inline]
    pub fn step(&mut self, from: NodeId) -> Grown {
        self.step_toward(from, self.target)
    }

    /// Moves one step from a node toward any state and adds where it ends.
    #[inline]
    pub fn step_toward(&mut self, from: NodeId, toward: &C::State) -> Grown {
        let reach = Reach::Step(self.steer.step);
        let extension = self.steer.extend(self.tree.state(from), toward, self.tree.direction(), reach);
        self.settle(from, extension)
    }

    /// Adds the end of an extension from a node, unless it leads to a node that exists already.
    #[inline]
    pub fn settle(&mut self, from: NodeId, extension: Extension<C::State, L::Edge>) -> Grown {
        let reached = matches!(extension, Extension::Reached(_));
        let (Extension::Advanced(motion) | Extension::Reached(motion)) = extension else {
            return Grown::Trapped;
        };
        let distrusts = self.steer.distrusts();
        if distrusts && !self.steer.verify_motion(self.tree, from, &motion.edge, &motion.end).is_free() {
            return Grown::Trapped;
        }
        match self.attach.attach(self.steer, self.tree, self.select, from, motion) {
            Inserted::Known(id) if reached && self.tree.state(id) == self.target => Grown::Reached(id),
            Inserted::Known(_) => Grown::Trapped,
            Inserted::New(id) => {
                let parent = self.tree.parent(id);
                if distrusts && parent == Some(from) {
                    self.tree.set_verified(id);
                }
                self.select.inserted(self.steer.space, self.tree.states(), id, parent);
                let (tree, state) = (self.index, self.tree.state(id));
                self.observer.on(Event::Added { tree, id, parent: parent.unwrap_or(from), state });
                for &id in self.attach.rewired() {
                    let Some(parent) = self.tree.parent(id) else { continue };
                    self.observer.on(Event::Rewired { tree, id, parent });
                }
                if reached { Grown::Reached(id) } else { Grown::Advanced(id) }
            }
        }
    }
}

impl<C: Space, L: LocalPlanner<C::State>, Se, A> fmt::Debug for Growing<'_, '_, C, L, Se, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Growing")
            .field("tree", &self.index)
            .field("nodes", &self.tree.len())
            .field("target", &self.target)
            .finish_non_exhaustive()
    }
}
