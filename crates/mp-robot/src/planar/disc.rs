//! A disc among polygons.

use crate::CheckCounters;
use mp_cspace::{
    Clearance, IntervalClearance, KnownFree, MotionCheck, MotionClearance, MotionInterval, MotionValidity,
    ParameterError, Validity, obstacles::ClearanceGradient,
};
use mp_geom::planar::PlanarWorld;
use nalgebra::{Point2, Vector2};
use std::sync::Arc;

/// A disc that moves in the plane. A configuration is its centre, in `Rn<2>`. A disc of radius zero is a point.
///
/// Touching is collision, and so is a disc within an obstacle. The disc is its own motion check, exact and fast: a
/// straight motion is free when the segment of the centre is farther from every boundary than the radius plus the
/// [tolerance](DiscRobot::tolerance). One query of the world answers this. Clones share the world; each has its own
/// counters.
///
/// ```
/// use mp_cspace::{MotionValidity, Validity};
/// use mp_geom::planar::{PlanarWorld, Polygon};
/// use mp_robot::{DiscRobot, DiscVerifier};
/// use nalgebra::Vector2;
///
/// let wall = Polygon::rectangle([1.0, 0.0], [1.1, 2.0])?;
/// let world = PlanarWorld::new(vec![wall], Some([[0.0, 0.0], [3.0, 3.0]]))?;
/// let mut robot = DiscRobot::new(world, 0.07)?;
/// let (left, right) = (Vector2::new(0.5, 1.0), Vector2::new(1.5, 1.0));
/// assert!(robot.is_valid(&left) && robot.is_valid(&right));
/// assert!(!robot.check_motion(&left, &right).is_free());
/// let mut verifier = DiscVerifier::new(&robot);
/// assert!(!verifier.check_motion(&left, &right).is_free());
/// let above = Vector2::new(1.0, 2.5);
/// assert!(robot.check_motion(&left, &above).is_free() && verifier.check_motion(&left, &above).is_free());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct DiscRobot {
    world: Arc<PlanarWorld>,
    radius: f64,
    tolerance: f64,
    /// The clearance (m) to keep.
    kept: f64,
    counters: CheckCounters,
}

impl DiscRobot {
    /// A disc of `radius` metres in `world`.
    ///
    /// # Errors
    /// When the radius is negative or not finite.
    pub fn new(world: impl Into<Arc<PlanarWorld>>, radius: f64) -> Result<Self, ParameterError> {
        if !(0.0..1e60).contains(&radius) {
            let (name, expected) = ("the radius", "zero or more and finite");
            return Err(ParameterError { name, expected, value: radius });
        }
        let world = world.into();
        let tolerance = super::tolerance(&world, radius, radius);
        Ok(Self { world, radius, tolerance, kept: 0.0, counters: CheckCounters::default() })
    }

    /// The same disc, which keeps the clearance `kept` (m) from obstacles: what is nearer counts as in contact, and clearances are less by
    /// this much, as if it were so much larger.
    #[must_use]
    pub fn keeping(self, kept: f64) -> Self {
        Self { kept: crate::kept::asked(kept), ..self }
    }

    /// The clearance (m) that it [keeps](Self::keeping): zero, unless asked for.
    #[must_use]
    pub fn kept(&self) -> f64 {
        self.kept
    }

    /// Its radius and what it keeps.
    fn reach(&self) -> f64 {
        self.radius + self.kept
    }

    /// The world in which it moves.
    #[must_use]
    pub fn world(&self) -> &Arc<PlanarWorld> {
        &self.world
    }

    /// Its radius, metres.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The clearance (m) that motions found free keep from every obstacle. The verifier uses a tenth of it.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The checks made by this clone so far.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        self.counters
    }

    /// The distance (m) between the disc and the nearest obstacle. If its centre is in an obstacle: minus the sum of the
    /// radius and the distance of the centre from the boundary. Infinite if there are no obstacles. Less by what it [keeps](Self::keeping).
    #[must_use]
    pub fn signed_clearance(&self, q: &Vector2<f64>) -> f64 {
        self.world.signed_distance(&Point2::from(*q)) - self.reach()
    }

    /// The [`signed_clearance`](DiscRobot::signed_clearance), and the direction in which it grows fastest: a unit
    /// vector, or zero on a boundary and if there are no obstacles.
    #[must_use]
    pub fn clearance_and_gradient(&self, q: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let p = Point2::from(*q);
        let Some(near) = self.world.nearest(&p) else { return (f64::INFINITY, Vector2::zeros()) };
        let away = (p - near.point).try_normalize(0.0).unwrap_or_default();
        match self.world.contains(&p) {
            true => (-near.distance - self.reach(), -away),
            false => (near.distance - self.reach(), away),
        }
    }

    /// The obstacle that the disc at `q` touches: its index, or `Some(None)` for the walls. `None` if it touches nothing.
    #[must_use]
    pub fn touching(&self, q: &Vector2<f64>) -> Option<Option<usize>> {
        let p = Point2::from(*q);
        let around = self.world.polygons().iter().position(|polygon| polygon.contains(&p));
        let near = self.world.nearest(&p)?;
        match around {
            Some(obstacle) => Some(Some(obstacle)),
            None => (near.distance <= self.reach() || self.world.contains(&p)).then_some(near.obstacle),
        }
    }
}

fn finite(q: &Vector2<f64>) -> bool {
    q.x.is_finite() && q.y.is_finite()
}

impl Validity<Vector2<f64>> for DiscRobot {
    fn is_valid(&mut self, q: &Vector2<f64>) -> bool {
        self.counters.collision_checks += 1;
        finite(q) && self.signed_clearance(q) > 0.0
    }
}

impl Clearance<Vector2<f64>> for DiscRobot {
    fn clearance(&mut self, q: &Vector2<f64>, _enough: f64) -> f64 {
        self.counters.clearance_checks += 1;
        if finite(q) { self.signed_clearance(q).max(0.0) } else { 0.0 }
    }
}

impl ClearanceGradient<Vector2<f64>> for DiscRobot {
    fn clearance_gradient(&mut self, q: &Vector2<f64>, _reach: f64, gradient: &mut [f64]) -> f64 {
        self.counters.clearance_checks += 1;
        let (clearance, away) = if finite(q) { self.clearance_and_gradient(q) } else { Default::default() };
        gradient.copy_from_slice(away.as_slice());
        clearance
    }
}

impl MotionClearance<Vector2<f64>> for DiscRobot {
    fn motion_bound(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> f64 {
        (to - from).norm()
    }
    /// By one query for the whole interval.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, Vector2<f64>>) -> IntervalClearance {
        let half = (interval.to - interval.from) * interval.half;
        let [a, b] = [interval.middle - half, interval.middle + half].map(Point2::from);
        let margin = interval.margin;
        let clearance = self.clearance(interval.middle, f64::INFINITY);
        if clearance >= 2.0 * margin && self.world.nearest_to_segment(&a, &b, self.reach() + margin).is_none()
        {
            let travel = (interval.to - interval.from).norm();
            return IntervalClearance::FreeOver { part: interval.half.max((clearance - margin) / travel) };
        }
        IntervalClearance::of(clearance, margin)
    }
}

impl MotionValidity<Vector2<f64>> for DiscRobot {
    fn check_motion(&mut self, from: &Vector2<f64>, to: &Vector2<f64>) -> MotionCheck {
        self.check_extension(from, to, KnownFree::Neither)
    }

    fn check_extension(&mut self, from: &Vector2<f64>, to: &Vector2<f64>, known: KnownFree) -> MotionCheck {
        self.counters.collision_checks += 1;
        if !(finite(from) && finite(to)) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let [a, b] = [from, to].map(|q| Point2::from(*q));
        if a == b {
            return match self.world.is_clear(&a, self.reach() + self.tolerance) {
                true => MotionCheck::Free { clearance: self.tolerance },
                false if self.world.is_clear(&a, self.reach()) => MotionCheck::Unproven { at: 0.0 },
                false => MotionCheck::Collision { at: 0.0 },
            };
        }
        // A segment that crosses no boundary is inside an obstacle if one of its ends is.
        if known == KnownFree::Neither && self.world.contains(&a) {
            return MotionCheck::Collision { at: 0.0 };
        }
        match self.world.nearest_to_segment(&a, &b, self.reach() + self.tolerance) {
            None => MotionCheck::Free { clearance: self.tolerance },
            Some(near) => {
                let length = (b - a).norm();
                let at = if length > 0.0 { ((near.on_segment - a).norm() / length).min(1.0) } else { 0.0 };
                match near.distance <= self.reach() {
                    true => MotionCheck::Collision { at },
                    false => MotionCheck::Unproven { at },
                }
            }
        }
    }
}
