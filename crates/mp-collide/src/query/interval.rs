//! Continuous collision checks: intervals of motions proved free.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::bvh::Tree;
use crate::bvh::frames::Frames;
use crate::kernels::swept_interval::{SweptInterval, Travel};
use crate::kernels::swept_triangles::LeafCheck;
use crate::mesh::CollisionMesh;
use crate::pose::{LIMIT, Relative};
use crate::query::schedule::Schedule;
use crate::query::sweep::SweepEnd;
use crate::query::{Query, clouds};

/// The motion of a rigid body over an interval, relative to the pose in its middle: from there the body moves at constant
/// velocity to one end of the interval, and in the same way back to the other end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// How far the origin of the body moves from the middle to the end, in the world (metres).
    pub shift: Vector3<f64>,
    /// The axis through the origin about which the body turns from the middle to the end, in the world, times the angle
    /// (radians).
    pub turn: Vector3<f64>,
    /// A bound on how far any point of the body moves from the middle to either end (metres).
    pub most: f64,
}

impl RigidMotion {
    /// The motion of a body with no point farther than `radius` from its origin.
    #[must_use]
    pub fn new(shift: Vector3<f64>, turn: Vector3<f64>, radius: f64) -> Self {
        Self { shift, turn, most: (shift.norm() + turn.norm() * radius) * (1.0 + 1e-12) }
    }

    /// The fraction `share` of the motion from `from` to `to` as spaces interpolate it: the origin on a straight
    /// line, the turn about a fixed axis by the smaller angle, both at constant speed. `None` when the turn is
    /// so near to half a turn that either direction may be the shorter.
    #[must_use]
    pub fn of_motion(from: &Isometry3<f64>, to: &Isometry3<f64>, share: f64, most: f64) -> Option<Self> {
        let shift = (to.translation.vector - from.translation.vector) * share;
        let by = to.rotation.quaternion() * from.rotation.quaternion().conjugate();
        let (sine, cosine) = (by.imag().norm(), by.w);
        if cosine.abs() < 1e-6 {
            return None;
        }
        let scale =
            if sine > 0.0 { 2.0 * mp_math::atan2(sine, cosine.abs()) / sine * cosine.signum() } else { 2.0 };
        Some(Self { shift, turn: by.imag() * (scale * share), most })
    }

    pub(super) fn is_usable(&self) -> bool {
        let usable = |x: f64| x.abs() <= LIMIT;
        self.shift.iter().all(|x| usable(*x))
            && self.turn.norm() <= 4.0
            && self.most >= 0.0
            && usable(self.most)
    }
}

/// Whether a body keeps a margin all along an interval of a motion. In `TooClose` and `Collision`, `at` is the place as a
/// fraction of the way from the middle of the interval to its end, from −1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntervalCheck {
    /// Proved to keep the margin.
    Free,
    /// Neither proved nor refuted: a shorter interval may be found free.
    Unproven,
    /// Nearer than the margin at `at`.
    TooClose {
        /// The place.
        at: f64,
    },
    /// In collision at `at`.
    Collision {
        /// The place.
        at: f64,
    },
}

impl IntervalCheck {
    /// Whether it is proved to keep the margin.
    #[must_use]
    pub fn is_free(self) -> bool {
        self == Self::Free
    }
}

impl Query {
    /// Whether `a` stays at least `margin` (metres) from `b` all along an interval about `middle_wa`.
    ///
    /// Whenever the clearance in the middle is at least `motion.most + margin`, up to rounding, the answer is
    /// [`IntervalCheck::Free`]; but far longer intervals are found free too, as each part of `a` has its own bound on motion,
    /// and only motion toward `b` counts. One traversal, in which the interval is divided where the bodies are near each
    /// other; it ends where they are in contact or too close (at an intermediate pose, computed with rounding).
    ///
    /// Input that counts as in collision with everything (see the crate docs), a motion or margin that is not
    /// finite, and a turn of more than 4 radians give [`IntervalCheck::Unproven`]; a negative margin counts as 0.
    pub fn check_interval(
        &mut self,
        a: &CollisionMesh,
        middle_wa: &Isometry3<f64>,
        motion: &RigidMotion,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
        margin: f64,
    ) -> IntervalCheck {
        self.counters.queries += 1;
        if a.cloud.is_some() || b.cloud.is_some() {
            return clouds::check_interval(self, (a, middle_wa), motion, (b, pose_wb), margin);
        }
        let relative = Relative::of((a, middle_wa), (b, pose_wb));
        let Some(relative) = relative.filter(|_| motion.is_usable() && margin.abs() <= LIMIT) else {
            return IntervalCheck::Unproven;
        };
        let margin = margin.max(0.0);
        let (a, b) = (a.tree(), b.tree());
        let frames = Frames::new(a, b, &relative);
        if !frames.fits_f32(a, b) || frames.apart + motion.most + margin > 1e8 {
            let enough = motion.most + margin;
            let clear = self.clearance_with(a, b, &relative, enough).0 >= enough;
            return if clear { IntervalCheck::Free } else { IntervalCheck::Unproven };
        }
        let back = pose_wb.rotation.inverse();
        let schedule = IntervalSchedule { a, b, middle_wa, motion, pose_wb, back, margin };
        let end = self.sweep(a, b, &schedule, [0, SUBINTERVALS]);
        end.map_or(IntervalCheck::Free, |SweepEnd { range, check }| match check {
            LeafCheck::Collision => IntervalCheck::Collision { at: middle(range) },
            LeafCheck::TooClose => IntervalCheck::TooClose { at: middle(range) },
            LeafCheck::Free | LeafCheck::Unproven => IntervalCheck::Unproven,
        })
    }
}

/// The most subintervals into which an interval is divided.
const SUBINTERVALS: u32 = 32;

/// Triangles are compared over parts of at most this number of subintervals. Measured: half as many or twice as many are slower.
const FINE: u32 = 4;

/// An interval of a motion; parts are ranges of its subintervals.
struct IntervalSchedule<'q> {
    a: &'q Tree,
    b: &'q Tree,
    middle_wa: &'q Isometry3<f64>,
    motion: &'q RigidMotion,
    pose_wb: &'q Isometry3<f64>,
    /// From the world into the frame of `b`.
    back: UnitQuaternion<f64>,
    margin: f64,
}

/// Half of a part, as a share of half the interval.
fn share([lo, hi]: [u32; 2]) -> f64 {
    f64::from(hi - lo) / f64::from(SUBINTERVALS)
}

/// The middle of a part, as a share of half the interval.
fn middle([lo, hi]: [u32; 2]) -> f64 {
    f64::from(lo + hi) / f64::from(SUBINTERVALS) - 1.0
}

impl Schedule for IntervalSchedule<'_> {
    const ORDERED: bool = false;

    fn most(&self, range: [u32; 2]) -> f64 {
        (self.motion.most * share(range)).max(1e-30)
    }

    fn make(&self, range: [u32; 2]) -> Option<SweptInterval> {
        let at = middle(range);
        let half = share(range);
        let motion = self.motion;
        let pose = if at == 0.0 {
            *self.middle_wa
        } else {
            let turned = UnitQuaternion::from_scaled_axis(motion.turn * at) * self.middle_wa.rotation;
            let place = self.middle_wa.translation.vector + motion.shift * at;
            Isometry3::from_parts(Translation3::from(place), turned)
        };
        let turn = motion.turn * half;
        // A point at most `radius` from the axis moves on a circle, and leaves its tangent by this much.
        let rest = 0.5 * turn.norm_squared() * self.a.radius;
        let travel = Travel {
            shift: self.back * (motion.shift * half),
            turn: self.back * turn,
            rest,
            most: motion.most * half,
        };
        let relative = Relative::between(&pose, self.a.radius, self.pose_wb, self.b.radius)?;
        SweptInterval::new((self.a, self.b), &relative, &travel, self.margin)
    }

    fn keep(&self, [lo, hi]: [u32; 2]) -> Option<f64> {
        (hi - lo <= FINE).then_some(self.margin)
    }
}
