//! Sequences of poses and intervals of motions in a scene.

use nalgebra::Isometry3;

use super::{BodyId, Scene};
use crate::mesh::CollisionMesh;
use crate::query::Query;
use crate::query::interval::{IntervalCheck, RigidMotion};

impl Scene {
    /// The index of the first of `poses_wm` at which `mesh` collides with a body, and the body. Much faster than
    /// pose by pose where neighbours are near each other: see [`Query::first_collision`].
    pub fn first_collision(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        poses_wm: &[Isometry3<f64>],
    ) -> Option<(usize, BodyId)> {
        let touching = self.first_touching(query, mesh, poses_wm);
        let apart = touching.map_or(poses_wm.len(), |(i, _)| i);
        let mut nested = poses_wm[..apart].iter().enumerate();
        nested.find_map(|(i, pose_wm)| Some((i, self.nested(query, mesh, pose_wm)?))).or(touching)
    }

    /// [`Scene::first_collision`] of surfaces: filled meshes count as surfaces too.
    fn first_touching(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        poses_wm: &[Isometry3<f64>],
    ) -> Option<(usize, BodyId)> {
        let mut before = poses_wm.len();
        if let Some(merged) = &self.merged {
            let hit = query.first_collision(mesh, poses_wm, &merged.mesh, &Isometry3::identity());
            before = hit.unwrap_or(before);
        }
        let fixed = !self.is_merged();
        for (i, pose_wm) in poses_wm[..before].iter().enumerate() {
            let hit = self.near(mesh, pose_wm, fixed, |id, body| {
                query.intersects(mesh, pose_wm, &body.mesh, &body.pose).then_some(id)
            });
            if let Some(id) = hit {
                return Some((i, id));
            }
        }
        let at = poses_wm.get(before)?;
        self.collide_body(query, mesh, at).map(|id| (before, id))
    }

    /// Whether `mesh` stays at least `margin` (metres) from all bodies along an interval of a motion: see
    /// [`Query::check_interval`].
    pub fn check_interval(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        middle_wm: &Isometry3<f64>,
        motion: &RigidMotion,
        margin: f64,
    ) -> IntervalCheck {
        let surfaces = self.check_surfaces(query, mesh, middle_wm, motion, margin);
        // Nothing gets inside or outside without meeting a surface, so the middle decides for the interval.
        match surfaces.is_free() && self.nested(query, mesh, middle_wm).is_some() {
            true => IntervalCheck::Collision { at: 0.0 },
            false => surfaces,
        }
    }

    /// [`check_interval`](Self::check_interval) of surfaces: filled meshes count as surfaces too.
    pub fn check_surfaces(
        &self,
        query: &mut Query,
        mesh: &CollisionMesh,
        middle_wm: &Isometry3<f64>,
        motion: &RigidMotion,
        margin: f64,
    ) -> IntervalCheck {
        if let Some(merged) = &self.merged {
            let found =
                query.check_interval(mesh, middle_wm, motion, &merged.mesh, &Isometry3::identity(), margin);
            if !found.is_free() {
                return found;
            }
        }
        // A body farther than this from the box in the middle stays farther than the margin.
        let reach = (motion.most + margin) * (1.0 + 1e-9);
        let blocked = self.near_by(mesh, middle_wm, reach, !self.is_merged(), |_, body| {
            let found = query.check_interval(mesh, middle_wm, motion, &body.mesh, &body.pose, margin);
            (!found.is_free()).then_some(found)
        });
        blocked.unwrap_or(IntervalCheck::Free)
    }
}
