//! The engine: the roadmap, the loops that grow it, and a slot for each thing in which variants differ. It knows no
//! variant.

mod ahead;
mod answers;
mod builder;
mod connect;
mod export;
mod file;
mod forest;
mod generate;
pub(crate) mod mixed;
mod planner;
mod roadmap;
mod search;
pub(crate) mod settings;
mod stages;
mod steer;

pub(crate) use planner::taken_apart;

pub use ahead::Foreseeing;
pub use answers::{Answers, IndexedRoadmap, Listed, Unanswered};
pub use builder::{Builder, Pace, Recipe};
pub use connect::{Connector, Growing, Nearest, Reachable};
pub use file::{RoadmapError, RoadmapFileError, fingerprint};
pub use generate::{Came, Candidate, Free, NodeGenerator};
pub use mixed::{Mixing, PairRule, Pairs};
pub use planner::{HasRoadmap, PATIENCE, RoadmapPlanner};
pub use roadmap::{EdgeId, Kind, Link, LinkState, Roadmap, Tag, Way};
pub use search::{AStar, Entry, Query};
pub use settings::{CYCLES, NEIGHBOURS, RADIUS, UNDIRECTED, length, reachable, yes};
pub use stages::{Among, Stages, Turns};
pub use steer::Steer;
