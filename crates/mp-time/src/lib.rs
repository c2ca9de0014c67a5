//! Trajectories: what a path of joint values becomes when it has times.
//!
//! A [`Trajectory`] has times, positions and, where known, velocities and accelerations, and says which [curve](Interpolation) a controller
//! runs between them. A [`BlendedPath`] is a path with its corners rounded within a bound, and [`timed`] goes along it as fast as
//! [`Limits`] of velocity, acceleration and jerk allow, by [`toppra`] and a mean over a window of time.
//!
//! ```
//! use mp_time::{BlendedPath, Limits, timed};
//! let path = BlendedPath::new(&[vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 1.0]], 0.05)?;
//! let limits = Limits::new(vec![1.0, 1.0], vec![2.0, 2.0])?;
//! let timing = timed(&path, &limits, [("a", "rad"), ("b", "rad")])?;
//! assert!((2.5..3.0).contains(&timing.trajectory.duration()));
//! let corner = timing.trajectory.at(timing.corners[0]);
//! assert!(corner.velocity.iter().all(|v| *v > 0.3));
//! # Ok::<(), mp_time::TimeError>(())
//! ```
//!
//! Robots moved by torques are not here.

mod blend;
mod error;
mod jerk;
mod polynomial;
mod timing;
pub mod toppra;
mod trajectory;

pub use blend::{Blend, BlendedPath};
pub use error::TimeError;
pub use polynomial::range;
pub use timing::{Limits, Timing, timed};
pub use trajectory::{Extreme, Interpolation, Knots, Sample, Trajectory};
