//! Slot: extension by inputs that are tried at most once per node.

use super::{Extender, Growing, Grown, Inserter, Selector};
use mp_control::InputChoice;
use mp_cspace::{Direction, LocalPlanner, NodeId, Space};

/// Extends by the inputs that have not been tried at a node, the most promising first: one per call, or as
/// many as it takes to add a node. A node from which the latter fails is exhausted.
#[derive(Clone, Debug, Default)]
pub struct Untried {
    one: bool,
    tried: Vec<Vec<bool>>,
}

impl Untried {
    /// One input per call, whether or not it adds a node.
    #[must_use]
    pub fn one() -> Self {
        Self { one: true, tried: Vec::new() }
    }

    /// As many inputs as it takes to add a node.
    #[must_use]
    pub fn until_new() -> Self {
        Self::default()
    }
}

impl<C: Space, L: LocalPlanner<C::State> + InputChoice> Extender<C, L> for Untried {
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let node = from as usize;
        if self.tried.len() <= node {
            self.tried.resize_with(node + 1, Vec::new);
        }
        let count = growing.checker().local().count();
        let (most, rounds) = if self.one { (1, 1) } else { (count, count) };
        // More than one round only where a successor is free but in the tree already.
        for _ in 0..rounds {
            let tried = std::mem::take(&mut self.tried[node]);
            growing.checker().local().lend_tried(tried, most);
            let grown = growing.step(from);
            self.tried[node] = growing.checker().local().take_tried();
            if grown != Grown::Trapped || self.tried[node].iter().all(|tried| *tried) {
                return grown;
            }
        }
        Grown::Trapped
    }

    fn pruned(&mut self, _: Direction, survivors: &[NodeId]) {
        let keep = |&id: &NodeId| self.tried.get_mut(id as usize).map(std::mem::take).unwrap_or_default();
        self.tried = survivors.iter().map(keep).collect();
    }
}
