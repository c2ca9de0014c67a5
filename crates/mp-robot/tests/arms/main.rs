//! Arms.

mod bad_input;
mod common;
mod kinematics;
mod motions;
#[cfg(feature = "urdf")]
mod urdf;
mod verifier;
