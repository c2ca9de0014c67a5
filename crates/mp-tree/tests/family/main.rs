//! Tests of the whole family. One program, so that what they share is compiled once: all planners by name of
//! one space, above all.

mod bad_input;
#[path = "../common/mod.rs"]
mod common;
mod conformance;
mod cyclic;
mod engine;
mod erased;
mod goals;
mod inputs;
mod obrrt;
mod optimal;
mod panics;
mod repeated;
mod retraction;
mod shared_bi_rrt;
mod shared_tree;
mod slots;
mod snakes;
mod t_rrt;
mod walks;
