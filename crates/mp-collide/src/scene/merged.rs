//! Static bodies as one tree.

use super::{Body, BodyId};
use crate::mesh::CollisionMesh;
use crate::pose::{LIMIT, to_world};

/// All static bodies as one mesh in the world.
#[derive(Clone, Debug)]
pub(super) struct Merged {
    pub(super) mesh: CollisionMesh,
    /// The first triangle of each body, with the body; ascending.
    starts: Vec<(usize, BodyId)>,
}

impl Merged {
    /// One mesh of `bodies`; `None` when there are none, or it would be too large.
    ///
    /// # Errors
    /// That of `go_on`, which is called often.
    pub(super) fn of<E>(
        bodies: &[(BodyId, &Body)],
        mut go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<Option<Self>, E> {
        let (mut triangles, mut starts) = (Vec::new(), Vec::new());
        for (id, body) in bodies {
            go_on()?;
            starts.push((triangles.len(), *id));
            triangles.extend(body.mesh.triangles().iter().map(|t| t.map(|p| to_world(&body.pose, &p))));
        }
        if triangles.is_empty() || u32::try_from(triangles.len()).is_err() {
            return Ok(None);
        }
        let mesh = CollisionMesh::built(triangles.len(), |i| triangles[i], go_on)?;
        // A large mesh far away may be beyond the limit in the world, though mesh and pose are each within it.
        Ok((mesh.radius() <= LIMIT).then_some(Self { mesh, starts }))
    }

    /// The body a triangle of the mesh belongs to.
    pub(super) fn owner(&self, triangle: usize) -> BodyId {
        let after = self.starts.partition_point(|(start, _)| *start <= triangle);
        self.starts[after - 1].1
    }
}
