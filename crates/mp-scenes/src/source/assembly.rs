//! `assembly-1.05`, `assembly-1.2`: a hook of cubes is taken out of a block, by 25 steps along three axes.

use super::scene::{Files, HOME, Scene, Six};
use super::shape::cells;
use mp_geom::TriMesh;
use std::collections::BTreeSet;

type Cube = [i32; 3];

const HOOK: [Cube; 5] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [2, 1, 1]];
/// The moves that take it out: an axis, a direction, a number of steps. The last one goes upwards through the top.
const MOVES: [(usize, i32, i32); 7] =
    [(1, -1, 3), (0, 1, 4), (2, -1, 3), (0, -1, 4), (1, 1, 3), (0, 1, 2), (2, 1, 6)];

/// Adds both scenes. The number in the name is the width of the tunnels divided by that of the cubes of the hook.
pub(super) fn add(files: &mut Files) {
    let mut at = [0; 3];
    let (mut stops, mut carved) = (vec![at], BTreeSet::from(HOOK));
    let mut inside = carved.clone();
    for (axis, direction, steps) in MOVES {
        inside.clone_from(&carved);
        for _ in 0..steps {
            at[axis] += direction;
            carved.extend(HOOK.map(|cube| plus(cube, at)));
        }
        stops.push(at);
    }
    let limit = |axis: usize| {
        let along = inside.iter().map(|cube| cube[axis]);
        [along.clone().min().unwrap_or(0) - 1, along.max().unwrap_or(0) + 1]
    };
    let limits = [0, 1, 2].map(limit);
    let block = cubes(limits, |cube| !carved.contains(&cube));
    let mut path: Vec<Six> =
        stops.iter().map(|c| [f64::from(c[0]), f64::from(c[1]), f64::from(c[2]), 0.0, 0.0, 0.0]).collect();
    let [x, y, z] = at.map(f64::from);
    path.push([x + 1.0, y + 2.0, z + 3.0, 1.0, 0.5, -0.5]);
    let bounds = [limits.map(|[low, _]| f64::from(low) - 3.0), limits.map(|[_, high]| f64::from(high) + 6.0)];
    for (name, factor) in [("assembly-1.05", 1.05), ("assembly-1.2", 1.2)] {
        Scene::new(name, bounds, &format!("assembly/{name}.off"), &hook(factor))
            .solved_by(&path)
            .obstacle("assembly/block.off", &block, &[HOME])
            .finish(files);
    }
}

fn plus(a: Cube, b: Cube) -> Cube {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The cubes of side 1 for which `solid` is true, within limits along each axis; that called `[0, 0, 0]` is about the origin.
fn cubes(limits: [[i32; 2]; 3], solid: impl Fn(Cube) -> bool) -> TriMesh {
    let [xs, ys, zs] =
        limits.map(|[low, high]| (low..=high + 1).map(|i| f64::from(i) - 0.5).collect::<Vec<_>>());
    let at = |axis: usize, i: usize| limits[axis][0] + i as i32;
    cells(&xs, &ys, &zs, |i, j, k| solid([at(0, i), at(1, j), at(2, k)]))
}

/// The hook, its bars 1 / `factor` thick.
fn hook(factor: f64) -> TriMesh {
    let half = 0.5 / factor;
    // Two planes for each cube: between them it is solid, and between two cubes if both are there.
    let lines: Vec<f64> = (-1..=2).flat_map(|i| [f64::from(i) - half, f64::from(i) + half]).collect();
    let both = |i: usize| [i / 2, i.div_ceil(2)].map(|i| i as i32 - 1);
    cells(&lines, &lines, &lines, |i, j, k| {
        let [xs, ys, zs] = [i, j, k].map(both);
        xs.iter().all(|&x| ys.iter().all(|&y| zs.iter().all(|&z| HOOK.contains(&[x, y, z]))))
    })
}
