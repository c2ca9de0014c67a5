//! A grid whose cells list the edges that can be nearest to their points.

use super::edge::Edge;
use super::polygon::crosses_ray;
use super::tree::EdgeTree;
use mp_stop::Interrupt;
use nalgebra::{Point2, Vector2};

/// The number of cells per edge, and the least and the greatest number of cells.
const CELLS_PER_EDGE: f64 = 16.0;
const FEWEST: f64 = 1024.0;
const MOST: f64 = 100_000.0;

/// The content of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellKind {
    /// No obstacle.
    Open,
    /// Wholly inside an obstacle.
    Solid,
    /// There may be edges in it.
    Mixed,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) kind: CellKind,
    /// The index of its first candidate; its candidates end where those of the next cell begin.
    first: u32,
    /// The distance of its centre from the nearest edge.
    pub(super) from_center: f64,
}

/// A grid over a box. The edge nearest to any point of a cell is among the candidates of the cell: the edges
/// no farther from its centre than the nearest edge plus its diagonal.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    low: Point2<f64>,
    high: Point2<f64>,
    pub(super) size: Vector2<f64>,
    /// Cells per metre.
    per_metre: Vector2<f64>,
    counts: [usize; 2],
    cells: Vec<Cell>,
    candidates: Vec<u32>,
    /// Edges in each row of cells, by polygon; the first of each row.
    rows: Vec<u32>,
    row_starts: Vec<u32>,
    /// Candidates are right for points up to this far outside of their cell.
    pub(super) slack: f64,
    /// No point of a cell is farther from its centre.
    pub(super) half_diagonal: f64,
}

impl Cells {
    /// A grid over the box from `low` to `high`, in which all edges are; the first `solid` of them bound
    /// obstacles, the rest the outside. Not to be used when `interrupt` has said to end.
    pub(super) fn new(
        [low, high]: [Point2<f64>; 2],
        edges: &[Edge],
        solid: usize,
        tree: &EdgeTree,
        interrupt: &mut Interrupt,
    ) -> Self {
        let extent = high - low;
        let wanted = (CELLS_PER_EDGE * edges.len() as f64).clamp(FEWEST, MOST);
        // Long and thin worlds get one row.
        let side = (extent.x * extent.y / wanted).sqrt().max(extent.max() / wanted);
        let counts = [extent.x, extent.y].map(|e| ((e / side).ceil().max(1.0)) as usize);
        let size = Vector2::new(extent.x / counts[0] as f64, extent.y / counts[1] as f64);
        let slack = 1e-9 * size.min() + 1e-14 * low.coords.amax().max(high.coords.amax());
        let mut cells = Self {
            low,
            high,
            size,
            per_metre: size.map(|s| 1.0 / s),
            counts,
            cells: Vec::with_capacity(counts[0] * counts[1] + 1),
            candidates: Vec::new(),
            rows: Vec::new(),
            row_starts: Vec::new(),
            slack,
            half_diagonal: 0.5 * size.norm() * (1.0 + 1e-9) + slack,
        };
        cells.fill_rows(&edges[..solid], interrupt);
        for row in 0..counts[1] {
            for column in 0..counts[0] {
                if interrupt.ask() {
                    break;
                }
                cells.fill(column, row, edges, tree);
            }
        }
        let first = cells.candidates.len() as u32;
        cells.cells.push(Cell { kind: CellKind::Open, first, from_center: 0.0 });
        cells
    }

    fn fill_rows(&mut self, edges: &[Edge], interrupt: &mut Interrupt) {
        let mut rows = vec![Vec::new(); self.counts[1]];
        for (i, edge) in edges.iter().enumerate() {
            if i % 1024 == 0 && interrupt.ask() {
                break;
            }
            let [low, high] = edge.bounds();
            for row in &mut rows[self.index(low.y, 1)..=self.index(high.y, 1)] {
                row.push(i as u32);
            }
        }
        // Edges are ordered by polygon, and so they are in rows.
        for row in rows {
            self.row_starts.push(self.rows.len() as u32);
            self.rows.extend(row);
        }
        self.row_starts.push(self.rows.len() as u32);
    }

    fn fill(&mut self, column: usize, row: usize, edges: &[Edge], tree: &EdgeTree) {
        let center = self.center(column, row);
        let reach = self.half_diagonal;
        let mut nearest = f64::INFINITY;
        tree.near(&center, nearest, |i, within| {
            nearest = within.min(edges[i as usize].squared(&center));
            nearest
        });
        let from_center = nearest.sqrt();
        let kind = match from_center > reach {
            false => CellKind::Mixed,
            true if self.row_contains(&center, edges) => CellKind::Solid,
            true => CellKind::Open,
        };
        let first = self.candidates.len();
        self.cells.push(Cell { kind, first: first as u32, from_center });
        let within = mp_math::powi(from_center + 2.0 * reach, 2);
        if within.is_finite() {
            let candidates = &mut self.candidates;
            tree.near(&center, within, |i, within| {
                if edges[i as usize].squared(&center) <= within {
                    candidates.push(i);
                }
                within
            });
            candidates[first..].sort_unstable();
        }
    }

    pub(super) fn center(&self, column: usize, row: usize) -> Point2<f64> {
        let at = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
        self.low + at.component_mul(&self.size)
    }

    /// Which column (axis 0) or row (axis 1) a coordinate is in, kept within the grid; never decreasing.
    #[inline]
    fn index(&self, v: f64, axis: usize) -> usize {
        (((v - self.low[axis]) * self.per_metre[axis]) as usize).min(self.counts[axis] - 1)
    }

    /// The column and row of the cell that holds `p`, if one does.
    #[inline]
    pub(super) fn locate(&self, p: &Point2<f64>) -> Option<(usize, usize)> {
        let inside = p.x >= self.low.x && p.y >= self.low.y && p.x <= self.high.x && p.y <= self.high.y;
        inside.then(|| (self.index(p.x, 0), self.index(p.y, 1)))
    }

    #[inline]
    pub(super) fn cell(&self, (column, row): (usize, usize)) -> (&Cell, &[u32]) {
        let at = row * self.counts[0] + column;
        let (cell, next) = (&self.cells[at], &self.cells[at + 1]);
        (cell, &self.candidates[cell.first as usize..next.first as usize])
    }

    /// The fraction of the segment from `a` at which it has left a cell by half of the slack; `inverse` holds the reciprocals of its
    /// components. Without the slack, a segment along a border would leave a cell again and again, where rounding leads it back.
    #[inline]
    pub(super) fn leaves(
        &self,
        a: &Point2<f64>,
        inverse: &Vector2<f64>,
        (column, row): (usize, usize),
    ) -> f64 {
        let at = |i: usize, axis: usize| {
            if inverse[axis].is_infinite() {
                return f64::INFINITY;
            }
            let line = i + usize::from(inverse[axis] > 0.0);
            let beyond = (0.5 * self.slack).copysign(inverse[axis]);
            (self.low[axis] + line as f64 * self.size[axis] + beyond - a[axis]) * inverse[axis]
        };
        at(column, 0).min(at(row, 1))
    }

    /// Whether `p` is in a polygon, by the edges in its row, which are grouped by polygon.
    pub(super) fn row_contains(&self, p: &Point2<f64>, edges: &[Edge]) -> bool {
        if self.locate(p).is_none() {
            return false;
        }
        let row = self.index(p.y, 1);
        let (mut polygon, mut odd) = (u32::MAX, false);
        for i in &self.rows[self.row_starts[row] as usize..self.row_starts[row + 1] as usize] {
            let edge = &edges[*i as usize];
            if edge.polygon != polygon {
                if odd {
                    return true;
                }
                polygon = edge.polygon;
            }
            odd ^= crosses_ray(&edge.a, &edge.b, p);
        }
        odd
    }
}
