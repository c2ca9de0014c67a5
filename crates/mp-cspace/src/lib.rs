//! The vocabulary of motion planning: spaces, metrics, samplers, validity, local planners, nearest
//! neighbours, goals, stops, observers and paths.
//!
//! Planners know only the traits of this crate; they never see a mesh.

mod local;
mod motion;
mod nn;
mod path;
mod planner;
mod rng;
mod sampler;
mod space;
mod validity;

pub use local::{Direction, Extension, LocalPlanner, Motion, Reach, Straight};
pub use nn::{DefaultNn, Hit, Linear, NearestNeighbors, NodeId};
pub use path::Path;
pub use planner::{Event, Goal, Observer, Or, Outcome, Planner, Progress, Stop, StopReason};
pub use rng::Rng;
pub use sampler::{Sampler, Uniform};
pub use space::{Metric, Space, TrueMetric};
pub use validity::{Clearance, MotionBound, MotionCheck, MotionValidity, Validity};
