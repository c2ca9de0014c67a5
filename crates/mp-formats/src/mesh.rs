//! Reading a mesh of any format, and making triangles of polygons.

use crate::error::{Error, ErrorKind};
use crate::files::{Disk, Files, MAX_MESH_BYTES, percent_decoded};
use crate::formats::Content;
use mp_geom::{MeshError, TriMesh};
use mp_stop::Interrupt;
use nalgebra::Point3;
use std::path::Path;

/// The most corners of a polygon that is cut into triangles; the time grows with the square of the corners.
pub const MAX_CORNERS: usize = 4096;
/// The largest sum, over all polygons of a mesh with more than 16 corners, of the squares of their corners: about a
/// minute.
const MAX_CUTTING: usize = 1_000_000_000;

/// The largest coordinate of a problem, metres: beyond it single precision and volumes lose their meaning.
pub const MAX_COORDINATE: f64 = 1e9;

/// The remark on a mesh with points and segments among its faces.
pub(crate) const LEFT_OUT: &str = "faces of fewer than three corners are left out";

/// Reads the mesh `path`, of any format for meshes in the [table](crate::formats::FORMATS). The ending of the name decides, or,
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

/// A mesh that stands for one that is not needed: so small that nothing collides with it.
pub fn stand_in(file: &str) -> Result<TriMesh, Error> {
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

/// What readers of meshes are given besides the bytes.
pub(crate) struct Reading<'a> {
    /// What becomes of the axes, for formats that say which is up.
    pub(crate) axes: Axes,
    /// What is asked whether to end.
    pub(crate) interrupt: Interrupt,
    /// Takes what was decided or passed over.
    pub(crate) remark: &'a mut dyn FnMut(&str),
    /// Reads a file that the mesh names, relative to it.
    pub(crate) beside: &'a dyn Fn(&str) -> Result<Vec<u8>, Error>,
}

/// What is said where a mesh names another file, and only its bytes are there.
pub(crate) fn alone(name: &str) -> Result<Vec<u8>, Error> {
    let message = format!("the mesh is in this file, which is not at hand: {}", crate::text::clipped(name));
    Err(Error::new(ErrorKind::Unsupported, crate::text::clipped(name), message)
        .help("export the mesh as one file"))
}

/// Reads the bytes of a mesh whose file errors call so.
pub(crate) type ReadMesh = fn(&str, &[u8], &mut Reading<'_>) -> Result<TriMesh, Error>;

/// Reads `bytes`, the content of a mesh in the format that the name `file`, or else the content, says. Errors call it `file`.
///
/// # Errors
/// As [`read_mesh`].
pub fn parse_mesh(file: &str, bytes: &[u8]) -> Result<TriMesh, Error> {
    parse_noting(file, bytes, &mut |_| ())
}

/// As [`parse_mesh`]; `remark` takes what was decided or passed over.
pub(crate) fn parse_noting(file: &str, bytes: &[u8], remark: &mut dyn FnMut(&str)) -> Result<TriMesh, Error> {
    let interrupt = Interrupt::never();
    reader(file, bytes)?(file, bytes, &mut Reading { axes: Axes::YUp, interrupt, remark, beside: &alone })
}

fn reader(file: &str, bytes: &[u8]) -> Result<ReadMesh, Error> {
    Content::of_mesh(Path::new(file), bytes).and_then(Content::mesh_reader).ok_or_else(|| {
        Error::new(ErrorKind::Unsupported, file, "this is not a mesh format that is read here")
            .expected(format!("a file {}", Content::endings(Content::is_mesh)))
            .help("convert the mesh to one of these")
    })
}

/// As [`read_mesh_of`], with these axes if it is a COLLADA mesh.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_with(files: &dyn Files, path: &Path, axes: Axes) -> Result<TriMesh, Error> {
    let (file, bytes) = (path.display().to_string(), files.read(path, MAX_MESH_BYTES)?);
    if files.only_reads() {
        return stand_in(&file);
    }
    let remark = &mut |remark: &str| files.note(path, remark);
    let beside = |uri: &str| {
        let literal = path.with_file_name(uri);
        let decoded = percent_decoded(uri).filter(|_| !files.holds(&literal));
        files.read(&decoded.map_or(literal, |name| path.with_file_name(name)), MAX_MESH_BYTES)
    };
    let reading = &mut Reading { axes, interrupt: files.interrupt(), remark, beside: &beside };
    let mesh = reader(&file, &bytes)?(&file, &bytes, reading)?;
    crate::trace::mesh(&file, &mesh);
    Ok(mesh)
}

/// The triangle mesh of polygons with at least three corners each, read from `file`. Vertices of no polygon are left out: they would
/// count for its size, and so for the distance that must be kept.
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
    let mesh = TriMesh::from_polygons(vertices, faces).map_err(|e| mesh_error(file, &e))?;
    Ok(mesh.without_unused_vertices())
}

/// The error of a file whose triangles do not make a mesh.
pub fn mesh_error(file: &str, e: &MeshError) -> Error {
    let error = Error::new(ErrorKind::Content, file, e.to_string());
    match e {
        MeshError::Empty => error.help("a body needs at least one triangle"),
        _ => error.help("correct the program that wrote the mesh, or export it again"),
    }
}

/// The mesh of `file` as a solid; one that is a solid already is not looked at again.
///
/// # Errors
/// When its surface is not closed, or does not face outward.
pub fn solid_mesh(file: &str, mesh: TriMesh) -> Result<TriMesh, Error> {
    if !mesh.solids().is_empty() {
        return Ok(mesh);
    }
    mesh.into_solid().map_err(|e| {
        let message = format!("the mesh cannot be a solid: {e}");
        Error::new(ErrorKind::Content, file, message)
            .help("close it in a mesh editor, all triangles facing outward, or leave out `solid`: then it is a surface")
    })
}

/// A vertex too far away to compute with, if there is one.
pub fn vertex_beyond(mesh: &TriMesh) -> Option<&Point3<f64>> {
    mesh.vertices().iter().find(|v| v.iter().any(|c| c.abs() > MAX_COORDINATE))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As of a scan that was cut, or points of a construction.
    #[test]
    fn vertices_of_no_face_do_not_count() {
        let collada = |far: &str| {
            let source = format!(
                "<source id=\"p\"><float_array id=\"a\" count=\"12\">0 0 0 {far} 1 0 0 0 1 0</float_array><technique_common>\
                <accessor source=\"#a\" count=\"4\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>\
                <param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
            );
            let mesh = format!(
                "<mesh>{source}<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"1\">\
                <input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 2 3</p></triangles></mesh>"
            );
            format!(
                "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><library_geometries><geometry id=\"g\">\
                {mesh}</geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node><instance_geometry url=\"#g\"/></node>\
                </visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
            )
        };
        let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
            property list uchar int vertex_indices\nend_header\n0 0 0\n9 9 9\n1 0 0\n0 1 0\n3 0 2 3\n";
        for (file, text) in [
            ("a.obj", "v 0 0 0\nv 9 9 9\nv 1 0 0\nv 0 1 0\nf 1 3 4\nl 1 2\n"),
            ("a.off", "OFF\n4 1 0\n0 0 0\n9 9 9\n1 0 0\n0 1 0\n3 0 2 3\n"),
            ("a.ply", ply),
            ("a.dae", &collada("9 9 9")),
        ] {
            let mesh = parse_mesh(file, text.as_bytes()).unwrap();
            let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Point3::from);
            assert_eq!((mesh.vertices(), mesh.triangles()), (&corners[..], &[[0, 1, 2]][..]), "{file}");
        }
    }

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
}
