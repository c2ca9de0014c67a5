//! Static bodies as one tree.

use super::{Body, BodyId, Groups};
use crate::mesh::CollisionMesh;
use crate::pose::{LIMIT, to_world};

/// All static bodies of the same groups as one mesh in the world.
#[derive(Clone, Debug)]
pub(super) struct Merged {
    pub(super) groups: Groups,
    pub(super) mesh: CollisionMesh,
    /// The first triangle of each body, with the body; ascending.
    starts: Vec<(usize, BodyId)>,
}

impl Merged {
    /// One mesh for each kind of groups, in the order in which `bodies` have them; `None` when one of the
    /// meshes would be too large.
    pub(super) fn all(bodies: &[(BodyId, &Body)]) -> Option<Vec<Self>> {
        let mut kinds: Vec<Groups> = Vec::new();
        for (_, body) in bodies {
            if !kinds.contains(&body.groups) {
                kinds.push(body.groups);
            }
        }
        kinds.into_iter().map(|groups| Self::of(bodies, groups)).collect()
    }

    fn of(bodies: &[(BodyId, &Body)], groups: Groups) -> Option<Self> {
        let (mut triangles, mut starts) = (Vec::new(), Vec::new());
        for (id, body) in bodies.iter().filter(|(_, body)| body.groups == groups) {
            starts.push((triangles.len(), *id));
            triangles.extend(body.mesh.triangles().iter().map(|t| t.map(|p| to_world(&body.pose, &p))));
        }
        u32::try_from(triangles.len()).ok()?;
        let mesh = CollisionMesh::from_triangles(triangles);
        // Far away and huge together may be beyond the limit where each alone is not.
        (mesh.radius() <= LIMIT).then_some(Self { groups, mesh, starts })
    }

    /// The body a triangle of the mesh belongs to.
    pub(super) fn owner(&self, triangle: usize) -> BodyId {
        let after = self.starts.partition_point(|(start, _)| *start <= triangle);
        self.starts[after - 1].1
    }
}
