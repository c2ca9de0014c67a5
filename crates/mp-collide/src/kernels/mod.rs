//! Kernels: boxes and triangles compared eight at a time in `f32` with error margins. What these do not decide is decided
//! in `f64`.

#![allow(clippy::needless_range_loop)] // Coordinates and axes are indices here, several arrays at a time.

pub(crate) mod corner_drift;
pub(crate) mod leaf_pair;
pub(crate) mod separating_axes;
pub(crate) mod swept_interval;
pub(crate) mod swept_triangles;
pub(crate) mod triangle_distance;
pub(crate) mod triangle_pair;
