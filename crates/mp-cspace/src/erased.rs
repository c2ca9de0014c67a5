//! Type erasure: spaces, indexes and checks behind pointers, so that a planner is compiled once for each kind
//! of *state* and not once for each robot, metric and motion check.
//!
//! | generic | erased |
//! |---|---|
//! | a [`Space`](crate::Space) | [`AnySpace`] |
//! | a [`Factored`](crate::Factored) space, borrowed | [`AnyFactored`] |
//! | [`NearestNeighbors`](crate::NearestNeighbors) of that space | [`AnyIndex`], which keeps the space it was made for: the search inside is not erased |
//! | a [`MotionValidity`] | [`AnyCheck`] |
//! | [`ObstacleGeometry`](crate::obstacles::ObstacleGeometry) | [`AnyGeometry`] |
//! | [`ClearanceGradient`](crate::obstacles::ClearanceGradient) | [`AnyGradient`] |
//! | an [`Objective`] | [`AnyObjective`] |
//!
//! Each call of a space or an index goes through one pointer, which costs a few nanoseconds. Constructors of
//! planners by type stay generic.

mod factored;
mod geometry;
mod index;
mod space;

pub use factored::AnyFactored;
pub use geometry::AnyGeometry;
pub use index::{AnyIndex, CompiledIndex};
pub use space::AnySpace;

use crate::{MotionValidity, Objective, Straight};

/// A motion check behind a pointer.
pub type AnyCheck<'c, S> = Box<dyn MotionValidity<S> + Send + 'c>;

/// A clearance gradient behind a pointer: a closure, as closures are clearance gradients.
pub type AnyGradient<'c, S> = Box<dyn FnMut(&S, f64, &mut [f64]) -> f64 + Send + 'c>;

/// An objective behind a pointer.
pub type AnyObjective<'c, S> = Box<dyn Objective<S> + Send + 'c>;

/// An energy of states behind a pointer: it writes its gradient, one number per degree of freedom.
pub type AnyEnergy<'c, S> = Box<dyn FnMut(&S, &mut [f64]) -> f64 + Send + 'c>;

/// The straight local planner of an erased space.
pub type AnyStraight<'c, S> = Straight<'c, AnySpace<'c, S>, AnyCheck<'c, S>>;
