//! A baby grand piano, the origin in the middle of its case.

use super::shape::{block, cushion, lathe, shifted, tube, union};
use mp_geom::{TriMesh, primitives::prism};
use nalgebra::{Point2, Point3, Vector3};
use std::f64::consts::FRAC_PI_2;

/// The height of the origin above the floor when the piano stands.
pub(super) const RAISE: f64 = 0.75;

/// The piano: about 1.4 wide, 1.5 long, 1 high.
pub(super) fn piano() -> TriMesh {
    let solid = |outline: &[Point2<f64>], low: f64, high: f64| {
        prism(outline, low, high).expect("a simple outline of constants")
    };
    let mut parts = vec![
        solid(&outline(0.0), 0.62, 0.9),
        solid(&outline(0.015), 0.905, 0.93),
        // Key bed, cheeks and the fall behind the keys.
        block([-0.69, -0.74, 0.625], [0.69, -0.43, 0.7]),
        shifted(&cushion([0.03, 0.14, 0.07], 0.025, 4), [-0.685, -0.59, 0.72]),
        shifted(&cushion([0.03, 0.14, 0.07], 0.025, 4), [0.685, -0.59, 0.72]),
        // Music stand.
        block([-0.32, -0.22, 0.925], [0.32, -0.2, 1.02]),
    ];
    let width = 1.3 / 52.0;
    for i in 0..52u32 {
        let x = -0.65 + width * f64::from(i);
        parts.push(block([x + 0.001, -0.72, 0.695], [x + width - 0.001, -0.44, 0.722]));
        // Black keys follow the first, third, fourth, sixth and seventh white key from A.
        if matches!(i % 7, 0 | 2 | 3 | 5 | 6) && i < 51 {
            parts.push(block([x + width - 0.007, -0.64, 0.715], [x + width + 0.007, -0.43, 0.734]));
        }
    }
    let leg = lathe(
        &[
            [0.0, 0.0],
            [0.03, 0.0],
            [0.04, 0.03],
            [0.03, 0.06],
            [0.035, 0.1],
            [0.045, 0.3],
            [0.06, 0.42],
            [0.04, 0.45],
            [0.065, 0.49],
            [0.04, 0.53],
            [0.07, 0.57],
            [0.07, 0.64],
            [0.0, 0.64],
        ],
        20,
    );
    for [x, y] in [[-0.6, -0.4], [0.6, -0.4], [-0.3, 0.5]] {
        parts.push(shifted(&leg, [x, y, 0.0]));
    }
    // The lyre: two rods, a box and three pedals.
    for x in [-0.06, 0.06] {
        let rod = [Point3::new(x, -0.3, 0.12), Point3::new(x, -0.3, 0.64)];
        parts.push(tube(&rod, |_| 0.012, 12, Vector3::x()));
    }
    parts.push(shifted(&cushion([0.12, 0.06, 0.03], 0.02, 3), [0.0, -0.3, 0.12]));
    for x in [-0.07, 0.0, 0.07] {
        let pedal = [Point3::new(x, -0.3, 0.1), Point3::new(x, -0.42, 0.09), Point3::new(x, -0.46, 0.07)];
        parts.push(tube(&pedal, |_| 0.012, 10, Vector3::x()));
    }
    shifted(&union(parts), [0.0, 0.0, -RAISE])
}

/// The outline of the case seen from above, counter-clockwise, grown by `edge`: straight bass side on the
/// left, a bent treble side on the right, a round tail.
fn outline(edge: f64) -> Vec<Point2<f64>> {
    let mut line = vec![Point2::new(-0.7 - edge, -0.45), Point2::new(0.7 + edge, -0.45)];
    let bend = 20;
    line.extend((0..=bend).map(|i| {
        let t = f64::from(i) / f64::from(bend);
        let ease = t * t * (3.0 - 2.0 * t);
        Point2::new(0.7 - 0.68 * ease + edge, -0.1 + 0.6 * t + 0.3 * edge)
    }));
    let tail = 16;
    line.extend((1..tail).map(|i| {
        let (s, c) = mp_math::sin_cos(FRAC_PI_2 * 2.0 * f64::from(i) / f64::from(tail));
        Point2::new(-0.34 + (0.36 + edge) * c, 0.5 + (0.26 + edge) * s)
    }));
    line.push(Point2::new(-0.7 - edge, 0.5));
    line
}
