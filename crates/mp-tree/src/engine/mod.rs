//! The engine: trees, the loops that grow them, and a slot for each policy in which variants differ. It does
//! not depend on any variant.

mod batch;
mod constructors;
mod core;
mod extend;
mod improve;
mod insert;
mod parts;
mod rewire;
mod search_tree;
mod select;
mod single;
mod target;
mod tree;
mod tree_pair;
#[cfg(feature = "serde")]
mod tree_serde;
mod tuning;
mod two;
mod untried;

pub(crate) use self::core::joined;
pub(crate) use batch::Batch;
pub(crate) use constructors::constructors;
pub(crate) use tree_pair::TreePair;

pub use self::core::Core;
pub use batch::BATCH;
pub use extend::{Connect, Extend, Extender, Grown};
pub use improve::{Improving, improve};
pub use insert::{Append, AppendApart, AppendDistinct, Inserted, Inserter};
pub use parts::TreePlannerParts;
pub use rewire::{Near, Rewire};
pub use search_tree::{Growing, SearchTree};
pub use select::{NearestSelector, Purpose, Selector};
pub use single::SingleTree;
pub use target::{Acceptable, Samples, TargetSampler};
pub use tree::Tree;
pub use tuning::{BALANCE, GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP, Tuning};
pub(crate) use tuning::{
    NEEDS_BOTH_ENDS_AND_GRADIENT, NEEDS_BOTH_ENDS_AND_HINTS, NEEDS_GRADIENT, NEEDS_HINTS,
};
pub use two::TwoTrees;
pub use untried::Untried;
