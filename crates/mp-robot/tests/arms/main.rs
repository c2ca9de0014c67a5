//! Arms.

mod bad_input;
mod common;
mod floating;
mod kinematics;
mod motions;
#[cfg(feature = "urdf")]
mod urdf;
mod verifier;
