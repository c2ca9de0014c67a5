//! One growing tree with its policies, and the loop body every planner of the family shares.

use super::{Extender, Grown, Inserted, Inserter, Purpose, Selector, Tree};
use crate::trace;
use mp_cspace::{
    Direction, EdgeChecker, Event, Extension, Hit, LocalPlanner, NodeId, Observer, Reach, Rng, Space,
};
use std::fmt;

/// A tree, the policies that belong to it, and its number in events.
#[derive(Clone, Debug)]
pub struct SearchTree<C: Space, L: LocalPlanner<C::State>, Se, A> {
    index: usize,
    tree: Tree<C::State, L::Edge>,
    selector: Se,
    inserter: A,
    candidates: Vec<Hit>,
}

impl<C: Space, L: LocalPlanner<C::State>, Se: Selector<C>, A: Inserter<C, L>> SearchTree<C, L, Se, A> {
    /// An empty tree. `index` is its number in events.
    pub fn new(index: usize, direction: Direction, selector: Se, inserter: A) -> Self {
        Self { index, tree: Tree::new(direction), selector, inserter, candidates: Vec::new() }
    }

    /// Its number in events.
    pub(crate) fn index(&self) -> usize {
        self.index
    }

    /// The nodes, with the edges to their parents.
    #[must_use]
    pub fn nodes(&self) -> &Tree<C::State, L::Edge> {
        &self.tree
    }

    /// Whether a node has exactly this state.
    #[must_use]
    pub fn contains(&self, space: &C, q: &C::State) -> bool {
        let mut near = Vec::new();
        self.selector.near(space, self.tree.states(), q, 0.0, &mut near);
        near.iter().any(|hit| self.tree.state(hit.id) == q)
    }

    /// Whether there are nodes, but the selector has none left to grow from.
    #[must_use]
    pub fn is_exhausted(&self) -> bool {
        !self.tree.is_empty() && self.selector.exhausted()
    }

    /// The states of all nodes, and the selector, to be used together.
    pub fn parts(&mut self) -> (&[C::State], &mut Se) {
        (self.tree.states(), &mut self.selector)
    }

    /// Adds a node without a parent: a start, or of a tree that grows backward a goal.
    pub fn add_root(&mut self, space: &C, state: C::State, observer: &mut dyn Observer<C::State>) -> NodeId {
        let id = self.tree.add_root(state);
        self.selector.inserted(space, self.tree.states(), id, None);
        observer.on(Event::Rooted { tree: self.index, id, state: self.tree.state(id), kind: None });
        id
    }

    /// Grows toward `target`: selects candidates and tries them in order until one grows.
    #[inline]
    pub fn toward<G: Extender<C, L>>(
        &mut self,
        target: &C::State,
        purpose: Purpose,
        checker: &mut EdgeChecker<'_, C, L>,
        extender: &mut G,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        self.selector.select(checker.space(), self.tree.states(), target, purpose, rng, &mut self.candidates);
        for i in 0..self.candidates.len() {
            let Hit { id, distance } = self.candidates[i];
            if distance == 0.0 && self.tree.state(id) == target {
                return Grown::Reached(id);
            }
            let grown = extender.extend(id, &mut self.growing(target, purpose, checker, rng, observer));
            let grew = grown != Grown::Trapped;
            self.selector.feedback(id, purpose, grew);
            if grew {
                return grown;
            }
            observer.on(Event::Blocked { from: self.tree.state(id), toward: target });
        }
        observer.on(Event::Trapped { tree: self.index });
        Grown::Trapped
    }

    /// The selector, which chooses from which nodes the tree grows.
    #[must_use]
    pub fn selector(&self) -> &Se {
        &self.selector
    }

    /// Grows from node `from` toward `target`, without the selector.
    pub fn grow_from<G: Extender<C, L>>(
        &mut self,
        from: NodeId,
        target: &C::State,
        checker: &mut EdgeChecker<'_, C, L>,
        extender: &mut G,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        if self.tree.state(from) == target {
            return Grown::Reached(from);
        }
        let grown =
            extender.extend(from, &mut self.growing(target, Purpose::Explore, checker, rng, observer));
        if grown == Grown::Trapped {
            observer.on(Event::Blocked { from: self.tree.state(from), toward: target });
            observer.on(Event::Trapped { tree: self.index });
        }
        grown
    }

    /// Tries one motion of any length from node `from` to `target`.
    pub fn connect_directly(
        &mut self,
        from: NodeId,
        target: &C::State,
        checker: &mut EdgeChecker<'_, C, L>,
        rng: &mut Rng,
        observer: &mut dyn Observer<C::State>,
    ) -> Grown {
        if self.tree.state(from) == target {
            return Grown::Reached(from);
        }
        let extension = checker.extend(self.tree.state(from), target, self.tree.direction(), Reach::Full);
        self.growing(target, Purpose::Join, checker, rng, observer).insert(from, extension)
    }

    /// Verifies the path between a root and `id`, edge by edge from the root; each edge is verified once.
    /// `false` when an edge fails: the subtree below it is pruned (unless the checker was interrupted), and
    /// `pruned` is called with the former ids of the remaining nodes, before observers are.
    pub fn verify(
        &mut self,
        id: NodeId,
        checker: &mut EdgeChecker<'_, C, L>,
        observer: &mut dyn Observer<C::State>,
        mut pruned: impl FnMut(&[NodeId]),
    ) -> bool {
        self.verify_and_tell(id, checker, observer, &mut pruned)
    }

    /// As [`verify`](Self::verify): compiled once for all closures.
    pub(super) fn verify_and_tell(
        &mut self,
        id: NodeId,
        checker: &mut EdgeChecker<'_, C, L>,
        observer: &mut dyn Observer<C::State>,
        pruned: &mut dyn FnMut(&[NodeId]),
    ) -> bool {
        for &node in self.tree.doubtful(id).iter().rev() {
            if self.passes(node, checker) {
                self.tree.set_verified(node);
                continue;
            }
            if checker.interrupt().raised().is_some() {
                return false;
            }
            checker.count_rejected();
            let before = self.tree.len();
            let survivors = self.tree.prune(node);
            trace::pruned(self.index, before, survivors.len());
            self.selector.pruned(checker.space(), self.tree.states(), &survivors);
            pruned(&survivors);
            observer.on(Event::Rejected);
            observer.on(Event::Pruned { tree: self.index, survivors: &survivors });
            return false;
        }
        true
    }

    /// Whether the verifier passes the edge between a node and its parent.
    fn passes(&self, id: NodeId, checker: &mut EdgeChecker<'_, C, L>) -> bool {
        let tree = &self.tree;
        let (Some(parent), Some(edge)) = (tree.parent(id), tree.edge(id)) else { return true };
        checker.passes(tree.state(parent), edge, tree.state(id), tree.direction())
    }

    fn growing<'a, 'c>(
        &'a mut self,
        target: &'a C::State,
        purpose: Purpose,
        checker: &'a mut EdgeChecker<'c, C, L>,
        rng: &'a mut Rng,
        observer: &'a mut dyn Observer<C::State>,
    ) -> Growing<'a, 'c, C, L, Se, A> {
        Growing {
            index: self.index,
            tree: &mut self.tree,
            selector: &mut self.selector,
            inserter: &mut self.inserter,
            target,
            purpose,
            checker,
            rng,
            observer,
        }
    }
}

/// A tree that is growing toward a target: what an [`Extender`] works with.
pub struct Growing<'a, 'c, C: Space, L: LocalPlanner<C::State>, Se, A> {
    index: usize,
    tree: &'a mut Tree<C::State, L::Edge>,
    selector: &'a mut Se,
    inserter: &'a mut A,
    target: &'a C::State,
    purpose: Purpose,
    checker: &'a mut EdgeChecker<'c, C, L>,
    rng: &'a mut Rng,
    observer: &'a mut dyn Observer<C::State>,
}

impl<'c, C: Space, L: LocalPlanner<C::State>, Se: Selector<C>, A: Inserter<C, L>>
    Growing<'_, 'c, C, L, Se, A>
{
    /// The state the tree grows toward.
    #[must_use]
    pub fn target(&self) -> &C::State {
        self.target
    }

    /// Why the tree grows; [`Explore`](Purpose::Explore) where the selector was not used.
    #[must_use]
    pub fn purpose(&self) -> Purpose {
        self.purpose
    }

    /// The nodes that the tree has so far.
    #[must_use]
    pub fn tree(&self) -> &Tree<C::State, L::Edge> {
        self.tree
    }

    /// Makes and verifies motions.
    pub fn checker(&mut self) -> &mut EdgeChecker<'c, C, L> {
        self.checker
    }

    /// The selector, which chooses from which nodes the tree grows.
    pub fn selector(&self) -> &Se {
        self.selector
    }

    /// The random numbers.
    pub fn rng(&mut self) -> &mut Rng {
        self.rng
    }

    /// The distance from a node to the target.
    #[must_use]
    pub fn distance(&self, from: NodeId) -> f64 {
        self.checker.space().distance(self.tree.state(from), self.target)
    }

    /// Moves one step from a node toward the target and inserts the end.
    #[inline]
    pub fn step(&mut self, from: NodeId) -> Grown {
        self.step_toward(from, self.target)
    }

    /// Moves one step from a node toward any state and inserts the end.
    #[inline]
    pub fn step_toward(&mut self, from: NodeId, toward: &C::State) -> Grown {
        let reach = Reach::Step(self.checker.step());
        let extension = self.checker.extend(self.tree.state(from), toward, self.tree.direction(), reach);
        self.insert(from, extension)
    }

    /// Inserts the end of an extension from a node, unless there is a node with that state already.
    #[inline]
    pub fn insert(&mut self, from: NodeId, extension: Extension<C::State, L::Edge>) -> Grown {
        let reached = matches!(extension, Extension::Reached(_));
        let (Extension::Advanced(motion) | Extension::Reached(motion)) = extension else {
            return Grown::Trapped;
        };
        let distrusts = self.checker.distrusts();
        if distrusts {
            let (origin, direction) = (self.tree.state(from), self.tree.direction());
            if !self.checker.passes(origin, &motion.edge, &motion.end, direction) {
                return Grown::Trapped;
            }
        }
        match self.inserter.insert(self.checker, self.tree, self.selector, from, motion) {
            Inserted::Known(id) if reached && self.tree.state(id) == self.target => Grown::Reached(id),
            Inserted::Known(_) => Grown::Trapped,
            Inserted::New(id) => {
                let parent = self.tree.parent(id);
                if distrusts && parent == Some(from) {
                    self.tree.set_verified(id);
                }
                self.selector.inserted(self.checker.space(), self.tree.states(), id, parent);
                let (tree, state) = (self.index, self.tree.state(id));
                let (parent, through) = (parent.unwrap_or(from), bends(self.checker, self.tree, id));
                self.observer.on(Event::Added { tree, id, parent, state, through });
                for &id in self.inserter.rewired() {
                    let Some(parent) = self.tree.parent(id) else { continue };
                    let through = bends(self.checker, self.tree, id);
                    self.observer.on(Event::Rewired { tree, id, parent, through });
                }
                if reached { Grown::Reached(id) } else { Grown::Advanced(id) }
            }
        }
    }
}

/// The states at which the edge between a node and its parent bends, in forward time.
fn bends<'t, C: Space, L: LocalPlanner<C::State>>(
    checker: &EdgeChecker<'_, C, L>,
    tree: &'t Tree<C::State, L::Edge>,
    id: NodeId,
) -> &'t [C::State] {
    tree.edge(id).map_or(&[], |edge| checker.vertices(edge))
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
