//! Whether two triangles meet: certified in `f64` where possible, else with integers of any size.

use mp_collide::reference::exact::triangles_meet;
use nalgebra::{Point3, Vector3};
use num_bigint::BigInt;
use std::cmp::Ordering;

pub(crate) type Triangle = [Point3<f64>; 3];

/// A bound of the rounding error of a sum of three products, relative to the sum of their magnitudes.
const DOT: f64 = 1e-15;
/// A bound of the rounding error of a determinant of differences, relative to the sum of its magnitudes.
const VOLUME: f64 = 1e-14;
/// A bound of errors by underflow, for coordinates up to 1e9.
const UNDERFLOW: f64 = 1e-280;

/// Whether a separating axis is certain, among the normals of both triangles, the normals of their edges in
/// their planes, and the cross products of edges.
pub(crate) fn apart(a: &Triangle, b: &Triangle) -> bool {
    let edges = |t: &Triangle| [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let (ea, eb) = (edges(a), edges(b));
    let (na, nb) = (ea[0].cross(&ea[1]), eb[0].cross(&eb[1]));
    [na, nb].iter().any(|axis| separates(axis, a, b))
        || ea.iter().any(|u| eb.iter().any(|v| separates(&u.cross(v), a, b)))
        || ea.iter().any(|u| separates(&na.cross(u), a, b))
        || eb.iter().any(|v| separates(&nb.cross(v), a, b))
}

/// Whether the intervals of `a` and `b` along `axis` are certainly disjoint; this is valid for any axis,
/// rounded or not.
fn separates(axis: &Vector3<f64>, a: &Triangle, b: &Triangle) -> bool {
    let slab = |t: &Triangle| {
        t.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
            let terms = axis.component_mul(&p.coords);
            let (sum, wrong) = (terms.x + terms.y + terms.z, DOT * terms.lp_norm(1) + UNDERFLOW);
            (low.min(sum - wrong), high.max(sum + wrong))
        })
    };
    let ((low_a, high_a), (low_b, high_b)) = (slab(a), slab(b));
    low_a > high_b || low_b > high_a
}

/// The certain signs of the volumes of three differences of corners; `None` where `f64` is not certain.
#[derive(Clone, Debug)]
pub(crate) struct Sides([[[Option<Ordering>; 9]; 9]; 9]);

impl Sides {
    pub(crate) fn of(a: &Triangle, b: &Triangle) -> Self {
        let d: [Vector3<f64>; 9] = std::array::from_fn(|i| a[i / 3] - b[i % 3]);
        let mut sides = [[[None; 9]; 9]; 9];
        for i in 0..9 {
            for j in i + 1..9 {
                for k in j + 1..9 {
                    sides[i][j][k] = side(&d[i], &d[j], &d[k]);
                }
            }
        }
        Self(sides)
    }

    /// Whether the origin is certainly in a tetrahedron of the differences, so that the triangles meet.
    pub(crate) fn meet(&self) -> bool {
        let s = &self.0;
        (0..9).any(|i| {
            (i + 1..9).any(|j| {
                (j + 1..9).any(|k| {
                    let Some(last) = s[i][j][k].map(Ordering::reverse) else { return false };
                    (k + 1..9).any(|l| {
                        s[j][k][l] == Some(last)
                            && s[i][k][l].map(Ordering::reverse) == Some(last)
                            && s[i][j][l] == Some(last)
                    })
                })
            })
        })
    }
}

/// The sign of the volume of three rounded differences; `None` when it is too close to zero.
fn side(p: &Vector3<f64>, q: &Vector3<f64>, r: &Vector3<f64>) -> Option<Ordering> {
    let (x1, x2) = (q.y * r.z, q.z * r.y);
    let (y1, y2) = (q.z * r.x, q.x * r.z);
    let (z1, z2) = (q.x * r.y, q.y * r.x);
    let volume = p.x * (x1 - x2) + p.y * (y1 - y2) + p.z * (z1 - z2);
    let size = p.x.abs() * (x1.abs() + x2.abs())
        + p.y.abs() * (y1.abs() + y2.abs())
        + p.z.abs() * (z1.abs() + z2.abs());
    (volume.abs() > VOLUME * size + UNDERFLOW).then(|| volume.total_cmp(&0.0))
}

pub(crate) fn meet_exactly(a: &Triangle, b: &Triangle, sides: &Sides) -> bool {
    let [a, b] = integers(a, b);
    triangles_meet(&a, &b, |i, j, k| sides.0[i][j][k])
}

/// The corners as integers: all multiplied by the same power of two.
fn integers(a: &Triangle, b: &Triangle) -> [[[BigInt; 3]; 3]; 2] {
    let all = a.iter().chain(b).flat_map(|p| p.iter());
    let least = all.filter(|&&v| v != 0.0).map(|&v| parts(v).1).min().unwrap_or(0);
    let integer = |v: f64| match parts(v) {
        (0, _) => BigInt::default(),
        (mantissa, exponent) => BigInt::from(mantissa) << (exponent - least),
    };
    [a, b].map(|t| t.map(|p| [integer(p.x), integer(p.y), integer(p.z)]))
}

/// `v` as m·2ᵉ with m odd or zero.
fn parts(v: f64) -> (i64, i32) {
    let bits = v.to_bits();
    let (raw, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (mantissa, exponent) = if raw == 0 { (fraction, -1074) } else { (fraction | 1 << 52, raw - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    ((mantissa >> zeros) * if v < 0.0 { -1 } else { 1 }, exponent + zeros as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_cspace::Rng;
    use rand::RngExt;

    #[test]
    fn numbers_come_apart_and_together() {
        for v in [0.0, 1.0, -3.0, 0.1, 1e-310, -1e300, 5e-324] {
            let (m, e) = parts(v);
            let half = e / 2;
            assert_eq!(m as f64 * mp_math::powi(2.0, half) * mp_math::powi(2.0, e - half), v);
        }
        assert_eq!(parts(-12.0), (-3, 2));
    }

    #[test]
    fn what_is_certain_is_so() {
        let mut rng = Rng::seed(4);
        let (mut apart_count, mut meet_count, mut close) = (0, 0, 0);
        for round in 0..20_000 {
            // Small integers touch often; random numbers nearly never.
            let mut point = || {
                Point3::from([0; 3].map(|_| match round % 2 {
                    0 => f64::from(rng.random_range(-2..=2)),
                    _ => rng.random_range(-2.0..2.0),
                }))
            };
            let (a, b): (Triangle, Triangle) = ([point(), point(), point()], [point(), point(), point()]);
            let sides = Sides::of(&a, &b);
            let [whole_a, whole_b] = integers(&a, &b);
            let exact = triangles_meet(&whole_a, &whole_b, |_, _, _| None);
            assert_eq!(meet_exactly(&a, &b, &sides), exact, "{a:?} {b:?}");
            assert_eq!(mp_collide::triangle::intersect(&a, &b), exact, "{a:?} {b:?}");
            let (no, yes) = (apart(&a, &b), sides.meet());
            assert!(if exact { !no } else { !yes }, "{a:?} {b:?}");
            (apart_count, meet_count) = (apart_count + usize::from(no), meet_count + usize::from(yes));
            close += usize::from(round % 2 == 1 && !no && !yes);
        }
        assert!(
            apart_count > 5_000 && meet_count > 2_000 && close < 20,
            "{apart_count} {meet_count} {close}"
        );
    }
}
