//! The algorithms, one file each.

pub mod lazy_prm;
pub mod prm;
pub mod prm_star;
pub mod visibility_prm;
