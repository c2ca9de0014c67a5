//! Arms: trees of links and joints among meshes.

mod check;
mod compile;
mod error;
mod explain;
mod ik;
mod kinematics;
mod model;
mod pairs;
mod robot;
mod sampled;
mod srdf;
mod travel;
#[cfg(feature = "urdf")]
mod urdf;
mod verify;
mod xml;

pub use error::{ArmError, UrdfError};
pub use explain::{ArmContact, ArmGap};
pub use ik::{FreeTurn, IK_PRECISION, InverseKinematics, PoseGoal};
pub use kinematics::{AttachedLink, Coordinate, JointFrame, Kinematics};
pub use model::{ArmModel, Joint, JointKind, Link, Mimic};
pub use robot::Arm;
pub use sampled::{SampledPair, SampledPairs, TouchReason};
pub use verify::ArmVerifier;
