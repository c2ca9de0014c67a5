//! Filled meshes: closed surfaces together with their inside.

use nalgebra::{Isometry3, Point3};
use std::sync::Arc;
use thiserror::Error;

use mp_geom::{Aabb, TriMesh};

use crate::broad::BroadPhase;
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::Relative;
use crate::query::Query;
use crate::scene::bounds;

/// Why a mesh has no inside.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FillError {
    /// Some edges belong to one triangle only.
    #[error("the mesh is not closed: {edges} edges have a triangle on one side only; close the holes")]
    Open {
        /// Edges with a triangle on one side only.
        edges: usize,
    },
    /// More than two triangles at an edge, or several fans of them at a vertex.
    #[error(
        "the mesh is no manifold: more than two triangles meet at {edges} edges, and several surfaces at \
         {vertices} vertices; take it apart there"
    )]
    NotManifold {
        /// Edges at which more than two triangles meet.
        edges: usize,
        /// Vertices at which several surfaces meet.
        vertices: usize,
    },
    /// Neighbouring triangles have opposite orientations.
    #[error(
        "the mesh is not oriented: the triangles at {edges} edges are turned against each other; turn some"
    )]
    NotOriented {
        /// Edges whose two triangles have opposite orientations.
        edges: usize,
    },
    /// All triangles face inward, as those of a room.
    #[error("the mesh faces inward: the volume it encloses is not positive; reverse its triangles")]
    InsideOut,
    /// Coordinates that are not finite.
    #[error("the mesh has a coordinate that is not finite")]
    NotFinite,
}

impl CollisionMesh {
    /// The same mesh as a solid: the surface and all points around which it winds outward. In a
    /// [`Scene`](crate::Scene), and for [`Query::meets`], [`Query::depth`] and [`Query::escape`], it then also collides with what is
    /// wholly inside of it; all other queries compare surfaces. O(n log n) for n triangles. A mesh made of
    /// [solids](TriMesh::solids) is filled already.
    ///
    /// ```
    /// use mp_collide::{CollisionMesh, Query, Scene};
    /// use nalgebra::Isometry3;
    ///
    /// let shell = mp_geom::primitives::cuboid(2.0, 2.0, 2.0)?.into_surface();
    /// let crate_ = CollisionMesh::new(&shell).filled()?;
    /// let ball = CollisionMesh::new(&mp_geom::primitives::sphere(0.5, 1)?);
    /// let (mut scene, here) = (Scene::new(), Isometry3::identity());
    /// scene.insert("crate", crate_, here)?;
    /// assert!(scene.collides(&mut Query::default(), &ball, &here));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the mesh is not closed, a manifold and consistently oriented (vertices at the same place count as one), or
    /// encloses no positive volume.
    pub fn filled(self) -> Result<Self, FillError> {
        let mesh = TriMesh::from_soup(&self.triangles()).map_err(|_| FillError::NotFinite)?;
        let found = mesh.topology();
        if !found.boundary_edges.is_empty() {
            return Err(FillError::Open { edges: found.boundary_edges.len() });
        }
        if !found.manifold {
            let (edges, vertices) = (found.crowded_edges.len(), found.pinched_vertices.len());
            return Err(FillError::NotManifold { edges, vertices });
        }
        if !found.is_solid() {
            return Err(FillError::NotOriented { edges: found.misoriented_edges.len() });
        }
        match mesh.signed_volume() > 0.0 {
            true => {
                Ok(Self { solids: [0..self.triangle_count() as u32].into(), outline: Arc::default(), ..self })
            }
            false => Err(FillError::InsideOut),
        }
    }

    /// Whether the mesh, or a part of it, counts as a solid: see [`CollisionMesh::filled`] and [`TriMesh::solids`].
    #[must_use]
    pub fn is_filled(&self) -> bool {
        !self.solids.is_empty()
    }

    /// The connected components; computed on first use, where building has not found that there are few.
    fn parts(&self) -> &Parts {
        self.parts.get_or_init(|| {
            if let Some(cloud) = &self.cloud {
                return Parts::new(cloud.centers());
            }
            let corners = self.triangles().concat();
            let triangles = (0..corners.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let mesh = TriMesh::new(corners, triangles);
            Parts::new(mesh.map_or_else(|_| Vec::new(), |mesh| mesh.component_vertices()))
        })
    }
}

/// At least one corner of each connected component of a mesh. Where surfaces are apart, a component is inside if its corner is.
#[derive(Clone, Debug)]
pub(crate) struct Parts {
    corners: Vec<Point3<f64>>,
    /// Finds the corners in a box, if there are many.
    near: BroadPhase,
}

/// More corners than this are looked for by their place.
const FEW: usize = 8;

impl Parts {
    pub(crate) fn new(corners: Vec<Point3<f64>>) -> Self {
        let mut near = BroadPhase::default();
        if corners.len() > FEW {
            for (i, p) in corners.iter().enumerate() {
                near.insert(i as u32, Aabb::new(*p, *p));
            }
        }
        Self { corners, near }
    }

    /// Whether `test` holds for a corner in the box that `around` gives; without a box, for any corner.
    fn any(&self, around: impl FnOnce() -> Option<Aabb>, mut test: impl FnMut(&Point3<f64>) -> bool) -> bool {
        if self.near.is_empty() {
            return self.corners.iter().any(test);
        }
        let around = around();
        let inside = |bounds: &Aabb| around.is_none_or(|around| around.intersects(bounds));
        self.near.find(inside, |i| test(&self.corners[i as usize]).then_some(())).is_some()
    }
}

impl Query {
    /// Whether two meshes have a point in common, [filled](CollisionMesh::filled) ones with their inside. Touching counts.
    pub fn meets(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> bool {
        self.intersects(a, pose_wa, b, pose_wb) || self.nested(a, pose_wa, b, pose_wb)
    }

    /// Whether one of two meshes is [filled](CollisionMesh::filled) and has a part of the other inside; the surfaces must be apart.
    pub fn nested(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> bool {
        self.holds((a, pose_wa), (b, pose_wb)) || self.holds((b, pose_wb), (a, pose_wa))
    }

    /// How often the surface of a mesh winds around a point of its frame, outward less inward; `None` when the point is on it. Exact.
    /// It says what is inside where the mesh is closed.
    pub fn winding(&mut self, mesh: &CollisionMesh, p: &Point3<f64>) -> Option<i32> {
        mesh.tree().winding(p, &[0..u32::MAX], &mut self.stack, &mut self.counters)
    }

    /// Whether `a` is filled and has a component of `b` inside. As the surfaces are apart, one corner decides for each
    /// component.
    fn holds(&mut self, a: PosedMesh<'_>, b: PosedMesh<'_>) -> bool {
        if !a.0.is_filled() {
            return false;
        }
        let tree = a.0.tree();
        let (center, stack, counters) = (a.1 * tree.center, &mut self.stack, &mut self.counters);
        // More than any rounding.
        let pad = 1e-9 * (a.0.radius() + b.0.radius() + center.coords.norm());
        let reach = tree.radius_center + pad;
        let around = || bounds(a.0, &b.1.inv_mul(a.1));
        b.0.parts().any(around, |p| {
            // Most corners are beyond the ball or the box around everything.
            let from_center = b.1 * p - center;
            if from_center.norm_squared() > reach * reach
                || tree.bounding.is_beyond(&a.1.inverse_transform_vector(&from_center), pad)
            {
                return false;
            }
            let Some(relative) = Relative::of(a, b) else { return true };
            let winding = tree.winding(&relative.point(p), &a.0.solids, stack, counters);
            // On the surface counts as inside: touching is collision.
            winding.is_none_or(|turns| turns > 0)
        })
    }
}
