//! Scalar maps of the plane.

use crate::Field;
use crate::params::positive;
use mp_cspace::{ParameterError, obstacles::ClearanceGradient};
use nalgebra::Vector2;

/// Numbers at the middles of square cells, row after row: an image with a position and a scale. Row 0 is the
/// lowest (the smallest y): flip images, whose first row is the top one.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    origin: Vector2<f64>,
    cell: f64,
    /// Cells per metre.
    per_metre: f64,
    width: usize,
    height: usize,
    /// The last column but one, and the last row but one.
    last: [u32; 2],
    values: Vec<f64>,
}

impl Grid {
    /// The map of `values`, `width` to a row, of cells of size `cell` (m); `origin` (m) is the lower left
    /// corner of the first.
    ///
    /// # Errors
    /// When the cell is not positive and finite, the origin or a value is not finite, or `values` are not
    /// some whole number of rows, two rows and two columns at least and 2³² at most.
    pub fn new(
        origin: impl Into<Vector2<f64>>,
        cell: f64,
        width: usize,
        values: Vec<f64>,
    ) -> Result<Self, ParameterError> {
        let (origin, cell) = (origin.into(), positive("the size of a cell", cell)?);
        let not_finite = origin.iter().chain(&values).find(|v| !v.is_finite());
        if let Some(&value) = not_finite {
            return Err(ParameterError { name: "a number of a map", expected: "finite", value });
        }
        if width < 2 || values.len() < 2 * width || !values.len().is_multiple_of(width) {
            let expected = "a whole number of rows, at least two by two in all";
            return Err(ParameterError { name: "the number of cells", expected, value: values.len() as f64 });
        }
        let height = values.len() / width;
        let many = |_| {
            let (name, expected) = ("the number of columns or rows", "at most 2³²");
            ParameterError { name, expected, value: width.max(height) as f64 }
        };
        let last = [u32::try_from(width - 2).map_err(many)?, u32::try_from(height - 2).map_err(many)?];
        Ok(Self { origin, cell, per_metre: 1.0 / cell, width, height, last, values })
    }

    /// The map of a function of the middle of each cell.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_fn(
        origin: impl Into<Vector2<f64>>,
        cell: f64,
        (width, height): (usize, usize),
        mut f: impl FnMut(Vector2<f64>) -> f64,
    ) -> Result<Self, ParameterError> {
        let _span = tracing::debug_span!("map", width, height).entered();
        let origin = origin.into();
        let middle =
            |i: usize| Vector2::new((i % width.max(1)) as f64 + 0.5, (i / width.max(1)) as f64 + 0.5);
        let number = width.checked_mul(height).ok_or(ParameterError {
            name: "the number of cells",
            expected: "one that memory can hold",
            value: width as f64 * height as f64,
        })?;
        let values = (0..number).map(|i| f(origin + middle(i) * cell)).collect();
        Self::new(origin, cell, width, values)
    }

    /// The lower left corner (m).
    #[must_use]
    pub fn origin(&self) -> Vector2<f64> {
        self.origin
    }

    /// The size of a cell (m).
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The numbers, row after row.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The map with each number replaced.
    #[must_use]
    pub fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        self.values.iter_mut().for_each(|v| *v = f(*v));
        self
    }

    /// The same position and scale, with as many other numbers.
    pub(crate) fn with_values(&self, values: Vec<f64>) -> Self {
        Self { values, ..*self }
    }

    /// The number at a point, bilinear between the middles of cells, and its gradient. Beyond the outermost
    /// middles the number at the nearest point within, with a gradient of zero in that direction.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, p: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let width = self.width;
        let axis = |x: f64, last: u32| {
            let x = x * self.per_metre - 0.5;
            let most = f64::from(last) + 1.0;
            let inside = f64::from(u8::from(x > 0.0 && x < most));
            let x = if x > 0.0 { x.min(most) } else { 0.0 };
            let low = (x as u32).min(last);
            (low as usize, x - f64::from(low), inside)
        };
        let (i, u, inside_x) = axis(p.x - self.origin.x, self.last[0]);
        let (j, v, inside_y) = axis(p.y - self.origin.y, self.last[1]);
        let row = &self.values[j * width + i..][..width + 2];
        let (a, b, c, d) = (row[0], row[1], row[width], row[width + 1]);
        let (low, high) = (a + (b - a) * u, c + (d - c) * u);
        let slope_x = (b - a) * (1.0 - v) + (d - c) * v;
        let gradient = Vector2::new(slope_x * inside_x, (high - low) * inside_y) * self.per_metre;
        (low + (high - low) * v, gradient)
    }
}

/// The numbers are energies.
impl Field<Vector2<f64>> for Grid {
    #[inline]
    fn energy(&mut self, q: &Vector2<f64>, gradient: &mut [f64]) -> f64 {
        let (value, slope) = self.at(q);
        gradient.copy_from_slice(slope.as_slice());
        value
    }
}

/// The numbers are signed clearances (m), as of [`signed_distance`](crate::signed_distance).
impl ClearanceGradient<Vector2<f64>> for Grid {
    #[inline]
    fn clearance_gradient(&mut self, q: &Vector2<f64>, reach: f64, gradient: &mut [f64]) -> f64 {
        (&mut &*self).clearance_gradient(q, reach, gradient)
    }
}

/// The same for a shared map.
impl ClearanceGradient<Vector2<f64>> for &Grid {
    #[inline(always)]
    fn clearance_gradient(&mut self, q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]) -> f64 {
        let (value, slope) = self.at(q);
        gradient.copy_from_slice(slope.as_slice());
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bilinear_functions_are_exact() {
        let f = |p: Vector2<f64>| 1.0 + 2.0 * p.x - 3.0 * p.y + 0.5 * p.x * p.y;
        let grid = Grid::from_fn([-1.0, 2.0], 0.25, (8, 5), f).unwrap();
        assert_eq!((grid.size(), grid.cell(), grid.values().len()), ((8, 5), 0.25, 40));
        for p in [Vector2::new(0.0, 2.5), Vector2::new(-0.7, 3.0), Vector2::new(0.8, 2.2)] {
            let (value, slope) = grid.at(&p);
            assert!((value - f(p)).abs() < 1e-12);
            assert!((slope - Vector2::new(2.0 + 0.5 * p.y, -3.0 + 0.5 * p.x)).norm() < 1e-12);
        }
        let (value, slope) = grid.at(&Vector2::new(-9.0, 2.5));
        assert!((value - f(Vector2::new(-0.875, 2.5))).abs() < 1e-12 && slope.x == 0.0 && slope.y != 0.0);
        assert!(grid.at(&Vector2::new(f64::NAN, 2.5)).0.is_finite());
    }

    #[test]
    fn bad_maps_are_refused() {
        for (cell, width, n) in [(0.0, 2, 4), (1.0, 1, 4), (1.0, 3, 4), (1.0, 2, 2)] {
            assert!(Grid::new([0.0, 0.0], cell, width, vec![0.0; n]).is_err());
        }
        assert!(Grid::new([0.0, 0.0], 1.0, 2, vec![f64::NAN; 4]).is_err());
        assert!(Grid::from_fn([0.0, 0.0], 1.0, (usize::MAX, 2), |_| 0.0).is_err());
    }
}
