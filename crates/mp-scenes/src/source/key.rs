//! `key-1.2`, `key-1.5`: a key goes through a lock of two wards, between which it is turned over.

use super::scene::{Files, HOME, QUARTER, Scene, Six};
use super::shape::{block, cells, cylinder, mapped, shifted, union};
use mp_geom::TriMesh;

/// Radius of the shaft, which is also half the thickness of the bit.
const THICK: f64 = 0.1;
/// How far the bit reaches from the axis, and its length along it.
const REACH: f64 = 0.8;
const BIT: f64 = 0.4;
/// Thickness of the plates of the lock.
const PLATE: f64 = 0.2;

/// Adds both scenes. The number in the name is the size of the openings, divided by that of the key.
pub(super) fn add(files: &mut Files) {
    let key = key();
    for (name, factor) in [("key-1.2", 1.2), ("key-1.5", 1.5)] {
        // The bit in the middle of the chamber.
        let turned_over = PLATE + 0.5 * factor * BIT;
        let along = |x: f64, turn: f64| -> Six { [x, 0.0, 0.0, 0.0, 0.0, turn] };
        let mut path: Vec<Six> = vec![[-1.5, 0.8, 1.0, 0.6, 0.5, 0.4], along(-0.6, 0.0)];
        path.extend((0..=6).map(|i| along(turned_over, QUARTER * f64::from(i) / 3.0)));
        path.extend([along(2.8, 2.0 * QUARTER), [3.2, -0.7, 0.9, -0.5, 0.9, 1.0]]);
        Scene::new(name, [[-3.0, -2.0, -2.0], [4.5, 2.0, 2.0]], "key/key.off", &key)
            .solved_by(&path)
            .obstacle(&format!("key/{name}.off"), &lock(factor), &[HOME])
            .finish(files);
    }
}

/// The key along the x axis, its origin in the middle of the bit.
fn key() -> TriMesh {
    let shaft = mapped(&shifted(&cylinder(THICK, 1.3, 12), [0.0, 0.0, -1.0]), |p| [p.z, p.x, p.y]);
    let bit = block([-0.5 * BIT, -THICK, 0.0], [0.5 * BIT, THICK, REACH]);
    union([shaft, bit])
}

/// Two plates with slots for the bit, upwards in the first one and downwards in the second, in a case with a chamber between them.
fn lock(factor: f64) -> TriMesh {
    let [slot, reach, chamber] = [THICK, REACH, BIT].map(|of_key| factor * of_key);
    let xs = [0.0, PLATE, PLATE + chamber, 2.0 * PLATE + chamber];
    let ys = [-2.5, -1.4, -slot, slot, 1.4, 2.5];
    let zs = [-2.5, -1.4, -reach, -slot, slot, reach, 1.4, 2.5];
    cells(&xs, &ys, &zs, |i, j, k| match i {
        0 => j != 2 || !matches!(k, 3 | 4),
        1 => !(1..=3).contains(&j) || !(1..=5).contains(&k),
        _ => j != 2 || !matches!(k, 2 | 3),
    })
}
