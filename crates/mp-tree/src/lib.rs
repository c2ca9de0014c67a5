//! The rapidly-exploring random tree family: one engine, and the algorithms on it. [`algo`] has the table of
//! them.
//!
//! [`SharedTree`] ([`algo::shared_tree`]) is RRT on several threads, which grow one tree together;
//! [`SharedBiRrt`] ([`algo::shared_bi_rrt`]) is Bi-RRT so. Two meta-planners run other planners:
//! [`OrParallel`] ([`algo::or_parallel`]) several at once, [`Restarts`] ([`algo::restarts`]) one after the
//! other. [`build_from`] makes them by name.
//!
//! A planner is made from a checked [`Problem`] and is run through the trait [`Planner`](mp_cspace::Planner):
//! one step at a time, or until a stop ends it. [`build`] makes one by name.
//!
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Length, Rn, Rng, Straight};
//! use mp_tree::{Problem, Settings, build};
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || q.y > 0.8;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
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
//! A [`SearchTree`] is a [`Tree`] with its policies. Every iteration of every variant samples a target,
//! selects nodes, extends them toward the target and inserts the motions. Each of these verbs is a slot:
//!
//! | slot | trait | here |
//! |---|---|---|
//! | what to grow toward | [`TargetSampler`] | [`Samples`], [`Acceptable`], [`VoronoiBias`] |
//! | which nodes to grow from | [`Selector`] | [`NearestSelector`], [`DynamicDomain`], [`LeastViolated`], [`Unexhausted`] |
//! | how far | [`Extender`] | [`Extend`], [`Connect`], [`UtilityGuided`], [`ObstacleGuided`], [`Untried`], [`Cyclic`] |
//! | how a motion joins the tree | [`Inserter`] | [`Append`], [`AppendDistinct`], [`AppendApart`], [`Rewire`] |
//! | how one state is connected to another | [`LocalPlanner`](mp_cspace::LocalPlanner) | given by you |
//!
//! A variant is a set of [`TreePlannerParts`] for one of three loops: [`SingleTree`], [`TwoTrees`], and
//! [`Improving`], the loop of anytime planners.
//!
//! # Writing your own planner
//! A variant of the family fills the slots with policies, those here or your own. RRT whose tree is as greedy
//! as those of [`RrtConCon`]:
//! ```
//! # use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Planner, Length, Rn, Rng, Straight};
//! # use mp_tree::Problem;
//! # use nalgebra::Vector2;
//! # let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! # let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! # let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! # let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! # let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//! # let problem = Problem::new(&space, local, verifier, start, goal)?;
//! use mp_cspace::{Linear, Uniform};
//! use mp_tree::{Append, Connect, NearestSelector, Samples, SingleTree, TreePlannerParts, Tuning};
//!
//! let target_sampler = Samples(Uniform(&space));
//! let (selector, extender) = (NearestSelector(Linear::new()), Connect::default());
//! let parts = TreePlannerParts { target_sampler, selector, extender, inserter: Append, tuning: Tuning::default() };
//! let mut planner = SingleTree::assemble(problem, parts)?;
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! The loops try the straight motion to the goal first, unless the extender
//! [declines](Extender::allows_direct).
//!
//! A planner with a loop of its own takes from the engine what it needs: [`Core`] has the ends of the problem
//! and traces and verifies paths; [`SearchTree`] is a tree that grows, and that prunes the subtree below an
//! edge the verifier rejects. A tree that grows from random nodes:
//! ```
//! use mp_cspace::{Direction, Linear, LocalPlanner, NodeId, Observer, Path, Planner, Progress, Rng, Space};
//! use mp_tree::{AppendDistinct, SearchTree, Core, Extend, Grown, NearestSelector};
//! use rand::RngExt;
//!
//! struct RandomTree<'c, C: Space, L: LocalPlanner<C::State>> {
//!     core: Core<'c, C, L>,
//!     tree: SearchTree<C, L, NearestSelector<Linear>, AppendDistinct>,
//! }
//!
//! impl<C: Space, L: LocalPlanner<C::State>> Planner<C::State> for RandomTree<'_, C, L> {
//!     type Edge = L::Edge;
//!
//!     fn step(
//!         &mut self,
//!         rng: &mut Rng,
//!         observer: &mut dyn Observer<C::State>,
//!     ) -> Option<Path<C::State, L::Edge>> {
//!         let Self { core, tree } = self;
//!         core.iterations += 1;
//!         if let Some(root) = core.add_start(tree, observer) {
//!             return core.path(tree, root, observer, |_| ());
//!         }
//!         let goal = core.aim(rng);
//!         let target = goal.clone().unwrap_or_else(|| core.checker.space().sample_uniform(rng));
//!         let from = rng.random_range(0..tree.nodes().len()) as NodeId;
//!         let grown = tree.grow_from(from, &target, &mut core.checker, &mut Extend, rng, observer);
//!         match grown {
//!             Grown::Reached(id) if goal.is_some() => core.path(tree, id, observer, |_| ()),
//!             _ => None,
//!         }
//!     }
//!
//!     fn progress(&self) -> Progress {
//!         self.core.progress(self.tree.nodes().len())
//!     }
//! }
//! # use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Length, Rn, Straight};
//! # use mp_tree::{Problem, Tuning};
//! # use nalgebra::Vector2;
//! # let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! # let free = |q: &Vector2<f64>| (q - Vector2::new(0.5, 0.5)).norm() > 0.3;
//! # let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! # let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! # let (start, goal) = (Vector2::new(0.1, 0.5), Vector2::new(0.9, 0.5));
//! # let problem = Problem::new(&space, local, verifier, start, goal)?;
//!
//! let tuning = Tuning { step: Length::Fraction(0.2), goal_bias: 0.2, ..Tuning::default() };
//! let tree = SearchTree::new(0, Direction::Forward, NearestSelector(Linear::new()), AppendDistinct::default());
//! let mut planner = RandomTree { core: Core::new(problem, &tuning)?, tree };
//! let outcome = planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ());
//! assert!(matches!(outcome, Outcome::Solved(_)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guarantees
//! - A path is returned only after a [verifier](Verify) has passed each of its edges. An edge that fails is
//!   removed from the tree with the subtree below it, and planning goes on.
//! - Bad input is a [`BuildError`] before planning begins.
//! - The same problem, parameters and random numbers give the same path, bit for bit. Stopping and continuing
//!   changes nothing.
//! - No tree has two nodes with the same state.
//! - A panic in a local planner, verifier, goal or observer loses only the step it interrupts: a caller that
//!   catches it may inspect the trees and continue.

pub mod algo;
mod by_name;
mod engine;
mod registry;
mod trace;

pub use algo::or_parallel::OrParallel;
pub use algo::restarts::{Lengths, Restarts, Schedule};
pub use algo::shared_bi_rrt::SharedBiRrt;
pub use algo::shared_tree::SharedTree;
pub use algo::types::*;
pub use by_name::{ACCEPT, AnyPlanner, INPUTS, LEVELS, ORDER};
pub use engine::{
    Acceptable, Append, AppendApart, AppendDistinct, BALANCE, Connect, Core, Extend, Extender, GOAL_BIAS,
    Growing, Grown, Improving, Inserted, Inserter, NEEDS_BOTH_ENDS, Near, NearestSelector, PATIENCE, Purpose,
    Rewire, STEP, Samples, SearchTree, Selector, SingleTree, TargetSampler, Tree, TreePlannerParts, Tuning,
    TwoTrees, Untried, improve,
};
pub use mp_cspace::AnyProblem;
pub use mp_cspace::erased::AnyIndex;
pub use mp_cspace::{
    BuildError, EdgeChecker, Endpoint, Goals, Length, Problem, Verify, Workers,
    registry::{Demand, Parameter, PlannerInfo, Settings, closest},
};
#[cfg(not(test))]
pub use registry::erased;
pub use registry::{
    MetaPlanner, PlannerSpec, build, build_from, build_with, meta_planners, planner, planners,
};
