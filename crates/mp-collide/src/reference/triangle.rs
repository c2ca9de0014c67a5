//! Distances of triangles, the plain way.

use nalgebra::Point3;

pub(super) type Triangle = [Point3<f64>; 3];

const EDGES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// The distance of two triangles, up to rounding; 0 when an edge of one passes through the other.
///
/// The least of: corners to the other triangle; common perpendiculars of edges.
#[must_use]
pub fn triangle_distance(a: &[Point3<f64>; 3], b: &[Point3<f64>; 3]) -> f64 {
    let mut least = f64::INFINITY;
    for p in a {
        least = least.min(point_triangle(p, b));
    }
    for p in b {
        least = least.min(point_triangle(p, a));
    }
    for (i, j) in EDGES {
        if passes_through(&a[i], &a[j], b) || passes_through(&b[i], &b[j], a) {
            return 0.0;
        }
        for (k, l) in EDGES {
            least = least.min(common_perpendicular(&a[i], &a[j], &b[k], &b[l]));
        }
    }
    least
}

/// The distance from a point to a triangle.
pub(super) fn point_triangle(p: &Point3<f64>, t: &Triangle) -> f64 {
    let (u, v) = (t[1] - t[0], t[2] - t[0]);
    let normal = u.cross(&v);
    let area = normal.norm();
    // A sliver thinner than rounding is as good as its edges.
    if area > 1e-14 * u.norm().max(v.norm()).powi(2) {
        let inside = EDGES.iter().all(|&(i, j)| normal.dot(&(t[j] - t[i]).cross(&(p - t[i]))) >= 0.0);
        if inside {
            return (normal.dot(&(p - t[0])) / area).abs();
        }
    }
    EDGES.iter().map(|&(i, j)| point_segment(p, &t[i], &t[j])).fold(f64::INFINITY, f64::min)
}

/// The distance from a point to a segment.
fn point_segment(p: &Point3<f64>, a: &Point3<f64>, b: &Point3<f64>) -> f64 {
    let (along, to_p) = (b - a, p - a);
    let reach = to_p.dot(&along);
    let square = along.norm_squared();
    if reach <= 0.0 || square == 0.0 {
        to_p.norm()
    } else if reach >= square {
        (p - b).norm()
    } else {
        (to_p - along * (reach / square)).norm()
    }
}

/// The distance of two segments at their common perpendicular, when it meets both; else infinity.
fn common_perpendicular(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, d: &Point3<f64>) -> f64 {
    let (u, v, w) = (b - a, d - c, c - a);
    let normal = u.cross(&v);
    let square = normal.norm_squared();
    if square == 0.0 {
        return f64::INFINITY;
    }
    let s = w.cross(&v).dot(&normal) / square;
    let t = w.cross(&u).dot(&normal) / square;
    if !(0.0..=1.0).contains(&s) || !(0.0..=1.0).contains(&t) {
        return f64::INFINITY;
    }
    point_segment(&(a + u * s), c, d)
}

/// Whether a segment passes through a triangle (Möller, Trumbore, *Fast, Minimum Storage Ray-Triangle
/// Intersection*, JGT 1997).
fn passes_through(a: &Point3<f64>, b: &Point3<f64>, t: &Triangle) -> bool {
    let (direction, u, v) = (b - a, t[1] - t[0], t[2] - t[0]);
    let cross = direction.cross(&v);
    let volume = u.dot(&cross);
    if volume == 0.0 {
        return false;
    }
    let from = a - t[0];
    let x = from.dot(&cross) / volume;
    let across = from.cross(&u);
    let y = direction.dot(&across) / volume;
    let along = v.dot(&across) / volume;
    x >= 0.0 && y >= 0.0 && x + y <= 1.0 && (0.0..=1.0).contains(&along)
}
