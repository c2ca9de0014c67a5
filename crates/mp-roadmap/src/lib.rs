//! The probabilistic roadmap family: one engine, and the algorithms on it. [`algo`] has the table of them.
//!
//! A roadmap is built once and answers many queries; or it grows until one start and goal are connected.
//! [`build`] makes planners of the second kind by name. Those by obstacles ([`Obprm`] and
//! [`ObstacleGeometryPrm`]) need the geometry of obstacles
//! ([`ObstacleGeometry`](mp_cspace::obstacles::ObstacleGeometry)).
//!
//! ```
//! use mp_cspace::{Discrete, FineDiscrete, Iterations, Outcome, Problem, Length, Rn, Rng, Straight, registry::Settings};
//! use mp_roadmap::build;
//! use nalgebra::Vector2;
//!
//! let space = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! let free = |q: &Vector2<f64>| (q.x - 0.5).abs() > 0.1 || q.y > 0.8;
//! let local = Straight::new(&space, Discrete::new(&space, free, Length::Fraction(0.01))?);
//! let verifier = FineDiscrete::new(&space, free, Length::Fraction(0.0005))?;
//! let problem = Problem::new(&space, local, verifier, Vector2::new(0.1, 0.1), Vector2::new(0.9, 0.1))?;
//!
//! let settings = Settings::parse(["neighbours=10"])?;
//! let mut planner = build("prm", problem, &settings)?;
//! match planner.solve(&mut Rng::seed(1), &mut Iterations(10_000), &mut ()) {
//!     Outcome::Solved(path) => assert!(path.states.len() > 2),
//!     Outcome::Stopped(reason) => panic!("stopped: {reason:?}"),
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The engine
//! Every attempt of every variant generates candidates and connects each to the [`Roadmap`], or refuses it.
//! Queries search for a path in the roadmap. Each of these verbs is a slot:
//!
//! | slot | trait | here |
//! |---|---|---|
//! | which configurations are tried as nodes | [`NodeGenerator`] | [`Free`], [`Learn`], [`AroundRemoved`], [`Pairs`] of [`NearObstacles`] or [`BetweenObstacles`], [`OnObstacles`], [`AroundObstacles`]; whole pieces: [`InRegions`] |
//! | which of them become nodes, with which edges | [`Connector`] | [`NearestConnector`], [`Star`], [`Visibility`], [`StagedConnector`] |
//! | how a path is searched for | [`Query`] | [`AStar`] |
//! | how one state is connected to another | [`LocalPlanner`](mp_cspace::LocalPlanner) | given by you; its edges are [`Reversible`](mp_cspace::Reversible) |
//!
//! A variant is a set of [`RoadmapPlannerParts`] for two loops: [`Builder`] builds until stopped,
//! [`RoadmapPlanner`] until start and goal are connected.
//!
//! # Guarantees
//! - A path is returned only after the verifier has passed each of its edges, in the direction of the path.
//!   An edge that fails is blocked, and planning goes on. Edges that passed are not verified again.
//! - On several threads ([`Builder::on`], [`ParallelProblem`]) the roadmap is the same to the bit as on one.
//! - Bad input is a [`BuildError`] before planning begins.
//! - An edge has one length for both directions, so the metric should be symmetric. Where it is not, paths are as safe, but
//!   may be longer than others in the roadmap.
//! - The same problem, parameters and random numbers give the same roadmap and path, bit for bit. Stopping
//!   and continuing changes nothing.

pub mod algo;
mod by_name;
mod engine;
mod registry;

pub use algo::types::*;
pub use by_name::{AnyEdgeChecker, AnyParallelProblem, AnyPlanner, ParallelProblem};
pub use engine::{
    AStar, Builder, CYCLES, Candidate, ConnectionStages, Connector, ENDS, ENDS_STEP, EdgeChecker, EdgeId,
    EndGrowth, Entry, Free, GraphPath, Growing, HasRoadmap, IndexedRoadmap, Link, LinkState, Listed,
    MAX_ROADMAP_BYTES, MilestoneKind, Mixing, NEIGHBOURS, NearestConnector, NeighborSet, NodeGenerator,
    PATIENCE, Pace, PairRule, Pairs, PairsPlanner, ParentMotion, Piece, Prefetching, Query, QueryMeter,
    RADIUS, Reachable, Roadmap, RoadmapError, RoadmapFileError, RoadmapPlanner, RoadmapPlannerParts,
    RoadmapQueries, StagedConnector, Tag, Turns, UNDIRECTED, Unanswered, fingerprint, length, reachable, yes,
};
pub use mp_cspace::erased::AnyIndex;
pub use mp_cspace::{BuildError, Path, registry::Settings};
#[cfg(not(test))]
pub use registry::erased;
pub use registry::{build, build_with, planner, planners};
