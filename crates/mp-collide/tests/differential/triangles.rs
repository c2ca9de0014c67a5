//! Triangle against triangle: the engine, the reference and parry against an exact referee.

use crate::common::{Pcg64, rng};
use crate::referee::{self, Corner};
use mp_collide::{reference, triangle};
use nalgebra::Point3;
use rand::RngExt;

fn float(t: &[Corner; 3]) -> triangle::Triangle {
    t.map(|p| Point3::from(p.map(|c| c as f64)))
}

fn corner(rng: &mut Pcg64, size: i64) -> Corner {
    [0; 3].map(|_| rng.random_range(-size..=size))
}

/// Pairs that degenerate in every way: small grids, shared planes, lines, corners, edges.
fn pair(rng: &mut Pcg64, size: i64) -> ([Corner; 3], [Corner; 3]) {
    let mut a = [0; 3].map(|_| corner(rng, size));
    let mut b = [0; 3].map(|_| corner(rng, size));
    match rng.random_range(0..9) {
        0 => {
            let k = rng.random_range(0..3);
            b.iter_mut().chain(a.iter_mut()).for_each(|p| p[k] = 0);
        }
        1 => b[rng.random_range(0..3)] = a[rng.random_range(0..3)],
        2 => (b[0], b[1]) = (a[1], a[0]),
        3 => a[2] = a[0],
        4 => {
            // A segment through three corners, and a corner of b on its line.
            let step = a[1].map(|c| c / 4);
            a[1] = [0, 1, 2].map(|k| a[0][k] / 2 + step[k]);
            a[2] = [0, 1, 2].map(|k| a[0][k] / 2 + 2 * step[k]);
            b[0] = [0, 1, 2].map(|k| a[0][k] / 2 + 3 * step[k]);
        }
        5 => {
            // A corner of b in the plane of a, within or beyond it.
            let (s, t) = (rng.random_range(-1..=2), rng.random_range(-1..=2));
            let half = a.map(|p| p.map(|c| c / 8));
            a = half.map(|p| p.map(|c| 2 * c));
            b[1] = [0, 1, 2]
                .map(|k| 2 * half[0][k] + s * (half[1][k] - half[0][k]) + t * (half[2][k] - half[0][k]));
        }
        6 => {
            // A sliver.
            a[2] = [0, 1, 2].map(|k| (a[0][k] + a[1][k]) / 2 + rng.random_range(-1..=1));
        }
        7 => {
            // Both in a tilted plane.
            let part = a.map(|p| p.map(|c| c / 8));
            a = part.map(|p| p.map(|c| 2 * c));
            for p in &mut b {
                let (s, t) = (rng.random_range(-3..=3), rng.random_range(-3..=3));
                *p = [0, 1, 2]
                    .map(|k| 2 * part[0][k] + s * (part[1][k] - part[0][k]) + t * (part[2][k] - part[0][k]));
            }
        }
        _ => {}
    }
    (a, b)
}

#[test]
fn intersection_is_exact() {
    let mut rng = rng(11);
    let mut hits = 0;
    for i in 0..150_000 {
        let size = [1, 2, 4, 16, 1 << 20, referee::LIMIT][i % 6];
        let (a, b) = pair(&mut rng, size);
        let expected = referee::intersect(&a, &b);
        hits += u32::from(expected);
        assert_eq!(triangle::intersect(&float(&a), &float(&b)), expected, "{a:?} {b:?}");
        assert_eq!(triangle::intersect(&float(&b), &float(&a)), expected, "{b:?} {a:?}");
    }
    assert!((30_000..120_000).contains(&hits), "{hits} hits");
}

#[test]
fn distances_are_right() {
    let mut rng = rng(12);
    let mut apart = 0;
    for i in 0..120_000 {
        let size = [2, 4, 16, 1000, referee::DISTANCE_LIMIT][i % 5];
        let (a, b) = pair(&mut rng, size);
        let expected = referee::distance(&a, &b);
        let found = triangle::closest(&float(&a), &float(&b));
        apart += u32::from(expected > 0.0);
        assert_eq!(found.distance == 0.0, expected == 0.0, "{a:?} {b:?}");
        // Relative to the distance, and some units in the last place of the coordinates.
        let error = 1e-14 * expected + 4.0 * f64::EPSILON * size as f64;
        assert!((found.distance - expected).abs() <= error, "{} {expected} {a:?} {b:?}", found.distance);
        let join = (found.point_a - found.point_b).norm();
        assert!((join - expected).abs() <= error, "{join} {expected} {a:?} {b:?}");
        for (point, of) in [(found.point_a, &a), (found.point_b, &b)] {
            let off = triangle::closest(&[point; 3], &float(of)).distance;
            assert!(off <= 8.0 * f64::EPSILON * size as f64, "{point} is {off} off {of:?}");
        }
        let reference = reference::triangle_distance(&float(&a), &float(&b));
        assert!((reference - expected).abs() <= 1e-12 * size as f64, "{reference} {expected} {a:?} {b:?}");
    }
    assert!((20_000..100_000).contains(&apart), "{apart} apart");
}
