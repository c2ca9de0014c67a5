//! The algorithms, one file each.

pub mod prm;
