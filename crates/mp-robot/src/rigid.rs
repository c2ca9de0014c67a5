//! A rigid body among obstacles that stand still.

use crate::features::SceneFeatures;
use crate::kept::beyond;
use crate::obstacles::{MAX_TRIANGLES, Obstacles, make_once, resolved_tolerance};
use crate::solid_obstacle::SolidObstacle;
use crate::{BodyRadii, CheckCounters, Placement, Planar, Point, Spatial};
use mp_collide::reference::RefMesh;
use mp_collide::{BodyId, CollisionMesh, IntervalCheck, Query, RigidMotion, Scene, SceneError};
use mp_cspace::{
    Clearance, Interrupt, Interrupted, IntervalClearance, MotionClearance, MotionInterval, Validity,
};
use mp_geom::{Aabb, MeshError, TriMesh};
use nalgebra::{Isometry3, Point3};
use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};
use thiserror::Error;

/// Why a robot and its obstacles could not be put together.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// The pose of an obstacle is not valid, or its mesh is too large.
    #[error("cannot place an obstacle: {0}")]
    Obstacle(#[from] SceneError),
    /// A mesh is not valid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// There are more triangles than trees can index.
    #[error("robot and obstacles have {count} triangles; at most {max} can be handled")]
    TooManyTriangles {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// The work was interrupted.
    #[error("preparing the meshes was ended")]
    Interrupted,
    /// The robot is too large to compute with.
    #[error("the robot is too large: {radius:e} m from its origin; at most {max:e} m can be handled")]
    TooLarge {
        /// The largest distance (m) of a point of it from the origin of its frame.
        radius: f64,
        /// The largest possible (m).
        max: f64,
    },
}

impl From<Interrupted> for RobotError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// The immutable part of a [`RigidBody`], shared by all clones.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) robot_mesh: TriMesh,
    pub(crate) robot: CollisionMesh,
    pub(crate) radii: BodyRadii,
    pub(crate) obstacles: Arc<Obstacles>,
    /// The robot as verifiers see it, made for the first one.
    reference: Arc<OnceLock<Arc<RefMesh>>>,
    /// Made at the first use.
    pub(crate) features: OnceLock<SceneFeatures>,
}

impl Shared {
    pub(crate) fn solids(&self) -> &[(BodyId, SolidObstacle)] {
        self.obstacles.solids()
    }

    /// The robot as verifiers see it.
    pub(crate) fn reference(&self) -> Arc<RefMesh> {
        Arc::clone(self.reference.get_or_init(|| Arc::new(RefMesh::new(&self.robot_mesh))))
    }
}

/// A rigid body among named obstacles that stand still.
///
/// A configuration is free when robot and obstacles have no point in common. Touching is collision. Meshes are surfaces: a
/// robot wholly inside a closed mesh is free, as in a room, though it can never leave. [Solids](TriMesh::solids), as primitives are,
/// have an inside: what is wholly in one, robot or obstacle, collides. For a [`PointRobot`] closed meshes are solids too.
///
/// Clones share meshes and trees. Each clone has its own counters and scratch memory, so clone it for each thread.
#[derive(Clone, Debug)]
pub struct RigidBody<P: Placement> {
    pub(crate) shared: Arc<Shared>,
    pub(crate) query: Query,
    counters: CheckCounters,
    poses: Vec<Isometry3<f64>>,
    /// The ends of the last motion that has a state where nothing is inside of anything: where it touches nothing, that holds for
    /// all of it.
    apart: Option<[Isometry3<f64>; 2]>,
    /// The clearance (m) to keep.
    kept: f64,
    placement: PhantomData<P>,
}

/// A mesh that moves freely in space. Configurations are poses of its frame in the world.
pub type FreeFlyer = RigidBody<Spatial>;

/// A mesh that moves in the plane z = 0 and turns about Z, among obstacles of any height.
pub type PlanarFlyer = RigidBody<Planar>;

/// A point that moves in space.
///
/// A point lies exactly on a surface only by rare chance. For this robot the inside of solid obstacles (closed, consistently
/// oriented, triangles facing outward) therefore counts as collision too. Rooms, whose triangles face inward, and open
/// sheets remain surfaces: among them only certified motion checks are useful.
pub type PointRobot = RigidBody<Point>;

/// Largest robot, metres.
const MAX_RADIUS: f64 = 1e75;

impl FreeFlyer {
    /// `robot`, in its own frame, among obstacles: each a name, a mesh and its pose in the world.
    ///
    /// # Errors
    /// When a pose is not a rigid motion, or a mesh is too large to compute with.
    pub fn new(
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among(robot, obstacles)
    }
}

impl PlanarFlyer {
    /// `robot`, in its own frame, among obstacles: each a name, a mesh and its pose in the world.
    ///
    /// # Errors
    /// When a pose is not a rigid motion, or a mesh is too large to compute with.
    pub fn new(
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among(robot, obstacles)
    }
}

impl PointRobot {
    /// A point among obstacles: each a name, a mesh and its pose in the world.
    ///
    /// # Errors
    /// When a pose is not a rigid motion, or a mesh is too large to compute with.
    pub fn new(
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among(&TriMesh::from_soup(&[[Point3::origin(); 3]])?, obstacles)
    }
}

impl<P: Placement> RigidBody<P> {
    /// `robot`, in its own frame, among obstacles: each a name, a mesh and its pose in the world. For code that is
    /// generic over the placement; otherwise use [`FreeFlyer::new`], [`PlanarFlyer::new`] or [`PointRobot::new`].
    ///
    /// # Errors
    /// When a pose is not a rigid motion, or a mesh is too large to compute with.
    pub fn among(
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among_after(None, robot, obstacles)
    }

    /// As [`among`](Self::among), after a small change: the trees of meshes that `before` has too are taken from there, so
    /// that only what differs takes time. The result is the same.
    ///
    /// # Errors
    /// As [`among`](Self::among).
    pub fn among_after(
        before: Option<&Self>,
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among_until(before, robot, obstacles, &Interrupt::never())
    }

    /// As [`among_after`](Self::among_after), unless `interrupt` says to end.
    ///
    /// # Errors
    /// As [`among`](Self::among), and [`Interrupted`](RobotError::Interrupted) when it was interrupted.
    pub fn among_until(
        before: Option<&Self>,
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
        interrupt: &Interrupt,
    ) -> Result<Self, RobotError> {
        let _span = tracing::debug_span!("build", triangles = robot.triangles().len()).entered();
        // What moves has facets: bounds of its motion are of its vertices.
        let robot = &robot.faceted();
        let before = before.map(|before| &*before.shared);
        let same = before.filter(|before| before.robot_mesh == *robot);
        let radii = same.map_or_else(|| BodyRadii::of(robot), |same| same.radii.clone());
        if radii.radius > MAX_RADIUS {
            return Err(RobotError::TooLarge { radius: radii.radius, max: MAX_RADIUS });
        }
        let too_many = |count| RobotError::TooManyTriangles { count, max: MAX_TRIANGLES };
        let known = before.map(|before| &before.obstacles);
        let obstacles = Obstacles::new(obstacles, (robot.triangles().len(), 0), too_many, known, interrupt)?;
        let tree = || CollisionMesh::new_until(robot, interrupt).ok_or(RobotError::Interrupted);
        let shared = Shared {
            robot_mesh: robot.clone(),
            robot: same.map_or_else(tree, |same| Ok(same.robot.clone()))?,
            radii,
            obstacles,
            reference: same.map(|same| Arc::clone(&same.reference)).unwrap_or_default(),
            features: OnceLock::new(),
        };
        Ok(Self {
            shared: Arc::new(shared),
            query: Query::default(),
            counters: CheckCounters::default(),
            poses: Vec::new(),
            apart: None,
            kept: 0.0,
            placement: PhantomData,
        })
    }

    /// The same body, which keeps the clearance `kept` (m) from obstacles: what is nearer counts as in contact, all clearances are less by
    /// this much, and a [`Verifier`](crate::Verifier) of it proves that it is kept. Below zero it is zero, and where it is not a number infinite.
    #[must_use]
    pub fn keeping(self, kept: f64) -> Self {
        Self { kept: crate::kept::asked(kept), apart: None, ..self }
    }

    /// The clearance (m) that it [keeps](Self::keeping): zero, unless asked for.
    #[must_use]
    pub fn kept(&self) -> f64 {
        self.kept
    }

    /// Makes what a [`Verifier`](crate::Verifier) would make at its first use, which takes long for large meshes, unless `interrupt`
    /// says to end. Clones share it.
    ///
    /// # Errors
    /// When it was interrupted.
    pub fn make_ready(&self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        let shared = &*self.shared;
        make_once(&shared.reference, interrupt, || {
            RefMesh::new_until(&shared.robot_mesh, interrupt).map(Arc::new).ok_or(Interrupted)
        })?;
        shared.obstacles.make_reference(interrupt)
    }

    /// The robot, in its own frame.
    #[must_use]
    pub fn mesh(&self) -> &TriMesh {
        &self.shared.robot_mesh
    }

    /// The radii and corners from which the travel of the robot is bounded.
    #[must_use]
    pub fn radii(&self) -> &BodyRadii {
        &self.shared.radii
    }

    /// The largest distance of a point of the robot from the origin of its frame, metres.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.shared.radii.radius
    }

    /// The obstacles, by name.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.shared.obstacles.scene
    }

    /// The box around all obstacles; empty when there are none.
    #[must_use]
    pub fn obstacle_bounds(&self) -> Aabb {
        self.shared.obstacles.bounds
    }

    /// The checks made by this clone so far.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        self.counters.with(&self.query)
    }

    /// Sets the counters of this clone to zero. Returns the counts before.
    pub fn take_counters(&mut self) -> CheckCounters {
        self.counters.take(&mut self.query)
    }

    /// The default tolerance (m) of certified motion checks: 1e-4 of the robot's radius, or of its length where it is far from its
    /// origin (for a point, 1e-6 of the size of the obstacles), and at least what coordinates can resolve. A [`Verifier`](crate::Verifier) uses a tenth of
    /// it, so that it proves whatever [`Certified`](mp_cspace::Certified) accepts at this tolerance.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        let (obstacles, radius) = (&self.shared.obstacles, self.radius());
        let size = if obstacles.bounds.is_empty() { 0.0 } else { obstacles.bounds.diagonal() };
        let wanted = if radius > 0.0 { 1e-4 * self.radii().size() } else { 1e-6 * size };
        resolved_tolerance(wanted, obstacles.farthest() + radius)
    }

    /// The solid that a point robot at `pose` is inside of.
    pub(crate) fn solid_around(&self, pose: &Isometry3<f64>) -> Option<BodyId> {
        if self.shared.radii.radius > 0.0 {
            return None;
        }
        let p = pose.translation.vector.into();
        self.shared.solids().iter().find(|(_, solid)| solid.contains(&p)).map(|(id, _)| *id)
    }

    /// Whether a point robot is inside a solid.
    pub(crate) fn point_inside(&self, pose: &Isometry3<f64>) -> bool {
        self.solid_around(pose).is_some()
    }

    pub(crate) fn count_clearance(&mut self) {
        self.counters.clearance_checks += 1;
    }

    /// Whether, at the middle of an interval of the motion between `ends` where surfaces are apart, something is inside of something.
    /// Asked once for a motion.
    pub(crate) fn is_nested_on(&mut self, ends: [Isometry3<f64>; 2], middle: &Isometry3<f64>) -> bool {
        if self.apart.is_some_and(|apart| apart == ends) {
            return false;
        }
        let shared = &*self.shared;
        let nested = shared.obstacles.scene.nested(&mut self.query, &shared.robot, middle).is_some()
            || self.point_inside(middle);
        self.apart = (!nested).then_some(ends);
        nested
    }

    /// The clearance of surfaces, beyond what is kept.
    pub(crate) fn surface_clearance(&mut self, pose: &Isometry3<f64>, enough: f64) -> f64 {
        self.counters.clearance_checks += 1;
        let (shared, query) = (&*self.shared, &mut self.query);
        let scene = &shared.obstacles.scene;
        beyond(self.kept, enough, |limit| scene.surface_clearance(query, &shared.robot, pose, limit).0)
    }

    fn collides(&mut self, pose: &Isometry3<f64>) -> bool {
        self.counters.collision_checks += 1;
        let shared = &*self.shared;
        let scene = &shared.obstacles.scene;
        let touches = match self.kept > 0.0 {
            true => scene.within(&mut self.query, &shared.robot, pose, self.kept),
            false => scene.collides(&mut self.query, &shared.robot, pose),
        };
        touches || self.point_inside(pose)
    }
}

impl<P: Placement> Validity<P::State> for RigidBody<P> {
    #[inline]
    fn is_valid(&mut self, q: &P::State) -> bool {
        !self.collides(&P::pose(q))
    }

    fn first_invalid(&mut self, states: &[P::State]) -> Option<usize> {
        if self.kept > 0.0 {
            return states.iter().position(|q| !self.is_valid(q));
        }
        self.poses.clear();
        self.poses.extend(states.iter().map(P::pose));
        let shared = &*self.shared;
        let hit = shared.obstacles.scene.first_collision(&mut self.query, &shared.robot, &self.poses);
        let hit = hit.map(|(i, _)| i);
        let tested = hit.map_or(states.len(), |i| i + 1);
        self.counters.collision_checks += tested as u64;
        self.poses[..tested].iter().position(|pose| self.point_inside(pose)).or(hit)
    }
}

impl<P: Placement> Clearance<P::State> for RigidBody<P> {
    fn clearance(&mut self, q: &P::State, enough: f64) -> f64 {
        self.counters.clearance_checks += 1;
        let pose = P::pose(q);
        let (shared, query) = (&*self.shared, &mut self.query);
        let scene = &shared.obstacles.scene;
        let clearance =
            beyond(self.kept, enough, |limit| scene.clearance(query, &shared.robot, &pose, limit).0);
        if self.point_inside(&pose) { 0.0 } else { clearance.max(0.0) }
    }

    fn in_contact(&mut self, q: &P::State) -> bool {
        self.collides(&P::pose(q))
    }
}

impl<P: Placement> MotionClearance<P::State> for RigidBody<P> {
    /// As [`Placement::travel`]: at most `‖Δp‖ + radius·θ`.
    #[inline]
    fn motion_bound(&self, from: &P::State, to: &P::State) -> f64 {
        P::travel(&self.shared.radii, from, to)
    }
    /// By one sweep over the interval. It takes into account how far each part of the body moves, and in which direction,
    /// so an interval shown free may be much longer than the clearance in its middle. The sweep ends at the first
    /// contact.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, P::State>) -> IntervalClearance {
        let MotionInterval { travel, margin, half, .. } = *interval;
        let [from, to, middle] = [interval.from, interval.to, interval.middle].map(P::pose);
        let long = travel > margin;
        if let Some(motion) = RigidMotion::of_motion(&from, &to, half, travel) {
            self.counters.clearance_checks += 1;
            let shared = &*self.shared;
            match shared.obstacles.scene.check_surfaces(
                &mut self.query,
                &shared.robot,
                &middle,
                &motion,
                margin + self.kept,
            ) {
                IntervalCheck::Free if self.is_nested_on([from, to], &middle) => {
                    return IntervalClearance::Collision { at: 0.0 };
                }
                IntervalCheck::Free => return IntervalClearance::Free { clearance: travel + margin },
                IntervalCheck::Collision { at } => return IntervalClearance::Collision { at },
                IntervalCheck::TooClose { at } => return IntervalClearance::TooClose { at },
                IntervalCheck::Unproven if long => return IntervalClearance::Unproven,
                IntervalCheck::Unproven => {}
            }
        }
        let clearance = self.surface_clearance(&middle, travel.max(margin) + margin);
        let nested = clearance > 0.0 && self.is_nested_on([from, to], &middle);
        IntervalClearance::of(if nested { 0.0 } else { clearance }, margin)
    }
    fn contact_first(&self) -> bool {
        true
    }
}
