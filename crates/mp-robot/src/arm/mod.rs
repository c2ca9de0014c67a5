//! Arms: trees of links and joints among meshes.

mod check;
mod compile;
mod error;
mod explain;
mod kinematics;
mod model;
mod pairs;
mod robot;
mod travel;
mod urdf;
mod verify;

pub use error::ArmError;
pub use explain::ArmContact;
pub use kinematics::{Coordinate, Kinematics};
pub use model::{ArmModel, Joint, JointKind, Link, Mimic};
pub use robot::Arm;
pub use urdf::UrdfError;
pub use verify::ArmVerifier;
