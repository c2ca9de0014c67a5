//! The `tracing` events of the crate: at debug level, from functions that are compiled once, and of what is
//! rare. The end of a run is an event of `mp-cspace`.

use std::fmt::Display;

/// A planner was made by name.
pub(crate) fn made(planner: &dyn Display) {
    tracing::debug!(%planner, "made");
}

/// A path to a node did not pass verification: how many nodes its tree had, and has without what hung on the
/// edge that failed.
pub(crate) fn pruned(tree: usize, from: usize, to: usize) {
    tracing::debug!(tree, from, to, "pruned");
}

/// A cheaper path was found.
pub(crate) fn improved(cost: f64, nodes: usize) {
    tracing::debug!(cost, nodes, "improved");
}

/// Attempt number `attempt` begins; the attempts before it made `iterations` iterations together.
pub(crate) fn restarted(attempt: u64, iterations: u64) {
    tracing::debug!(attempt, iterations, "restarted");
}

/// One of several runs has won.
pub(crate) fn won(run: usize, iterations: u64) {
    tracing::debug!(run, iterations, "won");
}
