//! Rotating calipers (G. Toussaint, 1983): the minimal rectangle around points in a plane.

use super::points::{FEW, LANES, Points, extremes};
use nalgebra::{Matrix3, Vector2};

/// The frame turned about its axis `axis` so that the rectangle around the points projected along that axis
/// is minimal.
pub(super) fn calipers(points: &Points, frame: &Matrix3<f64>, axis: usize) -> Matrix3<f64> {
    let (u, v) = (frame.column((axis + 1) % 3).into_owned(), frame.column((axis + 2) % 3).into_owned());
    let hull = hull_2d(match points.len() < FEW {
        true => points.along(u).zip(points.along(v)).map(|(x, y)| Vector2::new(x, y)).collect(),
        false => outer(&points.along(u).collect::<Vec<_>>(), &points.along(v).collect::<Vec<_>>()),
    });
    let Some(direction) = minimal_rectangle(&hull) else { return *frame };
    let x = (u * direction.x + v * direction.y).normalize();
    let w = frame.column(axis).into_owned();
    let mut turned = *frame;
    turned.set_column((axis + 1) % 3, &x);
    turned.set_column((axis + 2) % 3, &w.cross(&x));
    turned
}

/// The points that may be corners of the hull: those not clearly inside of the octagon of the extreme ones in eight directions
/// (S. Akl and G. Toussaint, "A fast convex hull algorithm", 1978).
fn outer(x: &[f64], y: &[f64]) -> Vec<Vector2<f64>> {
    let point = |i: usize| Vector2::new(x[i], y[i]);
    let mut along = Vec::with_capacity(x.len());
    let mut of = |f: fn((&f64, &f64)) -> f64| {
        along.clear();
        along.extend(x.iter().zip(y).map(f));
        extremes(&along)
    };
    let [[left, right], [bottom, top]] = [extremes(x), extremes(y)];
    let [[left_bottom, right_top], [left_top, right_bottom]] = [of(|(x, y)| x + y), of(|(x, y)| x - y)];
    let corners = [right, right_top, top, left_top, left, left_bottom, bottom, right_bottom].map(point);
    let size = (x[right] - x[left]) + (y[top] - y[bottom]);
    // Sides without a length leave all points as far inside as can be; where all points are one, no side is left.
    let sides: [_; 8] = std::array::from_fn(|k| {
        let (a, side) = (corners[k], corners[(k + 1) % 8] - corners[k]);
        (side, if side == Vector2::zeros() { f64::NEG_INFINITY } else { side.perp(&a) })
    });
    let [(whole_x, rest_x), (whole_y, rest_y)] = [x.as_chunks::<LANES>(), y.as_chunks::<LANES>()];
    let mut kept = Vec::with_capacity(x.len() / 2);
    for (x, y) in whole_x.iter().zip(whole_y) {
        // How far inside of each side, times its length.
        let mut inside = [f64::INFINITY; LANES];
        for (side, at) in &sides {
            for k in 0..LANES {
                let to = side.x * y[k] - side.y * x[k] - at;
                inside[k] = if to < inside[k] { to } else { inside[k] };
            }
        }
        // Far more than rounding.
        let clear = |least: f64| least > 1e-10 * size * size && least < f64::INFINITY;
        kept.extend((0..LANES).filter(|k| !clear(inside[*k])).map(|k| Vector2::new(x[k], y[k])));
    }
    kept.extend(rest_x.iter().zip(rest_y).map(|(x, y)| Vector2::new(*x, *y)));
    kept
}

/// Counter-clockwise convex hull without collinear points: A. M. Andrew's monotone chain, 1979.
fn hull_2d(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
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
        /// On a circle, on a grid, and anywhere.
        #[test]
        fn the_hull_is_that_of_the_outer_points(
            angles in prop::collection::vec(0.0..7.0_f64, 0..60),
            grid in prop::collection::vec(prop::array::uniform2(-3_i8..4), 0..60),
            points in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 0..60),
            [scale, to] in prop::array::uniform2(-1e3..1e3_f64),
        ) {
            let round = angles.iter().map(|a| mp_math::sin_cos(*a)).map(|(s, c)| [s, c]);
            let grid = grid.iter().map(|p| p.map(|v| f64::from(v) / 3.0));
            let all = round.chain(grid).chain(points).map(|p| p.map(|v| v * scale + to));
            let (x, y): (Vec<_>, Vec<_>) = all.map(|[x, y]| (x, y)).unzip();
            prop_assume!(!x.is_empty());
            let whole = x.iter().zip(&y).map(|(x, y)| Vector2::new(*x, *y)).collect();
            prop_assert_eq!(hull_2d(outer(&x, &y)), hull_2d(whole));
        }

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
