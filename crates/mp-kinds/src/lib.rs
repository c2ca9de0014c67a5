//! Kinds of robots: what a scene is made of before anybody plans in it.
//!
//! | kind | what moves |
//! |---|---|
//! | [`RigidScene`] | rigid bodies among meshes, in space or in the plane |
//! | [`ArmScene`], [`FloatingScene`] | trees of links, also on bases that float or roll |
//! | [`PlanarScene`] | discs and polygons among polygons |
//! | [`MovingScene`] | any of them among obstacles that move |
//! | [`DrivenScene`] | any of them moved by inputs |
//! | [`Constrained`] | any of them with conditions of one's own |
//!
//! Each is a [`Robot`], which is asked in three parts: planners ask its [`Motion`], messages and files its [`Description`], pictures its
//! [`Appearance`]. `mp-plan` plans for robots without knowing their kinds, and exports everything here that its users need.
//!
//! What is done with their paths is here too: [`shorten`], [`relax`], [`field`], [`proof`], and [`prove`] for certificates. So the checks of
//! motions, in which planning spends its time, are compiled here, optimised, and what stands above is compiled in seconds: [`build`] makes
//! robots of problems behind pointers.

pub mod build;
mod error;
pub mod field;
pub mod goals;
mod metric_name;
pub mod numbers;
mod objective;
pub mod possible;
pub mod proof;
pub mod prove;
pub mod relax;
mod relax_field;
mod robot;
mod shorten;
pub mod turns;

pub use error::{Error, ErrorKind};
pub use field::FieldImage;
pub use goals::GoalPart;
pub use metric_name::MetricName;
pub use numbers::{at_least, brief, count, plain, positive_number};
pub use objective::ObjectiveName;
pub use relax_field::RelaxField;
pub use robot::motion::{AnyChecker, AnyMotion, AnyVerifier, Counting, TypedMotion};
pub use robot::*;
pub use shorten::{hybridized, shorten};

pub use mp_cspace::{Interrupt, Length};
