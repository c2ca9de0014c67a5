//! Planar polygons into triangles by ear clipping.
//!
//! G. H. Meisters, "Polygons have ears", 1975. Orientation tests are exact (J. R. Shewchuk, "Adaptive
//! precision floating-point arithmetic and fast robust geometric predicates", 1997), so collinear runs,
//! needles and large coordinates are decided right. Among the ears the one with the best-shaped triangle
//! is cut, which also keeps collinear corners from becoming degenerate triangles.

use nalgebra::{Point2, Point3, Vector3};
use robust::{Coord, orient2d};

/// Newell's normal of a closed polygon: twice its area long, right also when it is concave.
pub(crate) fn newell_normal(corners: &[Point3<f64>]) -> Vector3<f64> {
    // Relative to the first corner, so that distance from the origin costs no digits.
    let Some(origin) = corners.first() else { return Vector3::zeros() };
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(p, q)| (p - origin).cross(&(q - origin))).sum()
}

/// Triangles (indices into `corners`) covering a planar polygon, in its own orientation: always
/// `corners.len() − 2` of them. The polygon may be concave; holes are not handled. A polygon that crosses
/// itself or has no area gets some triangulation of its corners.
pub(crate) fn triangulate(corners: &[Point3<f64>]) -> Vec<[usize; 3]> {
    if corners.len() == 3 {
        return vec![[0, 1, 2]];
    }
    let normal = newell_normal(corners);
    // Dropping the dominant axis keeps coordinates exact.
    let drop = normal.iamax();
    let (mut u, mut v) = ((drop + 1) % 3, (drop + 2) % 3);
    if normal[drop] < 0.0 {
        (u, v) = (v, u);
    }
    let flat: Vec<_> = corners.iter().map(|p| Point2::new(p[u], p[v])).collect();
    triangulate_ccw(&flat)
}

/// As [`triangulate`], for a counter-clockwise polygon of the plane.
pub(crate) fn triangulate_ccw(corners: &[Point2<f64>]) -> Vec<[usize; 3]> {
    let mut ring: Vec<usize> = (0..corners.len()).collect();
    let mut triangles = Vec::with_capacity(ring.len().saturating_sub(2));
    let mut quality: Vec<Option<f64>> = (0..ring.len()).map(|k| ear_quality(corners, &ring, k)).collect();
    while ring.len() > 3 {
        let mut best = best_ear(&quality);
        if best.is_none() {
            quality = (0..ring.len()).map(|k| ear_quality(corners, &ring, k)).collect();
            best = best_ear(&quality);
        }
        // Only a polygon that is not simple has no ear.
        let k = best.unwrap_or_else(|| flattest(corners, &ring));
        triangles.push(around(&ring, k));
        ring.remove(k);
        quality.remove(k);
        let n = ring.len();
        for neighbour in [(k + n - 1) % n, k % n] {
            quality[neighbour] = ear_quality(corners, &ring, neighbour);
        }
    }
    if let [a, b, c] = ring[..] {
        triangles.push([a, b, c]);
    }
    triangles
}

fn around(ring: &[usize], k: usize) -> [usize; 3] {
    let n = ring.len();
    [ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]]
}

fn best_ear(quality: &[Option<f64>]) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (k, q) in quality.iter().enumerate() {
        if let Some(q) = *q
            && best.is_none_or(|(_, b)| q > b)
        {
            best = Some((k, q));
        }
    }
    best.map(|(k, _)| k)
}

/// The corner of a ring without ears to cut: the one whose triangle is least turned the wrong way.
fn flattest(corners: &[Point2<f64>], ring: &[usize]) -> usize {
    let turn = |k: usize| turn(around(ring, k).map(|i| corners[i]));
    (0..ring.len()).min_by(|&a, &b| turn(a).abs().total_cmp(&turn(b).abs())).unwrap_or(0)
}

/// Twice the signed area of a triangle, with the exact sign.
fn turn([a, b, c]: [Point2<f64>; 3]) -> f64 {
    let coord = |p: Point2<f64>| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Whether corner `k` of the ring is an ear, and how well shaped: area over the longest side squared.
fn ear_quality(corners: &[Point2<f64>], ring: &[usize], k: usize) -> Option<f64> {
    let ear = around(ring, k).map(|i| corners[i]);
    let area = turn(ear);
    if area <= 0.0 {
        return None;
    }
    let [a, b, c] = ear;
    let blocked = ring.iter().any(|&i| {
        let p = corners[i];
        p != a
            && p != b
            && p != c
            && turn([a, b, p]) >= 0.0
            && turn([b, c, p]) >= 0.0
            && turn([c, a, p]) >= 0.0
    });
    let longest = (b - a).norm_squared().max((c - b).norm_squared()).max((a - c).norm_squared());
    (!blocked).then_some(area / longest)
}

/// Whether the closed polygon is simple: at least three corners, no two equal, no two sides touching but
/// neighbours at their common corner.
pub(crate) fn is_simple(corners: &[Point2<f64>]) -> bool {
    let n = corners.len();
    let side = |i: usize| (corners[i], corners[(i + 1) % n]);
    n >= 3
        && (0..n).all(|i| {
            let (a, b) = side(i);
            let after = corners[(i + 2) % n];
            // No zero-length side, no turning straight back.
            a != b
                && (turn([a, b, after]) != 0.0 || (b - a).dot(&(after - b)) > 0.0)
                && (i + 2..n).filter(|j| (j + 1) % n != i).all(|j| !sides_touch((a, b), side(j)))
        })
}

fn sides_touch((a, b): (Point2<f64>, Point2<f64>), (c, d): (Point2<f64>, Point2<f64>)) -> bool {
    let sign = |p, q, r| turn([p, q, r]).total_cmp(&0.0) as i8 * i8::from(turn([p, q, r]) != 0.0);
    let within = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| {
        let (low, high) = (p.inf(&q), p.sup(&q));
        low.x <= r.x && r.x <= high.x && low.y <= r.y && r.y <= high.y
    };
    let (o1, o2, o3, o4) = (sign(a, b, c), sign(a, b, d), sign(c, d, a), sign(c, d, b));
    (o1 * o2 < 0 && o3 * o4 < 0)
        || (o1 == 0 && within(a, b, c))
        || (o2 == 0 && within(a, b, d))
        || (o3 == 0 && within(c, d, a))
        || (o4 == 0 && within(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(polygon: &[Point2<f64>]) -> f64 {
        let n = polygon.len();
        (0..n).map(|i| polygon[i].coords.perp(&polygon[(i + 1) % n].coords)).sum::<f64>() * 0.5
    }

    /// Same orientation, areas adding up, every side used once: then nothing overlaps and nothing is missing.
    fn check(polygon: &[Point2<f64>]) -> Result<(), TestCaseError> {
        prop_assert!(is_simple(polygon), "{:?}", polygon);
        let triangles = triangulate_ccw(polygon);
        prop_assert_eq!(triangles.len(), polygon.len() - 2);
        let mut total = 0.0;
        for t in &triangles {
            let t = t.map(|i| polygon[i]);
            prop_assert!(turn(t) > 0.0, "degenerate or turned: {:?} of {:?}", t, polygon);
            total += turn(t) * 0.5;
        }
        let exact = area(polygon);
        prop_assert!((total - exact).abs() <= 1e-12 * exact);
        for i in 0..polygon.len() {
            let j = (i + 1) % polygon.len();
            let uses = triangles.iter().filter(|t| (0..3).any(|k| (t[k], t[(k + 1) % 3]) == (i, j)));
            prop_assert_eq!(uses.count(), 1);
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn star_shaped_polygons(radii in prop::collection::vec(0.05..1.0_f64, 3..40)) {
            let n = radii.len() as f64;
            let polygon: Vec<_> = radii.iter().enumerate().map(|(i, r)| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / n).sin_cos();
                Point2::new(r * c, r * s)
            }).collect();
            check(&polygon)?;
        }

        #[test]
        fn combs_with_collinear_corners(teeth in prop::collection::vec(1_u8..6, 1..12), extra in 0_usize..5) {
            // A comb on an integer grid: exact collinear runs below, right angles above.
            let mut polygon = Vec::new();
            let width = 2 * teeth.len();
            polygon.extend((0..=width).map(|x| Point2::new(x as f64, 0.0)));
            for k in 1..=extra {
                polygon.push(Point2::new(width as f64, k as f64 / (extra + 1) as f64));
            }
            for (i, t) in teeth.iter().enumerate() {
                let right = (width - 2 * i) as f64;
                let top = 1.0 + f64::from(*t);
                polygon.extend([(right, top), (right - 1.0, top), (right - 1.0, 1.0), (right - 2.0, 1.0)].map(|(x, y)| Point2::new(x, y)));
            }
            polygon.dedup();
            check(&polygon)?;
        }

        #[test]
        fn in_any_plane_and_orientation(radii in prop::collection::vec(0.1..1.0_f64, 4..12), axis in prop::array::uniform3(-1.0..1.0), reverse in any::<bool>()) {
            let n = radii.len() as f64;
            let turn = nalgebra::Rotation3::new(Vector3::from(axis) * 3.0);
            let mut corners: Vec<_> = radii.iter().enumerate().map(|(i, r)| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / n).sin_cos();
                turn * Point3::new(r * c + 5.0, r * s - 3.0, 2.0)
            }).collect();
            if reverse {
                corners.reverse();
            }
            let normal = newell_normal(&corners);
            let mut sum = Vector3::zeros();
            for t in triangulate(&corners) {
                let [a, b, c] = t.map(|i| corners[i]);
                let cross = (b - a).cross(&(c - a));
                prop_assert!(cross.dot(&normal) > 0.0);
                sum += cross;
            }
            prop_assert!((sum - normal).norm() < 1e-12);
        }

        #[test]
        fn any_ring_gives_triangles(points in prop::collection::vec(prop::array::uniform3(-3_i8..4), 3..12)) {
            let corners: Vec<_> = points.iter().map(|p| Point3::from(p.map(f64::from))).collect();
            let triangles = triangulate(&corners);
            prop_assert_eq!(triangles.len(), corners.len() - 2);
            prop_assert!(triangles.iter().flatten().all(|&i| i < corners.len()));
        }
    }

    #[test]
    fn simple_or_not() {
        let p = |c: &[(f64, f64)]| c.iter().map(|&(x, y)| Point2::new(x, y)).collect::<Vec<_>>();
        assert!(is_simple(&p(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0)])));
        // A bow tie, a spike, a repeated corner, a corner touching a side, two corners.
        assert!(!is_simple(&p(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (2.0, 0.0), (1.0, 0.0), (0.0, 1.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (4.0, 0.0), (2.0, 2.0), (2.0, 0.0), (1.0, 3.0)])));
        assert!(!is_simple(&p(&[(0.0, 0.0), (1.0, 0.0)])));
    }
}
