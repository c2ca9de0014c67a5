//! The engine: trees, the loops that grow them, and a slot for each thing in which variants differ. It knows no variant.

mod apart;
mod attach;
mod branch;
mod constructors;
mod core;
mod grow;
mod improve;
mod propose;
mod recipe;
mod rewire;
mod select;
mod settings;
mod single;
mod tree;
mod two;
mod untried;
#[cfg(feature = "serde")]
mod written;

pub(crate) use self::core::joined;
pub(crate) use constructors::constructors;

pub use self::core::Core;
pub use apart::AppendApart;
pub use attach::{Append, AppendDistinct, Attach, Attached};
pub use branch::{Branch, Growing, Steer};
pub use grow::{Connect, Extend, Grown, Growth};
pub use improve::{Improving, improve};
pub use propose::{Acceptable, Propose, Samples};
pub use recipe::{Recipe, Tuning};
pub use rewire::{Near, Rewire};
pub use select::{Nearest, Purpose, Selector};
pub use settings::{GOAL_BIAS, NEEDS_BOTH_ENDS, PATIENCE, STEP};
pub use single::SingleTree;
pub use tree::Tree;
pub use two::TwoTrees;
pub use untried::Untried;
