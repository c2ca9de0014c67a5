//! Slot: how a new motion joins the tree.

use super::{Selector, Tree};
use mp_cspace::{BuildError, EdgeChecker, Hit, LocalPlanner, Motion, NodeId, Space};

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
    fn insert<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        selector: &mut Se,
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
    fn insert<Se: Selector<C>>(
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
    fn insert<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        selector: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted {
        selector.near(checker.space(), tree.states(), &motion.end, 0.0, &mut self.near);
        match self.near.iter().find(|hit| *tree.state(hit.id) == motion.end) {
            Some(hit) => Inserted::Known(hit.id),
            None => Inserted::New(tree.push(from, motion)),
        }
    }
}

/// Under the node it came from, unless another node of the tree is there already: up to rounding, or
/// within a radius.
///
/// For motions by finitely many inputs: one way and back again, or the same two in another order,
/// leads to the same state but for rounding, and *similar* states must not be stacked on each other
/// (Jouandeau, Touati and Ali Cherif 2008, §2.3). Asks the index once per motion.
#[derive(Clone, Debug, Default)]
pub struct AppendApart {
    radius: Option<f64>,
    near: Vec<Hit>,
}

impl AppendApart {
    /// Takes states no farther apart than `radius`, in the metric of the space, for the same.
    ///
    /// # Errors
    /// When it is negative or not finite.
    pub fn within(radius: f64) -> Result<Self, BuildError> {
        if radius >= 0.0 && radius.is_finite() {
            return Ok(Self { radius: Some(radius), near: Vec::new() });
        }
        let range = "not negative and finite, a distance".to_owned();
        Err(BuildError::OutOfRange { name: "apart", value: radius, range })
    }
}

/// States this part of the extent of the space apart, or less, are similar.
const SIMILAR: f64 = 1e-9;

impl<C: Space, L: LocalPlanner<C::State>> Inserter<C, L> for AppendApart {
    fn insert<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        selector: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted {
        let radius = self.radius.unwrap_or(SIMILAR * checker.space().extent());
        selector.near(checker.space(), tree.states(), &motion.end, radius, &mut self.near);
        let same = |hit: &&Hit| *tree.state(hit.id) == motion.end;
        // A motion to a state similar to where it began is as short as it is meant to be.
        let similar = |hit: &&Hit| hit.id != from;
        match self.near.iter().find(same).or_else(|| self.near.iter().find(similar)) {
            Some(hit) => Inserted::Known(hit.id),
            None => Inserted::New(tree.push(from, motion)),
        }
    }
}
