//! `maze` and `planar-bugtrap`: robots that move in the plane z = 0 among walls of some height.

use super::scene::{Files, HOME, QUARTER, Scene, planar};
use super::shape::{block, cells, plan, ribbon, union};

/// Adds both scenes.
pub(super) fn add(files: &mut Files) {
    maze(files);
    bugtrap(files);
}

/// A bar and its way through a maze.
fn maze(files: &mut Files) {
    let rows = [
        "#####################",
        "#.......#.....#.....#",
        "#.#####.#.###.#.###.#",
        "#.#...#...#...#.#...#",
        "#.#.#.#####.###.#.###",
        "#.#.#.....#.....#...#",
        "#.#.#####.#########.#",
        "#.#.#...#.........#.#",
        "#.#.#.#.#########.#.#",
        "#.#...#.....#...#...#",
        "#.#########.#.#.#####",
        "#.........#...#.....#",
        "#.#######.#########.#",
        "#.......#...........#",
        "#####################",
    ];
    let lines = |n: usize, origin: f64| -> Vec<f64> {
        let mut at = origin;
        (0..=n)
            .map(|i| {
                let line = at;
                at += if i % 2 == 0 { 0.2 } else { 1.2 };
                (line * 1e6).round() / 1e6
            })
            .collect()
    };
    let (xs, ys) = (lines(21, -7.1), lines(15, -5.0));
    let walls = plan(&rows, &xs, &ys, -0.3, 0.3);
    let robot = cells(&[-0.5, -0.2, 0.5], &[-0.15, 0.15, 0.6], &[-0.2, 0.2], |i, j, _| i == 0 || j == 0);
    Scene::new("maze", [[-6.8, -4.7, 0.0], [6.8, 4.7, 0.0]], "maze/robot.txt", &robot)
        .query(planar(-5.8, 4.0, 0.0), planar(6.1, -4.2, QUARTER))
        .in_plane()
        .obstacle("maze/walls.off", &walls, &[HOME])
        .finish(files);
}

/// A bar leaves a bug trap: an open ring whose lips bend inwards.
fn bugtrap(files: &mut Files) {
    let half: Vec<[f64; 2]> = vec![
        [0.3, 0.4],
        [1.4, 0.45],
        [2.3, 1.0],
        [2.0, 2.0],
        [1.0, 2.7],
        [-0.4, 2.8],
        [-1.8, 2.3],
        [-2.7, 1.2],
        [-3.0, 0.0],
    ];
    let mirrored = half.iter().rev().skip(1).map(|&[x, y]| [x, -y]);
    let line: Vec<_> = half.iter().copied().chain(mirrored).collect();
    let robot = block([-0.8, -0.15, -0.2], [0.8, 0.15, 0.2]);
    Scene::new("planar-bugtrap", [[-5.0, -4.5, 0.0], [6.0, 4.5, 0.0]], "planar-bugtrap/robot.txt", &robot)
        .query(planar(-1.6, 0.0, 1.2), planar(4.8, 2.8, 0.0))
        .in_plane()
        .obstacle("planar-bugtrap/trap.off", &union([ribbon(&line, 0.2, -0.3, 0.3)]), &[HOME])
        .finish(files);
}
