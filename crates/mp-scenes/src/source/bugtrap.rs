//! `bugtrap`: a rod in a hollow body; the only exit is a neck that points inwards. `trap-1.05` … `trap-1.5`: the same with a short,
//! straight neck; the number is its width divided by the thickness of the rod.

use super::scene::{Files, HOME, QUARTER, Scene};
use super::shape::{cylinder, lathe, shifted};
use std::f64::consts::PI;

/// Radius of the rod.
const ROD: f64 = 0.2;
/// Corners of the neck.
const SIDES: u32 = 32;

/// Adds the scenes.
pub(super) fn add(files: &mut Files) {
    let rod = shifted(&cylinder(ROD, 1.8, 16), [0.0, 0.0, -0.9]);
    let scene = |name| Scene::new(name, [[-5.0, -5.0, -4.0], [5.0, 5.0, 7.0]], "bugtrap/rod.txt", &rod);
    let (start, goal) = ([0.6, 0.4, -1.4, 0.0, QUARTER, 0.0], [3.8, -3.0, 5.0, 0.0, 0.6, 0.3]);
    scene("bugtrap")
        .query(start, goal)
        .obstacle("bugtrap/trap.off", &lathe(&profile(0.6, 0.6, 0.1), SIDES), &[HOME])
        .finish(files);
    let upright = |z: f64| [0.0, 0.0, z, 0.0, 0.0, 0.0];
    for (name, mouth) in [("trap-1.05", 1.05), ("trap-1.2", 1.2), ("trap-1.5", 1.5)] {
        // The flats of the neck are as far from its axis as said.
        let neck = mouth * ROD / mp_math::cos(PI / f64::from(SIDES));
        scene(name)
            .solved_by(&[start, upright(-1.4), upright(4.5), goal])
            .obstacle(&format!("bugtrap/{name}.off"), &lathe(&profile(neck, 1.2, 0.0), SIDES), &[HOME])
            .finish(files);
    }
}

/// The wall in the (radius, z) half-plane, from the outer pole below, up the outside, down into the neck and
/// back along the inside to the inner pole below. The neck reaches down to `low`, and widens by
/// `flare` outwards.
fn profile(neck: f64, low: f64, flare: f64) -> Vec<[f64; 2]> {
    vec![
        [0.0, -2.8],
        [1.4, -2.6],
        [2.4, -1.8],
        [2.8, -0.6],
        [2.8, 0.8],
        [2.5, 1.9],
        [1.9, 2.6],
        [1.5, 2.7],
        [1.0, 2.3],
        [neck + flare, 1.6],
        [neck, low],
        [neck + 0.2, low],
        [neck + 0.3, 1.5],
        [1.2, 2.0],
        [1.6, 2.3],
        [2.2, 1.8],
        [2.6, 0.8],
        [2.6, -0.6],
        [2.2, -1.7],
        [1.3, -2.4],
        [0.0, -2.6],
    ]
}
