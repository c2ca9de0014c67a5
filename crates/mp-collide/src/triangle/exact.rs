//! The exact triangle–triangle intersection test.
//!
//! Two convex hulls of three points meet exactly when an edge of one meets the other. For triangles in
//! general position this is decided by the signs of 6 + 9 tetrahedron volumes (as in Guigue, Devillers,
//! *Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates*, JGT 2003), each computed
//! with an error bound and, where that is not enough, exactly (Shewchuk, *Adaptive Precision
//! Floating-Point Arithmetic and Fast Robust Geometric Predicates*, 1997).

use nalgebra::{Point3, Vector3};
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::Triangle;

/// Whether two closed triangles have a point in common: exactly, for the coordinates as given.
///
/// Touching counts. Any of them may be a segment or a point.
#[must_use]
pub fn intersect(a: &Triangle, b: &Triangle) -> bool {
    clear_cut(a, b).unwrap_or_else(|| decide(a, b))
}

/// The answer where error bounds in plain `f64` decide it: the usual case, at a fraction of the cost.
///
/// With u = 2⁻⁵³, coordinates of edges up to `e` and `f` and of differences of corners up to `d`, a coordinate of
/// a product of edges is wrong by 8u·e·f; a volume, three products of that with a difference, by 48u·d·e·f.
fn clear_cut(a: &Triangle, b: &Triangle) -> Option<bool> {
    const WRONG: f64 = 6e-15;
    /// Below this a volume may have lost something to underflow.
    const LEAST: f64 = 1e-280;
    let sign = |x: f64, wrong: f64| i8::from(x > wrong) - i8::from(x < -wrong);
    let (e, f) = (differences(a), differences(b));
    let (long_e, long_f) = (largest(&e), largest(&f));
    let to_b = b.map(|p| p - a[0]);
    let to_a = a.map(|p| p - b[0]);
    let reach = largest(&to_b);
    let wrong = (WRONG * reach * long_e * long_e).max(LEAST);
    let normal = e[0].cross(&e[1]);
    let side_of_a = to_b.map(|p| sign(normal.dot(&p), wrong));
    if side_of_a.contains(&0) {
        return None;
    }
    if one_sided(side_of_a) {
        return Some(false);
    }
    let reach = largest(&to_a);
    let wrong = (WRONG * reach * long_f * long_f).max(LEAST);
    let normal = f[0].cross(&f[1]);
    let side_of_b = to_a.map(|p| sign(normal.dot(&p), wrong));
    if side_of_b.contains(&0) {
        return None;
    }
    if one_sided(side_of_b) {
        return Some(false);
    }
    let wrong = (WRONG * (reach + long_f) * long_e * long_f).max(LEAST);
    let volume = |i: usize, j: usize| sign((a[i] - b[j]).dot(&e[i].cross(&f[j])), wrong);
    for j in (0..3).filter(|&j| side_of_a[j] != side_of_a[next(j)]) {
        if same([volume(0, j), volume(1, j), volume(2, j)])? {
            return Some(true);
        }
    }
    for i in (0..3).filter(|&i| side_of_b[i] != side_of_b[next(i)]) {
        if same([volume(i, 0), volume(i, 1), volume(i, 2)])? {
            return Some(true);
        }
    }
    Some(false)
}

/// Edge `i` starts at corner `i`.
fn differences(t: &Triangle) -> [Vector3<f64>; 3] {
    [t[1] - t[0], t[2] - t[1], t[0] - t[2]]
}

fn largest(v: &[Vector3<f64>; 3]) -> f64 {
    // `max` as one instruction: NaN does not matter here.
    let max = |x: f64, y: f64| if x > y { x } else { y };
    v.iter().flatten().fold(0.0, |m, x| max(x.abs(), m))
}

/// Whether three signs are the same; `None` where one is 0 and the others do not differ.
fn same(s: [i8; 3]) -> Option<bool> {
    let (up, down) = (s.contains(&1), s.contains(&-1));
    if up && down {
        Some(false)
    } else if s.contains(&0) {
        None
    } else {
        Some(true)
    }
}

/// The answer by exact signs.
fn decide(a: &Triangle, b: &Triangle) -> bool {
    // Flat faces of bodies that stand on one floor: no volume is needed.
    let level = |k: usize| a.iter().chain(b).all(|p| p[k] == a[0][k]);
    if let Some(answer) = (0..3).find(|&k| level(k)).and_then(|k| meet_in_plane(a, b, k)) {
        return answer;
    }
    let side_of_a = b.map(|p| volume(&a[0], &a[1], &a[2], &p));
    if one_sided(side_of_a) {
        return false;
    }
    let side_of_b = a.map(|p| volume(&b[0], &b[1], &b[2], &p));
    if one_sided(side_of_b) {
        return false;
    }
    if side_of_a == [0; 3] || side_of_b == [0; 3] {
        // Coplanar, or one has no area.
        let drop = visible_along(&a[0], &a[1], &a[2]);
        if let Some(answer) = drop.filter(|_| side_of_a == side_of_b).and_then(|k| meet_in_plane(a, b, k)) {
            return answer;
        }
        return edges(a).any(|(p, q)| segment_meets(p, q, b))
            || edges(b).any(|(p, q)| segment_meets(p, q, a));
    }
    // Both have an area, in different planes: they meet exactly when an edge of one that does not lie in
    // the plane of the other meets it there. Corner k starts edge k.
    let mut memo = [[None; 3]; 3];
    let mut twist = |i: usize, j: usize| {
        *memo[i][j].get_or_insert_with(|| volume(&a[i], &a[next(i)], &b[j], &b[next(j)]))
    };
    (0..3).any(|j| crosses(side_of_a[j], side_of_a[next(j)]) && agree((0..3).map(|i| twist(i, j))))
        || (0..3).any(|i| crosses(side_of_b[i], side_of_b[next(i)]) && agree((0..3).map(|j| twist(i, j))))
}

/// How the ray from `p` along x passes a triangle: 1 outward, −1 inward, 0 when it misses;
/// `None` when `p` is on it. Exactly.
///
/// By symbolic perturbation: seen along x, `p` counts as moved by ε along y and ε² along z. So the ray meets no edge or
/// corner, and of triangles that share an edge it passes through the right number.
pub(crate) fn passes(p: &Point3<f64>, t: &Triangle) -> Option<i8> {
    let side = |u: &Point3<f64>, v: &Point3<f64>| {
        let signs = [area(u, v, p, 0), sign(u.z - v.z), sign(v.y - u.y)];
        signs.into_iter().find(|s| *s != 0).unwrap_or(0)
    };
    let facing = side(&t[0], &t[1]);
    if facing == 0 || side(&t[1], &t[2]) != facing || side(&t[2], &t[0]) != facing {
        return Some(0);
    }
    match volume(&t[0], &t[1], &t[2], p) {
        0 => None,
        below if below == facing => Some(facing),
        _ => Some(0),
    }
}

fn next(i: usize) -> usize {
    (i + 1) % 3
}

fn edges(t: &Triangle) -> impl Iterator<Item = (&Point3<f64>, &Point3<f64>)> {
    (0..3).map(|i| (&t[i], &t[next(i)]))
}

fn one_sided(sides: [i8; 3]) -> bool {
    sides == [1; 3] || sides == [-1; 3]
}

/// Whether a segment with ends on these sides of a plane meets it in exactly one point.
fn crosses(p: i8, q: i8) -> bool {
    p * q <= 0 && (p, q) != (0, 0)
}

/// Whether no two signs are opposite.
fn agree(signs: impl Iterator<Item = i8>) -> bool {
    let (mut positive, mut negative) = (false, false);
    for s in signs {
        positive |= s > 0;
        negative |= s < 0;
        if positive && negative {
            return false;
        }
    }
    true
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// The sign of the volume of a tetrahedron, exactly.
///
/// The determinant with Shewchuk's first error bound decides nearly always; his adaptive arithmetic decides the rest.
#[inline]
fn volume(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, d: &Point3<f64>) -> i8 {
    const BOUND: f64 = 7.771_561_172_376_103e-16;
    let (u, v, w) = (a - d, b - d, c - d);
    let (vw, wv) = (v.x * w.y, w.x * v.y);
    let (wu, uw) = (w.x * u.y, u.x * w.y);
    let (uv, vu) = (u.x * v.y, v.x * u.y);
    let volume = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
    let size = (vw.abs() + wv.abs()) * u.z.abs()
        + (wu.abs() + uw.abs()) * v.z.abs()
        + (uv.abs() + vu.abs()) * w.z.abs();
    let wrong = BOUND * size;
    // The lower limit keeps clear of underflow, for which the bound does not account.
    if volume.abs() > wrong && size > 1e-280 { sign(volume) } else { exact_volume(a, b, c, d) }
}

#[cold]
fn exact_volume(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, d: &Point3<f64>) -> i8 {
    // What stands on one floor: all four in a plane across an axis, or two edges along one.
    let same = |p: &Point3<f64>, q: &Point3<f64>, k: usize| p[k] == q[k];
    let level = |k: usize| [b, c, d].into_iter().all(|p| same(a, p, k));
    let along = |k: usize| (0..3).all(|l| l == k || (same(a, b, l) && same(c, d, l)));
    if (0..3).any(|k| level(k) || along(k)) {
        return 0;
    }
    let coord = |p: &Point3<f64>| Coord3D { x: p.x, y: p.y, z: p.z };
    sign(orient3d(coord(a), coord(b), coord(c), coord(d)))
}

fn projected(p: &Point3<f64>, drop: usize) -> Coord<f64> {
    let (x, y) = [(1, 2), (0, 2), (0, 1)][drop];
    Coord { x: p[x], y: p[y] }
}

/// The sign of the area of a triangle seen along axis `drop`, exactly.
fn area(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>, drop: usize) -> i8 {
    sign(orient2d(projected(a, drop), projected(b, drop), projected(c, drop)))
}

/// An axis along which the triangle is seen to have an area; `None` when its corners lie on a line.
fn visible_along(a: &Point3<f64>, b: &Point3<f64>, c: &Point3<f64>) -> Option<usize> {
    (0..3).find(|&drop| area(a, b, c, drop) != 0)
}

/// Whether two triangles of one plane meet, seen along axis `drop`; `None` where one of them has no area then. Disjoint ones are on
/// different sides of an edge of one of them.
fn meet_in_plane(a: &Triangle, b: &Triangle, drop: usize) -> Option<bool> {
    let facing = |t: &Triangle| Some(area(&t[0], &t[1], &t[2], drop)).filter(|facing| *facing != 0);
    let beyond_an_edge = |t: &Triangle, facing: i8, other: &Triangle| {
        edges(t).any(|(u, v)| other.iter().all(|p| area(u, v, p, drop) == -facing))
    };
    let (of_a, of_b) = (facing(a)?, facing(b)?);
    Some(!beyond_an_edge(a, of_a, b) && !beyond_an_edge(b, of_b, a))
}

/// Whether a closed segment meets a closed triangle; both may be degenerate.
fn segment_meets(p: &Point3<f64>, q: &Point3<f64>, t: &Triangle) -> bool {
    let (sp, sq) = (volume(&t[0], &t[1], &t[2], p), volume(&t[0], &t[1], &t[2], q));
    if crosses(sp, sq) {
        return agree(edges(t).map(|(u, v)| volume(p, q, u, v)));
    }
    if (sp, sq) != (0, 0) {
        return false;
    }
    match visible_along(&t[0], &t[1], &t[2]) {
        // All in one plane, which is seen undistorted (up to an affine map) along `drop`.
        Some(drop) => {
            agree(edges(t).map(|(u, v)| area(u, v, p, drop)))
                || edges(t).any(|(u, v)| segments_meet_in_plane(p, q, u, v, drop))
        }
        None => edges(t).any(|(u, v)| segments_meet(p, q, u, v)),
    }
}

/// Whether two closed segments in space meet.
fn segments_meet(p: &Point3<f64>, q: &Point3<f64>, u: &Point3<f64>, v: &Point3<f64>) -> bool {
    if volume(p, q, u, v) != 0 {
        return false;
    }
    // In one plane: see it along an axis that shows some three of the four points as a triangle.
    let drop = visible_along(p, q, u)
        .or_else(|| visible_along(p, q, v))
        .or_else(|| visible_along(u, v, p))
        .or_else(|| visible_along(u, v, q));
    match drop {
        Some(drop) => segments_meet_in_plane(p, q, u, v, drop),
        None => on_line_overlap(p, q, u, v),
    }
}

/// Whether two closed segments of one plane meet, seen along axis `drop`, which must not be in the plane.
fn segments_meet_in_plane(
    p: &Point3<f64>,
    q: &Point3<f64>,
    u: &Point3<f64>,
    v: &Point3<f64>,
    drop: usize,
) -> bool {
    let (su, sv) = (area(p, q, u, drop), area(p, q, v, drop));
    let (sp, sq) = (area(u, v, p, drop), area(u, v, q, drop));
    if [su, sv, sp, sq] == [0; 4] {
        return on_line_overlap(p, q, u, v);
    }
    su * sv <= 0 && sp * sq <= 0
}

/// Whether two closed segments meet whose ends all lie on one line: along a line points are ordered as
/// their coordinates are, lexicographically.
fn on_line_overlap(p: &Point3<f64>, q: &Point3<f64>, u: &Point3<f64>, v: &Point3<f64>) -> bool {
    let key = |p: &Point3<f64>| [p.x, p.y, p.z];
    let sorted = |a: [f64; 3], b: [f64; 3]| if a <= b { (a, b) } else { (b, a) };
    let ((low, high), (low2, high2)) = (sorted(key(p), key(q)), sorted(key(u), key(v)));
    low <= high2 && low2 <= high
}
