//! Robots that are no arms.

mod common;
mod hints;
mod motions;
mod moving;
mod robots;
mod until;
