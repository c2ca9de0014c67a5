//! Exact answers for triangles with integer corners.
//!
//! Whether they meet is [`mp_collide::reference::exact`], in 128 bits. When they do not, the point of their
//! differences that is nearest to the origin is in the hull of three or fewer differences of corners: all subsets
//! are tried, in integers.

use mp_collide::reference::exact::triangles_meet;

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

/// Whether two closed triangles (which may be segments or points) have a point in common.
pub(crate) fn intersect(a: &[Corner; 3], b: &[Corner; 3]) -> bool {
    let wide = |t: &[Corner; 3]| t.map(|p| p.map(i128::from));
    triangles_meet(&wide(a), &wide(b), |_, _, _| None)
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
