//! The laser and the particle filter.

use mp_cspace::Rng;
use mp_experiments::rrs::noisy_robot::{ParticleFilter, Pose, range};
use mp_geom::planar::PlanarWorld;
use nalgebra::Vector2;

/// Particles about a known place are as uncertain as the place; seeing the walls makes them less so.
#[test]
fn seeing_walls_lessens_uncertainty() {
    let world = PlanarWorld::new(vec![], Some([[0.0, 0.0], [3.0, 2.0]])).unwrap();
    let pose = Pose { at: Vector2::new(1.0, 1.0), angle: 0.3 };
    let mut rng = Rng::seed(1);
    let mut filter = ParticleFilter::about(pose, &mut rng);
    let before = filter.uncertainty();
    assert!((0.010..0.018).contains(&before), "{before}");
    for _ in 0..60 {
        let seen = pose.scan(&world, &mut rng);
        filter.update([0.0, 0.0], &seen, &world, &mut rng);
    }
    assert!(filter.uncertainty() < 0.7 * before, "{} {before}", filter.uncertainty());
}

#[test]
fn beams_end_at_walls() {
    let world = PlanarWorld::new(vec![], Some([[0.0, 0.0], [3.0, 2.0]])).unwrap();
    let from = Vector2::new(1.0, 1.0);
    assert!((range(&world, from, Vector2::new(1.0, 0.0)) - 2.0).abs() < 2e-3);
    assert!((range(&world, from, Vector2::new(0.6, 0.8)) - 1.25).abs() < 2e-3);
}
