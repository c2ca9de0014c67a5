//! Where it is measured.

use crate::plan::Ready;
use miette::{IntoDiagnostic, Result};
use mp::geom::primitives::cuboid;
use mp::geom::{Aabb, TriMesh};
use mp::io::{Body, PlacedBody, Problem, SpaceKind};
use nalgebra::{Isometry3, Point3};
use std::path::PathBuf;

/// Shipped scenes.
pub(super) const SCENES: [&str; 8] =
    ["gempa-1", "gempa-2", "gempa-3", "gempa-4", "twisty", "cubicles", "bugtrap", "alpha-1.5"];

/// By how much the corridors are wider than the robot, metres.
pub(super) const SLACKS: [f64; 6] = [1.6, 0.8, 0.4, 0.2, 0.1, 0.05];

/// The robot is a bar of this length and width, metres.
const BAR: [f64; 2] = [0.3, 0.1];
/// How thick the wall is, and half the sides of the room.
const WALL: f64 = 1.0;
const ROOM: [f64; 3] = [2.0, 1.5, 1.5];

/// The name of the corridor with this slack.
pub(super) fn name(slack: f64) -> String {
    format!("corridor {slack}")
}

/// A bar must pass a square corridor through a wall, as many metres wider than it is. The straight way from start to
/// goal hits the wall beside it.
pub(super) fn corridors() -> Result<Vec<(String, Ready)>> {
    SLACKS.iter().map(|&slack| Ok((name(slack), Ready::of(corridor(slack)?)?))).collect()
}

fn corridor(slack: f64) -> Result<Problem> {
    let half = 0.5 * (BAR[1] + slack);
    let [_, y, z] = ROOM.map(|r| r + 0.5);
    let slab = |low: [f64; 2], high: [f64; 2]| -> Result<(TriMesh, Isometry3<f64>)> {
        let mesh = cuboid(WALL, high[0] - low[0], high[1] - low[1]).into_diagnostic()?;
        let at = Isometry3::translation(0.0, 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]));
        Ok((mesh, at))
    };
    let slabs = [
        slab([-y, -z], [-half, z])?,
        slab([half, -z], [y, z])?,
        slab([-half, -z], [half, -half])?,
        slab([-half, half], [half, z])?,
    ];
    let obstacles = slabs.into_iter().zip(1..).map(|((mesh, pose), i)| PlacedBody {
        name: format!("slab {i}"),
        file: PathBuf::new(),
        mesh,
        pose,
    });
    let bar = cuboid(BAR[0], BAR[1], BAR[1]).into_diagnostic()?;
    let high = Point3::from(ROOM);
    Ok(Problem {
        name: name(slack),
        space: SpaceKind::Se3,
        robot: Body { name: "bar".to_owned(), file: PathBuf::new(), mesh: bar },
        obstacles: obstacles.collect(),
        start: Isometry3::translation(-1.5, 1.1, -1.1),
        goal: Isometry3::translation(1.5, 1.1, 1.1),
        bounds: Some(Aabb { min: -high, max: high }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corridors_can_be_planned_in() {
        for (_, ready) in corridors().unwrap() {
            ready.check_ends().unwrap();
            assert_eq!(ready.overlaps().iter().filter(|text| text.contains("robot")).count(), 0);
        }
    }
}
