//! Obstacle-based RRT: a point leaves a bug trap in the plane, along its walls.
//!
//! `cargo run -p mp-tree --example trees obrrt [SEED]`

use crate::shared;
use mp_cspace::{Rng, obstacles::ObstacleHints};
use mp_tree::{GrowthWeights, Obrrt};
use rand::RngExt;
use shared::Point;

/// The walls of the trap run around its middle.
pub(crate) struct Around;

impl ObstacleHints<Point> for Around {
    fn touches(&mut self, q: &Point) -> bool {
        !shared::free(q)
    }
    fn slide_along(
        &mut self,
        from: &Point,
        toward: &Point,
        _: Option<&Point>,
        rng: &mut Rng,
    ) -> Option<Point> {
        let out = (from - Point::new(0.5, 0.5)).try_normalize(0.0)? * (toward - from).norm();
        let tangent = Point::new(-out.y, out.x);
        Some(if rng.random_bool(0.5) { from + tangent } else { from - tangent })
    }
    fn moved_by(&self, q: &Point, from: &Point, to: &Point) -> Point {
        q + (to - from)
    }
}

pub(crate) fn main() -> shared::Result {
    let space = shared::square()?;
    let problem = shared::bug_trap(&space)?;
    shared::run(Obrrt::new(problem, Around, shared::tuning(), GrowthWeights::default())?)
}
