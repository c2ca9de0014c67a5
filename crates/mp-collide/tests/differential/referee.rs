//! Exact answers for triangles with integer corners.
//!
//! Two convex sets meet exactly when the origin is in the set of their differences, here the convex hull of
//! the nine differences of corners. By Carathéodory's theorem it is in the hull of four or fewer of them
//! that are affinely independent; and when it is not in the hull, the nearest point of the hull is the
//! nearest point of the hull of three or fewer. All subsets are tried, in integers: nothing of this is how
//! the engine works.

pub(crate) type Corner = [i64; 3];
type V = [i128; 3];

/// Corners may be so large (in magnitude) that determinants of differences fit in 128 bits.
pub(crate) const LIMIT: i64 = 1 << 39;
/// The same for [`distance`], where determinants are squared.
pub(crate) const DISTANCE_LIMIT: i64 = 1 << 18;

fn differences(a: &[Corner; 3], b: &[Corner; 3]) -> Vec<V> {
    let mut all = Vec::with_capacity(9);
    for p in a {
        for q in b {
            let d = [0, 1, 2].map(|k| i128::from(p[k]) - i128::from(q[k]));
            if !all.contains(&d) {
                all.push(d);
            }
        }
    }
    all
}

fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: V, b: V) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn det(a: V, b: V, c: V) -> i128 {
    dot(a, cross(b, c))
}

/// Whether two closed triangles (which may be segments or points) have a point in common.
pub(crate) fn intersect(a: &[Corner; 3], b: &[Corner; 3]) -> bool {
    let d = differences(a, b);
    let n = d.len();
    for i in 0..n {
        if d[i] == [0; 3] {
            return true;
        }
        for j in i + 1..n {
            if cross(d[i], d[j]) == [0; 3] && dot(d[i], d[j]) <= 0 {
                return true;
            }
            for k in j + 1..n {
                if det(d[i], d[j], d[k]) == 0 && in_triangle(d[i], d[j], d[k]) {
                    return true;
                }
                if (k + 1..n).any(|l| in_tetrahedron(d[i], d[j], d[k], d[l])) {
                    return true;
                }
            }
        }
    }
    false
}

/// Whether the origin, known to be in the plane of a triangle, is in the triangle. `false` without area.
fn in_triangle(p: V, q: V, r: V) -> bool {
    let normal = cross(sub(q, p), sub(r, p));
    // The components of the normal tell orientation; one that is not zero will do.
    let Some(axis) = (0..3).find(|&k| normal[k] != 0) else { return false };
    let sign = normal[axis].signum();
    [(p, q), (q, r), (r, p)].iter().all(|&(u, v)| cross(u, v)[axis].signum() * sign >= 0)
}

/// Whether the origin is in a tetrahedron. `false` without volume.
fn in_tetrahedron(p: V, q: V, r: V, s: V) -> bool {
    let sign = det(sub(q, p), sub(r, p), sub(s, p)).signum();
    sign != 0
        && det(q, r, s).signum() * sign >= 0
        && det(p, s, r).signum() * sign >= 0
        && det(p, q, s).signum() * sign >= 0
        && det(p, r, q).signum() * sign >= 0
}

/// The distance, right to the last places of `f64`.
pub(crate) fn distance(a: &[Corner; 3], b: &[Corner; 3]) -> f64 {
    if intersect(a, b) {
        return 0.0;
    }
    let d = differences(a, b);
    let n = d.len();
    let mut least = f64::INFINITY;
    for i in 0..n {
        least = least.min(dot(d[i], d[i]) as f64);
        for j in i + 1..n {
            let u = sub(d[j], d[i]);
            let (along, square) = (-dot(d[i], u), dot(u, u));
            if along > 0 && along < square {
                let c = cross(d[i], d[j]);
                least = least.min(dot(c, c) as f64 / square as f64);
            }
            for k in j + 1..n {
                let normal = cross(u, sub(d[k], d[i]));
                let square = dot(normal, normal);
                if square != 0 && foot_inside(d[i], d[j], d[k], normal) {
                    let height = dot(d[i], normal) as f64;
                    least = least.min(height * height / square as f64);
                }
            }
        }
    }
    least.sqrt()
}

/// Whether the foot of the origin on the plane of a triangle is in the triangle.
fn foot_inside(p: V, q: V, r: V, normal: V) -> bool {
    [(p, q), (q, r), (r, p)].iter().all(|&(u, v)| dot(normal, cross(u, v)) >= 0)
}
