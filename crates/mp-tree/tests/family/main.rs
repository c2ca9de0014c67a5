//! Tests of the whole family. One program, so that what they share is compiled once; spaces that only few
//! have are in `spaces`.

mod bad_input;
#[path = "../common/mod.rs"]
mod common;
mod conformance;
mod cyclic;
mod engine;
mod goals;
mod obrrt;
mod optimal;
mod panics;
mod repeated;
mod retraction;
mod shared_bi_rrt;
mod shared_tree;
mod slots;
mod t_rrt;
mod walks;
