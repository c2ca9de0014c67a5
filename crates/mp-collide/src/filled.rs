//! Filled meshes: closed surfaces together with their inside.

use nalgebra::Point3;
use thiserror::Error;

use mp_geom::{NO_COMPONENT, TriMesh};

use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::Relative;
use crate::query::Query;

/// Why a mesh has no inside.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FillError {
    /// Some edges belong to one triangle only.
    #[error("the mesh is not closed: {edges} edges have a triangle on one side only; close the holes")]
    Open {
        /// How many.
        edges: usize,
    },
    /// More than two triangles at an edge, or several fans of them at a vertex.
    #[error(
        "the mesh is no manifold: more than two triangles meet at {edges} edges, and several surfaces at \
         {vertices} vertices; take it apart there"
    )]
    NotManifold {
        /// How many edges.
        edges: usize,
        /// How many vertices.
        vertices: usize,
    },
    /// Neighbouring triangles have opposite orientations.
    #[error(
        "the mesh is not oriented: the triangles at {edges} edges are turned against each other; turn some"
    )]
    NotOriented {
        /// At how many edges.
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
    /// [`Scene`](crate::Scene), and for [`Query::depth`] and [`Query::escape`], it then also collides with what is
    /// wholly inside of it; all other queries compare surfaces. O(n log n) for n triangles.
    ///
    /// ```
    /// use mp_collide::{CollisionMesh, Query, Scene};
    /// use nalgebra::Isometry3;
    ///
    /// let crate_ = CollisionMesh::new(&mp_geom::primitives::cuboid(2.0, 2.0, 2.0)?).filled()?;
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
        let outward = mesh.signed_volume() > 0.0;
        if outward { Ok(Self { filled: true, ..self }) } else { Err(FillError::InsideOut) }
    }

    /// Whether the mesh counts as a solid: see [`CollisionMesh::filled`].
    #[must_use]
    pub fn is_filled(&self) -> bool {
        self.filled
    }

    /// A corner of each component connected by edges; computed on first use.
    fn parts(&self) -> &[Point3<f64>] {
        self.parts.get_or_init(|| {
            let triangles = self.triangles();
            let Ok(mesh) = TriMesh::from_soup(&triangles) else { return Vec::new() };
            let found = mesh.topology();
            let mut known = vec![false; found.components];
            let first = triangles.iter().zip(&found.component).filter(|(_, part)| {
                // A triangle with two corners in one place is connected to nothing.
                **part == NO_COMPONENT || !std::mem::replace(&mut known[**part as usize], true)
            });
            first.map(|(triangle, _)| triangle[0]).collect()
        })
    }
}

impl Query {
    /// Whether two meshes have a point in common, filled ones with their inside.
    pub(crate) fn meets(&mut self, a: PosedMesh<'_>, b: PosedMesh<'_>) -> bool {
        self.intersects(a.0, a.1, b.0, b.1) || self.nested(a, b)
    }

    /// Whether one of two meshes is filled and has a part of the other inside; the surfaces must be apart.
    pub(crate) fn nested(&mut self, a: PosedMesh<'_>, b: PosedMesh<'_>) -> bool {
        self.holds(a, b) || self.holds(b, a)
    }

    /// Whether `a` is filled and has a component of `b` inside. As the surfaces are apart, one corner decides for each
    /// component.
    fn holds(&mut self, a: PosedMesh<'_>, b: PosedMesh<'_>) -> bool {
        if !a.0.filled {
            return false;
        }
        let Some(relative) = Relative::of(a, b) else { return true };
        let (stack, counters) = (&mut self.stack, &mut self.counters);
        // On the surface counts as inside: touching is collision.
        b.0.parts().iter().any(|p| {
            let winding = a.0.tree().winding(&relative.point(p), stack, counters);
            winding.is_none_or(|turns| turns > 0)
        })
    }
}
