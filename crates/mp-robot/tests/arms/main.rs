//! Arms.

mod bad_input;
mod common;
mod kinematics;
mod motions;
mod urdf;
mod verifier;
