//! `plan`.

mod files;
mod finish;
mod interrupt;
pub(crate) mod metrics;
pub(crate) mod mover;
mod options;
mod progress;
mod report;
mod run;
mod search;
pub(crate) mod setting;
pub(crate) mod tuples;

pub(crate) use options::Options;
pub(crate) use run::{planned, run};
pub(crate) use setting::Ready;
