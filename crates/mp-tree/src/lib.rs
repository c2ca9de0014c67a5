//! The rapidly-exploring random tree family: one engine, and one file per named algorithm.
//!
//! | algorithm | | trees | per iteration |
//! |---|---|---|---|
//! | [`Rrt`] | [`algo::rrt`] | from the start | one step toward a sample |
//! | [`CyclicRrt`] | [`algo::cyclic_rrt`] | from the start, with cycles | as RRT, or an edge to a similar node; lists alternative paths |
//! | [`RrtConnect`] | [`algo::rrt_connect`] | from start and goal | one step toward a sample; then the other tree all the way to it |
//! | [`Aorrtc`] | [`algo::aorrtc`] | from start and goal, anew for each better path | as RRT-Connect, in the space of states and costs; ever better paths |
//! | [`RrtStar`] | [`algo::rrt_star`] | from the start, rewired | one step toward a sample, attached by the cheapest way; ever better paths |
//! | [`InformedRrtStar`] | [`algo::informed_rrt_star`] | from the start, rewired | as RRT*, toward samples that can be on a better path |
//! | [`BiRrt`] | [`algo::bi_rrt`] | from start and goal | one step toward a sample; then one step of the other tree toward it |
//! | [`RrtConExt`] | [`algo::con_ext`] | from start and goal | all the way toward a sample; then one step of the other tree |
//! | [`RrtConCon`] | [`algo::con_con`] | from start and goal | all the way toward a sample; then the other tree all the way to it |
//! | [`RrtInputs`] | [`algo::rrt_inputs`] | from the start, by a set of inputs | the best of all successors free of collision |
//! | [`CvpRrt`] | [`algo::cvp_rrt`] | from the start, by a set of inputs | one untried input, at a node that has not often failed |
//! | [`RcRrt`] | [`algo::rc_rrt`] | from the start, by a set of inputs | untried inputs, until all are exhausted |
//! | [`Rsrt`] | [`algo::rsrt`] | from the start, by a set of inputs | the first successor free of collision, sorted by distance |
//! | [`DdRrt`] | [`algo::dd_rrt`] | from start and goal | as RRT-Connect, without samples far from nodes that failed |
//! | [`DdRrt`] | [`algo::add_rrt`] | from start and goal | the same, each node learning what is far |
//! | [`MvbRrt`] | [`algo::mvb_rrt`] | from start and goal | as RRT-Connect, toward the mean of the samples nearest to one node |
//! | [`UtilityRrt`] | [`algo::utility_rrt`] | from start and goal | as RRT-Connect, the most promising of several expansions |
//! | [`Obrrt`] | [`algo::obrrt`] | from the start | one step toward a sample or along an obstacle, by hints |
//! | [`Rrs`] | [`algo::rrs`] | from the start, of edges that bend | one step toward a sample, around obstacles by a snake |
//! | [`RrsConnect`] | [`algo::rrs_connect`] | from start and goal, of edges that bend | as RRT-Connect, around obstacles by snakes |
//!
//! [`SharedTree`] ([`algo::shared_tree`]) is RRT on several threads, which grow one tree together.
//! Two run other planners: [`OrParallel`] ([`algo::or_parallel`]) several at once, [`Restarts`]
//! ([`algo::restarts`]) one after the other. [`build_from`] makes them by name.
//!
//! A planner is made from a checked [`Problem`] and works through the trait
//! [`Planner`](mp_cspace::Planner): one step at a time, or until a stop says so. [`build`] makes
//! one by name.
//!
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Resolution, Rn, Rng, Straight};
//! use mp_tree::{Problem, Settings, build};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || q.y > 0.8;
//! let local = Straight::new(&space, Discrete::new(&space, free, Resolution::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Resolution::Fraction(0.0005))?;
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.1), Vector2::new(0.9, 0.1))?;
//!
//! let settings = Settings::parse(["step=10%"])?;
//! let mut planner = build("rrt-connect", problem, &settings)?;
//! match planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ()) {
//!     Outcome::Solved(path) => assert!(path.states.len() > 2),
//!     Outcome::Stopped(reason) => panic!("stopped: {reason:?}"),
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The engine
//! A [`Branch`] is a [`Tree`] with its policies. Every iteration of every variant is: propose a
//! target, select nodes, grow from them, attach what came of it. Each verb is a slot:
//!
//! | slot | trait | here |
//! |---|---|---|
//! | what to grow toward | [`Propose`] | [`Samples`], [`Acceptable`], [`VoronoiBias`] |
//! | which nodes to grow from | [`Selector`] | [`Nearest`], [`DynamicDomain`], [`LeastViolated`], [`Unexhausted`] |
//! | how far | [`Growth`] | [`Extend`], [`Connect`], [`UtilityGuided`], [`ObstacleGuided`], [`Untried`], [`Cyclic`] |
//! | how a motion joins the tree | [`Attach`] | [`Append`], [`AppendDistinct`], [`AppendApart`], [`Rewire`] |
//! | how one state reaches for another | [`LocalPlanner`](mp_cspace::LocalPlanner) | given by you |
//!
//! A variant is a [`Recipe`] for one of three loops: [`SingleTree`], [`TwoTrees`], and [`Improving`],
//! which goes on for better paths.
//!
//! # What is promised
//! - A path is returned only after a [verifier](Verify) has passed each of its edges. An edge that
//!   fails is removed from the tree with all that hangs on it, and planning goes on.
//! - Bad input is a [`BuildError`] before planning begins.
//! - The same problem, parameters and random numbers give the same path, bit for bit. Stopping
//!   and going on changes nothing.
//! - No tree has two nodes with the same state.
//! - A panic in a local planner, verifier, goal or observer leaves the planner as it was but for the
//!   step it interrupts: whoever catches it may look at the trees and step on.

pub mod algo;
mod by_name;
mod engine;
mod registry;

pub use algo::or_parallel::OrParallel;
pub use algo::restarts::{Lengths, Restarts, Schedule};
pub use algo::shared_tree::SharedTree;
pub use algo::types::*;
pub use by_name::{AnyPlanner, INPUTS, LEVELS};
pub use engine::{
    Acceptable, Append, AppendApart, AppendDistinct, Attach, Attached, Branch, Connect, Core, Extend,
    GOAL_BIAS, Growing, Grown, Growth, Improving, NEEDS_BOTH_ENDS, Near, Nearest, PATIENCE, Propose, Purpose,
    Recipe, Rewire, STEP, Samples, Selector, SingleTree, Steer, Tree, Tuning, TwoTrees, Untried, improve,
};
pub use mp_cspace::erased::{AnyIndex, AnyProblem};
pub use mp_cspace::{
    BuildError, Demand, Endpoint, Goals, Parameter, PlannerInfo, Problem, Settings, Step, Verify, Workers,
    closest,
};
pub use registry::{
    Named, ProblemFactory, TreeState, Wrapper, build, build_from, build_with, planner, planners, wrappers,
};
