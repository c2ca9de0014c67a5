//! Systems that move by inputs: flows, input sets, and the local planner that chooses among inputs.
//!
//! A [`Flow`] says how an input, applied for a while, moves a state. An [`InputSet`] lists the inputs.
//! [`InputPlanner`] is the [`LocalPlanner`](mp_cspace::LocalPlanner) of both, in either [`Order`] of
//! testing. A [`FlowCheck`] tests the motion to a successor and says what its edge stores.
//! [`ReplayMotions`] and [`ReplayFinely`] verify edges by replay.
//!
//! | system | states | inputs |
//! |---|---|---|
//! | [`Kinematic`] | of any space that has [velocities](mp_cspace::Space::moved) | velocities |
//! | [`DoubleIntegrator`] | positions and velocities, as in [`Product::with_velocity`](mp_cspace::Product::with_velocity) | accelerations |
//! | [`Unicycle`], [`Car`] | [`Se2State`](mp_cspace::Se2State) | speed and turning or steering |
//! | [`Rk4`] | vectors | any: a differential equation, integrated |
//! | a closure | any | any |

mod check;
mod curves;
mod double_integrator;
mod error;
mod flow;
mod kinematic;
mod local;
mod replay;
mod rk4;
mod set;
mod wheels;

pub use check::{
    ControlSegment, DiscreteFlowCheck, FlowCheck, LocalFlowCheck, OnPosition, RecordedFlowCheck,
    SuccessorMotion,
};
pub use curves::{CurvePart, dubins, reeds_shepp};
pub use double_integrator::DoubleIntegrator;
pub use error::InputError;
pub use flow::{Flow, Input};
pub use kinematic::Kinematic;
pub use local::{Accept, InputChoice, InputCounters, InputPlanner, Order};
pub use replay::{ReplayFinely, ReplayMotions};
pub use rk4::Rk4;
pub use set::InputSet;
pub use wheels::{Car, Unicycle};
