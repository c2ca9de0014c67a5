//! Fields of a world of the plane, as images of it: eq. 3, and the risk that is everywhere.

use crate::params::{not_negative, positive};
use crate::risk::{MotionNoise, RangeNoise, everywhere};
use crate::{Grid, outline_energy};
use mp_cspace::ParameterError;
use nalgebra::Vector2;

/// Cells of an image in the range of repulsion.
const CELLS: f64 = 7.5;

/// The most cells of an image along a side.
pub const MOST_CELLS: usize = 2048;

/// The standard deviation of the blur of an image, as a part of the range.
pub const BLUR: f64 = 1.0 / 3.0;

/// The length of a step of the robot in the landscape of risk, as a part of the range.
pub const STRIDE: f64 = 5.0 / 3.0;

/// The image of a world within `bounds` (of x, then of y; m). A cell is 1 if the robot `touches` something in
/// its middle, and 0 if not. 7.5 cells are as long as the `range` of repulsion (m), or more where a side
/// would have more than 2048.
///
/// # Errors
/// When the range is not positive and finite, the bounds are not finite, or an upper one is below its lower one.
pub fn occupancy(
    [x, y]: [[f64; 2]; 2],
    range: f64,
    mut touches: impl FnMut(Vector2<f64>) -> bool,
) -> Result<Grid, ParameterError> {
    let range = positive("the range of repulsion", range)?;
    let sides = [x, y].map(|[low, high]| high - low);
    for side in sides {
        not_negative("a side of the bounds", side)?;
    }
    let cell = (range / CELLS).max(sides[0].max(sides[1]) / MOST_CELLS as f64);
    let [width, height] = sides.map(|side| ((side / cell).ceil() as usize).clamp(2, MOST_CELLS + 1));
    Grid::from_fn([x[0], y[0]], cell, (width, height), |p| f64::from(u8::from(touches(p))))
}

/// Eq. 3 of Baizid et al. of such an image, as [`outline_energy`] says: blurred by a third of the range, from
/// 0 to 1.
///
/// # Errors
/// When the range is not positive and finite.
pub fn paper_energy(occupied: &Grid, range: f64) -> Result<Grid, ParameterError> {
    outline_energy(occupied, BLUR * range, 1.0)
}

/// The [risk](everywhere) of a robot that may pass everywhere in such an image, in steps of five thirds of
/// the range, from 0 to 1 where it is greatest. The deviations of its motion and of its sensor are the
/// default ones times `factor`.
///
/// # Errors
/// When the factor is not positive and finite, or the range is not, or they take too wide a blur.
pub fn risk_energy(occupied: &Grid, range: f64, factor: f64) -> Result<Grid, ParameterError> {
    let (motion, sensor) = (MotionNoise::default().times(factor), RangeNoise::default().times(factor));
    let risk = everywhere(occupied, motion, sensor, STRIDE * range)?;
    let most = risk.values().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    Ok(risk.map(|v| v / most))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disc of radius 0.5 in a room of 3 × 2 m.
    fn disc(p: Vector2<f64>) -> bool {
        (p - Vector2::new(1.0, 1.0)).norm() < 0.5
    }

    #[test]
    fn images_lie_over_the_bounds() {
        let image = occupancy([[0.0, 3.0], [0.0, 2.0]], 0.15, disc).unwrap();
        let (width, height) = image.size();
        assert!((image.cell() - 0.02).abs() < 1e-9 && (150..=151).contains(&width) && height >= 100);
        for (n, v) in image.values().iter().enumerate() {
            let p = Vector2::new((n % width) as f64 + 0.5, (n / width) as f64 + 0.5) * image.cell();
            assert_eq!(*v > 0.5, disc(p));
        }
        // However short the range is.
        assert!(occupancy([[0.0, 3.0], [0.0, 2.0]], 1e-9, |_| false).unwrap().size().0 <= MOST_CELLS + 1);
        assert!(occupancy([[0.0, 3.0], [0.0, 2.0]], f64::NAN, |_| false).is_err());
        for high in [f64::INFINITY, f64::NAN, -1.0] {
            assert!(occupancy([[0.0, high], [0.0, 2.0]], 0.1, |_| false).is_err(), "{high}");
        }
    }

    /// Both push away from the outline on its outside, the more the nearer; the noise widens the risk.
    #[test]
    fn fields_fall_outward() {
        let image = occupancy([[0.0, 3.0], [0.0, 2.0]], 0.15, disc).unwrap();
        let at = |grid: &Grid, far: f64| grid.at(&Vector2::new(1.5 + far, 1.0)).0;
        let [paper, risk, wide] = [
            paper_energy(&image, 0.15).unwrap(),
            risk_energy(&image, 0.15, 1.0).unwrap(),
            risk_energy(&image, 0.15, 2.0).unwrap(),
        ];
        for field in [&paper, &risk] {
            assert!(field.values().iter().all(|v| (0.0..=1.0).contains(v)));
            assert!((field.values().iter().copied().fold(0.0, f64::max) - 1.0).abs() < 1e-9);
            assert!(at(field, 0.04) > at(field, 0.08) && at(field, 0.5) < 1e-6);
        }
        // Where the robot touches the disc it hits it in half of all cases; the sum of both deviations is
        // about 4 cm.
        assert!((at(&risk, 0.0) - 0.5).abs() < 0.06, "{}", at(&risk, 0.0));
        assert!(at(&risk, 0.08) < 0.05 && at(&wide, 0.08) > 2.0 * at(&risk, 0.08));
        assert!(risk_energy(&image, 0.15, -1.0).is_err() && paper_energy(&image, 0.0).is_err());
    }
}
