//! Slot: how a new motion joins the tree.

use super::{Selector, Tree};
use mp_cspace::{BuildError, EdgeChecker, Hit, LocalPlanner, Motion, NodeId, Space};

/// The result of inserting a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Inserted {
    /// The end of the motion is this new node, the last of the tree.
    New(NodeId),
    /// Nothing was added: the end of the motion is the state of this older node, or counts as the same.
    Known(NodeId),
}

/// Slot: adds the end of a motion to a tree, under the node it came from or a better one.
///
/// Adds at most one node; the caller passes it to the selector afterwards.
pub trait Inserter<C: Space, L: LocalPlanner<C::State>> {
    /// Inserts `motion`, which leaves node `from` (enters it in time, in a backward tree).
    fn insert<Se: Selector<C>>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        selector: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Inserted;
    /// The nodes to which the last insertion gave another parent, in that order.
    fn rewired(&self) -> &[NodeId] {
        &[]
    }
}

/// Adds the end under the node the motion came from. A motion of no length adds nothing.
///
/// There are no duplicates where the node nearest to the target is chosen and motions come nearer to it, as
/// straight ones do: if the end were in the tree already, it would have been chosen. Otherwise use
/// [`AppendDistinct`].
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

/// Adds the end under the node the motion came from, unless a node of the tree has that state already: for
/// local planners with finitely many motions. One index query per motion.
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

/// Adds the end under the node the motion came from, unless another node of the tree has a similar state:
/// equal up to rounding, or within a radius.
///
/// For motions by finitely many inputs: an input and its inverse, or two inputs in either order, lead to the
/// same state but for rounding, and *similar* states must not be stacked on each other (Jouandeau, Touati and
/// Ali Cherif 2008, §2.3). One index query per motion.
#[derive(Clone, Debug, Default)]
pub struct AppendApart {
    radius: Option<f64>,
    near: Vec<Hit>,
}

impl AppendApart {
    /// States no farther apart than `radius`, in the metric of the space, are similar.
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

/// States at most this part of the extent of the space apart are similar by default.
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
        // Short motions are meant: the end may be similar to where the motion began.
        let similar = |hit: &&Hit| hit.id != from;
        match self.near.iter().find(same).or_else(|| self.near.iter().find(similar)) {
            Some(hit) => Inserted::Known(hit.id),
            None => Inserted::New(tree.push(from, motion)),
        }
    }
}
