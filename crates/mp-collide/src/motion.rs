//! Whole motions, proved clear.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::mesh::CollisionMesh;
use crate::pose::{LIMIT, Relative};
use crate::query::Query;
use crate::wide::Tree;
use crate::wide::frames::Frames;
use crate::wide::span::{Parts, Span, Travel};
use crate::wide::sweep::Course;

/// A stretch of a rigid motion about a pose in its middle: from there the body moves on at constant speed to
/// one end of the stretch, and back likewise to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sway {
    /// How far the origin of the body moves from the middle to the end, in the world (metres).
    pub shift: Vector3<f64>,
    /// The axis through the origin about which the body turns meanwhile, in the world, times the angle
    /// (radians).
    pub turn: Vector3<f64>,
    /// A bound on how far any point of the body moves from the middle to either end (metres).
    pub most: f64,
}

impl Sway {
    /// The sway of a body with no point farther than `radius` from its origin.
    #[must_use]
    pub fn new(shift: Vector3<f64>, turn: Vector3<f64>, radius: f64) -> Self {
        Self { shift, turn, most: (shift.norm() + turn.norm() * radius) * (1.0 + 1e-12) }
    }

    /// The part `share` of the motion from `from` to `to` as spaces interpolate it: the origin on a straight
    /// line, the turn about a fixed axis by the shorter way, both at constant speed; `None` when the turn is
    /// so near to half a turn that either way may be the shorter.
    #[must_use]
    pub fn of_motion(from: &Isometry3<f64>, to: &Isometry3<f64>, share: f64, most: f64) -> Option<Self> {
        let shift = (to.translation.vector - from.translation.vector) * share;
        let by = to.rotation.quaternion() * from.rotation.quaternion().conjugate();
        let (sine, cosine) = (by.imag().norm(), by.w);
        if cosine.abs() < 1e-6 {
            return None;
        }
        let scale = if sine > 0.0 { 2.0 * sine.atan2(cosine.abs()) / sine * cosine.signum() } else { 2.0 };
        Some(Self { shift, turn: by.imag() * (scale * share), most })
    }

    fn is_usable(&self) -> bool {
        let usable = |x: f64| x.abs() <= LIMIT;
        self.shift.iter().all(|x| usable(*x))
            && self.turn.norm() <= 4.0
            && self.most >= 0.0
            && usable(self.most)
    }
}

impl Query {
    /// Whether `a` surely stays at least `margin` (metres) from `b` all along a stretch about `middle_wa`.
    ///
    /// `false` says that it may not: a shorter stretch may be found clear. Whenever the clearance in the
    /// middle is at least `sway.most + margin`, up to rounding, the answer is `true`; but far longer stretches
    /// are found clear too, as the bound of each part of `a` is its own, and counts toward `b` only. One
    /// traversal, in which the stretch is divided where the bodies are near each other.
    ///
    /// What counts as in collision with everything (see the crate docs), a sway or a margin that is not
    /// finite, and a turn of more than 4 radians are never found clear; a negative margin counts as 0.
    pub fn keeps_clear(
        &mut self,
        a: &CollisionMesh,
        middle_wa: &Isometry3<f64>,
        sway: &Sway,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
        margin: f64,
    ) -> bool {
        self.counters.queries += 1;
        let relative = Relative::between(middle_wa, a.radius(), pose_wb, b.radius());
        let Some(relative) = relative.filter(|_| sway.is_usable() && margin.abs() <= LIMIT) else {
            return false;
        };
        let margin = margin.max(0.0);
        let (a, b) = (a.tree(), b.tree());
        let frames = Frames::new(a, b, &relative);
        if !frames.fits_f32(a, b) || frames.apart + sway.most + margin > 1e8 {
            let enough = sway.most + margin;
            return self.clearance_with(a, b, &relative, enough).0 >= enough;
        }
        let (back, parts) = (pose_wb.rotation.inverse(), std::mem::take(&mut self.parts));
        let mut course = Smooth { a, b, middle_wa, sway, pose_wb, back, margin, parts };
        let clear = self.sweep(a, b, &mut course, [0, PIECES]).is_none();
        self.parts = course.parts;
        clear
    }
}

/// A stretch is divided into no more pieces than this.
const PIECES: u32 = 8;

/// A stretch of a motion; parts are ranges of its pieces.
struct Smooth<'q> {
    a: &'q Tree,
    b: &'q Tree,
    middle_wa: &'q Isometry3<f64>,
    sway: &'q Sway,
    pose_wb: &'q Isometry3<f64>,
    /// From the world into the frame of `b`.
    back: UnitQuaternion<f64>,
    margin: f64,
    parts: Parts,
}

/// Half of a part, as a share of half the stretch.
fn share([lo, hi]: [u32; 2]) -> f64 {
    f64::from(hi - lo) / f64::from(PIECES)
}

impl Course for Smooth<'_> {
    const ORDERED: bool = false;

    #[inline]
    fn parts(&self) -> &Parts {
        &self.parts
    }

    #[inline]
    fn parts_mut(&mut self) -> &mut Parts {
        &mut self.parts
    }

    fn most(&self, range: [u32; 2]) -> f64 {
        (self.sway.most * share(range)).max(1e-30)
    }

    fn make(&self, range: [u32; 2]) -> Option<Span> {
        let at = f64::from(range[0] + range[1]) / f64::from(PIECES) - 1.0;
        let half = share(range);
        let sway = self.sway;
        let pose = if at == 0.0 {
            *self.middle_wa
        } else {
            let turned = UnitQuaternion::from_scaled_axis(sway.turn * at) * self.middle_wa.rotation;
            let place = self.middle_wa.translation.vector + sway.shift * at;
            Isometry3::from_parts(Translation3::from(place), turned)
        };
        let turn = sway.turn * half;
        // A point at most `radius` from the axis moves on a circle: this far from its tangent.
        let rest = 0.5 * turn.norm_squared() * self.a.radius;
        let travel = Travel {
            shift: self.back * (sway.shift * half),
            turn: self.back * turn,
            rest,
            most: sway.most * half,
        };
        let relative = Relative::between(&pose, self.a.radius, self.pose_wb, self.b.radius)?;
        Span::new((self.a, self.b), &relative, &travel, self.margin)
    }

    fn keep(&self, range: [u32; 2]) -> f64 {
        self.sway.most * share(range) + self.margin
    }
}
