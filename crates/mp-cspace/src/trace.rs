//! The `tracing` events of the crate: at debug level, from functions that are compiled once.

use crate::{Progress, StopReason, path::PathReport};

/// A planner has found a path, or stopped without one.
pub(crate) fn ended(progress: &Progress, stopped: Option<StopReason>) {
    let Progress { iterations, nodes, motions, rejected, .. } = *progress;
    match stopped {
        None => tracing::debug!(iterations, nodes, motions, rejected, "solved"),
        Some(reason) => tracing::debug!(iterations, nodes, motions, rejected, ?reason, "stopped"),
    }
}

/// A path was verified.
pub(crate) fn verified(report: &PathReport) {
    let PathReport { edges, length, clearance, fault } = report;
    match fault {
        None => tracing::debug!(edges, length, clearance, "verified"),
        Some(fault) => tracing::debug!(edges, length, %fault, "not verified"),
    }
}

/// A path was simplified: its numbers of states before and after.
pub(crate) fn simplified(states: [usize; 2]) {
    tracing::debug!(from = states[0], to = states[1], "simplified");
}
