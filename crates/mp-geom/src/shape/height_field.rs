//! Ground of varying height over a grid.

use super::Made;
use crate::primitives::positive;
use crate::{MeshError, PrimitiveError, TriMesh};
use nalgebra::Point3;

/// Heights over the corners of a grid in the plane, which is centred on the origin, and the ground below
/// them.
///
/// A cell is two triangles, along the diagonal from its corner with the least x and y to that with the
/// largest.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// The lengths (m) of a cell in x and y.
    pub cell: [f64; 2],
    /// The heights (m): a row for each y, from the least, with a height for each x, from the least. Rows are
    /// equally long.
    pub heights: Vec<Vec<f64>>,
    /// How far down (m) the ground reaches: below all heights.
    pub bottom: f64,
}

/// The most heights: 32 bits number the triangles.
const MAX_HEIGHTS: usize = 1 << 28;

impl HeightField {
    /// How far down ground reaches that does not say it: as far below the lowest of `heights` as a cell is
    /// long.
    #[must_use]
    pub fn default_bottom([x, y]: [f64; 2], heights: &[Vec<f64>]) -> f64 {
        heights.iter().flatten().fold(f64::INFINITY, |low, height| low.min(*height)) - x.max(y)
    }

    /// The surface, walls around it and a floor. O(n) for n heights.
    pub(super) fn mesh(&self) -> Made {
        let [x, y] = [
            positive("length of a cell in x", self.cell[0])?,
            positive("length of a cell in y", self.cell[1])?,
        ];
        let (rows, columns) = (self.heights.len(), self.heights.first().map_or(0, Vec::len));
        if rows < 2 || columns < 2 || self.heights.iter().any(|row| row.len() != columns) {
            return Err(PrimitiveError::NoInside {
                what: "a height field without two rows or more, of two heights or more and equally long",
            });
        }
        if self.heights.iter().flatten().any(|height| *height <= self.bottom) {
            return Err(PrimitiveError::NoInside {
                what: "a height field with heights at its bottom or below",
            });
        }
        let count = rows.saturating_mul(columns);
        if count > MAX_HEIGHTS {
            return Err(MeshError::TooLarge { what: "heights", count }.into());
        }
        let middle = |count: usize| 0.5 * (count - 1) as f64;
        let at = |i: usize, j: usize, z: f64| {
            Point3::new((j as f64 - middle(columns)) * x, (i as f64 - middle(rows)) * y, z)
        };
        let grid = |i: usize, j: usize| (i * columns + j) as u32;
        let mut vertices: Vec<_> = (0..rows * columns)
            .map(|k| (k / columns, k % columns))
            .map(|(i, j)| at(i, j, self.heights[i][j]))
            .collect();
        let mut triangles = Vec::with_capacity(2 * rows * columns + 6 * (rows + columns));
        for (i, j) in (0..rows - 1).flat_map(|i| (0..columns - 1).map(move |j| (i, j))) {
            let [a, b, c, d] = [grid(i, j), grid(i, j + 1), grid(i + 1, j + 1), grid(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        // The corners around it, as seen from above counterclockwise.
        let around: Vec<(usize, usize)> = (0..columns - 1)
            .map(|j| (0, j))
            .chain((0..rows - 1).map(|i| (i, columns - 1)))
            .chain((1..columns).rev().map(|j| (rows - 1, j)))
            .chain((1..rows).rev().map(|i| (i, 0)))
            .collect();
        let (low, count) = (vertices.len() as u32, around.len() as u32);
        vertices.extend(around.iter().map(|(i, j)| at(*i, *j, self.bottom)));
        vertices.push(Point3::new(0.0, 0.0, self.bottom));
        for k in 0..count {
            let next = (k + 1) % count;
            let [a, b] = [k, next].map(|k| grid(around[k as usize].0, around[k as usize].1));
            triangles.extend([[low + k, low + next, b], [low + k, b, a], [low + count, low + next, low + k]]);
        }
        Ok(TriMesh::new(vertices, triangles)?.trusted_solid())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ground_is_a_solid() {
        let heights = vec![vec![0.0, 0.5, 1.0], vec![0.2, 0.9, -0.3]];
        let cell = [0.5, 2.0];
        let field = HeightField { cell, bottom: HeightField::default_bottom(cell, &heights), heights };
        assert_eq!(field.bottom, -2.3);
        let mesh = field.mesh().unwrap();
        assert!(mesh.topology().is_solid());
        // Each cell is over its ground as high as its triangles are in the mean.
        let triangles = [[0.0, 0.5, 0.9], [0.0, 0.9, 0.2], [0.5, 1.0, -0.3], [0.5, -0.3, 0.9]];
        let volume: f64 = triangles.iter().map(|t| 0.5 * (t.iter().sum::<f64>() / 3.0 + 2.3)).sum();
        assert!((mesh.signed_volume() - volume).abs() < 1e-12);
        let bounds = mesh.aabb();
        assert_eq!((bounds.min, bounds.max), (Point3::new(-0.5, -1.0, -2.3), Point3::new(0.5, 1.0, 1.0)));
    }

    #[test]
    fn grids_that_enclose_nothing_are_refused() {
        let field = |heights: &[&[f64]], bottom: f64, x: f64| {
            let heights = heights.iter().map(|row| row.to_vec()).collect();
            HeightField { cell: [x, 1.0], heights, bottom }.mesh()
        };
        assert!(field(&[&[0.0, 1.0], &[0.0, 1.0]], -1.0, 1.0).is_ok());
        assert!(field(&[&[0.0, 1.0], &[0.0, 1.0]], 0.0, 1.0).is_err());
        assert!(field(&[&[0.0, 1.0], &[0.0]], -1.0, 1.0).is_err());
        assert!(field(&[&[0.0, 1.0]], -1.0, 1.0).is_err());
        assert!(field(&[], -1.0, 1.0).is_err());
        assert!(field(&[&[0.0, 1.0], &[0.0, 1.0]], -1.0, 0.0).is_err());
        assert!(field(&[&[0.0, f64::NAN], &[0.0, 1.0]], -1.0, 1.0).is_err());
    }
}
