//! Whether convex hulls of few points are farther apart than a distance.

use nalgebra::Vector3;

/// Directions tried for one pair. As a rule five are enough.
const MOST_DIRECTIONS: usize = 24;

/// Whether the convex hulls of `a` and `b` are more than `distance` apart, up to rounding: some direction shows it. `first` is one to begin with, from
/// `b` to `a`; Gilbert, Johnson and Keerthi (1988) say which to try next: from the origin to the nearest point of a simplex of differences of points.
pub(crate) fn are_apart(a: &[Vector3<f64>], b: &[Vector3<f64>], distance: f64, first: Vector3<f64>) -> bool {
    let mut way = first;
    let mut simplex = Simplex::default();
    for _ in 0..MOST_DIRECTIONS {
        let corner = lowest(a, &way) - lowest(b, &-way);
        let (along, square) = (way.dot(&corner), way.norm_squared());
        if along > distance * square.sqrt() * (1.0 + 1e-9) {
            return true;
        }
        // From the second direction on the hulls are no farther apart than its length, and not nearer when no corner is.
        let known = simplex.count > 0;
        if known && (square <= distance * distance || along >= square * (1.0 - 1e-12)) {
            return false;
        }
        match simplex.nearest_with(corner) {
            Some(next) if !known || next.norm_squared() < square => way = next,
            _ => return false,
        }
    }
    false
}

/// The point that is lowest along `way`.
fn lowest(points: &[Vector3<f64>], way: &Vector3<f64>) -> Vector3<f64> {
    let mut best = (f64::INFINITY, Vector3::zeros());
    for p in points {
        let along = p.dot(way);
        if along < best.0 {
            best = (along, *p);
        }
    }
    best.1
}

/// Up to four differences of points.
#[derive(Default)]
struct Simplex {
    corners: [Vector3<f64>; 4],
    count: usize,
}

impl Simplex {
    /// The point nearest to the origin of the simplex with one more corner, of which it keeps the corners of the side where that point is; `None` when
    /// the origin is inside.
    fn nearest_with(&mut self, corner: Vector3<f64>) -> Option<Vector3<f64>> {
        self.corners[self.count] = corner;
        let corners = self.corners;
        let (point, kept) = match self.count {
            0 => (corner, 0b1),
            1 => on_segment([corners[0], corner]),
            2 => on_triangle([corners[0], corners[1], corner]),
            _ => on_tetrahedron(&corners)?,
        };
        self.count = 0;
        for corner in (0..4).filter(|k| kept >> k & 1 == 1).map(|k| corners[k]) {
            self.corners[self.count] = corner;
            self.count += 1;
        }
        Some(point)
    }
}

/// The point of a tetrahedron nearest to the origin, and the corners between which it is; `None` when the origin is inside.
fn on_tetrahedron(corners: &[Vector3<f64>; 4]) -> Option<(Vector3<f64>, u8)> {
    let mut best: Option<(Vector3<f64>, u8)> = None;
    for (side, opposite) in [([0, 1, 2], 3), ([0, 1, 3], 2), ([0, 2, 3], 1), ([1, 2, 3], 0)] {
        let [p, q, r] = side.map(|k| corners[k]);
        let normal = (q - p).cross(&(r - p));
        // The origin and the other corner are on one side of it.
        if -normal.dot(&p) * normal.dot(&(corners[opposite] - p)) > 0.0 {
            continue;
        }
        let (point, kept) = on_triangle([p, q, r]);
        if best.is_none_or(|(nearest, _)| point.norm_squared() < nearest.norm_squared()) {
            let kept = (0..3).filter(|k| kept >> k & 1 == 1).fold(0, |bits, k| bits | 1 << side[k]);
            best = Some((point, kept));
        }
    }
    best
}

/// The point of a segment nearest to the origin, and the ends between which it is.
fn on_segment([p, q]: [Vector3<f64>; 2]) -> (Vector3<f64>, u8) {
    let u = q - p;
    let (along, square) = (-p.dot(&u), u.norm_squared());
    if along <= 0.0 {
        (p, 0b01)
    } else if along >= square {
        (q, 0b10)
    } else {
        (p + u * (along / square), 0b11)
    }
}

/// The point of a triangle nearest to the origin, and the corners between which it is (Ericson 2005, *Real-Time Collision Detection*, §5.1.5).
fn on_triangle([p, q, r]: [Vector3<f64>; 3]) -> (Vector3<f64>, u8) {
    let (u, v) = (q - p, r - p);
    let (pu, pv, qu, qv, ru, rv) = (-p.dot(&u), -p.dot(&v), -q.dot(&u), -q.dot(&v), -r.dot(&u), -r.dot(&v));
    if pu <= 0.0 && pv <= 0.0 {
        return (p, 0b001);
    }
    if qu >= 0.0 && qv <= qu {
        return (q, 0b010);
    }
    if rv >= 0.0 && ru <= rv {
        return (r, 0b100);
    }
    // Areas, as shares of which the corners count.
    let (at_r, at_q, at_p) = (pu * qv - qu * pv, ru * pv - pu * rv, qu * rv - ru * qv);
    if at_r <= 0.0 && pu >= 0.0 && qu <= 0.0 {
        return (p + u * (pu / (pu - qu)), 0b011);
    }
    if at_q <= 0.0 && pv >= 0.0 && rv <= 0.0 {
        return (p + v * (pv / (pv - rv)), 0b101);
    }
    if at_p <= 0.0 && qv >= qu && ru >= rv {
        return (q + (r - q) * ((qv - qu) / ((qv - qu) + (ru - rv))), 0b110);
    }
    let all = at_p + at_q + at_r;
    (p + u * (at_q / all) + v * (at_r / all), 0b111)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::triangle::closest;
    use nalgebra::Point3;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Hulls of six points and of three are apart by less than their distance and by no more: in space and in the plane, long ones and flat ones.
    #[test]
    fn hulls_are_apart_by_their_distance() {
        let mut rng = Pcg64::seed_from_u64(6);
        let mut shows = 0;
        for round in 0..4_000 {
            let height = [1.0, 0.0, 1e-9][round % 3];
            let mut any = |size: f64| {
                Vector3::from_fn(|k, _| {
                    rng.random_range(-1.0..1.0) * if k == 2 { size * height } else { size }
                })
            };
            // Every other one is sure not to be inside.
            let beside = round / 4 % 2 == 0;
            let way = any(2.0) + Vector3::x() * if beside { 6.0 } else { 0.0 };
            let drift = any([0.01, 1.0][round % 2]);
            let corners = [any(1.0), any([1.0, 1e-4][round / 2 % 2]), any(1.0)];
            let a = [corners[0], corners[1], corners[2]].map(|p| [p + way + drift, p + way - drift]);
            let a: Vec<Vector3<f64>> = a.into_iter().flatten().collect();
            let b = [any(1.0), any(1.0), any(1.0)];
            // All of a hull's surface is of triangles of its points.
            let triangle = |of: [Vector3<f64>; 3]| of.map(Point3::from);
            let mut distance = f64::INFINITY;
            for i in 0..6 {
                for j in 0..i {
                    for k in 0..j {
                        let gap = closest(&triangle([a[i], a[j], a[k]]), &triangle(b)).distance;
                        distance = distance.min(gap);
                    }
                }
            }
            for first in [way, any(1.0), Vector3::zeros()] {
                let apart = |share: f64| are_apart(&a, &b, distance * share, first);
                assert!(!apart(1.0 + 1e-6), "{round}: {distance} {a:?} {b:?}");
                let shown = apart(1.0 - 1e-6);
                assert!(shown || !beside, "{round}: {distance} {a:?} {b:?}");
                shows += usize::from(shown && !beside);
            }
        }
        assert!(shows > 2000, "{shows}");
    }
}
