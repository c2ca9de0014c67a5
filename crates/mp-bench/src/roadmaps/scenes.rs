//! The scenes of the measurement: shipped ones, and corridors.

use crate::error::{IntoError, Result};
use crate::scenes::Rigid;
use mp_geom::primitives::cuboid;
use mp_geom::{Aabb, pose_from_six};
use mp_io::{Body, PlacedBody, RigidProblem, SpaceKind};
use nalgebra::{Isometry3, Point3};
use std::path::PathBuf;

/// Shipped scenes.
pub(super) const SCENES: [&str; 8] =
    ["gempa-1", "gempa-2", "gempa-3", "gempa-4", "twisty", "cubicles", "bugtrap", "alpha-1.5"];

/// Corridors of one kind, of different widths.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corridors {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    /// How much wider each is than the robot, metres: halved at first, then in finer steps, where planners
    /// fail.
    pub(super) slacks: [f64; 11],
    make: fn(&str, f64) -> Result<RigidProblem>,
}

/// All kinds of corridors.
pub(super) const CORRIDORS: [Corridors; 2] = [
    Corridors {
        name: "rod",
        title: "A rod in the plane",
        slacks: [0.3, 0.15, 0.1261, 0.1061, 0.0892, 0.075, 0.0631, 0.053, 0.0446, 0.0375, 0.0315],
        make: rod,
    },
    Corridors {
        name: "bar",
        title: "A bar in space",
        slacks: [1.6, 0.8, 0.4, 0.3364, 0.2828, 0.2378, 0.2, 0.1682, 0.1414, 0.1189, 0.1],
        make: bar,
    },
];

impl Corridors {
    pub(super) fn scene(&self, slack: f64) -> String {
        format!("{} {slack}", self.name)
    }

    /// The corridor called `name`.
    pub(super) fn find(&self, name: &str) -> Option<Result<Rigid>> {
        let slack = self.slacks.iter().find(|&&slack| self.scene(slack) == name)?;
        Some((self.make)(name, *slack).and_then(Rigid::new))
    }

    /// All corridors, the widest first.
    pub(super) fn ready(&self) -> Result<Vec<(String, Rigid)>> {
        let one = |&slack: &f64| {
            let name = self.scene(slack);
            let ready = Rigid::new((self.make)(&name, slack)?)?;
            Ok((name, ready))
        };
        self.slacks.iter().map(one).collect()
    }
}

/// A block with these sides, centred at a point.
fn block(name: &str, sides: [f64; 3], at: [f64; 3]) -> Result<PlacedBody> {
    let mesh = cuboid(sides[0], sides[1], sides[2]).into_error()?;
    let pose = Isometry3::translation(at[0], at[1], at[2]);
    Ok(PlacedBody { name: name.to_owned(), file: PathBuf::new(), mesh, pose })
}

fn problem(
    name: &str,
    space: SpaceKind,
    robot: [f64; 3],
    obstacles: Vec<PlacedBody>,
    [start, goal]: [[f64; 6]; 2],
    room: [f64; 3],
) -> Result<RigidProblem> {
    let mesh = cuboid(robot[0], robot[1], robot[2]).into_error()?;
    let high = Point3::from(room);
    Ok(RigidProblem {
        name: name.to_owned(),
        space,
        robot: Body { name: "robot".to_owned(), file: PathBuf::new(), mesh },
        obstacles,
        start: pose_from_six(start),
        goal: pose_from_six(goal),
        bounds: Some(Aabb { min: -high, max: high }),
    })
}

/// A bar of 0.3 by 0.1 by 0.1 m must pass a square corridor 1 m long. The straight way from start to goal
/// hits the wall beside it.
fn bar(name: &str, slack: f64) -> Result<RigidProblem> {
    let room = [2.0, 1.5, 1.5];
    let half = 0.5 * (0.1 + slack);
    let [_, y, z] = room.map(|r| r + 0.5);
    let slab = |name, low: [f64; 2], high: [f64; 2]| {
        let sides = [1.0, high[0] - low[0], high[1] - low[1]];
        block(name, sides, [0.0, 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])])
    };
    let slabs = vec![
        slab("left", [-y, -z], [-half, z])?,
        slab("right", [half, -z], [y, z])?,
        slab("low", [-half, -z], [half, -half])?,
        slab("high", [-half, half], [half, z])?,
    ];
    let ends = [[-1.5, 1.1, -1.1, 0.0, 0.0, 0.0], [1.5, 1.1, 1.1, 0.0, 0.0, 0.0]];
    problem(name, SpaceKind::Se3, [0.3, 0.1, 0.1], slabs, ends, room)
}

/// A rod of 0.8 by 0.1 m must pass a corridor 0.8 m long, in the plane, and turn before and behind it.
fn rod(name: &str, slack: f64) -> Result<RigidProblem> {
    let y = 1.0 + 0.5 * (0.1 + slack);
    let walls =
        vec![block("low", [0.8, 2.0, 1.0], [0.0, -y, 0.0])?, block("high", [0.8, 2.0, 1.0], [0.0, y, 0.0])?];
    let ends = [[-1.4, 0.3, 0.0, 0.0, 0.0, 1.5], [1.4, -0.3, 0.0, 0.0, 0.0, -1.0]];
    problem(name, SpaceKind::Se2, [0.8, 0.1, 0.2], walls, ends, [2.0, 1.5, 0.5])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corridors_can_be_planned_in() {
        for corridors in CORRIDORS {
            assert!(corridors.slacks.is_sorted_by(|a, b| a > b));
            for (name, ready) in corridors.ready().unwrap() {
                let odd = mp_plan::Scene::from_problem(ready.problem().clone()).unwrap().check_ends();
                assert!(odd.unwrap().is_empty(), "{name}");
            }
        }
    }
}
