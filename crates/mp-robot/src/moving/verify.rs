//! The independent check of motions among moving obstacles.

use super::{AmongMoving, MovingObstacle};
use crate::{Placement, Verifier};
use mp_collide::reference::RefMesh;
use mp_cspace::{Interrupt, MotionCheck, MotionValidity, ParameterError, Space, space_time::SpaceTime};
use nalgebra::Isometry3;
use std::sync::Arc;

/// Proves motions in space and time free of collision, with other code than planners use.
///
/// A [`Verifier`] checks against the obstacles that stand still. For each moving obstacle, distances from sphere trees are
/// compared with how much nearer robot and obstacle can come, and the motion is halved until all of it is shown free. Motions that
/// begin with one inside of the other, the outer being a [solid](mp_geom::TriMesh::solids), collide.
/// Only the space and the trajectories are shared with the checker: they define what the motions are.
///
/// The answer is [`Unproven`](MotionCheck::Unproven) for motions back in time or beyond the speed limit, and for
/// motions with a tested moment of less clearance than the tolerance.
#[derive(Clone, Debug)]
pub struct MovingVerifier<'c, C, P> {
    space: &'c SpaceTime<C>,
    standing: Verifier<'c, C, P>,
    interrupt: Interrupt,
    robot: Arc<RefMesh>,
    radius: f64,
    moving: Arc<[MovingObstacle]>,
    tolerance: f64,
    /// The clearance (m) that the robot keeps, to which the tolerance is added.
    kept: f64,
}

/// Parts of a motion shorter than this are not tested. What is not shown free by then is not free.
const SHORTEST: f64 = 1e-12;

impl<'c, C: Space<State = P::State>, P: Placement> MovingVerifier<'c, C, P> {
    /// A verifier for `robot` in `space` with a tenth of its [tolerance](crate::RigidBody::tolerance).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite. The tolerance of a robot always is.
    pub fn new(space: &'c SpaceTime<C>, robot: &AmongMoving<P>) -> Result<Self, ParameterError> {
        let standing = Verifier::new(space.positions(), robot.body())?;
        let mesh = robot.body().mesh();
        let radius = mesh.vertices().iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        Ok(Self {
            space,
            tolerance: standing.tolerance(),
            standing,
            interrupt: Interrupt::never(),
            robot: robot.body().shared.reference(),
            radius,
            moving: Arc::clone(robot.moving()),
            kept: robot.body().kept(),
        })
    }

    /// The clearance (m) that motions found free keep from every obstacle.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// What holds at a single moment: free with its clearance, which is exact where it is below `enough` (m), or else at least that.
    /// Less than the tolerance is [`Unproven`](MotionCheck::Unproven).
    #[must_use]
    pub fn check_state(&self, q: &(P::State, f64), enough: f64) -> MotionCheck {
        if !self.space.contains(q) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let standing = self.standing.check_state(&q.0, enough);
        let MotionCheck::Free { clearance } = standing else { return standing };
        let pose: Isometry3<f64> = P::pose(&q.0);
        if self.moving.iter().any(|obstacle| self.is_nested(obstacle, q)) {
            return MotionCheck::Collision { at: 0.0 };
        }
        let from = |obstacle: &MovingObstacle| {
            self.robot.clearance(&pose, &obstacle.reference, &obstacle.trajectory.pose(q.1), enough)
        };
        self.standing.judged(self.moving.iter().map(from).fold(clearance, f64::min))
    }

    /// Whether the robot is inside of an obstacle or the other way round, where their surfaces are apart.
    fn is_nested(&self, obstacle: &MovingObstacle, (q, time): &(P::State, f64)) -> bool {
        self.robot.is_nested(&P::pose(q), &obstacle.reference, &obstacle.trajectory.pose(*time))
    }

    /// The clearance kept from one moving obstacle over the motion, or the check that failed. `rate` is how far a point of
    /// the robot moves over the motion.
    fn against(
        &self,
        obstacle: &MovingObstacle,
        from: &(P::State, f64),
        to: &(P::State, f64),
        rate: f64,
    ) -> Result<f64, MotionCheck> {
        let mut least = f64::INFINITY;
        let mut open = vec![(0.0_f64, 1.0_f64)];
        let mut interrupt = self.interrupt.clone();
        while let Some((a, b)) = open.pop() {
            let (at, half) = (0.5 * (a + b), 0.5 * (b - a));
            if interrupt.ask() {
                return Err(MotionCheck::Unproven { at });
            }
            let (q, time) = self.space.interpolate(from, to, at);
            let when = |t: f64| from.1 + (to.1 - from.1) * t;
            let approach = half
                * (rate + obstacle.trajectory.speed(obstacle.radius, when(a), when(b)) * (to.1 - from.1));
            let needed = (approach + self.kept + self.tolerance) * (1.0 + 1e-9);
            let pose: Isometry3<f64> = P::pose(&q);
            match self.robot.at_least(&pose, &obstacle.reference, &obstacle.trajectory.pose(time), needed) {
                Ok(distance) => least = least.min(distance - approach),
                Err(distance) if distance <= self.kept => return Err(MotionCheck::Collision { at }),
                Err(distance) if distance < self.kept + self.tolerance || half < SHORTEST => {
                    return Err(MotionCheck::Unproven { at });
                }
                Err(_) => open.extend([(at, b), (a, at)]),
            }
        }
        Ok(least)
    }
}

impl<C: Space<State = P::State>, P: Placement> MotionValidity<(P::State, f64)> for MovingVerifier<'_, C, P> {
    fn check_motion(&mut self, from: &(P::State, f64), to: &(P::State, f64)) -> MotionCheck {
        if !(self.space.contains(from) && self.space.contains(to) && self.space.can_move(from, to)) {
            return MotionCheck::Unproven { at: 0.0 };
        }
        let standing = self.standing.check_motion(&from.0, &to.0);
        let MotionCheck::Free { clearance: mut least } = standing else { return standing };
        // The origin moves on a line and the body turns about it, both at constant speed.
        let [a, b] = [&from.0, &to.0].map(P::pose);
        let shift = (b.translation.vector - a.translation.vector).norm();
        let rate = shift + self.radius * a.rotation.angle_to(&b.rotation);
        for obstacle in self.moving.iter() {
            if self.is_nested(obstacle, from) {
                return MotionCheck::Collision { at: 0.0 };
            }
            match self.against(obstacle, from, to, rate) {
                Ok(clearance) => least = least.min(clearance),
                Err(check) => return check,
            }
        }
        MotionCheck::Free { clearance: least }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
        self.standing.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
