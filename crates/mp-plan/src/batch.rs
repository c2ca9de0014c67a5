//! Many runs: streams and lists of problems, races, and work for the ranks of a cluster.

pub(crate) mod in_order;
#[cfg(feature = "ranks")]
pub(crate) mod job_identity;
pub(crate) mod list;
pub(crate) mod many;
pub(crate) mod parallel;
#[cfg(feature = "ranks")]
pub(crate) mod portfolio;
pub(crate) mod portfolio_counts;
#[cfg(all(feature = "ranks", feature = "roadmaps"))]
pub(crate) mod regional;
