//! Fields that push snakes, as pictures of them.

use mp_plan::{RelaxField, Scene};

/// The energy is that of the clearance which the scene itself reports.
#[test]
fn energies_are_those_of_clearances() {
    for name in ["rrs-low", "rrs-maze"] {
        let scene = Scene::find(name).unwrap();
        let image = scene.field(&RelaxField::Clearance, &scene.start(), None, Some("0.15"), 40).unwrap();
        assert_eq!(image.range, 0.15);
        let height = image.energy.len() / image.width;
        assert_eq!((image.width.max(height), image.energy.len() % image.width), (40, 0));
        let (mut far, mut pushed) = (0, 0);
        for (i, energy) in image.energy.iter().enumerate() {
            let mut row = scene.start();
            row[0] = image.origin[0] + ((i % image.width) as f64 + 0.5) * image.cell;
            row[1] = image.origin[1] + ((i / image.width) as f64 + 0.5) * image.cell;
            let found = scene.explain(&row).unwrap();
            if !found.free || !found.in_bounds {
                continue;
            }
            let near = (1.0 - found.clearance / 0.15).max(0.0);
            assert!((energy - 0.5 * near * near).abs() < 1e-6, "{name} {i}: {energy} at {}", found.clearance);
            far += usize::from(near == 0.0);
            pushed += usize::from(near > 0.0);
        }
        assert!(far > 10 && pushed > 10, "{name}: {far} {pushed}");
    }
}

#[test]
fn other_scenes_and_bad_ranges_are_refused() {
    let scene = Scene::find("easy").unwrap();
    assert!(
        scene
            .field(&RelaxField::Clearance, &scene.start(), None, None, 40)
            .unwrap_err()
            .to_string()
            .contains("is not drawn")
    );
    let scene = Scene::find("rrs-low").unwrap();
    for range in ["0", "-1", "far", "200%"] {
        assert!(
            scene.field(&RelaxField::Clearance, &scene.start(), None, Some(range), 40).is_err(),
            "{range}"
        );
    }
    assert!(scene.field(&RelaxField::Clearance, &[], None, None, 40).is_err());
    assert!(scene.field(&RelaxField::Clearance, &[1.0], None, None, 40).is_err());
}
