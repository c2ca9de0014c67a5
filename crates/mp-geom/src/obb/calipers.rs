//! Rotating calipers (G. Toussaint, 1983): the minimal rectangle around points in a plane.

use nalgebra::{Matrix3, Vector2, Vector3};

/// The frame turned about its axis `axis` so that the rectangle around the points projected along that axis
/// is minimal.
pub(super) fn calipers(points: &[Vector3<f64>], frame: &Matrix3<f64>, axis: usize) -> Matrix3<f64> {
    let (u, v) = (frame.column((axis + 1) % 3).into_owned(), frame.column((axis + 2) % 3).into_owned());
    let hull = hull_2d(points.iter().map(|p| Vector2::new(p.dot(&u), p.dot(&v))).collect());
    let Some(direction) = minimal_rectangle(&hull) else { return *frame };
    let x = (u * direction.x + v * direction.y).normalize();
    let w = frame.column(axis).into_owned();
    let mut turned = *frame;
    turned.set_column((axis + 1) % 3, &x);
    turned.set_column((axis + 2) % 3, &w.cross(&x));
    turned
}

/// Counter-clockwise convex hull without collinear points: A. M. Andrew's monotone chain, 1979.
fn hull_2d(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let mut hull: Vec<Vector2<f64>> = Vec::new();
    let chain = |hull: &mut Vec<Vector2<f64>>, p: Vector2<f64>, base: usize| {
        while hull.len() >= base + 2 {
            let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
            if (b - a).perp(&(p - b)) > 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    };
    for &p in &points {
        chain(&mut hull, p, 0);
    }
    let base = hull.len() - usize::from(!hull.is_empty());
    for &p in points.iter().rev().skip(1) {
        chain(&mut hull, p, base);
    }
    if hull.len() > 1 {
        hull.pop();
    }
    hull
}

/// Direction of a side of the rectangle of least area around a convex polygon: one of its edges.
fn minimal_rectangle(hull: &[Vector2<f64>]) -> Option<Vector2<f64>> {
    let n = hull.len();
    let mut best: Option<(f64, Vector2<f64>)> = None;
    // The extreme corners forward along, across and back along the edge; they only ever move on.
    let [mut right, mut top, mut left] = [1, 1, 1];
    for i in 0..n {
        let Some(e) = (hull[(i + 1) % n] - hull[i]).try_normalize(0.0) else { continue };
        let across = Vector2::new(-e.y, e.x);
        let advance = |from: usize, d: &Vector2<f64>| {
            let mut k = from;
            while k < from + n && hull[(k + 1) % n].dot(d) > hull[k % n].dot(d) {
                k += 1;
            }
            k
        };
        right = advance(right.max(i + 1), &e);
        top = advance(top.max(right), &across);
        left = advance(left.max(top), &-e);
        let length = (hull[right % n] - hull[left % n]).dot(&e);
        let height = (hull[top % n] - hull[i]).dot(&across);
        let area = length * height;
        if best.is_none_or(|(a, _)| area < a) {
            best = Some((area, e));
        }
    }
    best.map(|(_, e)| e)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn calipers_find_the_smallest_rectangle(points in prop::collection::vec(prop::array::uniform2(-5_i8..6), 1..20)) {
            let points: Vec<_> = points.iter().map(|p| Vector2::new(f64::from(p[0]), f64::from(p[1]))).collect();
            let hull = hull_2d(points.clone());
            let area = |e: &Vector2<f64>| {
                let spread = |d: Vector2<f64>| {
                    let s: Vec<_> = points.iter().map(|p| p.dot(&d)).collect();
                    s.iter().copied().fold(f64::MIN, f64::max) - s.iter().copied().fold(f64::MAX, f64::min)
                };
                spread(*e) * spread(Vector2::new(-e.y, e.x))
            };
            // Some side of the best rectangle joins two points.
            let mut best = f64::INFINITY;
            for p in &points {
                for e in points.iter().filter_map(|q| (q - p).try_normalize(0.0)) {
                    best = best.min(area(&e));
                }
            }
            match minimal_rectangle(&hull) {
                Some(e) => prop_assert!((area(&e) - best).abs() < 1e-9, "{} {}", area(&e), best),
                None => prop_assert!(best.is_infinite()),
            }
        }
    }
}
