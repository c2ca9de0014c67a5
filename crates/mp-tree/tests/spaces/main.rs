//! Planners in spaces that the tests of the family do not have: of inputs, and erased ones. A program of its
//! own, so that two are compiled at a time.

#[path = "../common/mod.rs"]
mod common;
mod erased;
mod inputs;
