//! Worlds in the plane on the command line: what is their own in `plan`, `check`, `info` and `render`.

mod check;
mod info;
mod mover;
mod picture;
mod plan;
mod task;

pub(crate) use check::check;
pub(crate) use info::Facts;
pub(crate) use mover::FlatMover;
pub(crate) use picture::draw;
pub(crate) use task::{AnyTask, Task, either};
