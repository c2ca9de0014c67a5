//! `easy` and `twisty`: a robot with three arms along three axes passes a window in a wall, wide or narrow.

use super::scene::{Files, HOME, Scene, Six};
use super::shape::cells;
use mp_geom::TriMesh;

/// Adds both scenes.
pub(super) fn add(files: &mut Files) {
    let robot = robot();
    let start: Six = [-3.2, 1.0, -1.0, 0.0, 0.0, 0.0];
    let goal: Six = [3.2, -1.0, 1.0, 2.0, 0.5, -1.0];
    for (name, file, half) in [("easy", "easy_wall.off", 1.0), ("twisty", "twisty_wall.off", 0.85)] {
        Scene::new(name, [[-4.6, -2.6, -2.6], [4.6, 2.6, 2.6]], "windows/robot.off", &robot)
            .query(start, goal)
            .obstacle("windows/box.off", &shell(), &[HOME])
            .obstacle(&format!("windows/{file}"), &wall(half), &[HOME])
            .finish(files);
    }
}

/// A chain of cubes: two steps along x, two along y, one along z.
fn robot() -> TriMesh {
    let xs = [-1.25, -0.75, 0.0, 0.5];
    let ys = [-0.25, 0.25, 0.75, 1.25];
    let zs = [-0.25, 0.25, 1.25];
    cells(&xs, &ys, &zs, |i, j, k| match k {
        0 => j == 0 || i == 2,
        _ => (i, j) == (2, 2),
    })
}

/// Floor, back and the two ends of the box; the bounds close its top and front.
fn shell() -> TriMesh {
    let grid = |half: f64| [-half - 0.3, -half, half, half + 0.3];
    cells(&grid(5.0), &grid(3.0), &grid(3.0), |i, j, k| (i != 1 || k == 0 || j == 2) && k != 2 && j != 0)
}

/// A wall across the box with a square window a little off its middle.
fn wall(half: f64) -> TriMesh {
    let (y, z) = (-0.3, 0.2);
    cells(
        &[-0.2, 0.2],
        &[-3.0, -1.6, y - half, y + half, 1.6, 3.0],
        &[-3.0, -1.6, z - half, z + half, 1.6, 3.0],
        |_, j, k| (j, k) != (2, 2),
    )
}
