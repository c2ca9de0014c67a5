//! A mesh by itself, as a scene to look at and to build on.

use mp_geom::TriMesh;
use mp_io::{DocumentBody, DocumentShape, Files, SceneDocument, SpaceKind};
use mp_plan::{Error, Scene};
use std::path::Path;

/// The scene of a mesh file: the mesh is the robot, at the origin, with no obstacles. Its goal is beside it, two radii away.
///
/// # Errors
/// When the file cannot be read or is no mesh.
pub fn scene_of_mesh(files: &dyn Files, file: &Path) -> Result<Scene, Error> {
    let mesh = mp_io::read_mesh_of(files, file)?;
    let name = file.file_stem().map_or_else(|| "mesh".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let file = file.file_name().map_or_else(|| name.clone(), |f| f.to_string_lossy().into_owned());
    let radius = mesh.radius_about(&nalgebra::Point3::origin());
    let robot = DocumentBody {
        name: name.clone(),
        color: None,
        shape: DocumentShape::Mesh { file, off: None, solid: false },
        scale: None,
        pose: None,
    };
    let document = SceneDocument {
        version: 1,
        name,
        space: SpaceKind::Se3,
        bounds: None,
        robot,
        start: [0.0; 6],
        goal: [2.0 * radius, 0.0, 0.0, 0.0, 0.0, 0.0],
        obstacles: Vec::new(),
    };
    let mesh = |_: &str| -> Result<TriMesh, mp_io::Error> { Ok(mesh.clone()) };
    Scene::from_document(document, &mesh)
}

/// Whether a file holds a mesh, by its name and content, and not a scene.
#[must_use]
pub fn is_mesh(file: &Path, bytes: &[u8]) -> bool {
    let scene = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"robot"));
    !scene && mp_io::Content::of_mesh(file, bytes).is_some()
}
