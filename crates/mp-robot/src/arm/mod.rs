//! Arms: trees of links and joints among meshes.

mod attached;
mod check;
mod compile;
mod error;
mod explain;
mod gradient;
mod groups;
mod held;
mod ik;
mod kinematics;
mod model;
mod pairs;
mod planar_base;
mod robot;
mod sampled;
mod srdf;
mod together;
mod travel;
mod urdf;
mod verify;
mod wide;
mod xml;

pub use error::{ArmError, UrdfError};
pub use explain::{ArmContact, ArmGap};
pub use groups::{NamedState, SrdfGroups};
pub use ik::{FreeTurn, IK_PRECISION, InverseKinematics, PoseGoal};
pub use kinematics::{AttachedLink, Coordinate, JointFrame, Kinematics};
pub use model::{ArmModel, Joint, JointKind, Link, Mimic, Rate};
pub use planar_base::PLANAR_NUMBERS;
pub use robot::Arm;
pub use sampled::{SampledPair, SampledPairs, TouchReason};
pub use verify::ArmVerifier;
