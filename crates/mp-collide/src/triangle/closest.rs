//! The distance between triangles and their nearest points.
//!
//! Two triangles apart are closest either edge to edge or corner to face: nine pairs of segments and six
//! points against triangles. Minima are found by orthogonal projection rather than normal equations, so
//! that nearly parallel edges and slivers keep their accuracy: errors stay at some units in the last place
//! of the coordinates.

use nalgebra::{Point3, Vector3};

use super::{Triangle, intersect};
use crate::separation::Separation;

/// A squared distance and the two points that far apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closest {
    pub(crate) squared: f64,
    pub(crate) on_a: Point3<f64>,
    pub(crate) on_b: Point3<f64>,
}

impl Closest {
    pub(crate) const NONE: Self =
        Self { squared: f64::INFINITY, on_a: Point3::new(0.0, 0.0, 0.0), on_b: Point3::new(0.0, 0.0, 0.0) };

    fn keep(&mut self, on_a: Point3<f64>, on_b: Point3<f64>) -> bool {
        let squared = (on_b - on_a).norm_squared();
        let better = squared < self.squared;
        if better {
            *self = Self { squared, on_a, on_b };
        }
        better
    }
}

/// The distance of two triangles in the same frame with nearest points; 0 exactly when they intersect.
#[must_use]
pub fn closest(a: &Triangle, b: &Triangle) -> Separation {
    if intersect(a, b) {
        let point = crossing(a, b);
        return Separation { distance: 0.0, point_a: point, point_b: point };
    }
    let best = closest_within(a, b, f64::INFINITY).unwrap_or(Closest::NONE);
    Separation {
        distance: best.squared.sqrt().max(f64::MIN_POSITIVE),
        point_a: best.on_a,
        point_b: best.on_b,
    }
}

/// The nearest points of two triangles that do not intersect, when their squared distance is below `squared`.
pub(crate) fn closest_within(a: &Triangle, b: &Triangle, squared: f64) -> Option<Closest> {
    let mut best = Closest { squared, ..Closest::NONE };
    let mut found = false;
    for i in 0..3 {
        for j in 0..3 {
            let (p, q) = between_segments((&a[i], &a[(i + 1) % 3]), (&b[j], &b[(j + 1) % 3]));
            if best.keep(p, q) {
                found = true;
                if is_nearest(a, b, p, q) {
                    return Some(best);
                }
            }
        }
    }
    for p in a {
        if let Some(q) = foot_inside(p, b) {
            found |= best.keep(*p, q);
        }
    }
    for q in b {
        if let Some(p) = foot_inside(q, a) {
            found |= best.keep(p, *q);
        }
    }
    found.then_some(best)
}

/// Whether `p` on `a` and `q` on `b` are nearest points, up to rounding: the slab between them, orthogonal to their join,
/// separates the triangles.
pub(crate) fn is_nearest(a: &Triangle, b: &Triangle, p: Point3<f64>, q: Point3<f64>) -> bool {
    let (gap, rounding) = gap_along(a, b, p, q);
    gap >= (q - p).norm_squared() - rounding
}

/// Whether `a` and `b` are farther apart than `p` and `q`, points of other triangles, by more than the rounding of a
/// distance: shown by the gap between the triangles along the join of the points.
pub(crate) fn is_farther(a: &Triangle, b: &Triangle, p: Point3<f64>, q: Point3<f64>) -> bool {
    let (gap, rounding) = gap_along(a, b, p, q);
    gap > (q - p).norm_squared() * (1.0 + 1e-9) + 1e3 * rounding
}

/// The gap between triangles along the join of two points, times the length of the join, and a bound on its rounding
/// error.
fn gap_along(a: &Triangle, b: &Triangle, p: Point3<f64>, q: Point3<f64>) -> (f64, f64) {
    let join = q - p;
    let (mut top_a, mut bottom_b, mut size) = (f64::NEG_INFINITY, f64::INFINITY, 0.0_f64);
    for corner in a {
        let along = join.dot(&(corner - p));
        top_a = top_a.max(along);
        size = size.max(along.abs());
    }
    for corner in b {
        let along = join.dot(&(corner - p));
        bottom_b = bottom_b.min(along);
        size = size.max(along.abs());
    }
    (bottom_b - top_a, 4.0 * f64::EPSILON * size)
}

/// The nearest points of two closed segments (either may be a point).
fn between_segments(
    (p0, p1): (&Point3<f64>, &Point3<f64>),
    (q0, q1): (&Point3<f64>, &Point3<f64>),
) -> (Point3<f64>, Point3<f64>) {
    let (u, v, r) = (p1 - p0, q1 - q0, q0 - p0);
    let vv = v.norm_squared();
    // The components of u and r orthogonal to v: the distance of the lines depends on them only.
    let beside = |w: &Vector3<f64>| if vv > 0.0 { w - v * (w.dot(&v) / vv) } else { *w };
    let (u_beside, r_beside) = (beside(&u), beside(&r));
    let mut s = ratio(r_beside.dot(&u_beside), u_beside.norm_squared());
    let t = unclamped_ratio((u * s - r).dot(&v), vv);
    let t = if t < 0.0 {
        s = ratio(r.dot(&u), u.norm_squared());
        0.0
    } else if t > 1.0 {
        s = ratio((r + v).dot(&u), u.norm_squared());
        1.0
    } else {
        t
    };
    (at(p0, p1, s), at(q0, q1, t))
}

/// The point at fraction `s` from `p0` to `p1`; exactly the ends at 0 and 1.
fn at(p0: &Point3<f64>, p1: &Point3<f64>, s: f64) -> Point3<f64> {
    if s < 1.0 { p0 + (p1 - p0) * s } else { *p1 }
}

fn unclamped_ratio(x: f64, y: f64) -> f64 {
    if y > 0.0 { x / y } else { 0.0 }
}

fn ratio(x: f64, y: f64) -> f64 {
    unclamped_ratio(x, y).clamp(0.0, 1.0)
}

/// The foot of the perpendicular from `p` on the plane of `t`, when within the triangle.
fn foot_inside(p: &Point3<f64>, t: &Triangle) -> Option<Point3<f64>> {
    let (u, v, r) = (t[1] - t[0], t[2] - t[0], p - t[0]);
    let uu = u.norm_squared();
    if uu <= 0.0 {
        return None;
    }
    let along = |w: &Vector3<f64>| w.dot(&u) / uu;
    let v_beside = v - u * along(&v);
    let vv = v_beside.norm_squared();
    if vv <= 0.0 {
        return None;
    }
    let y = (r - u * along(&r)).dot(&v_beside) / vv;
    let x = along(&(r - v * y));
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0).then(|| t[0] + u * x + v * y)
}

/// The point of a triangle that is nearest to `p`.
pub(crate) fn closest_to_point(t: &Triangle, p: &Point3<f64>) -> Point3<f64> {
    foot_inside(p, t).unwrap_or_else(|| {
        let on_edges = [0, 1, 2].map(|i| {
            let (from, along) = (t[i], t[(i + 1) % 3] - t[i]);
            at(&from, &t[(i + 1) % 3], ratio((p - from).dot(&along), along.norm_squared()))
        });
        let squared = on_edges.map(|q| (q - p).norm_squared());
        let nearest = if squared[1] < squared[0] { 1 } else { 0 };
        if squared[2] < squared[nearest] { on_edges[2] } else { on_edges[nearest] }
    })
}

/// A point common to two triangles that intersect, up to rounding.
pub(crate) fn crossing(a: &Triangle, b: &Triangle) -> Point3<f64> {
    let mut best = Closest::NONE;
    for (edges, face) in [(a, b), (b, a)] {
        let normal = (face[1] - face[0]).cross(&(face[2] - face[0]));
        for i in 0..3 {
            let (p, q) = (&edges[i], &edges[(i + 1) % 3]);
            let (hp, hq) = (normal.dot(&(p - face[0])), normal.dot(&(q - face[0])));
            if hp * hq < 0.0 {
                let through = at(p, q, hp / (hp - hq));
                if let Some(foot) = foot_inside(&through, face) {
                    best.keep(through, foot);
                }
            }
        }
    }
    // No edge passes through a face, or the face is too thin to compute where.
    let size = a.iter().chain(b).fold(0.0, |size: f64, p| size.max((p - a[0]).amax()));
    if best.squared.sqrt() > 1e-13 * size {
        best = closest_within(a, b, best.squared).unwrap_or(best);
    }
    best.on_a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_common_points() {
        let mut state = 5u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut hits = 0;
        for round in 0..20_000 {
            // In general position, on a coarse grid, and in one plane.
            let corner = |next: &mut dyn FnMut() -> f64| match round % 3 {
                0 => Point3::new(next(), next(), next()),
                1 => Point3::new(next(), next(), next()).map(|c| (2.0 * c).round()),
                _ => Point3::new(next(), next(), 0.0),
            };
            let [a, b]: [Triangle; 2] = [0; 2].map(|_| [0; 3].map(|_| corner(&mut next)));
            if intersect(&a, &b) {
                let at = crossing(&a, &b);
                for t in [&a, &b] {
                    assert!(closest(t, &[at; 3]).distance < 1e-12, "{a:?} {b:?} {at}");
                }
                hits += 1;
            }
        }
        assert!(hits > 4_000, "{hits}");
    }
}
