//! Thinning of point clouds on a grid.

use nalgebra::Point3;
use thiserror::Error;

/// Points that stand for others.
#[derive(Clone, Debug, PartialEq)]
pub struct Thinned {
    /// One for each cell of the grid that holds a point: the middle of the box around its points. In an order
    /// that does not depend on that of the points.
    pub centers: Vec<Point3<f64>>,
    /// No point is farther (m) from that of its cell: at most half the diagonal of a cell, zero where no two
    /// points share one.
    pub padding: f64,
    /// How many points were left out because a coordinate is not finite.
    pub not_finite: usize,
}

/// Why points cannot be thinned.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ThinError {
    /// There is no point with finite coordinates.
    #[error("none of {points} points has finite coordinates")]
    NoPoint {
        /// How many points there are.
        points: usize,
    },
    /// The cell is not positive, or too small for coordinates as large as these.
    #[error("cells of {cell} m are too small for coordinates as large as {farthest:e} m")]
    Cell {
        /// The side of a cell (m).
        cell: f64,
        /// The largest coordinate by magnitude (m).
        farthest: f64,
    },
}

/// The numbers of cells along an axis are below this by magnitude, so that three fit 128 bits.
const MOST: f64 = (1_u64 << 41) as f64;

/// Keeps one point for each cell of a grid of cubes with sides of `cell` (m): a ball around the kept one that
/// is larger by [`padding`](Thinned::padding) has every ball inside. Points that are not finite, which depth
/// cameras give where they see nothing, are left out. O(n log n).
///
/// ```
/// use nalgebra::Point3;
///
/// let points = [[0.001, 0.0, 0.0], [0.003, 0.0, 0.0], [0.5, 0.0, 0.0], [f64::NAN; 3]].map(Point3::from);
/// let thinned = mp_geom::thin(&points, 0.01)?;
/// assert_eq!((thinned.centers.len(), thinned.not_finite), (2, 1));
/// assert!((thinned.padding - 0.001).abs() < 1e-12);
/// # Ok::<(), mp_geom::ThinError>(())
/// ```
///
/// # Errors
/// [`ThinError`] when no point is left, or the cell does not suit them.
pub fn thin(points: &[Point3<f64>], cell: f64) -> Result<Thinned, ThinError> {
    let finite = || points.iter().filter(|p| p.iter().all(|x| x.is_finite()));
    let farthest = finite().map(|p| p.coords.amax()).fold(0.0, f64::max);
    if !(cell > 0.0 && farthest / cell < MOST) {
        return Err(ThinError::Cell { cell, farthest });
    }
    let number = |x: f64| ((x / cell).floor() + MOST) as u128;
    let place = |p: &Point3<f64>| number(p.x) << 84 | number(p.y) << 42 | number(p.z);
    let mut placed: Vec<(u128, Point3<f64>)> = finite().map(|p| (place(p), *p)).collect();
    if placed.is_empty() {
        return Err(ThinError::NoPoint { points: points.len() });
    }
    placed.sort_unstable_by_key(|(place, _)| *place);
    let (mut centers, mut padding) = (Vec::new(), 0.0_f64);
    for cell in placed.chunk_by(|(a, _), (b, _)| a == b) {
        let first = cell[0].1;
        let (low, high) = cell.iter().fold((first, first), |(low, high), (_, p)| (low.inf(p), high.sup(p)));
        // Without this, rounding could move a single point.
        let center = if low == high { first } else { nalgebra::center(&low, &high) };
        padding = cell.iter().map(|(_, p)| (p - center).norm_squared()).fold(padding, f64::max);
        centers.push(center);
    }
    // More than rounding of the distances and of what is computed with them.
    let padding = padding.sqrt() * (1.0 + 1e-12);
    Ok(Thinned { centers, padding, not_finite: points.len() - placed.len() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every ball is inside of a kept one; the order of the points does not matter; no more are kept than
        /// there are cells.
        #[test]
        fn kept_balls_hold_all(
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..200),
            cell in 0.01..0.9_f64,
        ) {
            let points: Vec<_> = points.into_iter().map(Point3::from).collect();
            let thinned = thin(&points, cell).unwrap();
            prop_assert!(thinned.padding <= 0.5 * 3.0_f64.sqrt() * cell * (1.0 + 1e-11));
            for p in &points {
                let nearest = thinned.centers.iter().map(|c| (c - p).norm()).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest <= thinned.padding);
            }
            let cells = points.iter().map(|p| p.coords.map(|x| (x / cell).floor() as i64));
            let cells: std::collections::HashSet<_> = cells.map(|c| [c.x, c.y, c.z]).collect();
            prop_assert_eq!(thinned.centers.len(), cells.len());
            let backward: Vec<_> = points.into_iter().rev().collect();
            prop_assert_eq!(thin(&backward, cell).unwrap(), thinned);
        }
    }

    #[test]
    fn points_alone_in_their_cells_stay_where_they_are() {
        let points = [[0.1, -0.2, 0.3], [7.0, 8.0, 9.0]].map(Point3::from);
        assert_eq!(
            thin(&points, 0.05).unwrap(),
            Thinned { centers: points.to_vec(), padding: 0.0, not_finite: 0 }
        );
    }

    #[test]
    fn what_cannot_be_thinned() {
        let p = Point3::origin();
        let bad = [f64::NAN, f64::INFINITY].map(|x| Point3::new(0.0, x, 0.0));
        assert_eq!(thin(&bad, 0.1), Err(ThinError::NoPoint { points: 2 }));
        assert_eq!(thin(&[], 0.1), Err(ThinError::NoPoint { points: 0 }));
        assert_eq!(thin(&[bad[0], p], 0.1).unwrap().not_finite, 1);
        for cell in [0.0, -1.0, f64::NAN, 1e-300] {
            assert!(
                matches!(thin(&[Point3::new(1.0, 0.0, 0.0)], cell), Err(ThinError::Cell { .. })),
                "{cell}"
            );
        }
    }
}
