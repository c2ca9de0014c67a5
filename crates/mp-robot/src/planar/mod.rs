//! Robots in the plane: discs and polygons in a [`PlanarWorld`](mp_geom::planar::PlanarWorld).

mod disc;
mod edge_list;
mod hints;
mod moving;
mod polygon;
mod verify;

pub use disc::DiscRobot;
pub use moving::{AmongMovingAreas, MovingAreasVerifier, PlanarConfiguration, PlanarRobot};
pub use polygon::PolygonRobot;
pub use verify::{DiscVerifier, PolygonVerifier};

use mp_geom::planar::PlanarWorld;

/// The tolerance (m) of checks for a robot of this size, whose points are within `radius` of its origin: a millionth of the size, and
/// at least what coordinates can resolve.
fn tolerance(world: &PlanarWorld, size: f64, radius: f64) -> f64 {
    let far = world.bounds().map_or(0.0, |[low, high]| low.coords.amax().max(high.coords.amax()));
    (1e-6 * size).max(1e-9 * (far + radius)).max(1e-12)
}

#[cfg(test)]
mod tests;
