//! Arms on the command line: what is their own in `plan`, `check`, `info` and `render`.

mod check;
mod info;
mod picture;
mod plan;
mod task;

pub(crate) use check::check;
pub(crate) use info::Facts;
pub(crate) use picture::scene;
pub(crate) use task::{State, Task};
