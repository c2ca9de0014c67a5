//! A scene as seen by a mesh of some groups: the queries.

use nalgebra::Isometry3;

use super::nearest::Nearest;
use super::{Body, BodyId, Contact, Groups, Scene, bounds};
use crate::broad::BroadPhase;
use crate::mesh::CollisionMesh;
use crate::query::Query;

/// The bodies of a [`Scene`] that a mesh of some [`Groups`] is compared with; made by [`Scene::view`].
///
/// The queries are those of [`Scene`], which are this with [`Groups::ALL`].
#[derive(Clone, Copy, Debug)]
pub struct View<'s> {
    pub(super) scene: &'s Scene,
    pub(super) groups: Groups,
}

impl View<'_> {
    /// The groups.
    #[must_use]
    pub fn groups(&self) -> Groups {
        self.groups
    }

    /// A body that `mesh` at `pose_wm` collides with: the first one found, always the same. Touching counts.
    pub fn collide_body(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Option<BodyId> {
        for merged in self.scene.merged.iter().filter(|merged| merged.groups.meets(self.groups)) {
            let hit = query.intersecting_triangles(mesh, pose_wm, &merged.mesh, &Isometry3::identity());
            if let Some((_, triangle)) = hit {
                return Some(merged.owner(triangle));
            }
        }
        self.near(mesh, pose_wm, !self.scene.is_merged(), |id, body| {
            query.intersects(mesh, pose_wm, &body.mesh, &body.pose).then_some(id)
        })
        .or_else(|| self.nested(query, mesh, pose_wm))
    }

    /// A body that is inside of `mesh` or around it, in whole or in part, one of the two being filled, where no
    /// surfaces meet.
    pub(super) fn nested(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Option<BodyId> {
        if self.scene.filled == 0 && !mesh.is_filled() {
            return None;
        }
        self.near(mesh, pose_wm, true, |id, body| {
            query.nested(mesh, pose_wm, &body.mesh, &body.pose).then_some(id)
        })
    }

    /// Whether `mesh` at `pose_wm` collides with any body.
    pub fn collides(&self, query: &mut Query, mesh: &CollisionMesh, pose_wm: &Isometry3<f64>) -> bool {
        let mut merged = self.scene.merged.iter().filter(|merged| merged.groups.meets(self.groups));
        // Any pair of triangles will do here, and that is found sooner than always the same.
        merged.any(|merged| query.intersects(mesh, pose_wm, &merged.mesh, &Isometry3::identity()))
            || self
                .near(mesh, pose_wm, !self.scene.is_merged(), |_, body| {
                    query.intersects(mesh, pose_wm, &body.mesh, &body.pose).then_some(())
                })
                .is_some()
            || self.nested(query, mesh, pose_wm).is_some()
    }

    /// A lower bound on the distance from `mesh` at `pose_wm` to the bodies, exact when below `enough`
    /// (metres), and the nearest body in that case; otherwise some value of at least `enough` and no body.
    /// 0 exactly when it collides. Infinity when there are no bodies.
    pub fn clearance(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        enough: f64,
    ) -> (f64, Option<BodyId>) {
        let mut nearest = Nearest {
            query,
            limit: if enough.is_nan() { f64::INFINITY } else { enough },
            body: None,
            beyond: f64::INFINITY,
        };
        let scene = self.scene;
        for merged in scene.merged.iter().filter(|merged| merged.groups.meets(self.groups)) {
            nearest.look(mesh, pose_wm, &merged.mesh, &Isometry3::identity(), |t| merged.owner(t));
        }
        for broad in self.phases(!scene.is_merged()) {
            let Some(own) = bounds(mesh, pose_wm) else {
                return match self.bodies().next() {
                    Some((id, _)) => (0.0, Some(id)),
                    None => (f64::INFINITY, None),
                };
            };
            let passed_over = broad.nearest(&own, nearest.limit, |item| {
                if let Some(body) = &scene.bodies[item as usize]
                    && body.groups.meets(self.groups)
                {
                    nearest.look(mesh, pose_wm, &body.mesh, &body.pose, |_| BodyId(item));
                }
                nearest.limit
            });
            nearest.beyond = nearest.beyond.min(passed_over);
        }
        let found = match nearest.body {
            Some(body) => (nearest.limit, Some(body)),
            None => (nearest.beyond, None),
        };
        let nested = if found.0 > 0.0 { self.nested(query, mesh, pose_wm) } else { None };
        nested.map_or(found, |id| (0.0, Some(id)))
    }

    /// The bodies, in the order of insertion.
    pub fn bodies(&self) -> impl Iterator<Item = (BodyId, &Body)> {
        self.scene.bodies().filter(|(_, body)| body.groups.meets(self.groups))
    }

    /// All bodies that `mesh` at `pose_wm` collides with, in the order of insertion, with an estimate of
    /// the depth. For messages: it takes thousands of times longer than [`View::collides`].
    pub fn contacts(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Vec<Contact> {
        let mut contacts = Vec::new();
        let _: Option<()> = self.near(mesh, pose_wm, true, |id, body| {
            if query.meets(mesh, pose_wm, &body.mesh, &body.pose) {
                let depth = query.depth(mesh, pose_wm, &body.mesh, &body.pose);
                contacts.push(Contact { body: id, name: body.name.clone(), depth });
            }
            None
        });
        contacts.sort_by_key(|contact| contact.body);
        contacts
    }

    /// Visits the bodies of the view whose boxes overlap the box of the mesh, until `visit` returns
    /// something; all bodies of the view when the mesh has no place in the world. Static ones when `fixed`.
    pub(super) fn near<T>(
        &self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        fixed: bool,
        mut visit: impl FnMut(BodyId, &Body) -> Option<T>,
    ) -> Option<T> {
        let mut phases = self.phases(fixed).peekable();
        phases.peek()?;
        let own = bounds(mesh, pose_wm);
        phases.find_map(|broad| {
            broad.find(
                |bounds| own.is_none_or(|own| own.overlaps(bounds)),
                |item| {
                    let body = self.scene.bodies[item as usize].as_ref()?;
                    if body.groups.meets(self.groups) { visit(BodyId(item), body) } else { None }
                },
            )
        })
    }

    /// The broad phases that have something in them; that of the static bodies only when `fixed`.
    pub(super) fn phases(&self, fixed: bool) -> impl Iterator<Item = &BroadPhase> {
        let phases = [fixed.then_some(&self.scene.fixed), Some(&self.scene.movable)];
        phases.into_iter().flatten().filter(|broad| !broad.is_empty())
    }
}

/// Queries of a mesh that is compared with every body; [`Scene::view`] for other groups.
impl Scene {
    /// The bodies that a mesh of these groups is compared with.
    #[must_use]
    pub fn view(&self, groups: Groups) -> View<'_> {
        View { scene: self, groups }
    }

    /// A body that `mesh` at `pose_wm` collides with: the first one found, always the same. Touching counts.
    pub fn collide_body(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Option<BodyId> {
        self.view(Groups::ALL).collide_body(query, mesh, pose_wm)
    }

    /// Whether `mesh` at `pose_wm` collides with any body.
    pub fn collides(&self, query: &mut Query, mesh: &CollisionMesh, pose_wm: &Isometry3<f64>) -> bool {
        self.view(Groups::ALL).collides(query, mesh, pose_wm)
    }

    /// A lower bound on the distance from `mesh` at `pose_wm` to the scene: see [`View::clearance`].
    pub fn clearance(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        enough: f64,
    ) -> (f64, Option<BodyId>) {
        self.view(Groups::ALL).clearance(query, mesh, pose_wm, enough)
    }

    /// All bodies that `mesh` at `pose_wm` collides with, and how deep: see [`View::contacts`].
    pub fn contacts(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Vec<Contact> {
        self.view(Groups::ALL).contacts(query, mesh, pose_wm)
    }
}
