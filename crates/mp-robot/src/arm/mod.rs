//! Arms: trees of links and joints among meshes.

mod check;
mod compile;
mod error;
mod kinematics;
mod model;
mod pairs;
mod robot;
mod travel;

pub use error::ArmError;
pub use kinematics::{Coordinate, Kinematics};
pub use model::{ArmModel, Joint, JointKind, Link, Mimic};
pub use robot::Arm;
