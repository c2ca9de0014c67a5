//! The minimal bounding sphere.
//!
//! The problem is of the linear-programming type: E. Welzl, "Smallest enclosing disks (balls and
//! ellipsoids)", 1991. Instead of recursing in random order, the farthest point is pivoted into the
//! support, as in B. Gärtner, "Fast and robust smallest enclosing balls", ESA 1999:
//!
//! 1. start from any support set (at most four points) and the smallest sphere around it;
//! 2. find the point farthest from the centre; stop when it is inside;
//! 3. among the spheres through that point and at most three support points, take the one that best
//!    encloses all five, and go to 2. The radius grows at every turn, so this ends.
//!
//! Step 3 compares the distances of the farthest points instead of testing signs of barycentric coordinates,
//! so no tolerance is needed, and repeated, collinear or cospherical points are no problem.

use crate::TriMesh;
use nalgebra::{DMatrix, DVector, Point3, Vector3};

/// A sphere, or the ball it bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, metres.
    pub center: Point3<f64>,
    /// Radius, metres.
    pub radius: f64,
}

impl Sphere {
    /// Whether `p` is inside or on the sphere, as computed: `‖p − center‖ ≤ radius`.
    #[must_use]
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        (p - self.center).norm() <= self.radius
    }
}

/// More iterations than any input has been seen to need; only rounding could require more.
const MAX_TURNS: usize = 1000;

/// A sphere that does not grow is gone on from where its reach is less by more than this part.
const MOVED: f64 = 1e-12;

/// The smallest sphere enclosing `points`, exact up to rounding; `None` when there are no points, or one is not finite.
///
/// Every point satisfies [`Sphere::contains`].
#[must_use]
pub fn minimal_sphere(points: &[Point3<f64>]) -> Option<Sphere> {
    let first = *points.first()?;
    if points.iter().any(|point| point.iter().any(|x| !x.is_finite())) {
        return None;
    }
    let mut support = vec![first];
    let mut center = first;
    let mut basis_radius = 0.0;
    let mut best = Sphere { center, radius: f64::INFINITY };
    for _ in 0..MAX_TURNS {
        let (far, reach) = farthest(points, &center);
        if reach < best.radius {
            best = Sphere { center, radius: reach };
        }
        if reach <= basis_radius {
            break;
        }
        support.push(points[far]);
        let (next_support, next_center) = pivot(&support);
        let next_radius = farthest(&next_support, &next_center).1;
        // The same radius, as computed: in a flat set the sphere may still have been moved to where it encloses more.
        if next_radius <= basis_radius && farthest(points, &next_center).1 >= best.radius * (1.0 - MOVED) {
            break;
        }
        (support, center, basis_radius) = (next_support, next_center, next_radius);
    }
    Some(best)
}

/// The index of the point farthest from `center` (the first of equals), and its distance.
fn farthest(points: &[Point3<f64>], center: &Point3<f64>) -> (usize, f64) {
    let mut best = (0, -1.0);
    for (i, p) in points.iter().enumerate() {
        let d = (p - center).norm();
        if d > best.1 {
            best = (i, d);
        }
    }
    best
}

/// The smallest sphere around at most five points with the last one on its boundary: the points that
/// determine it, and its centre.
fn pivot(points: &[Point3<f64>]) -> (Vec<Point3<f64>>, Point3<f64>) {
    let last = points.len() - 1;
    let mut best = (vec![points[last]], points[last]);
    let mut best_reach = farthest(points, &best.1).1;
    for subset in 1_usize..1 << last {
        if subset.count_ones() > 3 {
            continue;
        }
        let mut chosen = vec![points[last]];
        chosen.extend((0..last).filter(|i| subset >> i & 1 == 1).map(|i| points[i]));
        let Some(center) = circumcenter(&chosen) else { continue };
        let reach = farthest(points, &center).1;
        if reach < best_reach {
            (best, best_reach) = ((chosen, center), reach);
        }
    }
    best
}

/// The centre of the smallest sphere through all `points`, in their affine hull. `None` when they are not
/// affinely independent.
fn circumcenter(points: &[Point3<f64>]) -> Option<Point3<f64>> {
    let origin = points[0];
    let scale = points.iter().map(|p| (p - origin).amax()).fold(0.0, f64::max);
    if scale == 0.0 {
        return None;
    }
    let v: Vec<Vector3<f64>> = points[1..].iter().map(|p| (p - origin) / scale).collect();
    let gram = DMatrix::from_fn(v.len(), v.len(), |i, j| v[i].dot(&v[j]));
    let half_squares = DVector::from_fn(v.len(), |i, _| 0.5 * v[i].norm_squared());
    let lambda = gram.full_piv_lu().solve(&half_squares)?;
    let offset: Vector3<f64> = v.iter().zip(lambda.iter()).map(|(v, l)| v * *l).sum();
    offset.iter().all(|c| c.is_finite()).then(|| origin + offset * scale)
}

impl TriMesh {
    /// The smallest sphere enclosing the mesh; of [balls](TriMesh::balls), one about the middle of their centres.
    #[must_use]
    pub fn bounding_sphere(&self) -> Sphere {
        let found = minimal_sphere(self.vertices());
        let Sphere { center, radius } = found.unwrap_or(Sphere { center: Point3::origin(), radius: 0.0 });
        let radius = match self.is_balls() {
            true => {
                self.each_ball().map(|ball| (ball.center - center).norm() + ball.radius).fold(0.0, f64::max)
            }
            false => radius + self.rounding().unwrap_or(0.0),
        };
        Sphere { center, radius }
    }

    /// The largest distance from `point` to the mesh, metres.
    #[must_use]
    pub fn radius_about(&self, point: &Point3<f64>) -> f64 {
        farthest(self.vertices(), point).1 + self.rounding().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The best sphere over all supports of at most four points.
    fn brute_force(points: &[Point3<f64>]) -> f64 {
        let n = points.len();
        let mut best = f64::INFINITY;
        for subset in 1_usize..1 << n {
            if subset.count_ones() > 4 {
                continue;
            }
            let chosen: Vec<_> = (0..n).filter(|i| subset >> i & 1 == 1).map(|i| points[i]).collect();
            let center = if chosen.len() == 1 { Some(chosen[0]) } else { circumcenter(&chosen) };
            if let Some(center) = center {
                best = best.min(farthest(points, &center).1);
            }
        }
        best
    }

    fn point() -> impl Strategy<Value = Point3<f64>> {
        prop_oneof![
            prop::array::uniform3(-10.0..10.0).prop_map(Point3::from),
            // A coarse grid: repeated, collinear, coplanar and cospherical points.
            prop::array::uniform3(-2_i8..3).prop_map(|c| Point3::from(c.map(f64::from))),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]
        #[test]
        fn as_small_as_brute_force(points in prop::collection::vec(point(), 1..10)) {
            let s = minimal_sphere(&points).unwrap();
            prop_assert!(points.iter().all(|p| s.contains(p)));
            let exact = brute_force(&points);
            prop_assert!((s.radius - exact).abs() <= 1e-12 * exact, "{} {exact}", s.radius);
        }

        #[test]
        fn flat_and_needle_shaped_sets(points in prop::collection::vec(point(), 1..8), y in -14.0..0.0_f64, z in -14.0..0.0_f64) {
            let squeeze = Vector3::new(1.0, mp_math::powf(10.0, y), mp_math::powf(10.0, z));
            let points: Vec<_> = points.iter().map(|p| Point3::from(p.coords.component_mul(&squeeze))).collect();
            let s = minimal_sphere(&points).unwrap();
            prop_assert!(points.iter().all(|p| s.contains(p)));
            let exact = brute_force(&points);
            prop_assert!(s.radius <= exact * (1.0 + 1e-9), "{} {exact}", s.radius);
        }

        #[test]
        fn many_points_on_a_sphere(directions in prop::collection::vec(prop::array::uniform3(-1.0..1.0), 200..400)) {
            let center = Vector3::new(100.0, -50.0, 7.0);
            let points: Vec<_> = directions
                .iter()
                .flat_map(|d| [Vector3::from(*d), -Vector3::from(*d)])
                .filter_map(|d| d.try_normalize(1e-6))
                .map(|d| Point3::from(center + d * 3.0))
                .collect();
            let s = minimal_sphere(&points).unwrap();
            prop_assert!((s.radius - 3.0).abs() < 1e-12 && (s.center.coords - center).norm() < 1e-6);
        }
    }

    #[test]
    fn small_and_degenerate_sets() {
        assert_eq!(minimal_sphere(&[]), None);
        let p = Point3::new(1.0, 2.0, 3.0);
        assert_eq!(minimal_sphere(&[p; 5]), Some(Sphere { center: p, radius: 0.0 }));
        for odd in [f64::NAN, f64::INFINITY] {
            assert_eq!(minimal_sphere(&[p, Point3::new(0.0, odd, 0.0)]), None);
        }
        let s = minimal_sphere(&[p, p, p + Vector3::x() * 4.0]).unwrap();
        assert_eq!(s, Sphere { center: Point3::new(3.0, 2.0, 3.0), radius: 2.0 });
        // Flat, hardly acute: the circle about all three is as large, as computed, as that about the long side, which the third is outside of.
        let y = mp_math::powf(10.0, -4.260_763_230_555_386);
        let flat = [[0.0, y, 0.0], [-2.0, y, -1.0], [0.0, 2.0 * y, -1.0]].map(Point3::from);
        assert!(minimal_sphere(&flat).unwrap().radius <= brute_force(&flat) * (1.0 + 1e-12));
        // An obtuse triangle: the long side decides.
        let s = minimal_sphere(&[Point3::origin(), Point3::new(10.0, 0.0, 0.0), Point3::new(5.0, 1.0, 0.0)])
            .unwrap();
        assert_eq!(s, Sphere { center: Point3::new(5.0, 0.0, 0.0), radius: 5.0 });
    }
}
