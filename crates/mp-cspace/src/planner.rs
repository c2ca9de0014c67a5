//! Stops, observers, goals, outcomes and the planner trait.

use crate::{NodeId, Path, Rng};

/// What has been done so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Progress {
    /// Iterations of the planner's loop.
    pub iterations: u64,
    /// Nodes of its trees or roadmap.
    pub nodes: usize,
    /// Motion checks asked of the local planner.
    pub motions: u64,
    /// Candidate paths that failed independent verification.
    pub rejected: u64,
}

impl Progress {
    /// Progress with the given counts, nothing rejected.
    #[must_use]
    pub fn new(iterations: u64, nodes: usize, motions: u64) -> Self {
        Self { iterations, nodes, motions, rejected: 0 }
    }
}

/// Why a planner stopped without a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StopReason {
    /// The iteration budget is spent.
    Iterations,
    /// The node budget is spent.
    Nodes,
    /// The motion-check budget is spent.
    Motions,
    /// The deadline has passed.
    Deadline,
    /// Somebody asked it to stop.
    Cancelled,
}

/// When to stop. Combine with [`Stop::or`].
pub trait Stop {
    /// `Some(reason)` to stop now. Called once per iteration, before it.
    fn check(&mut self, progress: &Progress) -> Option<StopReason>;
    /// Stops when either does; `self` is asked first.
    fn or<B: Stop>(self, other: B) -> Or<Self, B>
    where
        Self: Sized,
    {
        Or(self, other)
    }
}

/// Either of two stops.
#[derive(Clone, Copy, Debug)]
pub struct Or<A, B>(pub A, pub B);

impl<A: Stop, B: Stop> Stop for Or<A, B> {
    fn check(&mut self, progress: &Progress) -> Option<StopReason> {
        self.0.check(progress).or_else(|| self.1.check(progress))
    }
}

/// What a planner tells an observer.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum Event<'a, S> {
    /// A state was sampled.
    Sampled(&'a S),
    /// A root was added to tree `tree`.
    Rooted {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
        /// The new node.
        id: NodeId,
        /// Its state.
        state: &'a S,
    },
    /// A node was added to tree `tree` under `parent`.
    Added {
        /// Which tree (0 from the start, 1 from the goal).
        tree: usize,
        /// The new node.
        id: NodeId,
        /// Its parent.
        parent: NodeId,
        /// Its state.
        state: &'a S,
    },
    /// An extension of `tree` failed.
    Trapped {
        /// Which tree.
        tree: usize,
    },
    /// A candidate path failed independent verification; its bad edge is pruned.
    Rejected,
    /// Nodes of `tree` were removed and the others renumbered, in unchanged order.
    Pruned {
        /// Which tree.
        tree: usize,
        /// The former ids of the nodes that remain: node `i` was `survivors[i]`.
        survivors: &'a [NodeId],
    },
    /// A verified path was found.
    Solved,
}

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

/// A set of states to reach.
pub trait Goal<S> {
    /// Whether `q` is in the goal set.
    fn reached(&self, q: &S) -> bool;
}
impl<S, F: Fn(&S) -> bool> Goal<S> for F {
    fn reached(&self, q: &S) -> bool {
        self(q)
    }
}

/// How a solve ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome<P> {
    /// A verified solution.
    Solved(P),
    /// Stopped without one.
    Stopped(StopReason),
}

/// A planner that works one iteration at a time, so that it can be stopped, resumed and watched.
pub trait Planner<S> {
    /// What an edge of its paths remembers.
    type Edge: Clone;
    /// One iteration. A returned path has passed the independent check.
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<S>) -> Option<Path<S, Self::Edge>>;
    /// What has been done so far.
    fn progress(&self) -> Progress;
    /// Runs until solved or stopped. Call again to go on with the same trees.
    fn solve(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<S>,
    ) -> Outcome<Path<S, Self::Edge>> {
        loop {
            if let Some(reason) = stop.check(&self.progress()) {
                return Outcome::Stopped(reason);
            }
            if let Some(path) = self.step(rng, observer) {
                observer.on(Event::Solved);
                return Outcome::Solved(path);
            }
        }
    }
}
