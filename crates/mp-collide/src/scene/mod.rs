//! Scenes of many named bodies: what is in them. Queries are in `queries`, `motion` and `pairs`.

mod boxes;
mod merged;
mod motion;
mod pairs;
mod queries;

use std::collections::BTreeSet;

use mp_geom::Aabb;
use mp_stop::{Interrupt, Interrupted};
use nalgebra::Isometry3;
use thiserror::Error;

use crate::around::{Around, Outline};
use crate::broad::BroadPhase;
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::{LIMIT, Relative};
use merged::Merged;

/// The name of a body in one [`Scene`]; not reused after the body is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(u32);

impl BodyId {
    /// Bodies are numbered from 0 in the order of their insertion.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Why a scene could not be changed.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A pose has a component that is not finite, is too large, or its quaternion is not of unit length.
    #[error("the pose of body \"{name}\" is not a finite rigid motion")]
    BadPose {
        /// The body's name.
        name: String,
    },
    /// A coordinate of the mesh is beyond 1e75, or not a number (the mesh was moved by a pose that is not finite).
    #[error("the mesh of body \"{name}\" is too large: a coordinate is beyond 1e75 or not a number")]
    TooLarge {
        /// The body's name.
        name: String,
    },
    /// No such body, or not any more.
    #[error("there is no body number {index} in the scene")]
    NoSuchBody {
        /// The index that was asked for, counted from 0.
        index: usize,
    },
    /// More bodies than can be numbered.
    #[error("the scene has too many bodies")]
    Full,
}

/// A mesh with a name and a place in the world.
#[derive(Clone, Debug)]
pub struct Body {
    name: String,
    mesh: CollisionMesh,
    pose: Isometry3<f64>,
    movable: bool,
    bounds: Aabb,
    /// What is around it in the world, turned as its mesh is.
    around: Around,
    handle: usize,
}

impl Body {
    /// What it is called; several bodies may share a name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its triangles, in its own frame.
    #[must_use]
    pub fn mesh(&self) -> &CollisionMesh {
        &self.mesh
    }

    /// Its pose in the world.
    #[must_use]
    pub fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Whether it is left out of [`Scene::merge_static`], as all clouds are.
    #[must_use]
    pub fn is_movable(&self) -> bool {
        self.movable
    }

    fn posed(&self) -> PosedMesh<'_> {
        (&self.mesh, &self.pose)
    }
}

/// A body something is in contact with, and how deep.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The body that is touched.
    pub body: BodyId,
    /// The name of the body.
    pub name: String,
    /// An estimate of the penetration depth (metres), see [`Query::depth`](crate::Query::depth).
    pub depth: f64,
}

/// Many named bodies, with a broad phase and pairs that are allowed to touch.
///
/// Changing a scene takes `&mut`; queries take `&` and a [`Query`](crate::Query) per thread. A clone shares
/// the meshes and their trees, the merged ones too. The mesh of a query need not be a body of the scene. Meshes are
/// surfaces, but those that are [filled](CollisionMesh::filled) also collide with what is wholly inside of them. What
/// counts as in collision with everything (see the crate docs) collides with every body here too.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    bodies: Vec<Option<Body>>,
    /// The static bodies and the movable ones.
    fixed: BroadPhase,
    movable: BroadPhase,
    allowed: BTreeSet<(BodyId, BodyId)>,
    /// All static bodies, or nothing.
    merged: Option<Merged>,
    /// How many bodies are filled.
    filled: usize,
}

impl Scene {
    /// An empty scene.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a static body at `pose_wb` in the world.
    ///
    /// # Errors
    /// [`SceneError::BadPose`], [`SceneError::TooLarge`], [`SceneError::Full`].
    pub fn insert(
        &mut self,
        name: impl Into<String>,
        mesh: CollisionMesh,
        pose_wb: Isometry3<f64>,
    ) -> Result<BodyId, SceneError> {
        self.add(name.into(), mesh, pose_wb, false)
    }

    /// Adds a body that will move: as [`Scene::insert`], but it is left out of [`Scene::merge_static`].
    ///
    /// # Errors
    /// As [`Scene::insert`].
    pub fn insert_movable(
        &mut self,
        name: impl Into<String>,
        mesh: CollisionMesh,
        pose_wb: Isometry3<f64>,
    ) -> Result<BodyId, SceneError> {
        self.add(name.into(), mesh, pose_wb, true)
    }

    fn add(
        &mut self,
        name: String,
        mesh: CollisionMesh,
        pose: Isometry3<f64>,
        movable: bool,
    ) -> Result<BodyId, SceneError> {
        // A cloud has a tree of its own kind.
        let movable = movable || mesh.cloud.is_some();
        let outline = *mesh.outline.get_or_init(|| Outline::of(&mesh));
        let (bounds, around) = placed(&name, &mesh, outline, &pose)?;
        let index = u32::try_from(self.bodies.len()).map_err(|_| SceneError::Full)?;
        let handle = self.broad_phase(movable).insert(index, bounds);
        self.filled += usize::from(mesh.is_filled());
        self.bodies.push(Some(Body { name, mesh, pose, movable, bounds, around, handle }));
        self.changed(movable);
        Ok(BodyId(index))
    }

    fn broad_phase(&mut self, movable: bool) -> &mut BroadPhase {
        if movable { &mut self.movable } else { &mut self.fixed }
    }

    /// Undoes merging when a static body has changed.
    fn changed(&mut self, movable: bool) {
        if !movable {
            self.merged = None;
        }
    }

    /// Puts a body elsewhere. Moving a static body undoes [`Scene::merge_static`].
    ///
    /// # Errors
    /// [`SceneError::NoSuchBody`], [`SceneError::BadPose`]; the scene is then as before.
    pub fn move_body(&mut self, id: BodyId, pose_wb: Isometry3<f64>) -> Result<(), SceneError> {
        let Some(body) = self.bodies.get_mut(id.index()).and_then(Option::as_mut) else {
            return Err(SceneError::NoSuchBody { index: id.index() });
        };
        (body.bounds, body.around) = placed(&body.name, &body.mesh, body.around.outline, &pose_wb)?;
        body.pose = pose_wb;
        let broad = if body.movable { &mut self.movable } else { &mut self.fixed };
        broad.remove(body.handle);
        body.handle = broad.insert(id.0, body.bounds);
        let movable = body.movable;
        self.changed(movable);
        Ok(())
    }

    /// Takes a body out; `None` when there is no such body. Removing a static body undoes
    /// [`Scene::merge_static`].
    pub fn remove(&mut self, id: BodyId) -> Option<Body> {
        let body = self.bodies.get_mut(id.index())?.take()?;
        self.broad_phase(body.movable).remove(body.handle);
        self.filled -= usize::from(body.mesh.is_filled());
        self.allowed.retain(|(x, y)| *x != id && *y != id);
        self.changed(body.movable);
        Some(body)
    }

    /// The body of this number; `None` if it was removed.
    #[must_use]
    pub fn body(&self, id: BodyId) -> Option<&Body> {
        self.bodies.get(id.index())?.as_ref()
    }

    /// All bodies, in the order of insertion.
    pub fn bodies(&self) -> impl Iterator<Item = (BodyId, &Body)> {
        (0..).zip(&self.bodies).filter_map(|(i, body)| Some((BodyId(i), body.as_ref()?)))
    }

    /// The first body of this name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<BodyId> {
        self.bodies().find(|(_, body)| body.name == name).map(|(id, _)| id)
    }

    /// How many bodies there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bodies().count()
    }

    /// Whether there is no body.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bodies().next().is_none()
    }

    /// Allows two bodies to touch and overlap (`allowed`), or forbids it again. Only [`Scene::colliding_pairs`] and
    /// [`Scene::body_collides`] are affected; without such bodies it has no effect.
    pub fn allow_pair(&mut self, x: BodyId, y: BodyId, allowed: bool) {
        let pair = (x.min(y), x.max(y));
        if allowed && self.body(x).is_some() && self.body(y).is_some() {
            self.allowed.insert(pair);
        } else {
            self.allowed.remove(&pair);
        }
    }

    /// Whether two bodies may overlap.
    #[must_use]
    pub fn is_allowed(&self, x: BodyId, y: BodyId) -> bool {
        self.allowed.contains(&(x.min(y), x.max(y)))
    }

    /// Makes one tree of all static bodies, which is faster to query; answers still name the body.
    ///
    /// Adding, moving or removing a static body undoes it; call it again afterwards. The vertices of the merged
    /// mesh are rounded to the world frame, so answers may differ by that rounding. Does nothing when there are no static
    /// bodies, or their coordinates in the world are beyond 1e75, or they have more than `u32::MAX` triangles.
    pub fn merge_static(&mut self) {
        // Nothing ends it.
        let _: Result<(), Interrupted> = self.merge_static_until(&Interrupt::never());
    }

    /// As [`merge_static`](Self::merge_static), unless `interrupt` says to end.
    ///
    /// # Errors
    /// When it was interrupted. Then nothing is merged.
    pub fn merge_static_until(&mut self, interrupt: &Interrupt) -> Result<(), Interrupted> {
        let (fixed, mut interrupt): (Vec<_>, _) =
            (self.bodies().filter(|(_, body)| !body.movable).collect(), interrupt.clone());
        self.merged = Merged::of(&fixed, || interrupt.go_on())?;
        Ok(())
    }

    /// Whether static bodies are merged at the moment.
    #[must_use]
    pub fn is_merged(&self) -> bool {
        self.merged.is_some()
    }
}

/// The box in the world of a mesh at a pose, a little enlarged so that rounding never cuts anything off;
/// `None` when mesh or pose are beyond the limits.
pub(crate) fn bounds(mesh: &CollisionMesh, pose: &Isometry3<f64>) -> Option<Aabb> {
    let relative = Relative::between(&Isometry3::identity(), 0.0, pose, mesh.radius())?;
    let obb = relative.obb(&mesh.tree().bounding);
    let half = obb.aligned_half().add_scalar(relative.slack + mesh.rounding());
    Some(Aabb::new(obb.center - half, obb.center + half))
}

/// The boxes around a body: along the axes, and turned as its mesh is.
fn placed(
    name: &str,
    mesh: &CollisionMesh,
    outline: Outline,
    pose: &Isometry3<f64>,
) -> Result<(Aabb, Around), SceneError> {
    if mesh.radius() > LIMIT {
        return Err(SceneError::TooLarge { name: name.into() });
    }
    let both = bounds(mesh, pose).zip(Around::new(mesh, outline, pose));
    both.ok_or_else(|| SceneError::BadPose { name: name.into() })
}
