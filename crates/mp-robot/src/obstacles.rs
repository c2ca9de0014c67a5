//! Meshes that stand still, as checkers and verifiers need them.

use mp_collide::reference::RefMesh;
use mp_collide::{BodyId, CollisionMesh, Scene, SceneError};
use mp_geom::{Aabb, TriMesh};
use nalgebra::Isometry3;
use std::sync::{Arc, OnceLock};

/// The most triangles of robot and obstacles together: what a reference mesh can hold.
pub(crate) const MAX_TRIANGLES: usize = 1 << 30;

/// Named obstacles that stand still. Clones of a robot share them.
#[derive(Debug)]
pub(crate) struct Obstacles {
    pub(crate) scene: Scene,
    /// Each obstacle, in the world frame.
    pub(crate) placed: Vec<(BodyId, Arc<TriMesh>)>,
    /// The box around all of them; empty when there are none.
    pub(crate) bounds: Aabb,
    /// Made for the first verifier; `None` inside when there are no obstacles.
    reference: OnceLock<Option<Arc<RefMesh>>>,
}

impl Obstacles {
    /// The obstacles of a robot that has `triangles` triangles itself. Each obstacle is a name, a mesh and its pose in the
    /// world.
    ///
    /// # Errors
    /// `too_many`, of the number of triangles, when there are more than [`MAX_TRIANGLES`]; or when an obstacle cannot be
    /// placed.
    pub(crate) fn new<E: From<SceneError>>(
        obstacles: impl IntoIterator<Item = (String, TriMesh, Isometry3<f64>)>,
        triangles: usize,
        too_many: impl Fn(usize) -> E,
    ) -> Result<Self, E> {
        let (mut scene, mut placed, mut count) = (Scene::new(), Vec::new(), triangles);
        for (name, mesh, pose) in obstacles {
            count = count.saturating_add(mesh.triangles().len());
            if count > MAX_TRIANGLES {
                return Err(too_many(count));
            }
            let in_world = Arc::new(mesh.transformed(&pose));
            placed.push((scene.insert(name, CollisionMesh::new(&mesh), pose)?, in_world));
        }
        scene.merge_static();
        let bounds = placed.iter().map(|(_, mesh)| mesh.aabb()).fold(Aabb::empty(), |a, b| a.union(&b));
        Ok(Self { scene, placed, bounds, reference: OnceLock::new() })
    }

    /// All obstacles as one mesh for verifiers; `None` when there are no obstacles.
    pub(crate) fn reference(&self) -> Option<Arc<RefMesh>> {
        let merged = || TriMesh::merged(self.placed.iter().map(|(_, mesh)| &**mesh));
        self.reference.get_or_init(|| merged().map(|mesh| Arc::new(RefMesh::new(&mesh)))).clone()
    }

    /// The largest coordinate of the obstacles by magnitude; zero when there are none.
    pub(crate) fn farthest(&self) -> f64 {
        let Aabb { min, max } = &self.bounds;
        if self.bounds.is_empty() { 0.0 } else { min.coords.amax().max(max.coords.amax()) }
    }
}

/// The tolerance `wanted`, or the least that coordinates as large as `farthest` can resolve, if that is more.
pub(crate) fn resolved_tolerance(wanted: f64, farthest: f64) -> f64 {
    let tolerance = wanted.max(1e-9 * farthest);
    if tolerance > 0.0 { tolerance } else { 1e-6 }
}
