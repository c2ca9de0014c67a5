//! Robots: where a configuration places them, and whether it is free.
//!
//! | robot | its configurations | moves |
//! |---|---|---|
//! | [`FreeFlyer`] | `Isometry3<f64>`, in SE(3) | a mesh, freely in space |
//! | [`PlanarFlyer`] | [`Se2State`](mp_cspace::Se2State), in SE(2) | a mesh, in the plane z = 0, turning about Z |
//! | [`PointRobot`] | `Vector3<f64>`, in R³ | a point |
//! | [`Arm`] | `SVector<f64, N>` or `Configuration`, in [`Joints`](mp_cspace::Joints) | a tree of links |
//! | [`Arm`] with a [floating](ArmModel::floating) root | `Configuration`, in [`FloatingJoints`](mp_cspace::FloatingJoints) | the same, freely in space |
//! | [`DiscRobot`] | `Vector2<f64>`, in R² | a disc among polygons |
//! | [`PolygonRobot`] | [`Se2State`](mp_cspace::Se2State), in SE(2) | a polygon among polygons |
//!
//! The first three are a [`RigidBody`]. Obstacles stand still, except those of [`AmongMoving`], a rigid body in space and
//! time among bodies on known trajectories, and of [`AmongMovingAreas`], the same in the plane.
//!
//! For planners, robots implement [`Validity`](mp_cspace::Validity), [`Clearance`](mp_cspace::Clearance) and
//! [`MotionClearance`](mp_cspace::MotionClearance), with the trees of `mp-collide`. A [`RigidBody`] also implements
//! [`ObstacleHints`](mp_cspace::obstacles::ObstacleHints), [`ObstacleGeometry`](mp_cspace::obstacles::ObstacleGeometry) and
//! [`ClearanceGradient`](mp_cspace::obstacles::ClearanceGradient). For messages to people there are
//! [`explain`](RigidBody::explain) and [`nearest_free`](RigidBody::nearest_free). A [`Verifier`] or
//! [`ArmVerifier`] proves finished paths with other code.
//!
//! ```
//! use mp_cspace::{Configuration, Certified, MotionValidity, Se3, Validity};
//! use mp_geom::primitives::cuboid;
//! use mp_robot::{FreeFlyer, Verifier};
//! use nalgebra::Isometry3;
//!
//! let wall = ("wall".to_owned(), cuboid(1e-4, 4.0, 4.0)?, Isometry3::identity());
//! let mut robot = FreeFlyer::new(&cuboid(0.2, 0.2, 0.2)?, [wall])?;
//! let (left, right) = (Isometry3::translation(-1.0, 0.0, 0.0), Isometry3::translation(1.0, 0.0, 0.0));
//! assert!(robot.is_valid(&left) && robot.is_valid(&right));
//!
//! let space = Se3::new([-2.0; 3], [2.0; 3])?;
//! let mut verifier = Verifier::new(&space, &robot)?;
//! let tolerance = robot.tolerance();
//! let mut planners = Certified::new(&space, robot, tolerance)?;
//! assert!(!planners.check_motion(&left, &right).is_free());
//! assert!(!verifier.check_motion(&left, &right).is_free());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arm;
mod bounds;
mod counters;
mod explain;
mod features;
mod gradient;
mod hints;
mod kept;
mod moving;
mod obstacles;
mod placement;
mod planar;
mod rigid;
mod shells;
mod solid_obstacle;
mod verify;

pub use arm::{
    Arm, ArmContact, ArmError, ArmGap, ArmModel, ArmVerifier, AttachedLink, Coordinate, FreeTurn,
    IK_PRECISION, InverseKinematics, Joint, JointFrame, JointKind, Kinematics, Link, Mimic, NamedState,
    PLANAR_NUMBERS, PoseGoal, Rate, SampledPair, SampledPairs, SrdfGroups, TouchReason, UrdfError,
};
pub use counters::CheckCounters;
pub use moving::{AmongMoving, MovingVerifier, Trajectory, TrajectoryError};
pub use placement::{BodyRadii, Placement, Planar, Point, Spatial};
pub use planar::{
    AmongMovingAreas, DiscRobot, DiscVerifier, MovingAreasVerifier, PlanarConfiguration, PlanarRobot,
    PolygonRobot, PolygonVerifier,
};
pub use rigid::{FreeFlyer, PlanarFlyer, PointRobot, RigidBody, RobotError};
pub use solid_obstacle::is_solid;
pub use verify::Verifier;
