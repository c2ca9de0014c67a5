//! `plan`.

mod chosen;
pub(crate) mod counted;
mod files;
pub(crate) mod interrupt;
mod measured;
pub(crate) mod metrics;
pub(crate) mod mover;
mod options;
pub(crate) mod progress;
mod report;
mod rigid;
mod run;
mod scene;
pub(crate) mod search;
pub(crate) mod setting;
pub(crate) mod task;
pub(crate) mod tuples;

pub(crate) use options::Options;
pub(crate) use run::{planned, run};
pub(crate) use search::Map;
pub(crate) use setting::Ready;
