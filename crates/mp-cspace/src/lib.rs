//! The vocabulary of motion planning: spaces, metrics, samplers, validity, local planners, nearest
//! neighbours, goals, stops, observers and paths.
//!
//! Planners know only the traits of this crate; they never see a mesh. To plan for a robot of your own, say how far it is
//! from obstacles and how far its points travel. The crate provides the rest:
//!
//! ```
//! use mp_cspace::{Certified, Clearance, FineDiscrete, MotionClearance, Problem, Length, Rn, Straight};
//! use mp_cspace::{Iterations, Outcome, Planner, Rng};
//! use mp_tree::{RrtConnect, Tuning};
//! use nalgebra::Vector2;
//!
//! /// A disc of radius 0.1 m among pillars of radius 0.3 m. Its configuration is its centre.
//! #[derive(Clone)]
//! struct Disc(Vec<Vector2<f64>>);
//!
//! impl Clearance<Vector2<f64>> for Disc {
//!     fn clearance(&mut self, q: &Vector2<f64>, _enough: f64) -> f64 {
//!         self.0.iter().map(|pillar| (q - pillar).norm() - 0.4).fold(f64::INFINITY, f64::min)
//!     }
//! }
//! impl MotionClearance<Vector2<f64>> for Disc {
//!     fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
//!         (to - from).norm()
//!     }
//! }
//!
//! let space = Rn::<2>::new([0.0; 2], [4.0; 2])?;
//! let disc = Disc(vec![[1.0, 1.2].into(), [2.0, 2.1].into(), [3.0, 2.8].into()]);
//! // Motions are proved free while planning, and a finished path is checked again, by other code.
//! let local = Straight::new(&space, Certified::new(&space, disc.clone(), 0.01)?);
//! let is_free = |q: &Vector2<f64>| disc.0.iter().all(|pillar| (q - pillar).norm() > 0.4);
//! let verifier = FineDiscrete::new(&space, is_free, Length::Absolute(0.001))?;
//!
//! let problem = Problem::new(&space, local, verifier, [0.2, 0.2].into(), Vector2::new(3.8, 3.8))?;
//! let mut planner = RrtConnect::new(problem, Tuning::default())?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! assert!(matches!(outcome, Outcome::Solved(path) if path.states.len() > 2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | to say | use |
//! |---|---|
//! | what configurations are | a [`Space`]: [`Rn`], [`So3`], [`Se2`], [`Se3`], [`Joints`], [`FloatingJoints`], [`Product`], [`SpaceTime`](space_time::SpaceTime) |
//! | how far apart they are | the space's own distance, or a [`Metric`] put on it by [`WithMetric`]: [`Euclidean`], [`ScaledEuclidean`], [`Manhattan`], [`MaxDisplacement`], [`SweptVolume`], [`MetricFn`] |
//! | which are near | [`NearestNeighbors`]: [`KdTree`], [`MetricTree`], [`Linear`]; [`DefaultNn`] names the best of a space |
//! | which to try | a [`Sampler`]: [`Uniform`], [`Halton`], [`GoalBias`], [`Gaussian`], [`Bridge`] |
//! | when a state is free | [`Validity`], or a [`Clearance`] in metres |
//! | when a motion is free | [`MotionValidity`]: [`Certified`] proves it by a [`MotionClearance`], [`Discrete`] samples it; [`FineDiscrete`] verifies |
//! | how to move | a [`LocalPlanner`]: [`Straight`]; by inputs: the crate `mp-control` |
//! | what motions cost | an [`Objective`]: [`PathLength`], [`StateCostIntegral`], a closure |
//! | what to reach | a [`Goal`]: [`Exactly`], [`Ball`], [`FixedFactors`], a closure |
//! | what to plan | a [`Problem`], with [`Goals`] and a [verifier](Verify) |
//! | when to stop | a [`Stop`]: [`Iterations`], [`Nodes`], [`Motions`], [`Deadline`], [`Cancel`], joined by [`Stop::or`] |
//! | what to do with a path | [`Path`], [`verify_path`], [`least_clearance`], [`shorten`] |
//! | what obstacles are like, for planners that use it | [`obstacles`] |
//! | planners and settings by name | [`registry`] |
//! | planners compiled once for many spaces | [`erased`] |
//! | whether your own implementation is right | `testkit`, with the feature `testkit` |

pub mod angle;
mod configuration;
mod curve;
mod edge_checker;
pub mod erased;
mod error;
mod goal;
mod layout;
mod length;
mod local;
mod metric;
mod motion;
pub mod nn;
mod numbers;
mod objective;
mod observer;
pub mod obstacles;
pub mod path;
mod planner;
mod problem;
pub mod registry;
mod rng;
mod sampler;
pub mod shorten;
pub mod shortest;
mod space;
pub mod space_time;
mod stop;
#[cfg(any(test, feature = "testkit"))]
pub mod testkit;
mod trace;
mod validity;

pub use configuration::Configuration;
pub use curve::Curve;
pub use edge_checker::EdgeChecker;
pub use error::{ParameterError, SpaceError};
pub use goal::{Ball, Exactly, FixedFactors, Goal};
pub use length::{Length, LengthError};
pub use local::{
    Direction, Extension, LocalPlanner, Motion, PathOf, PolylineEdge, Reach, Reversible, Straight,
};
pub use metric::{
    Euclidean, Manhattan, MaxDisplacement, Metric, MetricFn, ScaledEuclidean, SweptVolume, WithMetric,
};
pub use motion::{Certified, CoarseToFine, Discrete, FineDiscrete, Spaced};
pub use mp_stop::{Cancel, Clock, Interrupt, Interrupted, SparseClock, StopReason};
pub use nn::{DefaultNn, Embed, Hit, KdTree, Linear, MetricTree, NearestNeighbors, NodeId};
pub use numbers::StateVector;
pub use objective::{Objective, PathLength, StateCostIntegral, nearness};
pub use observer::{Both, Event, EventCounts, Observer, OnEvent};
pub use path::{Path, least_clearance, verify_path};
pub use planner::{Outcome, Planner};
pub use problem::{
    AnyFlow, AnyProblem, BoxedHints, BoxedVerify, BuildError, Endpoint, Goals, InputSystem,
    ObstacleKnowledge, Problem, ProblemParts, PushingField, Verify, Workers,
};
pub use registry::Demand;
pub use rng::Rng;
pub use sampler::{Bridge, Gaussian, GoalBias, Halton, Sampler, Uniform};
pub use space::{
    AsVectors, Coordinates, Factored, FloatingJoints, JointRange, Joints, OnVectors, Product, Rn, Se2,
    Se2State, Se3, So3, Space, TrueMetric,
};
pub use stop::{Deadline, Iterations, Motions, Nodes, Or, Progress, Stop};
pub use validity::{
    Clearance, ClearanceSearch, IntervalClearance, KnownFree, LeastClearance, MotionCheck, MotionClearance,
    MotionInterval, MotionValidity, Validity,
};
