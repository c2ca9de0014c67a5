//! Slot: how a new motion joins the tree.

use super::{Selector, Tree};
use mp_cspace::{EdgeChecker, Hit, LocalPlanner, Motion, NodeId, Space};

/// What became of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Inserted {
    /// Its end is this new node, the last of the tree.
    New(NodeId),
    /// Its end is the state of this node, or one that counts as the same, which was there before:
    /// nothing was added.
    Known(NodeId),
}

/// Adds the end of a motion to a tree, under the node it came from or a better one.
///
/// Adds at most one node. The caller tells the selector of it afterwards.
pub trait Inserter<C: Space, L: LocalPlanner<C::State>> {
    /// Attaches `motion`, which leaves (in time: enters, in a backward tree) node `from`.
    fn attach<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        select: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted;
    /// The nodes that the last motion attached gave another parent, in the order in which it did.
    fn rewired(&self) -> &[NodeId] {
        &[]
    }
}

/// Under the node it came from. A motion that goes nowhere adds nothing.
///
/// That leaves no duplicates where nodes are chosen as the nearest to the target and motions come
/// nearer to it, as straight ones do: were the end in the tree already, it would have been
/// chosen. Where that does not hold use [`AppendDistinct`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Append;

impl<C: Space, L: LocalPlanner<C::State>> Inserter<C, L> for Append {
    #[inline]
    fn attach<Se: Selector<C>>(
        &mut self,
        _: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        _: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted {
        if motion.end == *tree.state(from) {
            return Inserted::Known(from);
        }
        Inserted::New(tree.push(from, motion))
    }
}

/// Under the node it came from, unless any node of the tree has that state already: for local
/// planners that can only make finitely many moves. Asks the index once per motion.
#[derive(Clone, Debug, Default)]
pub struct AppendDistinct {
    near: Vec<Hit>,
}

impl<C: Space, L: LocalPlanner<C::State>> Inserter<C, L> for AppendDistinct {
    fn attach<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        select: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted {
        select.near(checker.space(), tree.states(), &motion.end, 0.0, &mut self.near);
        match self.near.iter().find(|hit| *tree.state(hit.id) == motion.end) {
            Some(hit) => Inserted::Known(hit.id),
            None => Inserted::New(tree.push(from, motion)),
        }
    }
}
