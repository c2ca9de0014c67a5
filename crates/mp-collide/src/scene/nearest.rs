//! Which of many meshes is nearest?

use nalgebra::Isometry3;

use super::BodyId;
use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use crate::query::Query;

/// The search for the nearest body.
pub(super) struct Nearest<'q> {
    pub(super) query: &'q mut Query,
    /// The distance to `body`; while there is none, the distance that is enough.
    pub(super) limit: f64,
    pub(super) body: Option<BodyId>,
    /// All bodies looked at and found beyond the limit are at least this far away.
    pub(super) beyond: f64,
}

impl Nearest<'_> {
    /// Looks at a mesh; `owner` tells whose a triangle of it is.
    pub(super) fn look(
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
            Some(relative) => {
                let (clearance, position) =
                    self.query.clearance_with(mesh.tree(), other.tree(), &relative, self.limit);
                (clearance, position.map(|position| other.tree().ids[position] as usize))
            }
            None => (0.0, Some(0)),
        };
        match triangle {
            Some(triangle) if clearance < self.limit || clearance == 0.0 => {
                self.limit = clearance;
                self.body = Some(owner(triangle));
            }
            _ => self.beyond = self.beyond.min(clearance),
        }
    }
}
