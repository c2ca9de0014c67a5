//! Motion planning in Rust: one name for the layered `mp-*` crates, each of which can be used alone.
//!
//! | crate | what it holds |
//! |---|---|
//! | [`math`] | sine, logarithm, power, with the same bits on every machine |
//! | [`geom`] | triangle meshes, primitives, poses, boxes and spheres around things |
//! | [`collide`] | exact collision and distance between meshes |
//! | [`cspace`] | spaces, metrics, samplers, motion checks, neighbours, paths: the traits |
//! | [`control`] | systems that move by inputs: flows, input sets, the local planner that chooses among inputs |
//! | [`robot`] | robots among obstacles: the poses of their bodies, and collision checks |
//! | [`snake`] | active contours that bend motions around obstacles |
//! | [`time`] | trajectories: paths timed within limits, and the curves that controllers run |
//! | [`tree`] | the RRT family |
//! | [`roadmap`] | the PRM family |
//! | [`io`] | meshes, scenes, problems and paths in files |
//! | [`render`] | pictures of scenes in space and in the plane |
//! | [`plan`] | a scene in, a verified path out |
//! | [`batch`] | many runs: lists of problems, races, work for clusters |
//!
//! # A tour
//! A body that must pass through a window, from its mesh to a verified path:
//!
//! ```
//! use mp::geom::primitives::cuboid;
//! use mp::prelude::*;
//! use nalgebra::Isometry3;
//!
//! // 1. A robot among obstacles: four slabs that leave a window of 2 m by 2 m in the plane x = 0.
//! let slab = |name: &str, size: [f64; 3], at: [f64; 3]| {
//!     let mesh = cuboid(size[0], size[1], size[2])?;
//!     Ok::<_, mp::geom::PrimitiveError>((name.to_owned(), mesh, Isometry3::translation(at[0], at[1], at[2])))
//! };
//! let obstacles = [
//!     slab("below", [0.2, 8.0, 3.0], [0.0, 0.0, -2.5])?,
//!     slab("above", [0.2, 8.0, 3.0], [0.0, 0.0, 2.5])?,
//!     slab("left", [0.2, 3.0, 2.0], [0.0, 2.5, 0.0])?,
//!     slab("right", [0.2, 3.0, 2.0], [0.0, -2.5, 0.0])?,
//! ];
//! let robot = FreeFlyer::new(&cuboid(1.0, 0.5, 0.5)?, obstacles)?;
//!
//! // 2. Its space: positions within bounds (metres), all rotations.
//! let space = Se3::new([-4.0; 3], [4.0; 3])?;
//!
//! // 3. How motions are checked while planning, and how a finished path is proved.
//! let tolerance = robot.tolerance();
//! let verifier = Verifier::new(&space, &robot)?;
//! let local = Straight::new(&space, Certified::new(&space, robot, tolerance)?);
//!
//! // 4. A planner, a budget, a seed.
//! let (start, goal) = (Isometry3::translation(-3.0, 2.0, 2.0), Isometry3::translation(3.0, -2.0, -2.0));
//! let problem = Problem::new(&space, local, verifier, start, Goals::states([goal]))?;
//! let mut planner = RrtConnect::new(problem, Tuning::default())?;
//! let Outcome::Solved(path) = planner.solve(&mut Rng::seed(1), &mut Iterations(100_000), &mut ()) else {
//!     panic!("no path within the budget");
//! };
//! assert_eq!(path.states.first(), Some(&start));
//! assert_eq!(path.states.last(), Some(&goal));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Scenes in files are read as [`io::RigidProblem`] or, for arms, [`io::RobotProblem`]; `examples/scene.rs` and
//! `examples/arm.rs` plan on one. With [`plan::Scene`] this takes three lines, with shortening, pictures and a report
//! included; the program `mp` is built on it.

pub use mp_batch as batch;
pub use mp_collide as collide;
pub use mp_control as control;
pub use mp_cspace as cspace;
pub use mp_geom as geom;
pub use mp_io as io;
pub use mp_math as math;
pub use mp_plan as plan;
pub use mp_render as render;
pub use mp_roadmap as roadmap;
pub use mp_robot as robot;
pub use mp_snake as snake;
pub use mp_time as time;
pub use mp_tree as tree;

/// The names that most programs need.
pub mod prelude {
    pub use mp_cspace::{
        Certified, Discrete, Goal, Iterations, Length, LocalPlanner, MotionCheck, MotionValidity, Outcome,
        Path, Planner, Rn, Rng, Sampler, Se2, Se3, Space, Stop, Straight, Validity,
    };
    pub use mp_robot::{Arm, ArmModel, ArmVerifier, FreeFlyer, PlanarFlyer, PointRobot, Verifier};
    pub use mp_tree::{Goals, Problem, Rrt, RrtConnect, Tuning};
}
