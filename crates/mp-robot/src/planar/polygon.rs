//! A polygon among polygons.

use crate::CheckCounters;
use mp_cspace::{
    Clearance, MotionClearance, Se2State, Validity, angle::angle_difference, obstacles::ClearanceGradient,
};
use mp_geom::planar::{PlanarWorld, Polygon};
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// A polygon that moves and turns in the plane. A configuration is the pose of its frame, in
/// [`Se2`](mp_cspace::Se2).
///
/// Touching is collision, and so is a robot in an obstacle, or around one. Motions are certified by conservative
/// advancement: [`Certified`](mp_cspace::Certified) at its [tolerance](PolygonRobot::tolerance). Clones share the world;
/// each has its own counters.
///
/// ```
/// use mp_cspace::{Certified, MotionValidity, Se2, Se2State};
/// use mp_geom::planar::{PlanarWorld, Polygon};
/// use mp_robot::{PolygonRobot, PolygonVerifier};
///
/// let gate = [[1.0, 0.0], [1.0, 1.3]].map(|[x, y]| Polygon::rectangle([x, y], [x + 0.1, y + 0.7]));
/// let world = PlanarWorld::new(gate.into_iter().collect::<Result<_, _>>()?, Some([[0.0, 0.0], [3.0, 2.0]]))?;
/// let rod = Polygon::rectangle([-0.4, -0.05], [0.4, 0.05])?;
/// let robot = PolygonRobot::new(world, rod);
/// let space = Se2::new([0.0, 0.0], [3.0, 2.0])?;
/// let mut verifier = PolygonVerifier::new(&space, &robot);
/// let tolerance = robot.tolerance();
/// let mut check = Certified::new(&space, robot, tolerance)?;
/// let ends = |angle| [0.5, 2.0].map(|x| Se2State::new(x, 1.0, angle));
/// let ([a, b], [c, d]) = (ends(0.0), ends(1.5));
/// assert!(check.check_motion(&a, &b).is_free() && verifier.check_motion(&a, &b).is_free());
/// assert!(!check.check_motion(&c, &d).is_free() && !verifier.check_motion(&c, &d).is_free());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PolygonRobot {
    world: Arc<PlanarWorld>,
    body: Arc<Polygon>,
    radius: f64,
    /// The radius, but at most the diagonal of the box around the body, which may be far from its origin.
    size: f64,
    /// The clearance (m) to keep.
    kept: f64,
    counters: CheckCounters,
}

/// The pose of the body, with the sine and cosine of its angle.
#[derive(Clone, Copy)]
struct BodyPose {
    sin: f64,
    cos: f64,
    at: Vector2<f64>,
}

impl BodyPose {
    fn of(q: &Se2State) -> Self {
        let (sin, cos) = mp_math::sin_cos(q.angle);
        Self { sin, cos, at: q.translation }
    }
    #[inline]
    fn in_world(&self, p: &Point2<f64>) -> Point2<f64> {
        Point2::new(self.cos * p.x - self.sin * p.y + self.at.x, self.sin * p.x + self.cos * p.y + self.at.y)
    }
    fn in_body(&self, p: &Point2<f64>) -> Point2<f64> {
        let v = p.coords - self.at;
        Point2::new(self.cos * v.x + self.sin * v.y, self.cos * v.y - self.sin * v.x)
    }
}

impl PolygonRobot {
    /// `body`, in its own frame, in `world`. It turns about the origin of its frame.
    #[must_use]
    pub fn new(world: impl Into<Arc<PlanarWorld>>, body: Polygon) -> Self {
        let radius = body.radius_about(&Point2::origin());
        let [low, high] = body.bounds();
        let (size, counters) = (radius.min((high - low).norm()), CheckCounters::default());
        Self { world: world.into(), body: body.into(), radius, size, kept: 0.0, counters }
    }

    /// The same robot, which keeps the clearance `kept` (m) from obstacles: what is nearer counts as in contact, and clearances are less by
    /// this much.
    #[must_use]
    pub fn keeping(self, kept: f64) -> Self {
        Self { kept: crate::kept::asked(kept), ..self }
    }

    /// The clearance (m) that it [keeps](Self::keeping): zero, unless asked for.
    #[must_use]
    pub fn kept(&self) -> f64 {
        self.kept
    }

    /// The world in which it moves.
    #[must_use]
    pub fn world(&self) -> &Arc<PlanarWorld> {
        &self.world
    }

    /// The body, in its own frame.
    #[must_use]
    pub fn body(&self) -> &Polygon {
        &self.body
    }

    /// The largest distance of a point of the body from the origin of its frame, metres.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The default tolerance (m) of certified motion checks: 1e-4 of the radius, or of the length of a body far from its
    /// origin, and at least what coordinates can resolve. The verifier uses a tenth of it.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        (1e-4 * self.size).max(super::tolerance(&self.world, self.size, self.radius))
    }

    /// The checks made by this clone so far.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        self.counters
    }

    /// The nearest points on the boundaries of body and obstacles, and their distance, if it is below `enough`. Does not
    /// test whether one is inside the other.
    fn nearest(&self, pose: &BodyPose, enough: f64) -> Option<(Point2<f64>, Point2<f64>, f64)> {
        let mut best = None;
        let mut below = enough;
        for [a, b] in self.body.edges() {
            if let Some(near) = self.world.nearest_to_segment(&pose.in_world(&a), &pose.in_world(&b), below) {
                below = near.distance;
                best = Some((near.on_segment, near.point, near.distance));
                if below <= 0.0 {
                    break;
                }
            }
        }
        best
    }

    /// Whether the robot is inside an obstacle or around one. For boundaries that do not meet.
    fn nested(&self, pose: &BodyPose) -> bool {
        let reach = Vector2::repeat(self.radius);
        let around = [pose.at - reach, pose.at + reach].map(Point2::from);
        self.body.rings().iter().any(|ring| self.world.contains(&pose.in_world(&ring[0])))
            || self.world.ring_in(around, |p| self.body.contains(&pose.in_body(p))).is_some()
    }

    /// The distance of the circle around the robot from the nearest obstacle, if it is at least `reach`.
    fn far(&self, q: &Se2State, reach: f64) -> Option<f64> {
        let around = self.world.signed_distance(&Point2::from(q.translation)) - self.radius;
        (around >= reach).then_some(around)
    }

    fn clearance_at(&self, q: &Se2State, enough: f64) -> f64 {
        if !finite(q) {
            return 0.0;
        }
        let reach = enough + self.kept;
        if let Some(around) = self.far(q, reach) {
            return (around - self.kept).max(enough);
        }
        let pose = BodyPose::of(q);
        let near = self.nearest(&pose, reach);
        if near.is_some_and(|n| n.2 <= self.kept) || self.nested(&pose) {
            return 0.0;
        }
        near.map_or(enough, |n| n.2 - self.kept)
    }

    /// The distance (m) between robot and obstacles, and how it changes with x, y and angle (m/m, m/m, m/rad).
    ///
    /// In collision: minus the depth of the robot corner that is deepest in an obstacle, and the gradient that leads it out;
    /// zeros if no corner is in an obstacle. Infinite and zeros if there are no obstacles. The distance is less by what the robot
    /// [keeps](Self::keeping).
    #[must_use]
    pub fn clearance_and_gradient(&self, q: &Se2State) -> (f64, [f64; 3]) {
        let pose = BodyPose::of(q);
        let toward = |on_body: Point2<f64>, away: Vector2<f64>| {
            let arm = on_body.coords - q.translation;
            [away.x, away.y, arm.x * away.y - arm.y * away.x]
        };
        let Some((on_body, on_obstacle, distance)) = self.nearest(&pose, f64::INFINITY) else {
            return (f64::INFINITY, [0.0; 3]);
        };
        if distance > 0.0 && !self.nested(&pose) {
            return (distance - self.kept, toward(on_body, (on_body - on_obstacle) / distance));
        }
        let mut deepest = (0.0, [0.0; 3]);
        for corner in self.body.rings().iter().flatten() {
            let p = pose.in_world(corner);
            if let Some(near) = self.world.nearest(&p).filter(|_| self.world.contains(&p))
                && -near.distance < deepest.0
            {
                deepest = (-near.distance, toward(p, (near.point - p) / near.distance));
            }
        }
        (deepest.0 - self.kept, deepest.1)
    }
}

fn finite(q: &Se2State) -> bool {
    q.translation.x.is_finite() && q.translation.y.is_finite() && q.angle.is_finite()
}

impl Validity<Se2State> for PolygonRobot {
    fn is_valid(&mut self, q: &Se2State) -> bool {
        self.counters.collision_checks += 1;
        self.clearance_at(q, f64::MIN_POSITIVE) > 0.0
    }
}

impl Clearance<Se2State> for PolygonRobot {
    fn clearance(&mut self, q: &Se2State, enough: f64) -> f64 {
        self.counters.clearance_checks += 1;
        self.clearance_at(q, enough)
    }
}

impl ClearanceGradient<Se2State> for PolygonRobot {
    fn clearance_gradient(&mut self, q: &Se2State, reach: f64, gradient: &mut [f64]) -> f64 {
        self.counters.clearance_checks += 1;
        let (clearance, along) = match (finite(q), self.far(q, reach + self.kept)) {
            (false, _) => (0.0, [0.0; 3]),
            (true, Some(far)) => (far - self.kept, [0.0; 3]),
            (true, None) => self.clearance_and_gradient(q),
        };
        gradient.copy_from_slice(&along);
        clearance
    }
}

impl MotionClearance<Se2State> for PolygonRobot {
    fn motion_bound(&self, from: &Se2State, to: &Se2State) -> f64 {
        let turn = angle_difference(from.angle, to.angle).abs();
        ((to.translation - from.translation).norm() + self.radius * turn) * (1.0 + 1e-12)
    }
}
