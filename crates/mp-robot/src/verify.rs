//! The independent check of motions.

use crate::rigid::Reference;
use crate::solid::Solid;
use crate::{Placement, RigidBody};
use mp_collide::reference::RefMesh;
use mp_cspace::{MotionCheck, MotionValidity, ParameterError, Space};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3};
use std::collections::VecDeque;
use std::marker::PhantomData;
use std::sync::Arc;

/// Proves motions of a rigid body free of collision, by other code than planners use: its own motion bound,
/// its own subdivision, and `mp_collide::reference` (sphere trees) for distances. Only the space is
/// shared: its interpolation is what a motion *is*.
///
/// The motion is bisected. A part is proved when the clearance at its middle exceeds, by the tolerance, how
/// far any point of the robot can be from where it is at the middle, `‖Δp‖ + 2·radius·sin(θ/2)` to either end
/// of the part. So:
///
/// - free means: clearance of at least the tolerance all along, however thin the obstacles;
/// - a motion with clearance of at least twice the tolerance all along is found free;
/// - a motion with a tested state of less is [`Undecided`](MotionCheck::Undecided), as are motions longer
///   than 10⁹ tolerances or cut into more than four million parts.
///
/// Interpolation in the space must move the origin on a straight line and turn by at most half a turn about
/// a fixed axis, as `Se3`, `Se2` and `Rn` do. Obstacles are surfaces; for a point, which can touch one only by
/// chance, motions that begin inside a solid collide too.
#[derive(Clone, Debug)]
pub struct Verifier<'c, C, P> {
    space: &'c C,
    robot: Arc<RefMesh>,
    world: Option<Arc<RefMesh>>,
    /// For a point; no others.
    solids: Vec<Solid>,
    radius: f64,
    tolerance: f64,
    queries: u64,
    parts: VecDeque<[f64; 2]>,
    placement: PhantomData<P>,
}

/// Motions longer than this many tolerances are refused.
const MAX_LENGTH: f64 = 1e9;
/// Motions that need more parts than this are given up.
const MAX_PARTS: u64 = 4_000_000;

impl<'c, C: Space<State = P::State>, P: Placement> Verifier<'c, C, P> {
    /// A verifier for `robot` in `space`, to a tenth of the robot's [tolerance](RigidBody::tolerance).
    ///
    /// # Errors
    /// When the tolerance is not positive and finite, which that of a robot always is.
    pub fn new(space: &'c C, robot: &RigidBody<P>) -> Result<Self, ParameterError> {
        Self::with_tolerance(space, robot, robot.tolerance() * 0.1)
    }

    /// A verifier to a tolerance of your own (m).
    ///
    /// # Errors
    /// When it is not positive and finite.
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
        let reference = shared.reference.get_or_init(|| Reference {
            robot: Arc::new(RefMesh::new(&shared.robot_mesh)),
            world: TriMesh::merged(shared.placed.iter().map(|(_, mesh)| &**mesh))
                .map(|mesh| Arc::new(RefMesh::new(&mesh))),
        });
        let solids = if shared.shape.radius == 0.0 { shared.solids() } else { &[] };
        let from_origin = |p: &Point3<f64>| p.coords.norm();
        Ok(Self {
            space,
            robot: Arc::clone(&reference.robot),
            world: reference.world.clone(),
            solids: solids.iter().map(|(_, solid)| solid.clone()).collect(),
            radius: shared.robot_mesh.vertices().iter().map(from_origin).fold(0.0, f64::max),
            tolerance,
            queries: 0,
            parts: VecDeque::new(),
            placement: PhantomData,
        })
    }

    /// Motions found free keep this far from every obstacle (m).
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// Distance queries made so far.
    #[must_use]
    pub fn queries(&self) -> u64 {
        self.queries
    }

    /// A lower bound on the distance to the obstacles (m) of at least `enough`, or else the distance of
    /// something nearer than that.
    fn at_least(&mut self, pose: &Isometry3<f64>, enough: f64) -> Result<f64, f64> {
        self.queries += 1;
        match &self.world {
            Some(world) => self.robot.at_least(pose, world, &Isometry3::identity(), enough),
            None if pose.to_homogeneous().iter().all(|v| v.is_finite()) => Ok(f64::INFINITY),
            None => Err(0.0),
        }
    }

    /// How far apart two poses can put a point of the robot.
    fn displacement(&self, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        // The imaginary part of the quaternion between has the sine of half the angle for length.
        let half_turn_sine = (a.rotation.quaternion().conjugate() * b.rotation.quaternion()).imag().norm();
        (a.translation.vector - b.translation.vector).norm() + 2.0 * self.radius * half_turn_sine
    }

    fn pose_at(&self, from: &P::State, to: &P::State, t: f64) -> Isometry3<f64> {
        P::pose(&self.space.interpolate(from, to, t))
    }
}

impl<C: Space<State = P::State>, P: Placement> MotionValidity<P::State> for Verifier<'_, C, P> {
    fn check_motion(&mut self, from: &P::State, to: &P::State) -> MotionCheck {
        let whole = self.displacement(&P::pose(from), &P::pose(to));
        // Written so that NaN is refused.
        let provable = whole / self.tolerance < MAX_LENGTH;
        if !provable {
            return MotionCheck::Undecided { at: 0.0 };
        }
        for (at, end) in [(0.0, from), (1.0, to)] {
            if self.at_least(&P::pose(end), self.tolerance).is_err_and(|distance| distance <= 0.0) {
                return MotionCheck::Collides { at };
            }
        }
        if self.solids.iter().any(|solid| solid.contains(&P::pose(from).translation.vector.into())) {
            return MotionCheck::Collides { at: 0.0 };
        }
        // Larger parts first: that meets obstacles soonest.
        let mut least = f64::INFINITY;
        let mut parts = std::mem::take(&mut self.parts);
        parts.clear();
        parts.push_back([0.0, 1.0]);
        let mut verdict = None;
        let limit = self.queries + MAX_PARTS;
        while let Some([a, b]) = parts.pop_front() {
            let at = 0.5 * (a + b);
            let middle = self.pose_at(from, to, at);
            let [to_a, to_b] = [a, b].map(|t| self.displacement(&middle, &self.pose_at(from, to, t)));
            let swept = to_a.max(to_b);
            if let Ok(clearance) = self.at_least(&middle, swept + self.tolerance) {
                // The maximum is for rounding only.
                least = least.min((clearance - swept).max(self.tolerance));
                continue;
            }
            match self.at_least(&middle, 2.0 * self.tolerance) {
                // Ends when the parts are so short that they can be proved.
                Ok(_) if self.queries < limit => parts.extend([[a, at], [at, b]]),
                found => {
                    let hit = found.is_err_and(|distance| distance <= 0.0);
                    verdict =
                        Some(if hit { MotionCheck::Collides { at } } else { MotionCheck::Undecided { at } });
                    break;
                }
            }
        }
        self.parts = parts;
        verdict.unwrap_or(MotionCheck::Free { clearance: least })
    }
}
