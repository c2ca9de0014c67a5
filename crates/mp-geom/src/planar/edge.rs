//! Edges of obstacles, and the distances of points and segments from them.

use super::polygon::side;
use nalgebra::{Point2, Vector2, distance};

/// An edge of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    pub(super) a: Point2<f64>,
    pub(super) b: Point2<f64>,
    along: Vector2<f64>,
    /// One over the square of its length; zero when that is zero.
    inverse: f64,
    /// The polygon it belongs to.
    pub(super) polygon: u32,
}

impl Edge {
    pub(super) fn new([a, b]: [Point2<f64>; 2], polygon: u32) -> Self {
        let along = b - a;
        let inverse = 1.0 / along.norm_squared();
        Self { a, b, along, inverse: if inverse.is_finite() { inverse } else { 0.0 }, polygon }
    }

    #[inline]
    pub(super) fn nearest(&self, p: &Point2<f64>) -> Point2<f64> {
        let t = ((p - self.a).dot(&self.along) * self.inverse).clamp(0.0, 1.0);
        if t == 1.0 { self.b } else { self.a + self.along * t }
    }

    /// The square of the distance to `p`.
    #[inline]
    pub(super) fn squared(&self, p: &Point2<f64>) -> f64 {
        (p - self.nearest(p)).norm_squared()
    }

    /// Lower and upper corner.
    pub(super) fn bounds(&self) -> [Point2<f64>; 2] {
        [self.a.inf(&self.b), self.a.sup(&self.b)]
    }

    /// Whether it is wholly on one side of the line through the other edge, and farther than `far` from it: a
    /// quick rejection.
    #[inline]
    pub(super) fn is_beside(&self, other: &Edge, far: f64) -> bool {
        let (a, b) = (other.along.perp(&(self.a - other.a)), other.along.perp(&(self.b - other.a)));
        let least = a.abs().min(b.abs());
        (a > 0.0) == (b > 0.0) && least * least * other.inverse > far * far
    }

    /// The points of the other edge and of this one that are nearest to each other, when they are less than
    /// `below` apart.
    #[inline]
    pub(super) fn nearest_to(&self, other: &Edge, below: f64) -> Option<([Point2<f64>; 2], f64)> {
        let ([low, high], [from, to]) = (self.bounds(), other.bounds());
        let gap = (low - to).sup(&(from - high)).sup(&Vector2::zeros());
        let gap = gap.norm_squared();
        // The square of a tiny `below` is zero.
        if below <= 0.0 || gap > 0.0 && gap >= below * below {
            return None;
        }
        if let Some(p) = self.crossing(other) {
            return Some(([p, p], 0.0));
        }
        let of_other = |p: &Point2<f64>| [other.nearest(p), *p];
        let of_self = |p: &Point2<f64>| [*p, self.nearest(p)];
        let pairs = [of_self(&other.a), of_self(&other.b), of_other(&self.a), of_other(&self.b)];
        let mut best = (pairs[0], distance(&pairs[0][0], &pairs[0][1]));
        for pair in &pairs[1..] {
            let d = distance(&pair[0], &pair[1]);
            if d < best.1 {
                best = (*pair, d);
            }
        }
        (best.1 < below).then_some(best)
    }

    /// Where the two cross, if each has its ends on different sides of the other.
    fn crossing(&self, other: &Edge) -> Option<Point2<f64>> {
        let (c, d) = (side(&self.a, &self.b, &other.a), side(&self.a, &self.b, &other.b));
        if c == 0.0 || d == 0.0 || (c > 0.0) == (d > 0.0) {
            return None;
        }
        let (a, b) = (side(&other.a, &other.b, &self.a), side(&other.a, &other.b, &self.b));
        if a == 0.0 || b == 0.0 || (a > 0.0) == (b > 0.0) {
            return None;
        }
        Some(other.a + other.along * (c / (c - d)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(a: [f64; 2], b: [f64; 2]) -> Edge {
        Edge::new([a.into(), b.into()], 0)
    }

    #[test]
    fn edges_and_edges() {
        let wall = edge([0.0, 0.0], [2.0, 0.0]);
        for (a, b, expected) in [
            ([1.0, 1.0], [1.0, -1.0], 0.0),
            ([1.0, 1.0], [1.0, 0.0], 0.0),
            ([1.0, 1.0], [1.5, 0.25], 0.25),
            ([-3.0, -4.0], [-3.0, -4.0], 5.0),
            ([5.0, 4.0], [5.0, -4.0], 3.0),
            ([1.0, 0.0], [4.0, 0.0], 0.0),
            ([3.0, 0.0], [4.0, 0.0], 1.0),
        ] {
            let other = edge(a, b);
            for (one, two) in [(wall, other), (other, wall)] {
                let ([p, q], d) = one.nearest_to(&two, 100.0).unwrap();
                assert!((d - expected).abs() < 1e-15 && (distance(&p, &q) - d).abs() < 1e-15);
                assert!(one.squared(&q) < 1e-30 && two.squared(&p) < 1e-30, "{a:?} {b:?}");
                assert!(one.nearest_to(&two, expected).is_none());
                assert_eq!(one.nearest_to(&two, f64::MIN_POSITIVE).is_some(), expected == 0.0);
            }
        }
    }
}
