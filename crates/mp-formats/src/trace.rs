//! The `tracing` events of the crate: at debug level, from functions that are compiled once.

use mp_geom::TriMesh;

/// A mesh was read.
pub(crate) fn mesh(file: &str, mesh: &TriMesh) {
    tracing::debug!(file, vertices = mesh.vertices().len(), triangles = mesh.triangles().len(), "mesh");
}

/// A path was read.
pub(crate) fn path(file: &str, configurations: usize) {
    tracing::debug!(file, configurations, "path");
}
