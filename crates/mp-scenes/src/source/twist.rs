//! `twist-1.05`, `twist-1.2`: a plate goes through a slot that turns by a right angle on its way through a thick slab.

use super::scene::{Files, HOME, Scene, Six};
use super::shape::{block, cells, mapped};
use std::f64::consts::FRAC_PI_4;

/// Half the width, thickness and length of the plate.
const PLATE: [f64; 3] = [0.5, 0.15, 0.4];
/// How far the slot turns for each metre; the slab is from −1 to 1.
const TURN: f64 = FRAC_PI_4;
/// Pieces of the slot along its width and its length.
const PIECES: [i32; 2] = [6, 24];

/// Adds both scenes: slots that are wider than the sweep of the plate by these factors.
pub(super) fn add(files: &mut Files) {
    let [a, b, c] = PLATE;
    let plate = block([-a, -b, -c], [a, b, c]);
    let (s, turned) = mp_math::sin_cos(TURN * c);
    let (width, thickness) = (a * turned + b * s, b * turned + a * s);
    let mut path: Vec<Six> = vec![[1.5, -1.0, 2.0, 0.4, 0.3, -0.5]];
    path.extend((-8..=8).rev().map(|i| {
        let z = 0.2 * f64::from(i);
        [0.0, 0.0, z, TURN * z, 0.0, 0.0]
    }));
    path.push([-1.2, 1.4, -2.0, 2.0, -0.4, 0.6]);
    for (name, factor) in [("twist-1.05", 1.05), ("twist-1.2", 1.2)] {
        let slab = slab(factor * width, factor * thickness);
        Scene::new(name, [[-2.6, -2.6, -2.6], [2.6, 2.6, 2.6]], "twist/plate.txt", &plate)
            .solved_by(&path)
            .obstacle(&format!("twist/{name}.off"), &slab, &[HOME])
            .finish(files);
    }
}

/// The slab with a slot of this half width and half thickness.
fn slab(width: f64, thickness: f64) -> mp_geom::TriMesh {
    let even = |pieces: i32, half: f64| {
        (0..=pieces).map(move |i| half * f64::from(2 * i - pieces) / f64::from(pieces))
    };
    let xs: Vec<f64> = [-3.0].into_iter().chain(even(PIECES[0], width)).chain([3.0]).collect();
    let zs: Vec<f64> = even(PIECES[1], 1.0).collect();
    let straight =
        cells(&xs, &[-3.0, -thickness, thickness, 3.0], &zs, |i, j, _| j != 1 || i == 0 || i + 2 == xs.len());
    mapped(&straight, |p| {
        let (s, c) = mp_math::sin_cos(TURN * p.z);
        match p.x.abs() <= width && p.y.abs() <= thickness {
            true => [c * p.x - s * p.y, s * p.x + c * p.y, p.z],
            false => [p.x, p.y, p.z],
        }
    })
}
