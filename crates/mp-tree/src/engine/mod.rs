//! The engine: trees, the loops that grow them, and a slot for each thing in which variants differ. It knows no variant.

mod apart;
mod constructors;
mod core;
mod extend;
mod improve;
mod insert;
mod recipe;
mod rewire;
mod search_tree;
mod select;
mod settings;
mod single;
mod target;
mod tree;
mod two;
mod untried;
#[cfg(feature = "serde")]
mod written;

pub(crate) use self::core::joined;
pub(crate) use constructors::constructors;

pub use self::core::Core;
pub use apart::AppendApart;
pub use extend::{Connect, Extend, Extender, Grown};
pub use improve::{Improving, improve};
pub use insert::{Append, AppendDistinct, Inserted, Inserter};
pub use recipe::{Recipe, Tuning};
pub use rewire::{Near, Rewire};
pub use search_tree::{Growing, SearchTree};
pub use select::{NearestSelector, Purpose, Selector};
pub use settings::{GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
pub use single::SingleTree;
pub use target::{Acceptable, Samples, TargetSampler};
pub use tree::Tree;
pub use two::TwoTrees;
pub use untried::Untried;
