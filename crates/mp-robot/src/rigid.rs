//! A rigid body among obstacles that stand still.

use crate::outlines::Outlines;
use crate::solid::Solid;
use crate::{Placement, Planar, Point, Shape, Spatial};
use mp_collide::reference::RefMesh;
use mp_collide::{BodyId, CollisionMesh, Counters, IntervalCheck, Query, RigidMotion, Scene, SceneError};
use mp_cspace::{Clearance, IntervalClearance, MotionClearance, MotionInterval, Validity};
use mp_geom::{Aabb, MeshError, TriMesh};
use nalgebra::{Isometry3, Point3};
use std::marker::PhantomData;
use std::sync::{Arc, OnceLock};
use thiserror::Error;

/// Why a robot could not be put among its obstacles.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RobotError {
    /// An obstacle's pose is no pose, or its mesh is too large.
    #[error("cannot place an obstacle: {0}")]
    Obstacle(#[from] SceneError),
    /// A mesh that is none.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// More triangles than trees can name.
    #[error("robot and obstacles have {count} triangles; at most {max} can be handled")]
    TooManyTriangles {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// The robot is too large to compute with.
    #[error("the robot is too large: {radius:e} m from its origin; at most {max:e} m can be handled")]
    TooLarge {
        /// Its largest distance from the origin of its frame.
        radius: f64,
        /// The largest possible.
        max: f64,
    },
}

/// How much checking was done: the same for the same questions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct CheckCounters {
    /// Configurations tested for collision.
    pub collision_checks: u64,
    /// Configurations whose clearance was asked.
    pub clearance_checks: u64,
    /// What that cost in boxes and triangles.
    pub work: Counters,
}

impl std::ops::AddAssign for CheckCounters {
    fn add_assign(&mut self, other: Self) {
        self.collision_checks += other.collision_checks;
        self.clearance_checks += other.clearance_checks;
        self.work += other.work;
    }
}

/// What never changes: shared by all clones.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) robot_mesh: TriMesh,
    pub(crate) robot: CollisionMesh,
    pub(crate) shape: Shape,
    pub(crate) scene: Scene,
    /// Made when first asked for.
    solids: OnceLock<Vec<(BodyId, Solid)>>,
    /// Every obstacle in the world.
    pub(crate) placed: Vec<(BodyId, Arc<TriMesh>)>,
    pub(crate) world_bounds: Aabb,
    /// For verifiers, made when the first one is.
    pub(crate) reference: OnceLock<Reference>,
    /// Made when first asked for.
    pub(crate) outlines: OnceLock<Outlines>,
}

impl Shared {
    /// The obstacles that are solids.
    pub(crate) fn solids(&self) -> &[(BodyId, Solid)] {
        self.solids.get_or_init(|| {
            let named = self.placed.iter().filter_map(|(id, mesh)| {
                let name = self.scene.body(*id)?.name();
                Some((*id, Solid::new(name, mesh)?))
            });
            named.collect()
        })
    }
}

/// Robot and obstacles as verifiers see them.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    pub(crate) robot: Arc<RefMesh>,
    pub(crate) world: Option<Arc<RefMesh>>,
}

/// A rigid body among named obstacles that stand still.
///
/// A configuration is free when the surfaces of robot and obstacles have no point in common: touching is
/// collision, and a robot wholly inside a closed obstacle is free, as in a room, though it can never leave.
/// Only a [`PointRobot`] is in collision inside a solid: see there.
///
/// Meshes and trees are shared between clones; counters and scratch memory are each clone's own, so clone
/// it per thread.
#[derive(Clone, Debug)]
pub struct RigidBody<P: Placement> {
    pub(crate) shared: Arc<Shared>,
    pub(crate) query: Query,
    counters: CheckCounters,
    poses: Vec<Isometry3<f64>>,
    placement: PhantomData<P>,
}

/// A mesh moving freely in space. Configurations are poses of its frame in the world.
pub type FreeFlyer = RigidBody<Spatial>;

/// A mesh moving in the plane z = 0 and turning about Z, among obstacles of any height.
pub type PlanarFlyer = RigidBody<Planar>;

/// A point moving in space.
///
/// A point meets a surface only by rare chance, so here the inside counts too: of obstacles that are solids
/// (closed, consistently oriented, triangles facing outward). Rooms, whose triangles face inward, and
/// open sheets are surfaces as for all robots: there only certified motion checks are of use.
pub type PointRobot = RigidBody<Point>;

/// Most triangles: what a reference mesh can hold.
const MAX_TRIANGLES: usize = 1 << 30;

/// Largest robot, metres.
const MAX_RADIUS: f64 = 1e75;

impl FreeFlyer {
    /// `robot`, in its own frame, among obstacles: name, mesh and pose in the world each.
    ///
    /// # Errors
    /// When a pose is no rigid motion, or a mesh is too large to compute with.
    pub fn new(
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among(robot, obstacles)
    }
}

impl PlanarFlyer {
    /// `robot`, in its own frame, among obstacles: name, mesh and pose in the world each.
    ///
    /// # Errors
    /// When a pose is no rigid motion, or a mesh is too large to compute with.
    pub fn new(
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among(robot, obstacles)
    }
}

impl PointRobot {
    /// A point among obstacles: name, mesh and pose in the world each.
    ///
    /// # Errors
    /// When a pose is no rigid motion, or a mesh is too large to compute with.
    pub fn new(
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        Self::among(&TriMesh::from_soup(&[[Point3::origin(); 3]])?, obstacles)
    }
}

impl<P: Placement> RigidBody<P> {
    /// `robot`, in its own frame, among obstacles: name, mesh and pose in the world each. For code that is
    /// generic over the placement; else use `FreeFlyer::new` and its kin.
    ///
    /// # Errors
    /// When a pose is no rigid motion, or a mesh is too large to compute with.
    pub fn among(
        robot: &TriMesh,
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
    ) -> Result<Self, RobotError> {
        let shape = Shape::of(robot);
        if shape.radius > MAX_RADIUS {
            return Err(RobotError::TooLarge { radius: shape.radius, max: MAX_RADIUS });
        }
        let mut scene = Scene::new();
        let mut placed = Vec::new();
        let mut count = robot.triangles().len();
        for (name, mesh, pose) in obstacles {
            count = count.saturating_add(mesh.triangles().len());
            if count > MAX_TRIANGLES {
                return Err(RobotError::TooManyTriangles { count, max: MAX_TRIANGLES });
            }
            let in_world = Arc::new(mesh.transformed(&pose));
            let id = scene.insert(name, CollisionMesh::new(&mesh), pose)?;
            placed.push((id, in_world));
        }
        scene.merge_static();
        let shared = Shared {
            robot_mesh: robot.clone(),
            robot: CollisionMesh::new(robot),
            shape,
            scene,
            solids: OnceLock::new(),
            world_bounds: placed.iter().map(|(_, mesh)| mesh.aabb()).fold(Aabb::empty(), |a, b| a.union(&b)),
            placed,
            reference: OnceLock::new(),
            outlines: OnceLock::new(),
        };
        Ok(Self {
            shared: Arc::new(shared),
            query: Query::default(),
            counters: CheckCounters::default(),
            poses: Vec::new(),
            placement: PhantomData,
        })
    }

    /// The robot, in its own frame.
    #[must_use]
    pub fn mesh(&self) -> &TriMesh {
        &self.shared.robot_mesh
    }

    /// What motion bounds know of the robot.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shared.shape
    }

    /// The largest distance of a point of the robot from the origin of its frame, metres.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.shared.shape.radius
    }

    /// The obstacles, by name.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.shared.scene
    }

    /// The box around all obstacles; empty when there are none.
    #[must_use]
    pub fn obstacle_bounds(&self) -> Aabb {
        self.shared.world_bounds
    }

    /// What was done so far by this clone.
    #[must_use]
    pub fn counters(&self) -> CheckCounters {
        CheckCounters { work: self.query.counters, ..self.counters }
    }

    /// Starts counting anew, returning the counts so far.
    pub fn take_counters(&mut self) -> CheckCounters {
        let counters = self.counters();
        self.counters = CheckCounters::default();
        self.query.counters = Counters::default();
        counters
    }

    /// The default tolerance (m) of certified motion checks, to the scale of the robot: 1e-4 of its radius
    /// (for a point, 1e-6 of the size of the obstacles), and never so small that coordinates could
    /// not resolve it. A [`Verifier`](crate::Verifier) works to a tenth of it, so that it proves whatever
    /// [`Certified`](mp_cspace::Certified) accepts at this tolerance.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        let bounds = &self.shared.world_bounds;
        let (size, far) = if bounds.is_empty() {
            (0.0, 0.0)
        } else {
            (bounds.diagonal(), bounds.min.coords.amax().max(bounds.max.coords.amax()))
        };
        let radius = self.shared.shape.radius;
        let wanted = if radius > 0.0 { 1e-4 * radius } else { 1e-6 * size };
        let tolerance = wanted.max(1e-9 * (far + radius));
        if tolerance > 0.0 { tolerance } else { 1e-6 }
    }

    /// The solid that a point robot is inside of.
    pub(crate) fn solid_around(&self, pose: &Isometry3<f64>) -> Option<BodyId> {
        if self.shared.shape.radius > 0.0 {
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

    fn collides(&mut self, pose: &Isometry3<f64>) -> bool {
        self.counters.collision_checks += 1;
        let shared = &*self.shared;
        shared.scene.collides(&mut self.query, &shared.robot, pose) || self.point_inside(pose)
    }
}

impl<P: Placement> Validity<P::State> for RigidBody<P> {
    #[inline]
    fn is_valid(&mut self, q: &P::State) -> bool {
        !self.collides(&P::pose(q))
    }

    fn first_invalid(&mut self, states: &[P::State]) -> Option<usize> {
        self.poses.clear();
        self.poses.extend(states.iter().map(P::pose));
        let shared = &*self.shared;
        let hit = shared.scene.first_collision(&mut self.query, &shared.robot, &self.poses);
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
        let shared = &*self.shared;
        let (clearance, _) = shared.scene.clearance(&mut self.query, &shared.robot, &pose, enough);
        if self.point_inside(&pose) { 0.0 } else { clearance }
    }

    fn in_contact(&mut self, q: &P::State) -> bool {
        self.collides(&P::pose(q))
    }
}

impl<P: Placement> MotionClearance<P::State> for RigidBody<P> {
    /// As [`Placement::travel`]: at most `‖Δp‖ + radius·θ`.
    #[inline]
    fn motion_bound(&self, from: &P::State, to: &P::State) -> f64 {
        P::travel(&self.shared.shape, from, to)
    }
    /// By one sweep over the interval, in which each part of the body moves as far as it does and as it does
    /// toward the obstacles: an interval found clear so may be much longer than the clearance in its middle. The sweep
    /// ends where it comes upon contact.
    fn interval_clearance(&mut self, interval: &MotionInterval<'_, P::State>) -> IntervalClearance {
        let MotionInterval { travel, margin, half, .. } = *interval;
        let [from, to, middle] = [interval.from, interval.to, interval.middle].map(P::pose);
        let long = travel > margin;
        if let Some(motion) = RigidMotion::of_motion(&from, &to, half, travel) {
            self.counters.clearance_checks += 1;
            let shared = &*self.shared;
            match shared.scene.check_interval(&mut self.query, &shared.robot, &middle, &motion, margin) {
                IntervalCheck::Free if self.point_inside(&middle) => {
                    return IntervalClearance::Collision { at: 0.0 };
                }
                IntervalCheck::Free => return IntervalClearance::Free { clearance: travel + margin },
                IntervalCheck::Collision { at } => return IntervalClearance::Collision { at },
                IntervalCheck::TooClose { at } => return IntervalClearance::TooClose { at },
                IntervalCheck::Unproven if long => return IntervalClearance::Unproven,
                IntervalCheck::Unproven => {}
            }
        }
        let clearance = self.clearance(interval.middle, travel.max(margin) + margin);
        IntervalClearance::of(clearance, margin)
    }
    fn contact_first(&self) -> bool {
        true
    }
}
