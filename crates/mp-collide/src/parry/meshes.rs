//! Conversions of triangle meshes.

use mp_geom::TriMesh;
use nalgebra::Point3;
use parry3d_f64::math::Vector;
use parry3d_f64::shape;

use super::{ParryError, guarded, point_from_parry, point_to_parry};

/// The same vertices and triangles as a mesh of parry, whose tree it builds: O(n log n) for n triangles.
///
/// # Errors
/// [`ParryError::Failed`], which no [`TriMesh`] should cause.
pub fn mesh_to_parry(mesh: &TriMesh) -> Result<shape::TriMesh, ParryError> {
    let vertices = mesh.vertices().iter().map(point_to_parry).collect();
    let made = guarded("building of a mesh", || shape::TriMesh::new(vertices, mesh.triangles().to_vec()))?;
    made.map_err(|_| ParryError::Failed { what: "building of a mesh" })
}

/// The same vertices and triangles. O(n).
///
/// # Errors
/// [`ParryError::Mesh`]: parry checks neither coordinates nor indices.
pub fn mesh_from_parry(mesh: &shape::TriMesh) -> Result<TriMesh, ParryError> {
    made_of(mesh.vertices(), mesh.indices().to_vec())
}

/// A mesh of vertices and triangles of parry.
pub(super) fn made_of(vertices: &[Vector], triangles: Vec<[u32; 3]>) -> Result<TriMesh, ParryError> {
    Ok(TriMesh::new(vertices.iter().copied().map(point_from_parry).collect(), triangles)?)
}

/// A mesh of triangles, or of segments and points as triangles with corners in one place.
pub(super) fn soup(triangles: impl IntoIterator<Item = [Vector; 3]>) -> Result<TriMesh, ParryError> {
    let triangles: Vec<[Point3<f64>; 3]> =
        triangles.into_iter().map(|corners| corners.map(point_from_parry)).collect();
    Ok(TriMesh::from_soup(&triangles)?)
}
