//! `bugtrap`: a rod in a hollow body; the only exit is a neck that points inwards.

use super::scene::{Files, HOME, QUARTER, Scene};
use super::shape::{cylinder, lathe, shifted};

/// Adds the scene.
pub(super) fn add(files: &mut Files) {
    let rod = shifted(&cylinder(0.2, 1.8, 16), [0.0, 0.0, -0.9]);
    Scene::new("bugtrap", [[-5.0, -5.0, -4.0], [5.0, 5.0, 7.0]], "bugtrap/rod.txt", &rod)
        .query([0.6, 0.4, -1.4, 0.0, QUARTER, 0.0], [3.8, -3.0, 5.0, 0.0, 0.6, 0.3])
        .obstacle("bugtrap/trap.off", &lathe(&profile(), 32), &[HOME])
        .finish(files);
}

/// The wall in the (radius, z) half-plane, from the outer pole below, up the outside, down into the neck and
/// back along the inside to the inner pole below.
fn profile() -> Vec<[f64; 2]> {
    let neck = 0.6;
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
        [neck + 0.1, 1.6],
        [neck, 0.6],
        [neck + 0.2, 0.6],
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
