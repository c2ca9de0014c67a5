//! Roadmaps on problems whose answer is known.

mod around;
#[path = "../../../mp-tree/tests/common/mod.rs"]
mod common;
mod conformance;
mod engine;
mod keep;
