//! Arms.

mod bad_input;
mod common;
mod floating;
mod ik;
mod kinematics;
mod motions;
mod pairs;
mod urdf;
mod verifier;
