//! The independent check of motions.

use crate::solid_obstacle::SolidObstacle;
use crate::{Placement, RigidBody};
use mp_collide::reference::{RefMesh, Sweep, SweepCheck};
use mp_cspace::{Interrupt, MotionCheck, MotionValidity, ParameterError, Space};
#[cfg(doc)]
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3};
use std::marker::PhantomData;
use std::sync::Arc;

/// Proves motions of a rigid body free of collision, with other code than planners use: its own motion bound,
/// its own subdivision, and `mp_collide::reference` (sphere trees). Only the space is shared with the checker: its
/// interpolation defines what a motion is.
///
/// The proof is a [`Sweep`] with the tolerance as its margin. Therefore:
///
/// - free means a clearance of at least the tolerance all along, however thin the obstacles are;
/// - a motion with a clearance of at least twice the tolerance all along is found free;
/// - a motion with a tested state of less clearance is [`Unproven`](MotionCheck::Unproven), as are motions longer
///   than 10¹² tolerances and motions for which the sweep takes too long.
///
/// Interpolation in the space must move the origin on a straight line and turn by at most half a turn about
/// a fixed axis, both at constant speed, as `Se3`, `Se2` and `Rn` do. Motions that begin inside of a
/// [solid](TriMesh::solids) collide, and those of a robot with an obstacle inside, for surfaces that do not meet keep inside what is
/// inside. A point can touch a surface only by chance; for a point, closed obstacles that face outward are solids too.
#[derive(Clone, Debug)]
pub struct Verifier<'c, C, P> {
    space: &'c C,
    robot: Arc<RefMesh>,
    world: Option<Arc<RefMesh>>,
    /// Of a point robot only; empty for others.
    solids: Vec<SolidObstacle>,
    radius: f64,
    tolerance: f64,
    /// The clearance (m) that the robot keeps, to which the tolerance is added.
    kept: f64,
    sweep: Sweep,
    interrupt: Interrupt,
    /// The end of the last motion that was found free, where nothing is inside of anything.
    apart: Option<Isometry3<f64>>,
    placement: PhantomData<P>,
}

/// Motions longer than this many tolerances are refused.
const MAX_LENGTH: f64 = 1e12;

impl<'c, C: Space<State = P::State>, P: Placement> Verifier<'c, C, P> {
    /// A verifier for `robot` in `space` with a tenth of the robot's [tolerance](RigidBody::tolerance).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite. The tolerance of a robot always is.
    pub fn new(space: &'c C, robot: &RigidBody<P>) -> Result<Self, ParameterError> {
        Self::with_tolerance(space, robot, robot.tolerance() * 0.1)
    }

    /// A verifier with the tolerance `tolerance` (m).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite.
    pub fn with_tolerance(
        space: &'c C,
        robot: &RigidBody<P>,
        tolerance: f64,
    ) -> Result<Self, ParameterError> {
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            let (name, expected) = ("the tolerance", "positive and finite");
            return Err(ParameterError { name, expected, value: tolerance });
        }
        let shared = &robot.shared;
        let solids = if shared.radii.radius == 0.0 { shared.solids() } else { &[] };
        let from_origin = |p: &Point3<f64>| p.coords.norm();
        Ok(Self {
            space,
            robot: shared.reference(),
            world: shared.obstacles.reference(),
            solids: solids.iter().map(|(_, solid)| solid.clone()).collect(),
            radius: shared.robot_mesh.vertices().iter().map(from_origin).fold(0.0, f64::max),
            tolerance,
            kept: robot.kept(),
            sweep: Sweep::default(),
            interrupt: Interrupt::never(),
            apart: None,
            placement: PhantomData,
        })
    }

    /// The clearance (m) that motions found free keep from every obstacle, beyond what the robot [keeps](RigidBody::keeping).
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// How many pairs of boxes have been compared so far.
    #[must_use]
    pub fn comparisons(&self) -> u64 {
        self.sweep.compared()
    }

    /// What holds at a single configuration: free with its clearance, which is exact where it is below `enough` (m), or else at
    /// least that. Less than the tolerance is [`Unproven`](MotionCheck::Unproven).
    #[must_use]
    pub fn check_state(&self, q: &P::State, enough: f64) -> MotionCheck {
        let pose = P::pose(q);
        if self.is_nested(&pose) {
            return MotionCheck::Collision { at: 0.0 };
        }
        let clearance = self.world.as_ref().map_or(f64::INFINITY, |world| {
            self.robot.clearance(&pose, world, &Isometry3::identity(), enough)
        });
        self.judged(clearance)
    }

    /// The clearance (m) of motions found free.
    pub(crate) fn margin(&self) -> f64 {
        self.kept + self.tolerance
    }

    /// What a clearance (m) means.
    pub(crate) fn judged(&self, clearance: f64) -> MotionCheck {
        match clearance {
            c if c <= self.kept => MotionCheck::Collision { at: 0.0 },
            c if c >= self.margin() => MotionCheck::Free { clearance: c },
            _ => MotionCheck::Unproven { at: 0.0 },
        }
    }

    /// Whether the robot is inside of a solid at a pose, or an obstacle inside of the robot, where their surfaces are apart.
    fn is_nested(&self, pose: &Isometry3<f64>) -> bool {
        let world = self.world.as_ref();
        world.is_some_and(|world| self.robot.is_nested(pose, world, &Isometry3::identity()))
            || self.solids.iter().any(|solid| solid.contains(&pose.translation.vector.into()))
    }

    /// Whether the robot surely touches an obstacle at a pose, or is nearer than the clearance to keep.
    fn touches(&self, pose: &Isometry3<f64>) -> bool {
        let Some(world) = &self.world else { return false };
        let touching = self.robot.at_least(pose, world, &Isometry3::identity(), self.margin());
        touching.is_err_and(|distance| distance <= self.kept)
    }

    /// An upper bound (m) on the distance between the places of a robot point at two poses.
    fn displacement(&self, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        // The length of the imaginary part of the relative quaternion is the sine of half the angle.
        let half_turn_sine = (a.rotation.quaternion().conjugate() * b.rotation.quaternion()).imag().norm();
        (a.translation.vector - b.translation.vector).norm() + 2.0 * self.radius * half_turn_sine
    }
}

impl<C: Space<State = P::State>, P: Placement> MotionValidity<P::State> for Verifier<'_, C, P> {
    fn check_motion(&mut self, from: &P::State, to: &P::State) -> MotionCheck {
        let ends = [from, to].map(P::pose);
        // Written so that NaN is refused.
        let provable = self.displacement(&ends[0], &ends[1]) / self.tolerance < MAX_LENGTH;
        if !provable {
            return MotionCheck::Unproven { at: 0.0 };
        }
        if self.apart != Some(ends[0]) && self.is_nested(&ends[0]) {
            return MotionCheck::Collision { at: 0.0 };
        }
        let Some(world) = &self.world else { return MotionCheck::Free { clearance: f64::INFINITY } };
        let pose_at = |t: f64| P::pose(&self.space.interpolate(from, to, t));
        if self.interrupt.ask() {
            return MotionCheck::Unproven { at: 0.0 };
        }
        match self.sweep.sweep(&self.robot, pose_at, world, self.margin(), self.tolerance) {
            SweepCheck::Free { clearance } if self.interrupt.raised().is_none() => {
                self.apart = Some(ends[1]);
                MotionCheck::Free { clearance }
            }
            _ if self.interrupt.raised().is_some() => MotionCheck::Unproven { at: 0.0 },
            _ if self.touches(&ends[0]) => MotionCheck::Collision { at: 0.0 },
            _ if self.touches(&ends[1]) => MotionCheck::Collision { at: 1.0 },
            SweepCheck::Collision { at } => MotionCheck::Collision { at },
            SweepCheck::TooClose { at } => MotionCheck::Unproven { at },
            SweepCheck::Free { .. } => MotionCheck::Unproven { at: 0.0 },
        }
    }
    fn interrupt_by(&mut self, interrupt: &Interrupt) {
        self.interrupt = interrupt.clone();
        self.sweep.interrupt_by(interrupt);
    }
    fn is_interrupted(&mut self) -> bool {
        self.interrupt.ask()
    }
}
