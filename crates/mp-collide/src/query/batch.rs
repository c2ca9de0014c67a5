//! Collision checks of a sequence of poses of one mesh.

use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};

use crate::bvh::Tree;
use crate::bvh::frames::Frames;
use crate::kernels::swept_interval::{SweptInterval, Travel};
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::{Relative, is_rigid};
use crate::query::schedule::Schedule;
use crate::query::{Query, clouds};

/// How many poses are checked at a time.
const CHUNK: usize = 64;

impl Query {
    /// The index of the first of `poses_wa` at which `a` collides with `b`; `None` when it never does.
    ///
    /// The answer is that of [`Query::intersects`] pose by pose. When neighbours in `poses_wa` are near each
    /// other, as along an edge of a planner, this is much faster: whole runs of poses are shown to be free
    /// at once where the bodies are far from each other.
    pub fn first_collision(
        &mut self,
        a: &CollisionMesh,
        poses_wa: &[Isometry3<f64>],
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Option<usize> {
        if a.cloud.is_some() || b.cloud.is_some() {
            return clouds::first_collision(self, a, poses_wa, (b, pose_wb));
        }
        let mut done = 0;
        for poses in poses_wa.chunks(CHUNK) {
            if let Some(i) = self.first_in_chunk(a, poses, (b, pose_wb)) {
                return Some(done + i);
            }
            done += poses.len();
        }
        None
    }

    fn first_in_chunk(
        &mut self,
        a: &CollisionMesh,
        poses: &[Isometry3<f64>],
        (b, pose_wb): PosedMesh<'_>,
    ) -> Option<usize> {
        let steps = StepBounds::of(poses);
        let step = steps.step + 2.0 * steps.turn * a.radius();
        let near = steps.rigid
            && step <= NEAR * a.tree().radius_center
            && in_lanes((a, &poses[0]), (b, pose_wb), step);
        let first = if near { 1 } else { poses.len() };
        if let Some(i) = poses[..first].iter().position(|p| self.intersects(a, p, b, pose_wb)) {
            return Some(i);
        }
        if first == poses.len() {
            return None;
        }
        let (a, b) = (a.tree(), b.tree());
        let schedule = PoseSchedule { a, b, poses, pose_wb, back: pose_wb.rotation.inverse(), steps };
        let found = self.sweep(a, b, &schedule, [first as u32, poses.len() as u32]);
        let found = found.map(|end| end.range[0] as usize);
        self.counters.queries += found.unwrap_or(poses.len() - 1) as u64;
        found
    }
}

/// Whether sizes allow lanes for a chunk of poses of `a` that starts at its pose here, each within `step` of the one before.
fn in_lanes(a: PosedMesh<'_>, b: PosedMesh<'_>, step: f64) -> bool {
    let Some(relative) = Relative::of(a, b) else { return false };
    let (a, b) = (a.0.tree(), b.0.tree());
    let frames = Frames::new(a, b, &relative);
    frames.fits_f32(a, b) && frames.apart + step * CHUNK as f64 <= 1e8
}

/// The least motion (metres) of more than one pose: only a single pose is still.
const LEAST_MOTION: f64 = 1e-30;

/// Poses are checked together when neighbours are no farther apart than this many times the body's radius.
const NEAR: f64 = 0.25;

/// Bounds on the steps between the poses of a sequence: the largest of each kind.
#[derive(Clone, Copy, Debug)]
struct StepBounds {
    /// Whether all poses are within the limits of the crate docs; if not, the rest means nothing.
    rigid: bool,
    /// How far the origin moves in a step, metres.
    step: f64,
    /// The length of the difference of the unit quaternions of a step.
    turn: f64,
    /// How much two steps in a row differ in the origin (metres), and in the quaternion.
    bend: f64,
    twist: f64,
}

impl StepBounds {
    fn of(poses: &[Isometry3<f64>]) -> Self {
        let (mut step, mut turn, mut bend, mut twist) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
        let mut before: Option<(Vector3<f64>, Quaternion<f64>)> = None;
        let mut last: (Vector3<f64>, Quaternion<f64>) = match poses.first() {
            Some(p) => (p.translation.vector, *p.rotation.quaternion()),
            None => (Vector3::zeros(), Quaternion::identity()),
        };
        let mut length = (last.1.norm_squared() - 1.0).abs();
        let mut rigid = poses.first().is_none_or(is_rigid);
        for pose in &poses[1.min(poses.len())..] {
            rigid &= is_rigid(pose);
            let p = pose.translation.vector;
            let q = *pose.rotation.quaternion();
            // A rotation has two quaternions: the nearer one.
            let q = if last.1.dot(&q) < 0.0 { -q } else { q };
            raise(&mut length, (q.norm_squared() - 1.0).abs());
            let by = (p - last.0, q - last.1);
            raise(&mut step, by.0.norm_squared());
            raise(&mut turn, by.1.norm_squared());
            if let Some(before) = before {
                raise(&mut bend, (by.0 - before.0).norm_squared());
                raise(&mut twist, (by.1 - before.1).norm_squared());
            }
            before = Some(by);
            last = (p, q);
        }
        // Quaternions whose squared length is off by `length` differ by up to this much from unit quaternions.
        let off = 2.0 * length + 1e-15;
        Self {
            rigid,
            step: step.sqrt(),
            turn: turn.sqrt() + 2.0 * off,
            bend: bend.sqrt(),
            twist: twist.sqrt() + 4.0 * off,
        }
    }
}

/// The greater, without the care for NaN that `f64::max` takes.
#[inline]
fn raise(greatest: &mut f64, x: f64) {
    if x > *greatest {
        *greatest = x;
    }
}

/// A sequence of poses; parts are ranges of them.
struct PoseSchedule<'q> {
    a: &'q Tree,
    b: &'q Tree,
    poses: &'q [Isometry3<f64>],
    pose_wb: &'q Isometry3<f64>,
    /// From the world into the frame of `b`.
    back: UnitQuaternion<f64>,
    steps: StepBounds,
}

impl PoseSchedule<'_> {
    /// A bound on how far a point moves in `n` steps.
    fn farthest(&self, n: usize) -> f64 {
        n as f64 * (self.steps.step + 2.0 * self.steps.turn * self.a.radius)
    }

    /// How far points move in `n` steps from pose `middle`; q is a point there, turned from the frame of `a`.
    ///
    /// With g half the difference of the pose after and the pose before (or, at an end, the whole difference to the one
    /// neighbour), and steps in a row that differ by at most c, the change after n steps is n·g to within c·n·(n + 1)/2,
    /// for both positions and quaternions. A quaternion r + d turns p to where r does, and by d·p·r* + r·p·d* + d·p·d*; for
    /// d = n·g and g·r* = (s, w) the first two are n·2·(s·q + w × q).
    fn travel(&self, relative: &Relative, middle: usize, n: usize) -> Travel {
        let most = self.farthest(n);
        let n = n as f64;
        let (before, after) = (middle.saturating_sub(1), (middle + 1).min(self.poses.len() - 1));
        let scale = n / (after - before) as f64;
        let (from, to) = (&self.poses[before], &self.poses[after]);
        let here = self.poses[middle].rotation.quaternion();
        // A rotation has two quaternions: the nearer one.
        let near = |pose: &Isometry3<f64>| {
            let q = *pose.rotation.quaternion();
            if q.dot(here) < 0.0 { -q } else { q }
        };
        let by = (near(to) - near(from)) * here.conjugate() * (2.0 * scale);
        let shift = (to.translation.vector - from.translation.vector) * scale;
        let StepBounds { turn, bend, twist, .. } = self.steps;
        let radius = self.a.radius;
        let curve = n * (n + 1.0) * (0.5 * bend + twist * radius) + mp_math::powi(n * turn, 2) * radius;
        let rest = curve + by.w.abs() * radius + n * relative.slack;
        if rest > 0.5 * most {
            // The poses are not smooth: points may move in any direction.
            return Travel { rest: most, most, ..Travel::none() };
        }
        let back = self.back;
        Travel { shift: back * shift, turn: back * by.imag(), rest, most }
    }
}

impl Schedule for PoseSchedule<'_> {
    const ORDERED: bool = true;

    fn most(&self, [lo, hi]: [u32; 2]) -> f64 {
        let steps = hi - 1 - u32::midpoint(lo, hi - 1);
        if hi - lo == 1 { 0.0 } else { self.farthest(steps as usize).max(LEAST_MOTION) }
    }

    fn make(&self, range: [u32; 2]) -> Option<SweptInterval> {
        let [lo, hi] = range.map(|i| i as usize);
        let middle = usize::midpoint(lo, hi - 1);
        let relative = Relative::between(&self.poses[middle], self.a.radius, self.pose_wb, self.b.radius)?;
        let travel =
            if hi - lo == 1 { Travel::none() } else { self.travel(&relative, middle, hi - 1 - middle) };
        SweptInterval::new((self.a, self.b), &relative, &travel, 0.0)
    }
}
