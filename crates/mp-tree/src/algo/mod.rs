//! The named algorithms, one file each.

pub mod rrt;
pub mod rrt_connect;
