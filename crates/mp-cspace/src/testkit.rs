//! Conformance kits: checks of the axioms that planners rely on, for any implementation of the traits.
//!
//! Call them from the tests of your own space, metric, local planner or nearest-neighbour index.
//! They panic and name the violated axiom and the states that violate it.
//!
//! ```
//! use mp_cspace::{Rn, testkit};
//! let square = Rn::<2>::new([0.0, 0.0], [1.0, 1.0])?;
//! testkit::SpaceKit::new().run(&square);
//! # Ok::<(), mp_cspace::SpaceError>(())
//! ```

mod gradient;
mod local;
mod metric;
mod neighbors;
mod space;

pub use gradient::check_clearance_gradient;
pub use local::check_local_planner;
pub use metric::{check_metric, check_true_metric};
pub use neighbors::check_nearest_neighbors;
pub use space::SpaceKit;
