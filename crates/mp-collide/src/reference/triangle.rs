//! Distances of triangles, by plain formulas.

use nalgebra::{Point3, Vector3};

pub(super) type Triangle = [Point3<f64>; 3];

const EDGES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// The distance of two triangles, up to rounding; 0 when an edge of one passes through the other.
#[must_use]
pub fn triangle_distance(a: &[Point3<f64>; 3], b: &[Point3<f64>; 3]) -> f64 {
    triangle_gap(a, b).norm()
}

/// The shortest vector from triangle `b` to triangle `a`; zero when an edge of one passes through the other.
///
/// The least of: corners to the other triangle; common perpendiculars of edges.
pub(super) fn triangle_gap(a: &Triangle, b: &Triangle) -> Vector3<f64> {
    if is_point(a) {
        return to_point(&a[0], b);
    }
    if is_point(b) {
        return -to_point(&b[0], a);
    }
    let mut least = Shortest::default();
    for p in a {
        least.offer(to_point(p, b));
    }
    for p in b {
        least.offer(-to_point(p, a));
    }
    for (i, j) in EDGES {
        if passes_through(&a[i], &a[j], b) || passes_through(&b[i], &b[j], a) {
            return Vector3::zeros();
        }
        for (k, l) in EDGES {
            if let Some(way) = common_perpendicular(&a[i], &a[j], &b[k], &b[l]) {
                least.offer(way);
            }
        }
    }
    least.way
}

/// The shortest of the vectors offered.
struct Shortest {
    way: Vector3<f64>,
    square: f64,
}

impl Default for Shortest {
    fn default() -> Self {
        Self { way: Vector3::repeat(f64::INFINITY), square: f64::INFINITY }
    }
}

impl Shortest {
    fn offer(&mut self, way: Vector3<f64>) {
        let square = way.norm_squared();
        if square < self.square {
            *self = Self { way, square };
        }
    }
}

/// Whether it is a single point: the middle of a ball.
fn is_point(t: &Triangle) -> bool {
    t[0] == t[1] && t[1] == t[2]
}

/// The distance from a point to a triangle.
pub(super) fn point_triangle(p: &Point3<f64>, t: &Triangle) -> f64 {
    to_point(p, t).norm()
}

/// The shortest vector from triangle `t` to a point.
pub(super) fn to_point(p: &Point3<f64>, t: &Triangle) -> Vector3<f64> {
    if is_point(t) {
        return p - t[0];
    }
    let (u, v) = (t[1] - t[0], t[2] - t[0]);
    let normal = u.cross(&v);
    let square = normal.norm_squared();
    // A sliver thinner than rounding is replaced by its edges.
    if square.sqrt() > 1e-14 * u.norm_squared().max(v.norm_squared()) {
        let inside = EDGES.iter().all(|&(i, j)| normal.dot(&(t[j] - t[i]).cross(&(p - t[i]))) >= 0.0);
        if inside {
            return normal * (normal.dot(&(p - t[0])) / square);
        }
    }
    let mut least = Shortest::default();
    for (i, j) in EDGES {
        least.offer(from_segment(p, &t[i], &t[j]));
    }
    least.way
}

pub(super) fn from_segment(p: &Point3<f64>, a: &Point3<f64>, b: &Point3<f64>) -> Vector3<f64> {
    let (along, to_p) = (b - a, p - a);
    let reach = to_p.dot(&along);
    let square = along.norm_squared();
    if reach <= 0.0 || square == 0.0 {
        to_p
    } else if reach >= square {
        p - b
    } else {
        to_p - along * (reach / square)
    }
}

/// The vector from the second of two segments to the first along their common perpendicular, when that meets both.
fn common_perpendicular(
    a: &Point3<f64>,
    b: &Point3<f64>,
    c: &Point3<f64>,
    d: &Point3<f64>,
) -> Option<Vector3<f64>> {
    let (u, v, w) = (b - a, d - c, c - a);
    let normal = u.cross(&v);
    let square = normal.norm_squared();
    if square == 0.0 {
        return None;
    }
    let s = w.cross(&v).dot(&normal) / square;
    let t = w.cross(&u).dot(&normal) / square;
    if !(0.0..=1.0).contains(&s) || !(0.0..=1.0).contains(&t) {
        return None;
    }
    Some(from_segment(&(a + u * s), c, d))
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
