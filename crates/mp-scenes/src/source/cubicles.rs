//! `cubicles`: an office floor cut in two by a wall; the way round leads through the basement.

use super::scene::{Files, HOME, Scene};
use super::shape::{block, cells, plan};

/// Adds the scene.
pub(super) fn add(files: &mut Files) {
    let robot =
        cells(&[-0.25, 0.25, 1.0, 1.75], &[-0.25, 0.25, 1.25], &[-0.25, 0.25], |i, j, _| i == 0 || j == 0);
    let outer = cells(&[-12.3, -12.0, 12.0, 12.3], &[-8.3, -8.0, 8.0, 8.3], &[-3.5, -3.2, 3.0], |i, j, k| {
        k == 0 || i != 1 || j != 1
    });
    // The slab between the floors, with two stair wells.
    let slab =
        cells(&[-12.0, -7.6, -4.8, 5.8, 8.6, 12.0], &[-8.0, -1.4, 1.4, 8.0], &[-0.2, 0.0], |i, j, _| {
            j != 1 || i % 2 == 0
        });
    let divider = block([-0.15, -8.0, 0.0], [0.15, 8.0, 3.0]);
    let at = [-2.0, -0.06, 0.06, 2.0];
    let partition = plan(&[".#.", "###", ".#."], &at, &at, 0.0, 1.7);
    let desks = [(-9.4, -4.8), (-9.4, 4.8), (-3.6, -4.6), (3.6, 4.6), (9.2, 4.8), (3.6, -4.6)]
        .map(|(x, y)| [x, y, 0.0, 0.0, 0.0, 0.0]);
    let column = block([-0.3, -0.3, -3.2], [0.3, 0.3, -0.2]);
    let columns: Vec<_> = [-9.0, -4.0, 0.0, 4.0, 9.0]
        .iter()
        .flat_map(|&x| [-4.0, 4.0].map(|y| [x, y, 0.0, 0.0, 0.0, 0.0]))
        .collect();
    Scene::new("cubicles", [[-11.6, -7.6, -2.8], [11.6, 7.6, 2.4]], "cubicles/robot.txt", &robot)
        .query([-10.8, 2.0, 0.8, 0.0, 0.0, 0.0], [10.4, -2.6, 0.8, 1.2, 0.0, 0.0])
        .obstacle("cubicles/outer.off", &outer, &[HOME])
        .obstacle("cubicles/slab.off", &slab, &[HOME])
        .obstacle("cubicles/divider.txt", &divider, &[HOME])
        .obstacle("cubicles/partition.off", &partition, &desks)
        .obstacle("cubicles/column.txt", &column, &columns)
        .finish(files);
}
