//! The base of all experiments: cases that are run once each, the log of their results, statistics and
//! tables.

mod lab;
mod log;
mod provenance;
pub(crate) mod ranks;
pub(crate) mod shards;
mod stats;
mod table;

pub(crate) use lab::{Lab, interrupted};
pub(crate) use log::{Group, Log};
pub(crate) use stats::{
    Median, bootstrap, geometric_mean, mean, paired_ratio, ratio, restricted_mean, seconds, short, survival,
    wilson, wilson_percent,
};
pub(crate) use table::{Table, bit, sections};
