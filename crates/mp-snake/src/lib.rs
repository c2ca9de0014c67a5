//! Active contours for motion planning: curves with fixed ends that minimize an energy, which keeps them away
//! from obstacles and straight otherwise.
//!
//! M. Kass, A. Witkin and D. Terzopoulos, *Snakes: active contour models*, IJCV 1, 1988; for paths as by K.
//! Baizid et al., *RRS: rapidly-exploring random snakes, a new method for mobile robot path planning*.
//!
//! | to | use |
//! |---|---|
//! | deform a curve in any space | [`Snake`], with [`Params`] |
//! | push it | a [`Field`]: [`Repulsion`] by a clearance gradient, a [`Grid`], a closure, two of them [`With`] each other |
//! | make fields of pictures | [`Grid`], [`outline_energy`] (eq. 3), [`signed_distance`], [`blurred`], [`laplacian`] |
//! | make fields of worlds of the plane | [`plane`]: eq. 3, and the risk of passing anywhere |
//! | estimate risk | [`risk`]: motion noise times range noise, a field and a path cost |
//! | plan with edges that bend | [`SnakePlanner`], whose edges are [`PolylineEdge`](mp_cspace::PolylineEdge)s |
//! | choose how they bend | [`Bending`]: by snakes, by bulges, by both; or your own [`Bend`] |
//! | relax a whole path | [`relax`] |
//!
//! A snake only guides and does not guarantee freedom of collision: [`SnakePlanner`] and [`relax`] accept
//! curves that the motion check has found free, piece by piece.
//!
//! A motion that is blocked by a disc goes around it:
//! ```
//! use mp_cspace::{Certified, Clearance, Direction, Extension, LocalPlanner, MotionClearance, Reach, Rn};
//! use mp_snake::SnakePlanner;
//! use nalgebra::Vector2;
//!
//! /// A point outside a disc.
//! struct Disc;
//! impl Clearance<Vector2<f64>> for Disc {
//!     fn clearance(&mut self, q: &Vector2<f64>, _: f64) -> f64 {
//!         q.norm() - 0.3
//!     }
//! }
//! impl MotionClearance<Vector2<f64>> for Disc {
//!     fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
//!         (to - from).norm()
//!     }
//! }
//! let field = |q: &Vector2<f64>, _: f64, gradient: &mut [f64]| {
//!     gradient.copy_from_slice((q / q.norm()).as_slice());
//!     q.norm() - 0.3
//! };
//! let space = Rn::<2>::new([-2.0; 2], [2.0; 2])?;
//! let mut local = SnakePlanner::new(&space, Certified::new(&space, Disc, 1e-3)?, field, 0.2)?;
//! let (from, to) = (Vector2::new(-1.0, -0.05), Vector2::new(1.0, -0.05));
//! let Extension::Reached(motion) = local.extend(&from, &to, Direction::Forward, Reach::Full) else { panic!() };
//! assert!(motion.cost > 2.0 && !motion.edge.vertices().is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod band;
mod bend;
mod bulge;
mod contour;
mod distance;
mod field;
mod grid;
mod image;
mod local;
mod params;
pub mod plane;
mod relax;
pub mod risk;
mod snake;

pub use band::Band;
pub use bend::{Bend, Bending, Bent, UnknownBending};
pub use bulge::Bulged;
pub use distance::{signed_distance, squared_distance};
pub use field::{Field, Nothing, Repulsion, With};
pub use grid::Grid;
pub use image::{blurred, laplacian, outline_energy};
pub use local::{SnakeCounters, SnakePlanner};
pub use params::{Params, SnakeError};
pub use relax::{Relaxed, relax};
pub use snake::{Energy, Moment, Rest, Snake};
