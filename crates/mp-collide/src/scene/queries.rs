//! Queries of one mesh against the bodies of a scene.

use nalgebra::Isometry3;

use super::{Body, BodyId, Contact, Scene, bounds};
use crate::broad::BroadPhase;
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::query::Query;

/// Up to this number of bodies are looked at one by one for what is inside of what.
const FEW: usize = 16;

/// Queries of a mesh, which need not be a body of the scene, against all bodies.
impl Scene {
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
        self.near(mesh, pose_wm, !self.is_merged(), |id, body| {
            query.intersects(mesh, pose_wm, &body.mesh, &body.pose).then_some(id)
        })
        .or_else(|| self.nested(query, mesh, pose_wm))
    }

    /// A body with a part inside of `mesh`, or that has a part of `mesh` inside, the outer one being
    /// [filled](CollisionMesh::is_filled); surfaces are assumed not to meet. All other queries of a scene ask this too, but
    /// [`surface_clearance`](Self::surface_clearance) and [`check_surfaces`](Self::check_surfaces).
    pub fn nested(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
    ) -> Option<BodyId> {
        if self.filled == 0 && !mesh.is_filled() {
            return None;
        }
        let tree = mesh.tree();
        let center = pose_wm * tree.center;
        let radius = tree.radius_center + 1e-9 * (tree.radius_center + center.coords.amax());
        let mut nested = |id, body: &Body| {
            let gap =
                |k: usize| (body.bounds.min[k] - center[k]).max(center[k] - body.bounds.max[k]).max(0.0);
            let far = gap(0) * gap(0) + gap(1) * gap(1) + gap(2) * gap(2) > radius * radius;
            (!far && query.nested(mesh, pose_wm, &body.mesh, &body.pose)).then_some(id)
        };
        // Of few bodies each takes less time than the box of the mesh.
        if self.bodies.len() <= FEW {
            return self.bodies().find_map(|(id, body)| nested(id, body));
        }
        self.near(mesh, pose_wm, true, nested)
    }

    /// Whether `mesh` at `pose_wm` collides with any body.
    pub fn collides(&self, query: &mut Query, mesh: &CollisionMesh, pose_wm: &Isometry3<f64>) -> bool {
        // Any pair of triangles will do here, which is found sooner than always the same pair.
        self.any_surface(mesh, pose_wm, 0.0, |(body, at)| query.intersects(mesh, pose_wm, body, at))
            || self.nested(query, mesh, pose_wm).is_some()
    }

    /// Whether `mesh` at `pose_wm` collides with any body, or its surface is at most `tolerance` (metres) from that of one, to
    /// rounding.
    pub fn within(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        tolerance: f64,
    ) -> bool {
        // Rounding of boxes is far below this part.
        let reach = tolerance.max(0.0) * (1.0 + 1e-9);
        self.any_surface(mesh, pose_wm, reach, |(body, at)| query.within(mesh, pose_wm, body, at, tolerance))
            || self.nested(query, mesh, pose_wm).is_some()
    }

    /// Whether `test` holds for the merged mesh, or for a body whose box overlaps that of the mesh, enlarged by `reach` (metres).
    fn any_surface(
        &self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        reach: f64,
        mut test: impl FnMut(PosedMesh<'_>) -> bool,
    ) -> bool {
        self.merged.iter().any(|merged| test((&merged.mesh, &Isometry3::identity())))
            || self
                .near_by(mesh, pose_wm, reach, !self.is_merged(), |_, body| test(body.posed()).then_some(()))
                .is_some()
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
        let found = self.surface_clearance(query, mesh, pose_wm, enough);
        let nested = if found.0 > 0.0 { self.nested(query, mesh, pose_wm) } else { None };
        nested.map_or(found, |id| (0.0, Some(id)))
    }

    /// [`clearance`](Self::clearance) of surfaces: filled meshes count as surfaces too.
    pub fn surface_clearance(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        enough: f64,
    ) -> (f64, Option<BodyId>) {
        let mut nearest = NearestBody {
            query,
            limit: if enough.is_nan() { f64::INFINITY } else { enough },
            body: None,
            beyond: f64::INFINITY,
        };
        let posed = (mesh, pose_wm);
        if let Some(merged) = &self.merged {
            nearest.look(posed, (&merged.mesh, &Isometry3::identity()), |t| merged.owner(t));
        }
        for broad in self.phases(!self.is_merged()) {
            let Some(own) = bounds(mesh, pose_wm) else {
                return match self.bodies().next() {
                    Some((id, _)) => (0.0, Some(id)),
                    None => (f64::INFINITY, None),
                };
            };
            let passed_over = broad.nearest(&own, nearest.limit, |item| {
                if let Some(body) = &self.bodies[item as usize] {
                    nearest.look(posed, body.posed(), |_| BodyId(item));
                }
                nearest.limit
            });
            nearest.beyond = nearest.beyond.min(passed_over);
        }
        match nearest.body {
            Some(body) => (nearest.limit, Some(body)),
            None => (nearest.beyond, None),
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

    /// Visits the bodies whose boxes overlap the box of the mesh, until `visit` returns something; all bodies
    /// when mesh or pose are beyond the limits. Static bodies are visited only when `fixed`.
    pub(super) fn near<T>(
        &self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        fixed: bool,
        visit: impl FnMut(BodyId, &Body) -> Option<T>,
    ) -> Option<T> {
        self.near_by(mesh, pose_wm, 0.0, fixed, visit)
    }

    /// [`near`](Self::near) with the box of the mesh enlarged by `reach` (metres); all bodies when that is NaN.
    pub(super) fn near_by<T>(
        &self,
        mesh: &CollisionMesh,
        pose_wm: &Isometry3<f64>,
        reach: f64,
        fixed: bool,
        mut visit: impl FnMut(BodyId, &Body) -> Option<T>,
    ) -> Option<T> {
        let mut phases = self.phases(fixed).peekable();
        phases.peek()?;
        let own = bounds(mesh, pose_wm).filter(|_| reach >= 0.0).map(|own| own.enlarged(reach));
        phases.find_map(|broad| {
            broad.find(
                |bounds| own.is_none_or(|own| own.intersects(bounds)),
                |item| visit(BodyId(item), self.bodies[item as usize].as_ref()?),
            )
        })
    }

    /// The broad phases that are not empty; that of the static bodies only when `fixed`.
    pub(super) fn phases(&self, fixed: bool) -> impl Iterator<Item = &BroadPhase> {
        let phases = [fixed.then_some(&self.fixed), Some(&self.movable)];
        phases.into_iter().flatten().filter(|broad| !broad.is_empty())
    }
}

/// The search for the nearest body.
struct NearestBody<'q> {
    query: &'q mut Query,
    /// The distance to `body`; while there is none, the distance that is enough.
    limit: f64,
    body: Option<BodyId>,
    /// A lower bound on the distance of all bodies that were compared and found beyond the limit.
    beyond: f64,
}

impl NearestBody<'_> {
    /// Compares the mesh with another; `owner` names the body of a triangle of the other.
    fn look(&mut self, mesh: PosedMesh<'_>, other: PosedMesh<'_>, owner: impl Fn(usize) -> BodyId) {
        if self.limit == 0.0 && self.body.is_some() {
            return;
        }
        let (clearance, triangle) = self.query.clearance_of(mesh, other, self.limit);
        match triangle {
            Some(triangle) if clearance < self.limit || clearance == 0.0 => {
                self.limit = clearance;
                self.body = Some(owner(triangle));
            }
            _ => self.beyond = self.beyond.min(clearance),
        }
    }
}
