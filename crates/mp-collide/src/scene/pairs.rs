//! Bodies of a scene against each other.

use super::{Body, BodyId, Scene};
use crate::query::Query;

/// Bodies against each other, but for the allowed pairs.
impl Scene {
    /// A body of the scene that body `id` collides with, allowed pairs excepted: the first one found, always
    /// the same. `None` when there is none, or no body `id`.
    pub fn body_collides(&self, query: &mut Query, id: BodyId) -> Option<BodyId> {
        let body = self.body(id)?;
        self.near(&body.mesh, &body.pose, true, |other_id, other| {
            let compared = other_id != id && !self.is_allowed(id, other_id);
            (compared && query.meets(&body.mesh, &body.pose, &other.mesh, &other.pose)).then_some(other_id)
        })
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
                if body.bounds.intersects(&other.bounds)
                    && !self.is_allowed(*id, *other_id)
                    && query.meets(&body.mesh, &body.pose, &other.mesh, &other.pose)
                {
                    pairs.push((*id.min(other_id), *id.max(other_id)));
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }
}
