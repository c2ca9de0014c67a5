//! An interval of a motion: how two trees lie in its middle, and how far the points of the first move from there.

use nalgebra::Vector3;

use crate::bvh::frames::Frames;
use crate::bvh::{NodeBox, Tree};
use crate::pose::Relative;
use mp_simd::Lanes;

/// The displacement (m) of points of `a` from the middle of an interval to one of its ends, to first order:
/// `shift + turn × p`, in the centred frame of a tree. To the other end it is the opposite.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drift {
    shift: [f32; 3],
    turn: [f32; 3],
}

impl Drift {
    /// The drift that moves the point `origin` by `shift`.
    pub(crate) fn new(turn: &Vector3<f64>, shift: &Vector3<f64>, origin: &Vector3<f64>) -> Self {
        let shift = shift - turn.cross(origin);
        Self { shift: shift.map(|x| x as f32).into(), turn: turn.map(|x| x as f32).into() }
    }

    #[inline(always)]
    pub(crate) fn at_point(&self, p: &Vector3<f64>) -> Vector3<f64> {
        let wide = |v: [f32; 3]| Vector3::from(v.map(f64::from));
        wide(self.shift) + wide(self.turn).cross(p)
    }

    /// The drift of a point in each lane.
    #[inline(always)]
    pub(crate) fn at<L: Lanes>(&self, p: &[L; 3]) -> [L; 3] {
        let w = [L::splat(self.turn[0]), L::splat(self.turn[1]), L::splat(self.turn[2])];
        let s = [L::splat(self.shift[0]), L::splat(self.shift[1]), L::splat(self.shift[2])];
        [
            w[1].mul_add(p[2], s[0]).sub(w[2].mul(p[1])),
            w[2].mul_add(p[0], s[1]).sub(w[0].mul(p[2])),
            w[0].mul_add(p[1], s[2]).sub(w[1].mul(p[0])),
        ]
    }
}

/// A bound on the motion of `a` over half an interval, in `f64` and in the frame of `b`: the origin of `a` moves by
/// `shift`, a point at `p` from it by `shift + turn × p`, and by up to `rest` more in any direction; by `most`
/// in all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Travel {
    pub(crate) shift: Vector3<f64>,
    pub(crate) turn: Vector3<f64>,
    /// Metres.
    pub(crate) rest: f64,
    /// Metres.
    pub(crate) most: f64,
}

impl Travel {
    /// No motion.
    pub(crate) fn none() -> Self {
        Self { shift: Vector3::zeros(), turn: Vector3::zeros(), rest: 0.0, most: 0.0 }
    }
}

/// How `a` lies to `b` in the middle of an interval of its motion, and how it moves from there.
#[derive(Clone, Debug)]
pub(crate) struct SweptInterval {
    pub(crate) frames: Frames,
    /// The drift in the frame of `a` as it is in the middle, and in the frame of `b`.
    pub(crate) in_a: Drift,
    pub(crate) in_b: Drift,
    /// How much the drift differs between points of `a`, per metre between them.
    pub(crate) rate: f32,
    /// How much farther than its drift a point may move (m), in any direction.
    pub(crate) rest: f32,
    /// Boxes and triangles are apart when their gap exceeds this (m) and their motion: rounding, and
    /// the clearance to keep.
    pub(crate) margin: f32,
}

/// A factor that outweighs rounding to `f32`.
pub(crate) const UP: f64 = 1.0 + 1e-6;

impl SweptInterval {
    /// `None` when `a` stays farther than `clearance` from `b` by the balls around them.
    #[inline(always)]
    pub(crate) fn new(
        (a, b): (&Tree, &Tree),
        relative: &Relative,
        travel: &Travel,
        clearance: f64,
    ) -> Option<Self> {
        let frames = Frames::new(a, b, relative);
        let reach = a.radius_center + b.radius_center + travel.most + clearance;
        if frames.apart > reach * (1.0 + 1e-12) + relative.slack {
            return None;
        }
        let rate = travel.turn.norm();
        // Drifts are sums of three products in `f32`, and their projections of three; quaternions may be 1e-6
        // off unit length.
        let rounding = 1e-5 * (travel.shift.norm() + rate * (a.radius + b.radius_center)) + relative.slack;
        let into_a = &relative.rotation;
        let origin = -into_a.tr_mul(&relative.translation) - b.center.coords;
        Some(Self {
            in_a: Drift::new(&(into_a * travel.turn), &(into_a * travel.shift), &-a.center.coords),
            in_b: Drift::new(&travel.turn, &travel.shift, &origin),
            rate: (rate * UP) as f32,
            rest: ((travel.rest + rounding) * UP) as f32,
            margin: ((clearance + f64::from(frames.pad)) * UP) as f32,
            frames,
        })
    }

    /// How much farther than the drift of its centre a point of a box of `a` may move.
    #[inline(always)]
    pub(crate) fn slop(&self, obb: &NodeBox) -> f32 {
        self.rate * (obb.size.sqrt() * 1.000_001) + self.rest
    }
}
