//! Slot: motions that only join the tree where nothing is yet.

use crate::{Attach, Attached, Selector, Steer, Tree};
use mp_cspace::{Hit, LocalPlanner, Motion, NodeId, Space};

/// Under the node it came from, unless a node of the tree is there already, up to rounding.
///
/// For motions by finitely many inputs: one way and back again, or the same two in another order,
/// leads to the same state but for rounding, and *similar* states must not be stacked on each other
/// (Jouandeau, Touati and Ali Cherif 2008, §2.3). Asks the index once per motion.
#[derive(Clone, Debug, Default)]
pub struct AppendApart {
    near: Vec<Hit>,
}

/// States this part of the extent of the space apart, or less, are similar.
const SIMILAR: f64 = 1e-9;

impl<C: Space, L: LocalPlanner<C::State>> Attach<C, L> for AppendApart {
    fn attach<Se: Selector<C>>(
        &mut self,
        steer: &mut Steer<'_, C, L>,
        tree: &mut Tree<C::State, L::Edge>,
        select: &mut Se,
        from: NodeId,
        motion: Motion<C::State, L::Edge>,
    ) -> Attached {
        let radius = SIMILAR * steer.space().extent();
        select.near(steer.space(), tree.states(), &motion.end, radius, &mut self.near);
        let same = |hit: &&Hit| *tree.state(hit.id) == motion.end;
        // A motion to a state similar to where it began is as short as it is meant to be.
        let similar = |hit: &&Hit| hit.id != from;
        match self.near.iter().find(same).or_else(|| self.near.iter().find(similar)) {
            Some(hit) => Attached::Known(hit.id),
            None => Attached::New(tree.push(from, motion)),
        }
    }
}
