//! Exact answers for triangles, in any arithmetic that is exact.
//!
//! Two convex sets meet exactly when the origin is in the set of their differences, here the convex hull of
//! the nine differences of corners. By Carathéodory's theorem it is then in the hull of four or fewer of them
//! that are affinely independent. All subsets are tried: the library decides in an entirely different way.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

/// Numbers with exact sums, differences and products, such as integers of any size; their default is zero.
pub trait Exact:
    Clone + Ord + Default + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}

impl<N> Exact for N where N: Clone + Ord + Default + Add<Output = N> + Sub<Output = N> + Mul<Output = N> {}

/// Whether two closed triangles have a point in common: exactly. Touching counts; any of them may be a segment
/// or a point.
///
/// `known` may tell how the volume det(d₁, d₂, d₃) of three differences compares to zero where the caller knows
/// for certain; the difference of corner i of `a` and corner j of `b` has the number 3·i + j, and the numbers it is called
/// with ascend. All else is computed. `N` must hold determinants of differences exactly.
#[must_use]
pub fn triangles_meet<N: Exact>(
    a: &[[N; 3]; 3],
    b: &[[N; 3]; 3],
    known: impl Fn(usize, usize, usize) -> Option<Ordering>,
) -> bool {
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    let d: Vec<[N; 3]> = pairs.map(|(p, q)| minus(p, q)).collect();
    if d.iter().any(|d| is_zero(d)) {
        return true;
    }
    let n = d.len();
    let mut side = [[[Ordering::Equal; 9]; 9]; 9];
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let volume = || dot(&d[i], &cross(&d[j], &d[k])).cmp(&N::default());
                side[i][j][k] = known(i, j, k).unwrap_or_else(volume);
            }
        }
    }
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let in_tetrahedron = |l: usize| {
                    same_side([
                        side[j][k][l],
                        side[i][k][l].reverse(),
                        side[i][j][l],
                        side[i][j][k].reverse(),
                    ])
                };
                if (k + 1..n).any(in_tetrahedron) {
                    return true;
                }
                if side[i][j][k].is_eq() && in_triangle(&d[i], &d[j], &d[k]) {
                    return true;
                }
            }
            if is_zero(&cross(&d[i], &d[j])) && dot(&d[i], &d[j]) <= N::default() {
                return true;
            }
        }
    }
    false
}

/// Whether the origin is in a tetrahedron with a volume, given the four volumes it makes with its faces.
fn same_side(volumes: [Ordering; 4]) -> bool {
    let any = |of: Ordering| volumes.contains(&of);
    any(Ordering::Less) != any(Ordering::Greater)
}

/// Whether the origin, known to be in the plane of a triangle, is in the triangle. `false` without area.
fn in_triangle<N: Exact>(p: &[N; 3], q: &[N; 3], r: &[N; 3]) -> bool {
    let normal = cross(&minus(q, p), &minus(r, p));
    // The components of the normal tell orientation; one that is not zero will do.
    let Some(axis) = (0..3).find(|&k| normal[k] != N::default()) else { return false };
    let side = normal[axis].cmp(&N::default());
    [(p, q), (q, r), (r, p)].into_iter().all(|(u, v)| {
        let along = cross(u, v)[axis].cmp(&N::default());
        along.is_eq() || along == side
    })
}

fn is_zero<N: Exact>(v: &[N; 3]) -> bool {
    v.iter().all(|c| *c == N::default())
}

fn minus<N: Exact>(p: &[N; 3], q: &[N; 3]) -> [N; 3] {
    [0, 1, 2].map(|k| p[k].clone() - q[k].clone())
}

fn dot<N: Exact>(p: &[N; 3], q: &[N; 3]) -> N {
    let [x, y, z] = [0, 1, 2].map(|k| p[k].clone() * q[k].clone());
    x + y + z
}

fn cross<N: Exact>(p: &[N; 3], q: &[N; 3]) -> [N; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(k, l)| p[k].clone() * q[l].clone() - p[l].clone() * q[k].clone())
}
