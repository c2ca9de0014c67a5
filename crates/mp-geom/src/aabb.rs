//! Axis-aligned boxes.

use crate::TriMesh;
use nalgebra::{Isometry3, Point3, Vector3};

/// An axis-aligned box: all points with `min ≤ p ≤ max`, metres. Empty when some `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub min: Point3<f64>,
    /// Highest corner.
    pub max: Point3<f64>,
}

impl Aabb {
    /// The box from `min` to `max`.
    #[must_use]
    pub fn new(min: Point3<f64>, max: Point3<f64>) -> Self {
        Self { min, max }
    }

    /// The empty box: its [`union`](Aabb::union) with another box is the other box.
    #[must_use]
    pub fn empty() -> Self {
        let inf = f64::INFINITY;
        Self { min: Point3::new(inf, inf, inf), max: Point3::new(-inf, -inf, -inf) }
    }

    /// The smallest box containing `points`; empty when there are none.
    #[must_use]
    pub fn of_points<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Self {
        points.into_iter().fold(Self::empty(), |b, p| Self { min: b.min.inf(p), max: b.max.sup(p) })
    }

    /// Whether it holds no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        (0..3).any(|i| self.min[i] > self.max[i])
    }

    /// The centre.
    #[must_use]
    pub fn center(&self) -> Point3<f64> {
        nalgebra::center(&self.min, &self.max)
    }

    /// Half the side lengths.
    #[must_use]
    pub fn half_extents(&self) -> Vector3<f64> {
        (self.max - self.min) * 0.5
    }

    /// Length of the diagonal.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        (self.max - self.min).norm()
    }

    /// Volume, m³; 0 when empty.
    #[must_use]
    pub fn volume(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).product() }
    }

    /// The smallest box containing both.
    #[must_use]
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The box grown by `margin` on every side (shrunk when negative).
    #[must_use]
    #[inline]
    pub fn enlarged(&self, margin: f64) -> Self {
        Self { min: self.min.map(|v| v - margin), max: self.max.map(|v| v + margin) }
    }

    /// Whether it holds `p`, boundary included.
    #[must_use]
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        (0..3).all(|i| self.min[i] <= p[i] && p[i] <= self.max[i])
    }

    /// Whether the boxes share a point, boundaries included.
    #[must_use]
    #[inline]
    pub fn intersects(&self, other: &Self) -> bool {
        (0..3).all(|i| self.min[i] <= other.max[i] && other.min[i] <= self.max[i])
    }

    /// Distance from `p` to the box, 0 inside.
    #[must_use]
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        let excess = (self.min - p).sup(&(p - self.max)).sup(&Vector3::zeros());
        excess.norm()
    }

    /// The eight corners; bit `i` of the index chooses the upper side of axis `i`.
    #[must_use]
    pub fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|k| {
            Point3::from(Vector3::from_fn(|i, _| if k >> i & 1 == 1 { self.max[i] } else { self.min[i] }))
        })
    }

    /// The axis-aligned box around this box moved by `pose`.
    #[must_use]
    pub fn transformed(&self, pose: &Isometry3<f64>) -> Self {
        Self::of_points(&self.corners().map(|c| pose * c))
    }
}

impl TriMesh {
    /// The axis-aligned box of the vertices, and of the [balls](TriMesh::balls) around them.
    #[must_use]
    pub fn aabb(&self) -> Aabb {
        let vertices = Aabb::of_points(self.vertices());
        self.rounding().map_or(vertices, |radius| vertices.enlarged(radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point3<f64>> {
        prop::array::uniform3(-10.0..10.0).prop_map(Point3::from)
    }

    proptest! {
        #[test]
        fn holds_its_points_and_no_smaller_box_does(points in prop::collection::vec(point(), 1..20)) {
            let b = Aabb::of_points(&points);
            prop_assert!(points.iter().all(|p| b.contains(p) && b.distance(p) == 0.0));
            for i in 0..3 {
                prop_assert!(points.iter().any(|p| p[i] == b.min[i]));
                prop_assert!(points.iter().any(|p| p[i] == b.max[i]));
            }
            prop_assert!(!points.iter().all(|p| b.enlarged(-1e-9).contains(p)));
        }

        #[test]
        fn intersection_is_the_overlap_of_intervals(a in [point(), point()], b in [point(), point()]) {
            let (x, y) = (Aabb::of_points(&a), Aabb::of_points(&b));
            let overlap = Aabb::new(x.min.sup(&y.min), x.max.inf(&y.max));
            prop_assert_eq!(x.intersects(&y), !overlap.is_empty());
            prop_assert_eq!(x.union(&y), Aabb::of_points(a.iter().chain(&b)));
        }

        #[test]
        fn distance_is_to_the_nearest_point(a in [point(), point()], p in point()) {
            let b = Aabb::of_points(&a);
            let nearest = p.sup(&b.min).inf(&b.max);
            prop_assert!((b.distance(&p) - (nearest - p).norm()).abs() < 1e-12);
        }
    }

    #[test]
    fn empty() {
        let e = Aabb::of_points(&[]);
        assert!(e.is_empty() && e.volume() == 0.0);
        let unit = Aabb::new(Point3::origin(), Point3::new(1.0, 1.0, 1.0));
        assert_eq!(e.union(&unit), unit);
        assert_eq!(
            (unit.volume(), unit.center(), unit.corners()[7]),
            (1.0, Point3::new(0.5, 0.5, 0.5), unit.max)
        );
    }
}
