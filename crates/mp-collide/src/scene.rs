//! Scenes of many named bodies.

use std::collections::BTreeSet;

use nalgebra::Isometry3;
use thiserror::Error;

use crate::broad::{Bounds, BroadPhase};
use crate::mesh::CollisionMesh;
use crate::pose::{LIMIT, Relative, to_world};
use crate::query::Query;

/// Names a body of one [`Scene`]; never used again after the body is removed.
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
    /// A coordinate of the mesh is beyond 1e75.
    #[error("the mesh of body \"{name}\" is too large: a coordinate is beyond 1e75")]
    TooLarge {
        /// The body's name.
        name: String,
    },
    /// No such body, or not any more.
    #[error("there is no body number {index} in the scene")]
    NoSuchBody {
        /// The number.
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
    bounds: Bounds,
    handle: usize,
}

impl Body {
    /// What it is called; several bodies may share a name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its mesh.
    #[must_use]
    pub fn mesh(&self) -> &CollisionMesh {
        &self.mesh
    }

    /// Its pose in the world.
    #[must_use]
    pub fn pose(&self) -> &Isometry3<f64> {
        &self.pose
    }

    /// Whether it is left out of [`Scene::merge_static`].
    #[must_use]
    pub fn is_movable(&self) -> bool {
        self.movable
    }
}

/// A body something is in contact with, and how deep.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The body.
    pub body: BodyId,
    /// Its name.
    pub name: String,
    /// An estimate of the penetration depth (metres), see [`Query::depth`].
    pub depth: f64,
}

/// All static bodies as one mesh in the world.
#[derive(Clone, Debug)]
struct Merged {
    mesh: CollisionMesh,
    /// The first triangle of each body, with the body; ascending.
    starts: Vec<(usize, BodyId)>,
}

impl Merged {
    fn owner(&self, triangle: usize) -> BodyId {
        let after = self.starts.partition_point(|(start, _)| *start <= triangle);
        self.starts[after - 1].1
    }
}

/// Many named bodies, with a broad phase and pairs that are allowed to touch.
///
/// Changing a scene takes `&mut`; queries take `&` and a [`Query`] per thread. A moving mesh that is asked
/// about need not be a body of the scene. What counts as in collision with everything (see the crate docs)
/// collides with every body here too.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    bodies: Vec<Option<Body>>,
    broad: BroadPhase,
    allowed: BTreeSet<(BodyId, BodyId)>,
    merged: Option<Merged>,
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
        let bounds = placed(&name, &mesh, &pose)?;
        let index = u32::try_from(self.bodies.len()).map_err(|_| SceneError::Full)?;
        let handle = self.broad.insert(index, bounds);
        self.bodies.push(Some(Body { name, mesh, pose, movable, bounds, handle }));
        if !movable {
            self.merged = None;
        }
        Ok(BodyId(index))
    }

    /// Puts a body elsewhere. Moving a static body undoes [`Scene::merge_static`].
    ///
    /// # Errors
    /// [`SceneError::NoSuchBody`], [`SceneError::BadPose`]; the scene is then as before.
    pub fn move_body(&mut self, id: BodyId, pose_wb: Isometry3<f64>) -> Result<(), SceneError> {
        let Some(body) = self.bodies.get_mut(id.index()).and_then(Option::as_mut) else {
            return Err(SceneError::NoSuchBody { index: id.index() });
        };
        body.bounds = placed(&body.name, &body.mesh, &pose_wb)?;
        body.pose = pose_wb;
        self.broad.remove(body.handle);
        body.handle = self.broad.insert(id.0, body.bounds);
        if !body.movable {
            self.merged = None;
        }
        Ok(())
    }

    /// Takes a body out; `None` when there is no such body. Removing a static body undoes
    /// [`Scene::merge_static`].
    pub fn remove(&mut self, id: BodyId) -> Option<Body> {
        let body = self.bodies.get_mut(id.index())?.take()?;
        self.broad.remove(body.handle);
        self.allowed.retain(|(x, y)| *x != id && *y != id);
        if !body.movable {
            self.merged = None;
        }
        Some(body)
    }

    /// A body.
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

    /// Lets two bodies touch and overlap from now on (`allowed`), or forbids it again. It is about
    /// [`Scene::colliding_pairs`] and [`Scene::body_collides`] only.
    pub fn allow_pair(&mut self, x: BodyId, y: BodyId, allowed: bool) {
        let pair = (x.min(y), x.max(y));
        if allowed {
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
    /// Adding, moving or removing a static body undoes it; call it again afterwards. The vertices of the
    /// merged mesh are rounded to the world frame, so answers may differ by that rounding. Does nothing when
    /// there are no static bodies, or more than `u32::MAX` triangles.
    pub fn merge_static(&mut self) {
        let (mut starts, mut triangles) = (Vec::new(), Vec::new());
        for (id, body) in self.bodies().filter(|(_, body)| !body.movable) {
            starts.push((triangles.len(), id));
            triangles.extend(body.mesh.triangles().iter().map(|t| t.map(|p| to_world(&body.pose, &p))));
        }
        self.merged = None;
        if !triangles.is_empty() && u32::try_from(triangles.len()).is_ok() {
            let mesh = CollisionMesh::from_triangles(triangles);
            // Far away and huge together may be beyond the limit where each alone is not.
            self.merged = (mesh.radius() <= LIMIT).then_some(Merged { mesh, starts });
        }
    }

    /// Whether static bodies are merged at the moment.
    #[must_use]
    pub fn is_merged(&self) -> bool {
        self.merged.is_some()
    }

    /// A body that `mesh` at `pose_wm` collides with: the first one found, always the same. Touching counts.
    pub fn collide_body(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Option<BodyId> {
        if let Some(merged) = &self.merged {
            let hit = query.intersecting_triangles(mesh, pose_wm, &merged.mesh, &Isometry3::identity());
            if let Some((_, triangle)) = hit {
                return Some(merged.owner(triangle));
            }
        }
        self.near(mesh, pose_wm, |id, body| {
            let done = self.merged.is_some() && !body.movable;
            (!done && query.intersects(mesh, pose_wm, &body.mesh, &body.pose)).then_some(id)
        })
    }

    /// Whether `mesh` at `pose_wm` collides with any body.
    pub fn collides(&self, query: &mut Query, mesh: &CollisionMesh, pose_wm: &Isometry3<f64>) -> bool {
        self.collide_body(query, mesh, pose_wm).is_some()
    }

    /// The index of the first of `poses_wm` at which `mesh` collides with a body, and the body.
    pub fn first_collision(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        poses_wm: &[Isometry3<f64>],
    ) -> Option<(usize, BodyId)> {
        poses_wm
            .iter()
            .enumerate()
            .find_map(|(i, pose_wm)| Some((i, self.collide_body(query, mesh, pose_wm)?)))
    }

    /// A body of the scene that body `id` collides with, allowed pairs apart: the first one found, always
    /// the same. `None` when there is none, or no body `id`.
    pub fn body_collides(&self, query: &mut Query, id: BodyId) -> Option<BodyId> {
        let body = self.body(id)?;
        self.near(&body.mesh, &body.pose, |other_id, other| {
            (other_id != id
                && !self.is_allowed(id, other_id)
                && query.intersects(&body.mesh, &body.pose, &other.mesh, &other.pose))
            .then_some(other_id)
        })
    }

    /// A lower bound on the distance from `mesh` at `pose_wm` to the scene, exact when below `enough`
    /// (metres), and the nearest body in that case; otherwise some value of at least `enough` and no body.
    /// 0 exactly when it collides. An empty scene is infinitely far away.
    pub fn clearance(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        enough: f64,
    ) -> (f64, Option<BodyId>) {
        let Some(own) = bounds(mesh, pose_wm) else {
            return match self.bodies().next() {
                Some((id, _)) => (0.0, Some(id)),
                None => (f64::INFINITY, None),
            };
        };
        let mut nearest = Nearest {
            query,
            limit: if enough.is_nan() { f64::INFINITY } else { enough },
            body: None,
            beyond: f64::INFINITY,
        };
        if let Some(merged) = &self.merged {
            nearest.look(mesh, pose_wm, &merged.mesh, &Isometry3::identity(), |t| merged.owner(t));
        }
        let passed_over = self.broad.nearest(&own, nearest.limit, |item| {
            if let Some(body) = &self.bodies[item as usize]
                && (self.merged.is_none() || body.movable)
            {
                nearest.look(mesh, pose_wm, &body.mesh, &body.pose, |_| BodyId(item));
            }
            nearest.limit
        });
        match nearest.body {
            Some(body) => (nearest.limit, Some(body)),
            None => (nearest.beyond.min(passed_over), None),
        }
    }

    /// All bodies that `mesh` at `pose_wm` collides with, in the order of insertion, with an estimate of
    /// the depth. For messages: it takes thousands of times longer than [`Scene::collides`].
    pub fn contacts(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Vec<Contact> {
        let mut contacts = Vec::new();
        let _: Option<()> = self.near(mesh, pose_wm, |id, body| {
            if query.intersects(mesh, pose_wm, &body.mesh, &body.pose) {
                let depth = query.depth(mesh, pose_wm, &body.mesh, &body.pose);
                contacts.push(Contact { body: id, name: body.name.clone(), depth });
            }
            None
        });
        contacts.sort_by_key(|contact| contact.body);
        contacts
    }

    /// All pairs of bodies that collide and are not allowed to, in ascending order.
    pub fn colliding_pairs(&self, query: &mut Query) -> Vec<(BodyId, BodyId)> {
        // Sweep and prune along x.
        let mut sorted: Vec<(BodyId, &Body)> = self.bodies().collect();
        sorted.sort_by(|(_, x), (_, y)| x.bounds.min.x.total_cmp(&y.bounds.min.x));
        let mut pairs = Vec::new();
        for (i, (id, body)) in sorted.iter().enumerate() {
            let reach =
                sorted[i + 1..].iter().take_while(|(_, other)| other.bounds.min.x <= body.bounds.max.x);
            for (other_id, other) in reach {
                if body.bounds.overlaps(&other.bounds)
                    && !self.is_allowed(*id, *other_id)
                    && query.intersects(&body.mesh, &body.pose, &other.mesh, &other.pose)
                {
                    pairs.push((*id.min(other_id), *id.max(other_id)));
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }

    /// Visits the bodies whose boxes overlap the box of the mesh, until `visit` returns something; all
    /// bodies when the mesh has no place in the world.
    fn near<T>(
        &self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        mut visit: impl FnMut(BodyId, &Body) -> Option<T>,
    ) -> Option<T> {
        let own = bounds(mesh, pose_wm);
        self.broad.find(
            |bounds| own.is_none_or(|own| own.overlaps(bounds)),
            |item| visit(BodyId(item), self.bodies[item as usize].as_ref()?),
        )
    }
}

/// The search for the nearest body.
struct Nearest<'q> {
    query: &'q mut Query,
    /// The distance to `body`; while there is none, the distance that is enough.
    limit: f64,
    body: Option<BodyId>,
    /// All bodies looked at and found beyond the limit are at least this far away.
    beyond: f64,
}

impl Nearest<'_> {
    fn look(
        &mut self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        other: &CollisionMesh,
        pose_wo: &Isometry3<f64>,
        owner: impl Fn(usize) -> BodyId,
    ) {
        if self.limit == 0.0 && self.body.is_some() {
            return;
        }
        self.query.counters.queries += 1;
        let (clearance, triangle) = match Relative::between(pose_wm, mesh.radius(), pose_wo, other.radius()) {
            Some(relative) => self.query.clearance_with(mesh.tree(), other.tree(), &relative, self.limit),
            None => (0.0, Some(0)),
        };
        match triangle {
            Some(position) if clearance < self.limit || clearance == 0.0 => {
                self.limit = clearance;
                self.body = Some(owner(other.tree().ids[position] as usize));
            }
            _ => self.beyond = self.beyond.min(clearance),
        }
    }
}

/// The box in the world of a mesh at a pose, a little enlarged so that rounding never cuts anything off;
/// `None` when mesh or pose are beyond the limits.
fn bounds(mesh: &CollisionMesh, pose: &Isometry3<f64>) -> Option<Bounds> {
    let relative = Relative::between(&Isometry3::identity(), 0.0, pose, mesh.radius())?;
    let obb = relative.obb(&mesh.tree().bounding);
    let half = obb.aligned_half().add_scalar(relative.slack);
    let (min, max) = (obb.center - half, obb.center + half);
    Some(Bounds { min, max })
}

fn placed(name: &str, mesh: &CollisionMesh, pose: &Isometry3<f64>) -> Result<Bounds, SceneError> {
    if mesh.radius() > LIMIT {
        return Err(SceneError::TooLarge { name: name.into() });
    }
    bounds(mesh, pose).ok_or_else(|| SceneError::BadPose { name: name.into() })
}
