//! Operations on maps: blur, Laplacian, and the image energy of the paper.

use crate::Grid;
use crate::params::positive;
use mp_cspace::ParameterError;

/// Applies `line` to every row, then to every column: `line(from, to)` computes `to` from `from`.
pub(crate) fn by_lines(grid: &Grid, mut line: impl FnMut(&[f64], &mut [f64])) -> Grid {
    let (width, height) = grid.size();
    let mut values = vec![0.0; width * height];
    for (from, to) in grid.values().chunks_exact(width).zip(values.chunks_exact_mut(width)) {
        line(from, to);
    }
    let (mut column, mut done) = (vec![0.0; height], vec![0.0; height]);
    for i in 0..width {
        (0..height).for_each(|j| column[j] = values[j * width + i]);
        line(&column, &mut done);
        (0..height).for_each(|j| values[j * width + i] = done[j]);
    }
    grid.with_values(values)
}

/// The map convolved with a Gaussian of standard deviation `sigma` (m): `G_σ ∗ I`. The border is continued
/// outward. The kernel is cut at four deviations and sums to one.
///
/// # Errors
/// When `sigma` is not positive and finite, or takes a kernel of more than a million cells.
pub fn blurred(grid: &Grid, sigma: f64) -> Result<Grid, ParameterError> {
    let cells = positive("the deviation of a blur", sigma)? / grid.cell();
    if cells > 1e5 {
        let expected = "at most a hundred thousand cells";
        return Err(ParameterError { name: "the deviation of a blur", expected, value: sigma });
    }
    let whole = (4.0 * cells).ceil() as isize;
    let weight = |k: isize| mp_math::exp(-0.5 * mp_math::powi(k as f64 / cells, 2));
    let sum: f64 = (-whole..=whole).map(weight).sum();
    // What is farther away than the map is long is its border, from everywhere.
    let (width, height) = grid.size();
    let reach = whole.min(width.max(height) as isize - 1);
    let mut kernel: Vec<f64> = (-reach..=reach).map(|k| weight(k) / sum).collect();
    let beyond: f64 = (reach + 1..=whole).map(|k| weight(k) / sum).sum();
    kernel[0] += beyond;
    kernel[2 * reach as usize] += beyond;
    Ok(by_lines(grid, |from, to| {
        let last = from.len() as isize - 1;
        for (i, out) in to.iter_mut().enumerate() {
            let at = |k: usize| from[(i as isize + k as isize - reach).clamp(0, last) as usize];
            *out = kernel.iter().enumerate().map(|(k, w)| w * at(k)).sum();
        }
    }))
}

/// `∇²I` (1/m²) by the five-point formula. The border is continued outward.
#[must_use]
pub fn laplacian(grid: &Grid) -> Grid {
    let (width, height) = grid.size();
    let v = grid.values();
    let square = grid.cell() * grid.cell();
    let at = |i: usize, j: usize| v[j * width + i];
    let values = (0..v.len()).map(|n| {
        let (i, j) = (n % width, n / width);
        let beside = at(i.saturating_sub(1), j) + at((i + 1).min(width - 1), j);
        let above = at(i, j.saturating_sub(1)) + at(i, (j + 1).min(height - 1));
        (beside + above - 4.0 * at(i, j)) / square
    });
    grid.with_values(values.collect())
}

/// The external energy of eq. 3 of the paper, of the image of a world:
/// `weight · (G_σ ∗ ∇²I)² / max (G_σ ∗ ∇²I)²`, so from 0 to `weight`.
///
/// As printed, `1 − (G_σ ∗ ∇²I)²` is least on the outlines of obstacles and attracts snakes, as in image
/// segmentation; the text wants repulsion. So the sign is inverted here, and the constant, which has no
/// force, left out. The energy is a ridge about two `sigma` wide along each outline. Deep inside an obstacle
/// larger than that it is flat: use a [`Repulsion`](crate::Repulsion) by [`signed_distance`] there.
///
/// # Errors
/// When `sigma` or `weight` is not positive and finite, or energies would not be finite.
///
/// [`signed_distance`]: crate::signed_distance
pub fn outline_energy(image: &Grid, sigma: f64, weight: f64) -> Result<Grid, ParameterError> {
    let weight = positive("the weight of an image", weight)?;
    let squares = blurred(&laplacian(image), sigma)?.map(|x| x * x);
    let most = squares.values().iter().copied().fold(0.0, f64::max);
    positive("the weight of an image times its greatest square", (weight * most).max(f64::MIN_POSITIVE))?;
    Ok(if most > 0.0 { squares.map(|x| weight * x / most) } else { squares })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    #[test]
    fn laplacians_of_polynomials_are_exact_inside() {
        let grid =
            Grid::from_fn([0.0, 0.0], 0.1, (9, 7), |p| 3.0 * p.x * p.x - p.y * p.y + p.x * p.y).unwrap();
        let l = laplacian(&grid);
        for j in 1..6 {
            for i in 1..8 {
                assert!((l.values()[j * 9 + i] - 4.0).abs() < 1e-9);
            }
        }
    }

    /// A blurred spike is a Gaussian: its sum and its variance.
    #[test]
    fn blurring_spreads_by_the_deviation() {
        let (n, cell, sigma) = (81, 0.05, 0.2);
        let middle = n as f64 * cell / 2.0;
        let spike = |p: Vector2<f64>| f64::from(u8::from((p - Vector2::repeat(middle)).norm() < 0.5 * cell));
        let grid = blurred(&Grid::from_fn([0.0, 0.0], cell, (n, n), spike).unwrap(), sigma).unwrap();
        let total: f64 = grid.values().iter().sum();
        let second: f64 = (grid.values().iter().enumerate())
            .map(|(k, v)| v * mp_math::powi((k % n) as f64 * cell + 0.5 * cell - middle, 2))
            .sum();
        assert!((total - 1.0).abs() < 1e-9 && (second.sqrt() - sigma).abs() < 2e-3, "{total} {second}");
        assert!(blurred(&grid, 0.0).is_err() && blurred(&grid, 1e9).is_err());
    }

    /// However wide the blur, it does no more work than one as wide as the map. The last one took ten minutes.
    #[test]
    fn a_blur_wider_than_the_map_sees_its_border_beyond() {
        let value = |i: usize, j: usize| ((7 * i + 3 * j) % 5) as f64;
        let values = (0..63).map(|n| value(n % 9, n / 9)).collect();
        let grid = Grid::new([0.0, 0.0], 0.5, 9, values).unwrap();
        let weight = |k: i32| mp_math::exp(-0.5 * mp_math::powi(f64::from(k) / 6.0, 2));
        let all: f64 = (-24..=24).map(weight).sum();
        let found = blurred(&grid, 3.0).unwrap();
        for (n, v) in found.values().iter().enumerate() {
            let (i, j) = ((n % 9) as i32, (n / 9) as i32);
            let at = |k: i32, l: i32| value((i + k).clamp(0, 8) as usize, (j + l).clamp(0, 6) as usize);
            let pairs = (-24..=24).flat_map(|k| (-24..=24).map(move |l| (k, l)));
            let expected: f64 =
                pairs.map(|(k, l)| weight(k) * weight(l) * at(k, l)).sum::<f64>() / (all * all);
            assert!((v - expected).abs() < 1e-12, "{v} {expected}");
        }
        let large = Grid::from_fn([0.0, 0.0], 1.0, (300, 300), |p| p.x).unwrap();
        assert!((blurred(&large, 1e5).unwrap().values()[0] - 150.0).abs() < 1.0);
    }

    /// The energy falls away from the outline of a disc, on both sides: it repels.
    #[test]
    fn outlines_repel() {
        let disc =
            Grid::from_fn([-1.0, -1.0], 0.02, (100, 100), |p| f64::from(u8::from(p.norm() < 0.4))).unwrap();
        let energy = outline_energy(&disc, 0.06, 2.0).unwrap();
        let at = |x: f64| energy.at(&Vector2::new(x, 0.0)).0;
        let ridge = (30..50).map(|i| at(f64::from(i) * 0.01)).fold(0.0, f64::max);
        assert!(ridge > 1.0 && ridge <= 2.0, "{ridge}");
        assert!(at(0.7) < 0.01 && at(0.05) < 0.01 && at(0.46) > at(0.52) && at(0.52) > at(0.6));
        // Energies that would be infinite.
        assert!(outline_energy(&disc, 0.06, 1e308).is_err());
        let flat = outline_energy(&disc.map(|_| 1.0), 0.06, 2.0).unwrap();
        assert!(flat.values().iter().all(|v| *v == 0.0));
    }
}
