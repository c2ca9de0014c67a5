//! Polygons with holes.

use crate::triangulate::{bridged, triangulate_ccw};
use nalgebra::{Isometry2, Point2, distance};
use robust::{Coord, orient2d};
use thiserror::Error;

/// Why a polygon could not be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PolygonError {
    /// A ring of fewer than three points, or no ring at all.
    #[error("ring {ring} has {points} points: at least three are needed")]
    TooFewPoints {
        /// The index of the ring, from 0; 0 too where there is no ring.
        ring: usize,
        /// The points found, fewer than three.
        points: usize,
    },
    /// A coordinate that is NaN, infinite or beyond 10⁶⁰.
    #[error("point {point} of ring {ring} is ({x}, {y}): coordinates must be finite, below 1e60")]
    NotFinite {
        /// The index of the ring, from 0.
        ring: usize,
        /// The index of the point in the ring, from 0.
        point: usize,
        /// Its first coordinate, as it was given.
        x: f64,
        /// Its second coordinate.
        y: f64,
    },
    /// The work was interrupted.
    #[error("reading the map was ended")]
    Interrupted,
    /// A size that is not positive, or corners of which the second is not above the first.
    #[error("{what} must be positive and finite, found {value}")]
    Size {
        /// What size.
        what: &'static str,
        /// The size found, metres.
        value: f64,
    },
}

/// The largest coordinate allowed: its square is far from overflow.
const MAX_COORDINATE: f64 = 1e60;

/// Closed rings of points; a point is inside when an odd number of rings goes around it (the even-odd rule).
///
/// So a ring inside another is a hole, whatever their orientations, and rings may cross themselves.
/// Convex or not; the last point of a ring is joined to its first.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    rings: Vec<Vec<Point2<f64>>>,
}

impl Polygon {
    /// The polygon of `rings`. A last point that repeats the first is left out.
    ///
    /// # Errors
    /// When there is no ring, one has fewer than three points, or a coordinate is not finite or beyond 10⁶⁰.
    pub fn new(rings: Vec<Vec<Point2<f64>>>) -> Result<Self, PolygonError> {
        let mut rings = rings;
        if rings.is_empty() {
            return Err(PolygonError::TooFewPoints { ring: 0, points: 0 });
        }
        for (ring, points) in rings.iter_mut().enumerate() {
            if points.len() > 3 && points.first() == points.last() {
                points.pop();
            }
            if points.len() < 3 {
                return Err(PolygonError::TooFewPoints { ring, points: points.len() });
            }
            let bad = |p: &Point2<f64>| p.iter().any(|v| v.is_nan() || v.abs() > MAX_COORDINATE);
            if let Some(point) = points.iter().position(bad) {
                let Point2 { coords, .. } = points[point];
                return Err(PolygonError::NotFinite { ring, point, x: coords.x, y: coords.y });
            }
        }
        Ok(Self { rings })
    }

    /// The polygon of one ring.
    ///
    /// # Errors
    /// As [`Polygon::new`].
    pub fn outlined(points: impl IntoIterator<Item = [f64; 2]>) -> Result<Self, PolygonError> {
        Self::new(vec![points.into_iter().map(Point2::from).collect()])
    }

    /// The rectangle from corner `low` to corner `high`.
    ///
    /// # Errors
    /// When a coordinate is not finite, or `high` is not above `low`.
    pub fn rectangle(low: [f64; 2], high: [f64; 2]) -> Result<Self, PolygonError> {
        for (what, value) in [("the width", high[0] - low[0]), ("the height", high[1] - low[1])] {
            positive(what, value)?;
        }
        Self::outlined([low, [high[0], low[1]], high, [low[0], high[1]]])
    }

    /// The regular polygon of `corners` corners *around* the circle of `radius` (m) about `center`: it
    /// contains the disc.
    ///
    /// # Errors
    /// When there are fewer than three corners, or the radius is not positive and finite.
    pub fn around_circle(center: [f64; 2], radius: f64, corners: usize) -> Result<Self, PolygonError> {
        positive("the radius", radius)?;
        let step = std::f64::consts::TAU / corners.max(1) as f64;
        let reach = radius / mp_math::cos(0.5 * step);
        let corner = |i: usize| {
            let (s, c) = mp_math::sin_cos(step * i as f64);
            [center[0] + reach * c, center[1] + reach * s]
        };
        Self::outlined((0..corners).map(corner))
    }

    /// The rings, closed without a repeated point. A point that an odd number of them surrounds is inside.
    #[must_use]
    pub fn rings(&self) -> &[Vec<Point2<f64>>] {
        &self.rings
    }

    /// The edges of all rings, each from one point to the next.
    pub fn edges(&self) -> impl Iterator<Item = [Point2<f64>; 2]> + '_ {
        self.rings.iter().flat_map(|ring| {
            let next = ring.iter().skip(1).chain(ring.first());
            ring.iter().zip(next).map(|(a, b)| [*a, *b])
        })
    }

    /// Its lower and upper corner.
    #[must_use]
    pub fn bounds(&self) -> [Point2<f64>; 2] {
        let mut box_ = [Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2])];
        for p in self.rings.iter().flatten() {
            box_ = [box_[0].inf(p), box_[1].sup(p)];
        }
        box_
    }

    /// The distance of its farthest point from `center`, metres.
    #[must_use]
    pub fn radius_about(&self, center: &Point2<f64>) -> f64 {
        self.rings.iter().flatten().map(|p| distance(p, center)).fold(0.0, f64::max)
    }

    /// Its area, outer rings less holes; right for rings that cross neither themselves nor each other.
    #[must_use]
    pub fn area(&self) -> f64 {
        let inside = |p: &Point2<f64>, ring: &[Point2<f64>]| odd(closed(ring), p);
        let sign = |i: usize| {
            let others = self.rings.iter().enumerate().filter(|(j, _)| *j != i);
            let around = others.filter(|(_, ring)| inside(&self.rings[i][0], ring)).count();
            if around % 2 == 0 { 1.0 } else { -1.0 }
        };
        let area = |ring: &[Point2<f64>]| {
            let o = ring[0];
            closed(ring).map(|[a, b]| (a - o).perp(&(b - o))).sum::<f64>().abs() * 0.5
        };
        self.rings.iter().enumerate().map(|(i, ring)| sign(i) * area(ring)).sum()
    }

    /// Triangles that cover it, counter-clockwise, without overlaps; right for rings that cross neither
    /// themselves nor each other.
    #[must_use]
    pub fn triangles(&self) -> Vec<[Point2<f64>; 3]> {
        let around = |i: usize| {
            let inside = |j: &usize| *j != i && odd(closed(&self.rings[*j]), &self.rings[i][0]);
            (0..self.rings.len()).filter(inside).collect::<Vec<_>>()
        };
        let containers: Vec<Vec<usize>> = (0..self.rings.len()).map(around).collect();
        let ring = |i: usize, left: bool| {
            let mut ring = self.rings[i].clone();
            ring.dedup();
            let area: f64 = closed(&ring).map(|[a, b]| (a - ring[0]).perp(&(b - ring[0]))).sum();
            if (area > 0.0) != left {
                ring.reverse();
            }
            ring
        };
        let mut triangles = Vec::new();
        for outer in (0..self.rings.len()).filter(|i| containers[*i].len().is_multiple_of(2)) {
            // Its holes are the rings directly inside.
            let within = |i: &usize| {
                containers[*i].len() == containers[outer].len() + 1 && containers[*i].contains(&outer)
            };
            let holes = (0..self.rings.len()).filter(within).map(|i| ring(i, false)).collect();
            let joined = bridged(ring(outer, true), holes);
            triangles.extend(triangulate_ccw(&joined).into_iter().map(|t| t.map(|i| joined[i])));
        }
        triangles
    }

    /// Whether `p` is inside, by exact predicates; on the boundary the answer may be either.
    #[must_use]
    pub fn contains(&self, p: &Point2<f64>) -> bool {
        odd(self.edges(), p)
    }

    /// The polygon moved.
    #[must_use]
    pub fn transformed(&self, pose: &Isometry2<f64>) -> Self {
        let moved = |ring: &Vec<Point2<f64>>| ring.iter().map(|p| pose * p).collect();
        Self { rings: self.rings.iter().map(moved).collect() }
    }
}

fn positive(what: &'static str, value: f64) -> Result<(), PolygonError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(PolygonError::Size { what, value }) }
}

/// The edges of a ring.
pub(super) fn closed(ring: &[Point2<f64>]) -> impl Iterator<Item = [Point2<f64>; 2]> + '_ {
    ring.iter().zip(ring.iter().skip(1).chain(ring.first())).map(|(a, b)| [*a, *b])
}

/// Whether the ray from `p` along -x crosses an odd number of `edges`.
fn odd(edges: impl Iterator<Item = [Point2<f64>; 2]>, p: &Point2<f64>) -> bool {
    edges.fold(false, |odd, [a, b]| odd ^ crosses_ray(&a, &b, p))
}

/// Whether the edge from `a` to `b` crosses the ray from `p` along -x; an edge owns its lower end, not its
/// upper.
#[inline]
pub(super) fn crosses_ray(a: &Point2<f64>, b: &Point2<f64>, p: &Point2<f64>) -> bool {
    if (a.y > p.y) == (b.y > p.y) {
        return false;
    }
    let (low, high) = if a.y < b.y { (a, b) } else { (b, a) };
    side(low, high, p) < 0.0
}

/// Positive when `p` is to the left of the line from `a` to `b`, negative to its right, zero on it: exact.
#[inline]
pub(super) fn side(a: &Point2<f64>, b: &Point2<f64>, p: &Point2<f64>) -> f64 {
    let coord = |p: &Point2<f64>| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_has_a_hole() {
        let ring = |r: f64| [[-r, -r], [r, -r], [r, r], [-r, r]].map(Point2::from).to_vec();
        let frame = Polygon::new(vec![ring(2.0), ring(1.0)]).unwrap();
        assert_eq!((frame.area(), frame.edges().count()), (12.0, 8));
        for (x, inside) in [(0.0, false), (1.5, true), (2.5, false), (-1.5, true)] {
            assert_eq!(frame.contains(&Point2::new(x, 0.0)), inside, "{x}");
            // In line with corners.
            assert_eq!(frame.contains(&Point2::new(x, 1.0)), inside || x == 0.0, "{x}");
        }
        assert_eq!(frame.bounds(), [Point2::new(-2.0, -2.0), Point2::new(2.0, 2.0)]);
        let moved = frame.transformed(&Isometry2::translation(5.0, 0.0));
        assert!(moved.contains(&Point2::new(6.5, 0.0)) && !moved.contains(&Point2::new(5.0, 0.0)));
    }

    /// Triangles have the area of the polygon and lie in it: nested rings, several outer ones, and holes side
    /// by side.
    #[test]
    fn triangles_cover_what_is_inside() {
        let square = |x: f64, y: f64, r: f64| {
            [[-r, -r], [r, -r], [r, r], [-r, r]].map(|[a, b]| Point2::new(x + a, y + b)).to_vec()
        };
        let grid = |n: usize, r: f64| {
            (0..n * n).map(move |i| square((i % n) as f64 * 2.0 + 2.0, (i / n) as f64 * 2.0 + 2.0, r))
        };
        let round = |x: f64, y: f64, r: f64, n: u32| -> Vec<Point2<f64>> {
            let corner = |k: u32| mp_math::sin_cos(std::f64::consts::TAU * f64::from(k) / f64::from(n));
            (0..n).map(corner).map(|(s, c)| Point2::new(x + r * c, y + r * s)).collect()
        };
        let mut sieve = vec![square(5.0, 5.0, 5.0)];
        sieve.extend(grid(4, 0.5));
        let mut clockwise = sieve.clone();
        clockwise.iter_mut().step_by(2).for_each(|ring| ring.reverse());
        let bull =
            vec![square(0.0, 0.0, 4.0), square(0.0, 0.0, 3.0), square(0.0, 0.0, 2.0), square(0.0, 0.0, 1.0)];
        let apart = vec![square(0.0, 0.0, 1.0), square(5.0, 1.0, 2.0), square(5.0, 1.0, 1.0)];
        let rounds = vec![
            round(0.0, 0.0, 9.0, 40),
            round(-3.0, 1.0, 2.0, 17),
            round(4.0, 0.0, 3.0, 30),
            round(0.0, -6.0, 1.5, 9),
        ];
        for rings in [sieve, clockwise, bull, apart, rounds] {
            let polygon = Polygon::new(rings).unwrap();
            let triangles = polygon.triangles();
            let area = |t: &[Point2<f64>; 3]| (t[1] - t[0]).perp(&(t[2] - t[0])) * 0.5;
            let total: f64 = triangles.iter().map(area).sum();
            assert!((total - polygon.area()).abs() < 1e-9 * total, "{total} {}", polygon.area());
            for t in triangles.iter().filter(|t| area(t) > 1e-9) {
                assert!(
                    polygon.contains(&Point2::from((t[0].coords + t[1].coords + t[2].coords) / 3.0)),
                    "{t:?}"
                );
            }
        }
    }

    #[test]
    fn circles_are_within() {
        let p = Polygon::around_circle([1.0, 2.0], 0.5, 12).unwrap();
        let least = p.edges().map(|[a, b]| ((a + b.coords) / 2.0 - Point2::new(1.0, 2.0)).norm());
        assert!((least.fold(f64::INFINITY, f64::min) - 0.5).abs() < 1e-12);
        assert!(
            (p.radius_about(&Point2::new(1.0, 2.0)) - 0.5 / mp_math::cos(std::f64::consts::PI / 12.0)).abs()
                < 1e-12
        );
    }

    #[test]
    fn what_is_no_polygon() {
        let p = |x: f64, y: f64| Point2::new(x, y);
        assert!(matches!(Polygon::new(vec![]), Err(PolygonError::TooFewPoints { ring: 0, points: 0 })));
        let two = Polygon::outlined([[0.0, 0.0], [1.0, 1.0]]);
        assert!(matches!(two, Err(PolygonError::TooFewPoints { points: 2, .. })));
        for bad in [f64::NAN, f64::INFINITY, 1e61] {
            let ring = vec![p(0.0, 0.0), p(1.0, 0.0), p(bad, 1.0)];
            assert!(matches!(Polygon::new(vec![ring]), Err(PolygonError::NotFinite { point: 2, .. })));
            assert!(Polygon::rectangle([0.0, 0.0], [-1.0, bad]).is_err());
        }
        assert!(Polygon::around_circle([0.0, 0.0], 0.0, 8).is_err());
        assert!(Polygon::around_circle([0.0, 0.0], 1.0, 2).is_err());
        let closed = Polygon::outlined([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]).unwrap();
        assert_eq!(closed.rings()[0].len(), 3);
    }
}
