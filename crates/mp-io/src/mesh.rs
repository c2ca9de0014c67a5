//! Reading a mesh of any format, and making triangles of polygons.

use crate::collada::Scene;
use crate::error::{Error, ErrorKind};
use crate::files::{Disk, Files, MAX_MESH_BYTES};
use crate::gempa::parse_gempa_mesh;
use crate::obj::parse_obj_until;
use crate::off::OffDocument;
use crate::stl::parse_stl_until;
use mp_geom::{MeshError, TriMesh};
use nalgebra::Point3;
use std::path::Path;

/// The most corners of a polygon that is cut into triangles; the time grows with the square of the corners.
pub const MAX_CORNERS: usize = 4096;
/// The largest sum, over all polygons of a mesh with more than 16 corners, of the squares of their corners: about a
/// minute.
const MAX_CUTTING: usize = 1_000_000_000;

/// The remark on a mesh with points and segments among its faces.
pub(crate) const LEFT_OUT: &str = "faces of fewer than three corners are left out";

/// Reads the mesh `path`: OFF, GEMPA `.txt`, STL, OBJ or COLLADA. The extension of the name decides, or,
/// when it is not known, the content.
///
/// # Errors
/// [`Error`] when it cannot be read, is of no known format, or has no triangles.
pub fn read_mesh(path: impl AsRef<Path>) -> Result<TriMesh, Error> {
    read_mesh_of(&Disk, path.as_ref())
}

/// As [`read_mesh`], with the file read through `files`.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_of(files: &dyn Files, path: &Path) -> Result<TriMesh, Error> {
    read_mesh_with(files, path, Axes::YUp)
}

/// The mesh in place of one that is not needed: so small that it is in nothing's way.
pub(crate) fn stand_in(file: &str) -> Result<TriMesh, Error> {
    let corner = Point3::new(1e-9, 1e-9, 1e-9);
    let corners = vec![corner, corner * 2.0, Point3::origin()];
    TriMesh::new(corners, vec![[0, 1, 2]]).map_err(|e| mesh_error(file, &e))
}

/// What becomes of the axes of a COLLADA mesh, which says which of them is up. Other formats do not: their axes stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// They stay as they are, whatever is up: those of a mesh in a robot description are the axes of the link.
    OfFile,
    /// They are turned so that Y is up, as assimp does for OMPL.app.
    YUp,
}

/// As [`read_mesh_of`], with these axes if it is a COLLADA mesh.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_with(files: &dyn Files, path: &Path, axes: Axes) -> Result<TriMesh, Error> {
    let (bytes, interrupt) = (files.read(path, MAX_MESH_BYTES)?, files.interrupt());
    let (file, bytes, interrupt) = (path.display().to_string(), bytes.as_slice(), &interrupt);
    let file = file.as_str();
    if files.only_reads() {
        return stand_in(file);
    }
    match MeshFormat::of(path, bytes) {
        Some(MeshFormat::Off) => {
            let document = OffDocument::parse_until(file, bytes, interrupt)?;
            if document.faces.iter().any(|face| face.corners.len() < 3) {
                files.note(path, LEFT_OUT);
            }
            document.to_mesh(file)
        }
        Some(MeshFormat::Gempa) => parse_gempa_mesh(file, bytes),
        Some(MeshFormat::Stl) => {
            parse_stl_until(file, bytes, interrupt, &mut |remark| files.note(path, remark))
        }
        Some(MeshFormat::Obj) => {
            parse_obj_until(file, bytes, interrupt, &mut |remark| files.note(path, remark))
        }
        Some(MeshFormat::Collada) => {
            let scene = Scene::parse(file, bytes, axes)?;
            scene.remarks(axes).iter().for_each(|remark| files.note(path, remark));
            scene.to_mesh(file)
        }
        None => Err(Error::new(ErrorKind::Unsupported, file, "this is not a mesh format that is read here")
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
    let too_large =
        |message: String| Error::new(ErrorKind::TooLarge, file, message).help("export the mesh as triangles");
    let mut cutting = 0;
    for n in faces.clone().map(<[u32]>::len) {
        if n > MAX_CORNERS {
            return Err(too_large(format!("a polygon has {n} corners, more than the {MAX_CORNERS} allowed")));
        }
        cutting += if n > 16 { n * n } else { 0 };
        if cutting > MAX_CUTTING {
            return Err(too_large("the polygons take too long to be cut into triangles".to_owned()));
        }
    }
    TriMesh::from_polygons(vertices, faces).map_err(|e| mesh_error(file, &e))
}

/// The error of a file whose triangles do not make a mesh.
pub(crate) fn mesh_error(file: &str, e: &MeshError) -> Error {
    let error = Error::new(ErrorKind::Content, file, e.to_string());
    match e {
        MeshError::Empty => error.help("a body needs at least one triangle"),
        _ => error.help("correct the program that wrote the mesh, or export it again"),
    }
}

/// The mesh of `file` as a solid; one that is a solid already is not looked at again.
pub(crate) fn solid_mesh(file: &str, mesh: TriMesh) -> Result<TriMesh, Error> {
    if !mesh.solids().is_empty() {
        return Ok(mesh);
    }
    mesh.into_solid().map_err(|e| {
        let message = format!("the mesh cannot be a solid: {e}");
        Error::new(ErrorKind::Content, file, message)
            .help("close it in a mesh editor, all triangles facing outward, or leave out `solid`: then it is a surface")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polygons_that_would_take_hours_are_refused() {
        let circle = |n: u32| {
            let angle = |i| f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            (0..n)
                .map(|i| Point3::new(mp_math::cos(angle(i)), mp_math::sin(angle(i)), 0.0))
                .collect::<Vec<_>>()
        };
        let face: Vec<u32> = (0..200).collect();
        let some = build("m", circle(200), std::iter::repeat_n(face.as_slice(), 3)).unwrap();
        assert_eq!(some.triangles().len(), 3 * 198);
        let e = build("m", circle(200), std::iter::repeat_n(face.as_slice(), 1_000_000)).unwrap_err();
        assert_eq!(e.kind(), ErrorKind::TooLarge);
    }

    #[test]
    fn formats_are_told_by_name_or_content() {
        let of = |name: &str, bytes: &[u8]| MeshFormat::of(Path::new(name), bytes);
        assert_eq!(of("a.OFF", b""), Some(MeshFormat::Off));
        assert_eq!(of("a.txt", b"12\n"), Some(MeshFormat::Gempa));
        assert_eq!(of("a.txt", b"\n COFF # x"), Some(MeshFormat::Off));
        assert_eq!(of("a", b"OFF 1 2 3"), Some(MeshFormat::Off));
        assert_eq!(of("a", b"solid x\n facet normal 0 0 1"), Some(MeshFormat::Stl));
        assert_eq!(of("a.xml", b"<?xml?><COLLADA"), Some(MeshFormat::Collada));
        assert_eq!(of("a.step", b"ISO-10303-21;"), None);
    }
}
