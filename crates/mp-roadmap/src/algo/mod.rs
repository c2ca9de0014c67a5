//! The algorithms, one file each.

pub mod bridge_prm;
pub mod gaussian_prm;
pub mod lazy_prm;
pub mod obprm;
pub mod obstacle_geometry_prm;
pub mod prm;
pub mod prm_star;
pub mod visibility_prm;
