//! Reading a mesh of any format, and making triangles of what a format gives.

use crate::collada::parse_collada;
use crate::error::{Error, ErrorKind};
use crate::gempa::parse_gempa_mesh;
use crate::obj::parse_obj;
use crate::off::OffDocument;
use crate::source::{MAX_MESH_BYTES, read_file};
use crate::stl::parse_stl;
use mp_geom::{MeshError, TriMesh};
use nalgebra::Point3;
use std::path::Path;

/// The most corners of a polygon that is cut into triangles; the time grows with their square.
pub const MAX_CORNERS: usize = 4096;

/// Reads the mesh `path`: OFF, GEMPA `.txt`, STL, OBJ or COLLADA. The extension decides; a name that tells
/// nothing is decided by the content.
///
/// # Errors
/// [`Error`] when it cannot be read, is of no known format, or has no triangles.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriMesh, Error> {
    let path = path.as_ref();
    let bytes = read_file(path, MAX_MESH_BYTES)?;
    let file = path.display().to_string();
    match MeshFormat::of(path, &bytes) {
        Some(MeshFormat::Off) => OffDocument::parse(&file, &bytes)?.to_mesh(&file),
        Some(MeshFormat::Gempa) => parse_gempa_mesh(&file, &bytes),
        Some(MeshFormat::Stl) => parse_stl(&file, &bytes),
        Some(MeshFormat::Obj) => parse_obj(&file, &bytes),
        Some(MeshFormat::Collada) => parse_collada(&file, &bytes),
        None => Err(Error::new(ErrorKind::Unsupported, &file, "this is not a mesh format that is read here")
            .expected("a file .off, .txt (GEMPA), .stl, .obj or .dae")
            .help("convert the mesh to one of these")),
    }
}

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// Object file format, `.off`.
    Off,
    /// GEMPA's triangle soup, `.txt`.
    Gempa,
    /// Stereolithography, `.stl`, text or binary.
    Stl,
    /// Wavefront, `.obj`.
    Obj,
    /// COLLADA, `.dae`.
    Collada,
}

impl MeshFormat {
    /// The format of a file, by the extension of its name, or else by its content.
    #[must_use]
    pub fn of(path: &Path, bytes: &[u8]) -> Option<Self> {
        let extension =
            path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        match extension.as_str() {
            "off" => Some(Self::Off),
            "stl" | "stla" | "stlb" => Some(Self::Stl),
            "obj" => Some(Self::Obj),
            "dae" => Some(Self::Collada),
            "txt" => Some(if looks_like_off(bytes) { Self::Off } else { Self::Gempa }),
            _ if looks_like_off(bytes) => Some(Self::Off),
            _ => {
                let head = &bytes[..bytes.len().min(4096)];
                let has = |what: &[u8]| head.windows(what.len()).any(|w| w == what);
                if has(b"<COLLADA") {
                    Some(Self::Collada)
                } else if head.trim_ascii_start().starts_with(b"solid") && has(b"facet") {
                    Some(Self::Stl)
                } else {
                    None
                }
            }
        }
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
