//! `apartment`: piano movers. A baby grand goes from the living room through the hall to the music room.
//!
//! `flat-1.05`, `flat-1.2`: the same piano in a flat without furniture, through two doors that it passes only on its side.

use super::furniture::{
    basin, bath, bed, chair, closet, counter, lamp, plant, refrigerator, round_table, shelves, sofa, stool,
    table, wardrobe,
};
use super::piano::{RAISE, piano};
use super::scene::{Files, HOME, QUARTER, Scene, Six};
use super::shape::{block, cells};
use mp_geom::TriMesh;

/// Adds the scene.
pub(super) fn add(files: &mut Files) {
    let at = |x: f64, y: f64, yaw: f64| -> Six { [x, y, 0.0, yaw, 0.0, 0.0] };
    let half_turn = 2.0 * QUARTER;
    Scene::new("apartment", [[0.3, 0.3, 0.3], [11.7, 10.7, 1.8]], "apartment/piano.off", &piano())
        .query([1.6, 3.6, RAISE + 0.06, half_turn, 0.0, 0.0], [10.6, 9.2, RAISE + 0.06, QUARTER, 0.0, 0.0])
        .obstacle("apartment/walls.off", &walls(), &[HOME])
        .obstacle("apartment/floor.txt", &block([-0.15, -0.15, -0.2], [12.15, 11.15, 0.0]), &[HOME])
        // Living room.
        .obstacle("apartment/sofa.off", &sofa(3), &[at(2.4, 0.55, half_turn)])
        .obstacle("apartment/armchair.off", &sofa(1), &[at(0.6, 1.7, QUARTER), at(4.3, 0.75, -2.6)])
        .obstacle("apartment/round_table.off", &round_table(), &[at(2.4, 1.7, 0.0)])
        .obstacle(
            "apartment/lamp.off",
            &lamp(),
            &[at(0.45, 0.45, 0.0), at(4.25, 10.6, 0.0), at(8.0, 10.6, 0.0)],
        )
        .obstacle(
            "apartment/plant.off",
            &plant(),
            &[at(6.4, 0.5, 0.0), at(0.45, 6.2, 0.0), at(11.6, 7.6, 1.0)],
        )
        .obstacle("apartment/shelves.off", &shelves(), &[at(6.6, 4.2, -QUARTER), at(8.0, 8.8, QUARTER)])
        // Kitchen.
        .obstacle("apartment/table.off", &table(0.8, 0.45), &[at(9.4, 2.4, 0.0)])
        .obstacle(
            "apartment/chair.off",
            &chair(),
            &[
                at(9.0, 1.85, half_turn),
                at(9.8, 1.8, half_turn),
                at(9.0, 2.95, 0.0),
                at(9.8, 3.05, 0.2),
                at(8.35, 2.4, QUARTER),
                at(10.5, 2.45, -QUARTER),
            ],
        )
        .obstacle("apartment/counter.off", &counter(), &[at(9.2, 0.34, half_turn)])
        .obstacle("apartment/refrigerator.off", &refrigerator(), &[at(11.5, 0.4, half_turn)])
        // Bedroom.
        .obstacle("apartment/bed.off", &bed(), &[at(1.6, 9.8, 0.0)])
        .obstacle("apartment/wardrobe.off", &wardrobe(), &[at(4.2, 8.6, -QUARTER)])
        // Bathroom.
        .obstacle("apartment/bath.off", &bath(), &[at(6.1, 10.5, 0.0)])
        .obstacle("apartment/basin.off", &basin(), &[at(5.1, 8.2, 0.0)])
        .obstacle("apartment/closet.off", &closet(), &[at(7.05, 8.4, -QUARTER)])
        // Music room.
        .obstacle("apartment/stool.off", &stool(), &[at(8.5, 10.2, 0.4)])
        .finish(files);
}

/// Adds the flats. The number in the name is the width of the doors divided by the height of the piano, and their height divided by
/// its width.
pub(super) fn add_flats(files: &mut Files) {
    let piano = piano();
    let size = piano.aabb();
    let (low, high) = (size.min.z, size.max.z);
    let (half_width, length) = (size.max.x, size.max.y - size.min.y);
    for (name, factor) in [("flat-1.05", 1.05), ("flat-1.2", 1.2)] {
        let (door, lintel) = (0.5 * factor * (high - low), 2.0 * factor * half_width);
        let hall = 1.25 * length;
        // On its side, in the middle of the door.
        let tilted = |x: f64, y: f64| -> Six { [x - 0.5 * (low + high), y, 0.5 * lintel, 0.0, QUARTER, 0.0] };
        let upright = |x: f64, z: f64| -> Six { [x, -2.0, z, 0.0, 0.0, 0.0] };
        let on_side = |x: f64| -> Six { [x, -2.0, 1.3, 0.0, QUARTER, 0.0] };
        let inside = 0.15 + 0.5 * hall - 0.5 * (size.min.y + size.max.y);
        let path = [
            upright(-1.5, RAISE + 0.2),
            upright(-1.5, 1.3),
            on_side(-1.5),
            tilted(-1.5, -2.0),
            tilted(-1.5, inside),
            tilted(1.5, inside),
            tilted(1.5, -2.0),
            on_side(1.5),
            upright(1.5, 1.3),
            upright(1.5, RAISE + 0.2),
        ];
        let xs = [-3.15, -3.0, -1.5 - door, -1.5 + door, -0.075, 0.075, 1.5 - door, 1.5 + door, 3.0, 3.15];
        let ys = [-3.65, -3.5, 0.0, 0.15, 0.15 + hall, 0.3 + hall];
        let walls = cells(&xs, &ys, &[0.0, lintel, 2.6], |i, j, k| match (i, j) {
            (0 | 8, _) | (_, 0 | 4) | (4, 1) => true,
            (2 | 6, 2) => k == 1,
            (_, 2) => true,
            _ => false,
        });
        Scene::new(name, [[-2.8, -3.3, 0.3], [2.8, hall, 1.8]], "apartment/piano.off", &piano)
            .solved_by(&path)
            .obstacle(&format!("flat/{name}.off"), &walls, &[HOME])
            .obstacle("flat/floor.txt", &block([-3.15, -3.65, -0.2], [3.15, 2.65, 0.0]), &[HOME])
            .finish(files);
    }
}

/// Walls 0.15 thick and 2.6 high, with door openings 2.1 high.
///
/// South of the hall the living room (west) and the kitchen; north of it bedroom, bathroom, music room.
fn walls() -> TriMesh {
    let xs = [-0.15, 0.0, 1.8, 2.7, 4.3, 4.6, 4.75, 5.5, 6.0, 6.8, 6.95, 7.4, 7.55, 9.0, 10.2, 12.0, 12.15];
    let ys = [-0.15, 0.0, 1.6, 2.8, 5.2, 5.35, 7.05, 7.2, 11.0, 11.15];
    cells(&xs, &ys, &[0.0, 2.1, 2.6], |i, j, k| {
        let lintel = k == 1;
        match (i, j) {
            (0 | 15, _) | (_, 0 | 8) => true,
            // Living room and kitchen to the hall.
            (4..=6 | 13, 4) => lintel,
            (_, 4) => true,
            // Bedroom, bathroom and music room to the hall.
            (2 | 8 | 13, 6) => lintel,
            (_, 6) => true,
            // Living room to kitchen.
            (9, 2) => lintel,
            (9, 1 | 3) | (5 | 11, 7) => true,
            _ => false,
        }
    })
}
