//! Retraction-based RRT: a point leaves a bug trap in the plane, along its walls.
//!
//! `cargo run -p mp-tree --example trees retraction_rrt [SEED]`

use crate::shared;
use mp_tree::RetractionRrt;
use shared::Point;

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    // The wall is a ring: it repels to the side on which the point is.
    let gradient = |q: &Point, _reach: f64, gradient: &mut [f64]| {
        let from = q - Point::new(0.5, 0.5);
        let out = if from.norm() < 0.25 { -from } else { from };
        gradient.copy_from_slice(out.try_normalize(0.0).unwrap_or(Point::x()).as_slice());
        (from.norm() - 0.25).abs() - 0.05
    };
    let problem = shared::bug_trap(&space)?;
    shared::run(RetractionRrt::new(problem, gradient, 8, shared::tuning())?)
}
