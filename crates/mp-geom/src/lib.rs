//! Triangle meshes, primitives, poses and bounding volumes for motion planning.

mod mesh;

pub use mesh::{MeshError, TriMesh};
