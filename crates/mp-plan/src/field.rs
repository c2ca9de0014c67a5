//! The field that pushes snakes, as an image of a world of the plane.

#[cfg(feature = "planar")]
use crate::{Error, RobotKind, counted::Counted, path::state};
#[cfg(feature = "planar")]
use mp_cspace::{Space, registry::Settings};
#[cfg(feature = "planar")]
use mp_snake::{Field, Repulsion};
#[cfg(feature = "planar")]
use mp_tree::algo::rrs::RANGE;
#[cfg(feature = "planar")]
use std::sync::atomic::AtomicU64;

/// The energy of the repulsion of obstacles, where the robot of a world of the plane may be: what pushes snakes, and with them the
/// bent edges of the planners `rrs` and `rrs-connect`. [`Scene::field`](crate::Scene::field) makes it.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldImage {
    /// The lower left corner of the first cell (m).
    pub origin: [f64; 2],
    /// The size of a cell (m).
    pub cell: f64,
    /// How many cells a row has.
    pub width: usize,
    /// The energy at the middle of each cell, row after row from the lowest: `½·(1 − c/range)²` for a clearance of `c`, so ½ where the
    /// robot touches an obstacle and 0 where it is farther away than the range.
    pub energy: Vec<f64>,
    /// The clearance (m) below which obstacles push.
    pub range: f64,
}

/// The image with about so many `cells` along the longer side. Coordinates of `row` other than the place stay.
#[cfg(feature = "planar")]
pub(crate) fn field<K: RobotKind>(
    kind: &K,
    row: &[f64],
    range: Option<&str>,
    cells: usize,
) -> Result<FieldImage, Error> {
    let not_drawn = || Error::new(format!("the field of {} is not drawn", kind.name()));
    let [Some(x), Some(y), ..] = kind.limits()[..] else {
        return Err(not_drawn().help("its robot has no bounds of x and y"));
    };
    let unused = AtomicU64::new(0);
    let knowledge = kind.obstacles(&|| Counted::new(kind.checker().clone(), &unused));
    let gradient =
        knowledge.gradient.ok_or_else(|| not_drawn().help("this robot knows no clearance gradient"))?;
    let mut settings = Settings::default();
    if let Some(range) = range {
        settings.set(RANGE.name, range);
    }
    let range = settings.length_of(&RANGE, kind.space())?;
    let mut repulsion = Repulsion::new(gradient, range)?;
    let sides = [x, y].map(|[low, high]| high - low);
    let cell = sides[0].max(sides[1]) / cells.clamp(2, 4096) as f64;
    let [width, height] = sides.map(|side| (side / cell).round().max(1.0) as usize);
    let (mut place, mut slope) = (row.to_vec(), vec![0.0; kind.space().dim()]);
    let mut energy = Vec::with_capacity(width * height);
    for i in 0..width * height {
        // A row that does not fit is refused by `state`.
        let at = [x[0] + ((i % width) as f64 + 0.5) * cell, y[0] + ((i / width) as f64 + 0.5) * cell];
        place.iter_mut().zip(at).for_each(|(value, at)| *value = at);
        energy.push(repulsion.energy(&state(kind, &place)?, &mut slope));
    }
    Ok(FieldImage { origin: [x[0], y[0]], cell, width, energy, range })
}

#[cfg(all(test, feature = "planar"))]
mod tests {
    use crate::Scene;

    /// The energy is that of the clearance which the scene itself reports.
    #[test]
    fn energies_are_those_of_clearances() {
        for name in ["rrs-low", "rrs-maze"] {
            let scene = Scene::find(name).unwrap();
            let image = scene.field(&scene.start(), Some("0.15"), 40).unwrap();
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
                assert!(
                    (energy - 0.5 * near * near).abs() < 1e-6,
                    "{name} {i}: {energy} at {}",
                    found.clearance
                );
                far += usize::from(near == 0.0);
                pushed += usize::from(near > 0.0);
            }
            assert!(far > 10 && pushed > 10, "{name}: {far} {pushed}");
        }
    }

    #[test]
    fn other_scenes_and_bad_ranges_are_refused() {
        let scene = Scene::find("easy").unwrap();
        assert!(scene.field(&scene.start(), None, 40).unwrap_err().to_string().contains("is not drawn"));
        let scene = Scene::find("rrs-low").unwrap();
        for range in ["0", "-1", "far", "200%"] {
            assert!(scene.field(&scene.start(), Some(range), 40).is_err(), "{range}");
        }
        assert!(scene.field(&[], None, 40).is_err());
        assert!(scene.field(&[1.0], None, 40).is_err());
    }
}
