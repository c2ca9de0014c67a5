//! A rigid body among obstacles, some of which move on known trajectories.

mod trajectory;
mod verify;

pub use trajectory::{Trajectory, TrajectoryError};
pub use verify::MovingVerifier;

use crate::kept::beyond;
use crate::{CheckCounters, Placement, RigidBody, RobotError};
use mp_collide::reference::RefMesh;
use mp_collide::{CollisionMesh, Query, Scene};
use mp_cspace::{
    Clearance, Interrupt, Interrupted, IntervalClearance, MotionClearance, MotionInterval, Validity,
};
use mp_geom::TriMesh;
use nalgebra::{Isometry3, Point3};
use std::sync::Arc;

/// A moving obstacle. Its scene holds it alone, with its frame at the origin; queries give the pose of the robot in that
/// frame.
#[derive(Clone, Debug)]
pub(crate) struct MovingObstacle {
    scene: Arc<Scene>,
    pub(crate) trajectory: Trajectory,
    /// The largest distance (m) of one of its points from the origin of its frame.
    pub(crate) radius: f64,
    pub(crate) reference: Arc<RefMesh>,
}

/// A [`RigidBody`] and the bodies that move around it, each on its [`Trajectory`] whatever the robot does.
///
/// A state is a pair of a configuration and a time (s), as in [`SpaceTime`](mp_cspace::space_time::SpaceTime). It is free
/// if the robot touches neither the obstacles that stand still nor a moving one, with its inside if it is a
/// [solid](TriMesh::solids). A robot that is inside a closed moving surface from the beginning, even a point, is not in contact with
/// it. Motion bounds are for the robot and the
/// fastest obstacle together, so [`Certified`](mp_cspace::Certified) misses no obstacle, however thin.
/// [`ForwardInTime`](mp_cspace::space_time::ForwardInTime) around it keeps time running forward.
#[derive(Clone, Debug)]
pub struct AmongMoving<P: Placement> {
    body: RigidBody<P>,
    moving: Arc<[MovingObstacle]>,
    query: Query,
    counters: CheckCounters,
    /// The ends of the last motion that has a state where nothing is inside of anything that moves.
    apart: Option<[(Isometry3<f64>, f64); 2]>,
}

/// Bounds are enlarged by this factor against rounding.
const ROUND_UP: f64 = 1.0 + 1e-9;

impl<P: Placement> AmongMoving<P> {
    /// `body` among its obstacles that stand still, and the obstacles `moving`: each a name, a mesh in its own frame, and
    /// the trajectory of that frame in the world.
    ///
    /// # Errors
    /// When a mesh is too large to compute with.
    pub fn new(
        body: RigidBody<P>,
        moving: impl IntoIterator<Item = (String, TriMesh, Trajectory)>,
    ) -> Result<Self, RobotError> {
        Self::new_until(body, moving, &Interrupt::never())
    }

    /// As [`new`](Self::new), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`Interrupted`](RobotError::Interrupted) when it was interrupted.
    pub fn new_until(
        body: RigidBody<P>,
        moving: impl IntoIterator<Item = (String, TriMesh, Trajectory)>,
        interrupt: &Interrupt,
    ) -> Result<Self, RobotError> {
        let make = |(name, mesh, trajectory): (String, TriMesh, Trajectory)| {
            // What moves has facets: bounds of its motion are of its vertices.
            let (mut scene, mesh) = (Scene::new(), mesh.faceted());
            let tree = CollisionMesh::new_until(&mesh, interrupt).ok_or(Interrupted)?;
            scene.insert(name, tree, Isometry3::identity())?;
            let radius = mesh.radius_about(&Point3::origin());
            let reference = Arc::new(RefMesh::new_until(&mesh, interrupt).ok_or(Interrupted)?);
            Ok(MovingObstacle { scene: Arc::new(scene), trajectory, radius, reference })
        };
        let moving: Vec<MovingObstacle> = moving.into_iter().map(make).collect::<Result<_, RobotError>>()?;
        Ok(Self {
            body,
            moving: moving.into(),
            query: Query::default(),
            counters: CheckCounters::default(),
            apart: None,
        })
    }

    /// The same, which keeps the clearance `kept` (m) from all obstacles: see [`RigidBody::keeping`].
    #[must_use]
    pub fn keeping(self, kept: f64) -> Self {
        Self { body: self.body.keeping(kept), apart: None, ..self }
    }

    /// The robot among the obstacles that stand still.
    #[must_use]
    pub fn body(&self) -> &RigidBody<P> {
        &self.body
    }

    /// The checks made by this clone so far. Those against obstacles that stand still and against each that moves count
    /// separately.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        let mut counters = self.body.counters();
        counters += self.counters.with(&self.query);
        counters
    }

    /// The trajectories of the moving obstacles, in the order in which they were given.
    pub fn trajectories(&self) -> impl Iterator<Item = &Trajectory> {
        self.moving.iter().map(|obstacle| &obstacle.trajectory)
    }

    /// The poses of the moving obstacles at a time, in the order in which they were given.
    pub fn poses(&self, time: f64) -> impl Iterator<Item = Isometry3<f64>> + '_ {
        self.moving.iter().map(move |obstacle| obstacle.trajectory.pose(time))
    }

    /// The speed (m/s) that no point of a moving obstacle ever exceeds.
    #[must_use]
    pub fn greatest_speed(&self) -> f64 {
        let speed = |obstacle: &MovingObstacle| {
            obstacle.trajectory.speed(obstacle.radius, f64::NEG_INFINITY, f64::INFINITY)
        };
        self.moving.iter().map(speed).fold(0.0, f64::max)
    }

    /// The indices of the moving obstacles that the robot touches.
    pub fn touching(&mut self, (q, time): &(P::State, f64)) -> Vec<usize> {
        let pose = P::pose(q);
        let touches = |obstacle: &MovingObstacle| {
            self.counters.collision_checks += 1;
            let seen = obstacle.trajectory.pose(*time).inv_mul(&pose);
            obstacle.scene.collides(&mut self.query, &self.body.shared.robot, &seen)
        };
        let each = self.moving.iter().map(touches).enumerate();
        each.filter_map(|(i, touched)| touched.then_some(i)).collect()
    }

    pub(crate) fn moving(&self) -> &Arc<[MovingObstacle]> {
        &self.moving
    }
}

impl<P: Placement> Validity<(P::State, f64)> for AmongMoving<P> {
    fn is_valid(&mut self, q: &(P::State, f64)) -> bool {
        !self.in_contact(q)
    }
}

impl<P: Placement> Clearance<(P::State, f64)> for AmongMoving<P> {
    fn clearance(&mut self, (q, time): &(P::State, f64), enough: f64) -> f64 {
        let mut least = self.body.clearance(q, enough);
        let pose = P::pose(q);
        for obstacle in self.moving.iter() {
            self.counters.clearance_checks += 1;
            let seen = obstacle.trajectory.pose(*time).inv_mul(&pose);
            let (robot, query) = (&self.body.shared.robot, &mut self.query);
            let found = |limit| obstacle.scene.clearance(query, robot, &seen, limit).0;
            least = least.min(beyond(self.body.kept(), enough.min(least), found));
        }
        least.max(0.0)
    }

    fn in_contact(&mut self, (q, time): &(P::State, f64)) -> bool {
        if self.body.in_contact(q) {
            return true;
        }
        let (pose, kept) = (P::pose(q), self.body.kept());
        self.moving.iter().any(|obstacle| {
            self.counters.collision_checks += 1;
            let seen = obstacle.trajectory.pose(*time).inv_mul(&pose);
            let (scene, query, robot) = (&obstacle.scene, &mut self.query, &self.body.shared.robot);
            match kept > 0.0 {
                true => scene.within(query, robot, &seen, kept),
                false => scene.collides(query, robot, &seen),
            }
        })
    }
}

impl<P: Placement> MotionClearance<(P::State, f64)> for AmongMoving<P> {
    /// How far the robot and the fastest moving obstacle travel, added.
    fn motion_bound(&self, from: &(P::State, f64), to: &(P::State, f64)) -> f64 {
        let speed = |obstacle: &MovingObstacle| obstacle.trajectory.speed(obstacle.radius, from.1, to.1);
        let fastest = self.moving.iter().map(speed).fold(0.0, f64::max);
        (self.body.motion_bound(&from.0, &to.0) + fastest * (to.1 - from.1).abs()) * ROUND_UP
    }

    /// By the clearance of surfaces in the middle. What is inside of what is asked once for a motion: nothing gets inside without
    /// meeting a surface.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, (P::State, f64)>) -> IntervalClearance {
        let ends = [interval.from, interval.to].map(|(q, time)| (P::pose(q), *time));
        let (pose, time) = (P::pose(&interval.middle.0), interval.middle.1);
        let enough = interval.travel.max(interval.margin) + interval.margin;
        let mut least = self.body.surface_clearance(&pose, enough);
        for obstacle in self.moving.iter() {
            self.counters.clearance_checks += 1;
            let seen = obstacle.trajectory.pose(time).inv_mul(&pose);
            let (robot, query) = (&self.body.shared.robot, &mut self.query);
            let found = |limit| obstacle.scene.surface_clearance(query, robot, &seen, limit).0;
            least = least.min(beyond(self.body.kept(), enough.min(least), found));
        }
        if least > 0.0 && self.apart.is_none_or(|apart| apart != ends) {
            let inside = |obstacle: &MovingObstacle| {
                let seen = obstacle.trajectory.pose(time).inv_mul(&pose);
                obstacle.scene.nested(&mut self.query, &self.body.shared.robot, &seen).is_some()
            };
            let nested =
                self.moving.iter().any(inside) || self.body.is_nested_on([ends[0].0, ends[1].0], &pose);
            self.apart = (!nested).then_some(ends);
            least = if nested { 0.0 } else { least };
        }
        IntervalClearance::of(least, interval.margin)
    }
}
