//! The vocabulary of motion planning: spaces, metrics, samplers, validity, local planners, nearest
//! neighbours, goals, stops, observers and paths.
//!
//! Planners know only the traits of this crate; they never see a mesh.
//!
//! | to say | use |
//! |---|---|
//! | what configurations are | [`Rn`], [`RnDyn`], [`So2`], [`So3`], [`Se2`], [`Se3`], [`Torus`], [`Joints`], [`Product`], [`SpaceTime`] |
//! | how far apart | their own metric, or [`WithMetric`]: [`Euclidean`], [`ScaledEuclidean`], [`Manhattan`], [`MaxDisplacement`], [`SweptVolume`], [`Bounded`] |
//! | which to try | [`Uniform`], [`Halton`], [`GoalBias`], [`Gaussian`], [`Bridge`] |
//! | when a motion is free | [`Certified`], [`Discrete`]; [`FineDiscrete`] to verify |
//! | where obstacles lead along, and what they look like | [`ObstacleHints`], [`ObstacleGeometry`] |
//! | which way clearance grows | [`ClearanceGradient`] |
//! | how to move | [`Straight`], [`RotateAtS`]; by a set of inputs: [`inputs`] |
//! | what to reach | [`Exactly`], [`Ball`], [`FixedFactors`], a closure |
//! | what to plan | [`Problem`], with [`Goals`] and a [verifier](Verify); by names: [`PlannerInfo`], [`Settings`] |
//! | when to stop | [`Iterations`], [`Nodes`], [`Motions`], [`Deadline`], [`Cancel`], joined by [`Stop::or`] |
//! | what to do with a path | [`Path`], [`verify_path`], [`least_clearance`], [`shorten`] |
//! | planners compiled once for many spaces | [`erased`] |
//! | whether your own implementation is right | [`testkit`] |

mod edge_checker;
pub mod erased;
mod error;
mod goal;
mod gradient;
mod hints;
pub mod inputs;
mod local;
mod metric;
mod motion;
pub mod nn;
mod numbers;
mod observer;
mod path;
mod planner;
mod problem;
mod rng;
mod sampler;
pub mod shorten;
pub mod shortest;
mod space;
mod space_time;
mod stop;
mod tell;
pub mod testkit;
mod validity;

pub use edge_checker::EdgeChecker;
pub use error::{ParameterError, SpaceError};
pub use goal::{Ball, Exactly, FixedFactors, Goal};
pub use gradient::ClearanceGradient;
pub use hints::{BodyFeatures, ObstacleGeometry, ObstacleHints, PointOf};
pub use local::{
    Direction, Extension, LocalPlanner, Motion, PolylineEdge, PoseSpace, Reach, Reversible, RotateAtS,
    Straight, turn_at,
};
pub use metric::{
    Bounded, Euclidean, Manhattan, MaxDisplacement, MetricFn, MetricOn, ScaledEuclidean, SweptVolume,
    TrueMetricOn, WithMetric,
};
pub use motion::{Certified, Discrete, FineDiscrete, Resolution};
pub use nn::{
    DefaultNn, Embed, EmbedFactors, Hit, KdTree, Layout, Linear, MetricTree, NearestNeighbors, NnOn, NodeId,
};
pub use numbers::StateVector;
pub use observer::{Both, Event, EventCounts, Observer, OnEvent};
pub use path::{GapError, Path, PathFault, PathReport, Tightest, least_clearance, verify_path};
pub use planner::{Outcome, Planner};
pub use problem::{
    AnyProblem, BoxedHints, BoxedVerify, BuildError, Demand, Endpoint, Goals, ObstacleKnowledge, Parameter,
    PlannerInfo, Problem, ProblemParts, Settings, Step, Verify, Workers, closest,
};
pub use rng::Rng;
pub use sampler::{Bridge, Gaussian, GoalBias, Halton, Sampler, Uniform};
pub use space::{
    Coordinates, Factored, JointRange, Joints, Metric, Product, Rn, RnDyn, Se2, Se2State, Se3, So2, So3,
    Space, Torus, TrueMetric, rotation_angle, slerp, wrap_angle,
};
pub use space_time::{AtAnyTime, Forward, SpaceTime};
pub use stop::{Cancel, Deadline, Iterations, Motions, Nodes, Or, Progress, Stop, StopReason};
pub use validity::{
    Clearance, IntervalClearance, KnownFree, MotionBound, MotionCheck, MotionInterval, MotionValidity,
    Validity,
};
