//! Slot: how far to grow in one iteration.

use super::{Growing, Inserter, Selector};
use mp_cspace::{Direction, LocalPlanner, NodeId, Space};

/// The result of growing toward a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Grown {
    /// No node was added.
    Trapped,
    /// This node was added, nearer to the target.
    Advanced(NodeId),
    /// This node is the target, whether it is new or not.
    Reached(NodeId),
}

impl Grown {
    /// The node that was added or is the target.
    pub(crate) fn node(self) -> Option<NodeId> {
        match self {
            Self::Trapped => None,
            Self::Advanced(id) | Self::Reached(id) => Some(id),
        }
    }
}

/// Slot: grows a tree from a selected node toward the target. An extender decides which steps are made;
/// [`Growing`] makes them.
pub trait Extender<C: Space, L: LocalPlanner<C::State>> {
    /// Grows from `from`.
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown;
    /// Whether a planner may try the straight motion from the start to a goal, of any length, before it calls
    /// this extender for the first time. Variants that must see every motion decline: those that refuse
    /// motions free of collision, and those that make none longer than a step. With two extenders both must
    /// agree.
    fn allows_direct(&self) -> bool {
        true
    }
    /// Nodes of the tree that grows in `direction` were removed: what is now node `i` was node
    /// `survivors[i]`.
    fn pruned(&mut self, _direction: Direction, _survivors: &[NodeId]) {}
}

/// One step (LaValle 1998; EXTEND of Kuffner and LaValle 2000).
#[derive(Clone, Copy, Debug, Default)]
pub struct Extend;

impl<C: Space, L: LocalPlanner<C::State>> Extender<C, L> for Extend {
    #[inline]
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        growing.step(from)
    }
}

/// Step after step until the target is reached or a step fails (CONNECT of Kuffner and LaValle
/// 2000). Each step becomes a node.
///
/// Also ends where a step comes no nearer to the target, and after `limit` steps: local planners whose steps
/// need not come nearer would otherwise never end.
#[derive(Clone, Copy, Debug)]
pub struct Connect {
    /// Most steps per call, so that a planner with tiny steps still reaches its stop.
    pub limit: u32,
}

impl Default for Connect {
    fn default() -> Self {
        Self { limit: 10_000 }
    }
}

impl<C: Space, L: LocalPlanner<C::State>> Extender<C, L> for Connect {
    #[inline]
    fn extend<Se: Selector<C>, A: Inserter<C, L>>(
        &mut self,
        from: NodeId,
        growing: &mut Growing<'_, '_, C, L, Se, A>,
    ) -> Grown {
        let mut grown = growing.step(from);
        let mut distance = f64::INFINITY;
        for _ in 1..self.limit {
            let Grown::Advanced(id) = grown else { break };
            let nearer = growing.distance(id);
            if nearer >= distance {
                break;
            }
            distance = nearer;
            match growing.step(id) {
                Grown::Trapped => break,
                next => grown = next,
            }
        }
        grown
    }
}
