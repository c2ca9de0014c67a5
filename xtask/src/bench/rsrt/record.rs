//! What is kept of a run.

use serde::{Deserialize, Serialize};

/// What was run.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) mover: String,
    pub(super) model: String,
    pub(super) metric: String,
    pub(super) planner: String,
    pub(super) obstacles: usize,
    pub(super) instance: u64,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) solved: bool,
    /// Processor time, with the verification of candidate paths.
    pub(super) seconds: f64,
    pub(super) iterations: u64,
    pub(super) nodes: usize,
    /// Configurations asked of the collision checker.
    pub(super) checks: u64,
    /// Times a node was expanded: motions asked of the local planner.
    pub(super) expansions: u64,
    /// Candidate paths that failed verification.
    pub(super) rejected: u64,
    /// Time along the path, in steps of the inputs (positions: number of edges).
    pub(super) edges: usize,
}
