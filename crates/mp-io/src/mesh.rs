//! Reading a mesh of any format, and making triangles of what a format gives.

use crate::error::{Error, ErrorKind};
use crate::gempa::parse_gempa_mesh;
use crate::off::OffDocument;
use crate::source::{MAX_MESH_BYTES, read_file};
use mp_geom::{MeshError, TriMesh};
use nalgebra::Point3;
use std::path::Path;

/// The most corners of a polygon that is cut into triangles; the time grows with their square.
pub const MAX_CORNERS: usize = 4096;

/// Reads the mesh `path`, of any format this crate knows: OFF, GEMPA `.txt`.
///
/// # Errors
/// [`Error`] when it cannot be read, is of no known format, or has no triangles.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriMesh, Error> {
    let path = path.as_ref();
    let bytes = read_file(path, MAX_MESH_BYTES)?;
    let file = path.display().to_string();
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    match extension.as_str() {
        "off" => OffDocument::parse(&file, &bytes)?.to_mesh(&file),
        "txt" if !looks_like_off(&bytes) => parse_gempa_mesh(&file, &bytes),
        _ if looks_like_off(&bytes) => OffDocument::parse(&file, &bytes)?.to_mesh(&file),
        _ => Err(Error::new(ErrorKind::Unsupported, &file, "this is not a mesh format that is read here")
            .expected("a file .off or .txt")),
    }
}

/// Whether the first word is a keyword of OFF.
fn looks_like_off(bytes: &[u8]) -> bool {
    let head = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let end = head.iter().position(|b| b.is_ascii_whitespace() || *b == b'#').unwrap_or(head.len());
    (3..=8).contains(&end) && head[..end].ends_with(b"OFF")
}

/// The triangle mesh of polygons with at least three corners each, read from `file`.
pub(crate) fn build<'a>(
    file: &str,
    vertices: Vec<Point3<f64>>,
    faces: impl Iterator<Item = &'a [u32]> + Clone,
) -> Result<TriMesh, Error> {
    if let Some(face) = faces.clone().find(|f| f.len() > MAX_CORNERS) {
        let message = format!("a polygon has {} corners, more than the {MAX_CORNERS} allowed", face.len());
        return Err(Error::new(ErrorKind::TooLarge, file, message).help("cut the polygon into triangles"));
    }
    TriMesh::from_polygons(vertices, faces).map_err(|e| mesh_error(file, &e))
}

pub(crate) fn mesh_error(file: &str, e: &MeshError) -> Error {
    let error = Error::new(ErrorKind::Content, file, e.to_string());
    match e {
        MeshError::Empty => error.help("a body needs at least one triangle"),
        _ => error,
    }
}
