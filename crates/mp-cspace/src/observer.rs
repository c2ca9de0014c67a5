//! Observers: they watch a planner at work.

use crate::{NodeId, Progress};

/// What a planner reports to an observer.
#[derive(Debug)]
#[non_exhaustive]
pub enum Event<'a, S> {
    /// An iteration begins.
    Iteration(Progress),
    /// A state was sampled.
    Sampled(&'a S),
    /// A root was added to tree `tree`, or a node to a roadmap (0).
    Rooted {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
        /// Its index in the tree or roadmap.
        id: NodeId,
        /// Its configuration.
        state: &'a S,
        /// Of a node of a roadmap, the name of its kind; `None` for the root of a tree.
        kind: Option<&'static str>,
    },
    /// A node was added to tree `tree` under `parent`.
    Added {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
        /// Its index in the tree.
        id: NodeId,
        /// The node that it was reached from; in tree 1 the node that it leads to.
        parent: NodeId,
        /// Its configuration.
        state: &'a S,
        /// The states at which the edge between them bends, in forward time: from the parent on in tree 0, to
        /// the parent in tree 1. Empty for a straight edge.
        through: &'a [S],
    },
    /// A node of tree `tree` got another parent, through which it costs less.
    Rewired {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
        /// The node that was moved within the tree.
        id: NodeId,
        /// The parent that it has from now on.
        parent: NodeId,
        /// The states at which the new edge bends, as in [`Added`](Self::Added).
        through: &'a [S],
    },
    /// An edge was added between two nodes of a roadmap.
    Linked {
        /// The node it leads from.
        from: NodeId,
        /// The node it leads to.
        to: NodeId,
    },
    /// An edge of a roadmap, added before, turned out to be blocked.
    Unlinked {
        /// The node it led from.
        from: NodeId,
        /// The node it led to.
        to: NodeId,
    },
    /// An extension of `tree` failed.
    Trapped {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
    },
    /// The motion from a node of a tree or roadmap toward a state was not free.
    Blocked {
        /// The state of the node.
        from: &'a S,
        /// The state toward which the motion led. The motion may have been shorter: see the planner's step.
        toward: &'a S,
    },
    /// A candidate path failed independent verification; the edge that failed is pruned.
    Rejected,
    /// Nodes of `tree` were removed and the others renumbered, in unchanged order.
    Pruned {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
        /// The former ids of the nodes that remain: node `i` was `survivors[i]`.
        survivors: &'a [NodeId],
    },
    /// A verified path was found.
    Solved,
}

// Derived, these would require `S: Copy`.
impl<S> Clone for Event<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<S> Copy for Event<'_, S> {}

/// Watches a planner. The default does nothing.
pub trait Observer<S> {
    /// Called at each event.
    fn on(&mut self, _event: Event<'_, S>) {}
}
impl<S> Observer<S> for () {}
impl<S, O: Observer<S> + ?Sized> Observer<S> for &mut O {
    fn on(&mut self, event: Event<'_, S>) {
        (**self).on(event);
    }
}

/// A closure as an observer.
#[derive(Clone, Copy, Debug)]
pub struct OnEvent<F>(pub F);

impl<S, F: FnMut(Event<'_, S>)> Observer<S> for OnEvent<F> {
    fn on(&mut self, event: Event<'_, S>) {
        (self.0)(event);
    }
}

/// Two observers, called in order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Both<A, B>(pub A, pub B);

impl<S, A: Observer<S>, B: Observer<S>> Observer<S> for Both<A, B> {
    fn on(&mut self, event: Event<'_, S>) {
        self.0.on(event);
        self.1.on(event);
    }
}

/// An observer that only counts, for measurements and tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EventCounts {
    /// States sampled.
    pub sampled: u64,
    /// Nodes added, roots too.
    pub added: u64,
    /// Extensions trapped.
    pub trapped: u64,
    /// Candidate paths that failed verification.
    pub rejected: u64,
    /// Verified paths found.
    pub solved: u64,
}

impl<S> Observer<S> for EventCounts {
    fn on(&mut self, event: Event<'_, S>) {
        match event {
            Event::Iteration(_)
            | Event::Rewired { .. }
            | Event::Linked { .. }
            | Event::Unlinked { .. }
            | Event::Blocked { .. }
            | Event::Pruned { .. } => {}
            Event::Sampled(_) => self.sampled += 1,
            Event::Rooted { .. } | Event::Added { .. } => self.added += 1,
            Event::Trapped { .. } => self.trapped += 1,
            Event::Rejected => self.rejected += 1,
            Event::Solved => self.solved += 1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_are_called() {
        let mut seen = 0;
        let mut counts = EventCounts::default();
        let mut both = Both(
            &mut counts,
            OnEvent(|event: Event<'_, f64>| {
                if let Event::Sampled(q) = event {
                    seen += *q as i32;
                }
            }),
        );
        both.on(Event::Sampled(&3.0));
        both.on(Event::Added { tree: 0, id: 1, parent: 0, state: &3.0, through: &[] });
        both.on(Event::Rejected);
        assert_eq!(counts, EventCounts { sampled: 1, added: 1, rejected: 1, ..EventCounts::default() });
        assert_eq!(seen, 3);
    }
}
