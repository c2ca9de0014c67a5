//! The engine: the roadmap, the loops that grow it, and a slot for each policy in which variants differ. It
//! does not depend on any variant.

mod builder;
mod connect;
mod constructors;
mod end_trees;
mod export;
mod file;
mod forest;
mod generate;
pub(crate) mod pairs;
mod parts;
mod piece;
mod planner;
mod prefetch;
mod queries;
mod roadmap;
mod search;
pub(crate) mod settings;
pub(crate) mod staged;

pub(crate) use constructors::constructors;

pub use builder::Builder;
pub use connect::{Connector, Growing, NearestConnector, Reachable};
pub use end_trees::{ENDS, ENDS_STEP, EndGrowth};
pub use file::{MAX_ROADMAP_BYTES, RoadmapError, RoadmapFileError, fingerprint};
pub use generate::{Candidate, Free, NodeGenerator, ParentMotion};
pub use mp_cspace::EdgeChecker;
pub use pairs::{Mixing, PairRule, Pairs, PairsPlanner};
pub use parts::{Pace, RoadmapPlannerParts};
pub use piece::Piece;
pub(crate) use piece::{Moment, Part};
pub use planner::{HasRoadmap, PATIENCE, RoadmapPlanner};
pub use prefetch::{Prefetching, QueryMeter};
pub use queries::{IndexedRoadmap, Listed, RoadmapQueries, Unanswered};
pub use roadmap::{EdgeId, GraphPath, Link, LinkState, MilestoneKind, Roadmap, Tag};
pub use search::{AStar, Entry, Query};
pub use settings::{CYCLES, NEIGHBOURS, RADIUS, UNDIRECTED, length, reachable, yes};
pub use staged::{ConnectionStages, NeighborSet, StagedConnector, Turns};
