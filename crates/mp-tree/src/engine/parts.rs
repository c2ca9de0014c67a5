//! What makes one variant of the family differ from another.

use super::Tuning;

/// One variant of the family: a policy for each slot of the engine, and the parameters.
///
/// Planners with two trees have a pair of extenders: one for exploring, one for joining.
#[derive(Clone, Copy, Debug)]
pub struct TreePlannerParts<P, Se, G, A> {
    /// What to grow toward next.
    pub target_sampler: P,
    /// Which nodes to grow from.
    pub selector: Se,
    /// How far to grow in one iteration.
    pub extender: G,
    /// How a new motion joins the tree.
    pub inserter: A,
    /// The parameters.
    pub tuning: Tuning,
}
