//! Exact distances on maps.

use crate::Grid;
use crate::image::by_lines;

/// The squared distance (m²), from the middle of each cell, to the nearest middle of a cell whose number is
/// above one half; infinite where there is no such cell.
///
/// P. Felzenszwalb and D. Huttenlocher, *Distance transforms of sampled functions*, Theory of Computing 8,
/// 2012: the lower envelope of parabolas, row by row and column by column. Exact, O(cells).
#[must_use]
pub fn squared_distance(mask: &Grid) -> Grid {
    let seeds = mask.clone().map(|v| if v > 0.5 { 0.0 } else { f64::INFINITY });
    let (mut roots, mut bounds) = (Vec::new(), Vec::new());
    let square = mask.cell() * mask.cell();
    by_lines(&seeds, |from, to| envelope(from, to, &mut roots, &mut bounds)).map(|d| d * square)
}

/// `to[i]` is the least of `from[j] + (i − j)²` over all `j`.
fn envelope(from: &[f64], to: &mut [f64], roots: &mut Vec<usize>, bounds: &mut Vec<f64>) {
    roots.clear();
    bounds.clear();
    let height = |j: usize| from[j] + (j * j) as f64;
    for j in (0..from.len()).filter(|&j| from[j].is_finite()) {
        // Where the parabola at j falls below the last one of the envelope.
        let mut begins = f64::NEG_INFINITY;
        while let Some(&last) = roots.last() {
            begins = (height(j) - height(last)) / (2 * (j - last)) as f64;
            if begins > bounds[roots.len() - 1] {
                break;
            }
            roots.pop();
            bounds.pop();
            begins = f64::NEG_INFINITY;
        }
        roots.push(j);
        bounds.push(begins);
    }
    let mut k = 0;
    for (i, out) in to.iter_mut().enumerate() {
        while k + 1 < roots.len() && bounds[k + 1] < i as f64 {
            k += 1;
        }
        *out = roots.get(k).map_or(f64::INFINITY, |&j| from[j] + (i.abs_diff(j) * i.abs_diff(j)) as f64);
    }
}

/// The signed distance (m) of the middle of each cell to the boundary of the occupied region, cells whose
/// number is above one half: positive outside, negative inside, exact between middles and half a cell less.
/// At most `far` (m), as everywhere on an empty map.
///
/// Used as a [clearance gradient](mp_cspace::obstacles::ClearanceGradient) it is that of a point robot; for a
/// disc use `map(|d| d - radius)`.
#[must_use]
pub fn signed_distance(mask: &Grid, far: f64) -> Grid {
    let _span = tracing::debug_span!("distance", cells = mask.values().len()).entered();
    let outside = squared_distance(mask);
    let inside = squared_distance(&mask.clone().map(|v| if v > 0.5 { 0.0 } else { 1.0 }));
    let half = 0.5 * mask.cell();
    let signed = outside.values().iter().zip(inside.values()).map(|(&out, &within)| {
        if out > 0.0 { (out.sqrt() - half).min(far) } else { -(within.sqrt() - half).min(far) }
    });
    mask.with_values(signed.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn agrees_with_all_pairs(
            width in 2..20_usize,
            cells in prop::collection::vec(prop::bool::weighted(0.15), 400),
        ) {
            let values: Vec<f64> = cells[..width * (400 / width)].iter().map(|&o| f64::from(u8::from(o))).collect();
            let mask = Grid::new([0.0, 0.0], 0.5, width, values).unwrap();
            let found = squared_distance(&mask);
            let place = |n: usize| ((n % width) as f64, (n / width) as f64);
            for (n, d) in found.values().iter().enumerate() {
                let (x, y) = place(n);
                let squares = (0..mask.values().len()).filter(|&m| mask.values()[m] > 0.5).map(|m| {
                    let (u, v) = place(m);
                    0.25 * (mp_math::powi(x - u, 2) + mp_math::powi(y - v, 2))
                });
                prop_assert_eq!(*d, squares.fold(f64::INFINITY, f64::min));
            }
        }
    }

    #[test]
    fn signs_tell_inside_from_outside() {
        let slab =
            Grid::from_fn([0.0, 0.0], 0.1, (50, 4), |p| f64::from(u8::from((2.0..3.0).contains(&p.x))))
                .unwrap();
        let distance = signed_distance(&slab, 9.0);
        let at = |x: f64| distance.at(&nalgebra::Vector2::new(x, 0.2)).0;
        for (x, expected) in [(0.55, 1.45), (1.95, 0.05), (2.05, -0.05), (2.45, -0.45), (3.55, 0.55)] {
            assert!((at(x) - expected).abs() < 1e-9, "{x}: {}", at(x));
        }
        let empty = signed_distance(&slab.map(|_| 0.0), 9.0);
        assert!(empty.values().iter().all(|d| *d == 9.0));
    }
}
