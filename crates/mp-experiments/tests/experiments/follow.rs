//! A robot that follows paths.

use mp_cspace::{Path, Rn};
use mp_experiments::rrs::{follow, planned_and_followed};
use mp_scenes::source::disc_scenes::{DiscScene, RADIUS, tight};
use nalgebra::Vector2;

/// A wide way is followed to its end, near to it, and the same way again; a way along a wall is not safe.
#[test]
fn paths_are_followed() {
    let bar = vec![[1.0, 0.9], [4.0, 0.9], [4.0, 1.1], [1.0, 1.1]];
    let scene = DiscScene { size: [5.0, 2.0], obstacles: vec![bar], start: [0.5, 0.5], goal: [4.5, 0.5] };
    let robot = scene.robot().unwrap();
    let space = Rn::<2>::new([0.0; 2], scene.size).unwrap();
    let at = |y: f64| {
        Path::straight([(0.5, 0.5), (1.0, y), (4.0, y), (4.5, 0.5)].map(|(x, y)| Vector2::new(x, y)).to_vec())
    };
    let done = follow(&robot, &space, &at(0.45), 1).unwrap();
    // The corner (1, 0.9) is nearest, seen from the line through (0.5, 0.5) and (1, 0.45).
    let corner = 0.225 / mp_math::hypot(0.5, 0.05) - RADIUS;
    assert!(
        done.run.arrived && done.run.executed > 0.25 && (done.run.planned - corner).abs() < 1e-3,
        "{done:?}"
    );
    let again = follow(&robot, &space, &at(0.45), 1).unwrap();
    assert_eq!(done.driven, again.driven);
    let near = 0.9 - RADIUS - 0.002;
    let hits = (0..10).filter(|i| follow(&robot, &space, &at(near), *i).unwrap().run.executed <= 0.0).count();
    assert!(hits > 2, "{hits} of 10");
    assert!(done.run.error < 0.03 && done.run.uncertainty < 0.05, "{done:?}");
}

/// Planned, shortened, relaxed and driven by a robot with noise: a hash of every place (FNV-1a).
#[test]
fn a_path_is_followed_to_the_same_bits_on_every_machine() {
    let scene = tight();
    let followed = planned_and_followed(&scene, "rrs relaxed", 0).unwrap().unwrap();
    let places = followed.path.iter().chain(&followed.driven).flat_map(|p| [p.x, p.y]);
    let numbers = places.chain([followed.run.executed, followed.run.error, followed.run.uncertainty]);
    let hash =
        numbers.fold(0xcbf2_9ce4_8422_2325_u64, |h, v| (h ^ v.to_bits()).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(hash, 0xd515_d6d3_8ded_bd4a, "{hash:#x}");
}
