//! Worlds of discs and slabs, with two implementations: one to plan by, one to judge by.

use mp_cspace::{Certified, Clearance, MotionCheck, MotionClearance, MotionValidity, Rn, Rng};
use nalgebra::Vector2;
use rand::RngExt;

pub(crate) type Point = Vector2<f64>;

pub(crate) fn square() -> Rn<2> {
    Rn::new([-1.0; 2], [1.0; 2]).unwrap()
}

/// Discs (middle, radius) and boxes along the axes (middle, half the sides).
#[derive(Clone, Debug, Default)]
pub(crate) struct World {
    pub(crate) discs: Vec<(Point, f64)>,
    pub(crate) boxes: Vec<(Point, Point)>,
}

impl World {
    pub(crate) fn random(rng: &mut Rng) -> Self {
        let mut point =
            |scale: f64| Point::new(rng.random_range(-scale..scale), rng.random_range(-scale..scale));
        let middles: Vec<Point> = (0..8).map(|_| point(1.0)).collect();
        let sizes: Vec<f64> = middles.iter().map(|_| rng.random_range(0.02..0.25)).collect();
        let kinds = rng.random_range(0..=8_usize);
        let all: Vec<(Point, f64)> = middles.into_iter().zip(sizes).collect();
        let boxes = all[kinds..].iter().map(|&(m, s)| (m, Point::new(s, 0.3 * s + 0.05))).collect();
        Self { discs: all[..kinds].to_vec(), boxes }
    }

    /// The signed distance and its gradient.
    pub(crate) fn distance(&self, q: &Point) -> (f64, Point) {
        let discs = self.discs.iter().map(|(m, r)| {
            let from = q - m;
            (from.norm() - r, from.try_normalize(0.0).unwrap_or(Point::x()))
        });
        let boxes = self.boxes.iter().map(|(m, half)| {
            let from = q - m;
            let beyond = from.abs() - half;
            let sign = from.map(|x| if x < 0.0 { -1.0 } else { 1.0 });
            let outside = beyond.map(|x| x.max(0.0));
            if outside.norm() > 0.0 {
                (outside.norm(), outside.normalize().component_mul(&sign))
            } else if beyond.x > beyond.y {
                (beyond.x, Point::new(sign.x, 0.0))
            } else {
                (beyond.y, Point::new(0.0, sign.y))
            }
        });
        discs.chain(boxes).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, Point::zeros()))
    }

    pub(crate) fn field(&self) -> impl FnMut(&Point, f64, &mut [f64]) -> f64 + use<'_> {
        |q, _, gradient| {
            let (distance, slope) = self.distance(q);
            gradient.copy_from_slice(slope.as_slice());
            distance
        }
    }

    pub(crate) fn check<'c>(&self, space: &'c Rn<2>) -> Certified<'c, Rn<2>, Self> {
        Certified::new(space, self.clone(), 1e-4).unwrap()
    }
}

impl Clearance<Point> for World {
    fn clearance(&mut self, q: &Point, _: f64) -> f64 {
        self.distance(q).0
    }
}
impl MotionClearance<Point> for World {
    fn motion_bound(&self, from: &Point, to: &Point) -> f64 {
        (to - from).norm()
    }
}

/// Judges segments by algebra, with nothing of the above: nearest point of a segment to a disc, clipping of a
/// segment by a box.
pub(crate) struct Judge<'w>(pub(crate) &'w World);

impl MotionValidity<Point> for Judge<'_> {
    fn check_motion(&mut self, from: &Point, to: &Point) -> MotionCheck {
        let along = to - from;
        let square = along.norm_squared();
        for (middle, radius) in &self.0.discs {
            let t = if square > 0.0 { ((middle - from).dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
            if (from + along * t - middle).norm_squared() <= radius * radius {
                return MotionCheck::Collision { at: t };
            }
        }
        for (middle, half) in &self.0.boxes {
            let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
            for k in 0..2 {
                let (low, high) = (middle[k] - half[k] - from[k], middle[k] + half[k] - from[k]);
                if along[k] == 0.0 {
                    if low > 0.0 || high < 0.0 {
                        leave = -1.0;
                    }
                    continue;
                }
                let (a, b) = (low / along[k], high / along[k]);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            }
            if enter <= leave {
                return MotionCheck::Collision { at: enter };
            }
        }
        MotionCheck::Free { clearance: 0.0 }
    }
}
