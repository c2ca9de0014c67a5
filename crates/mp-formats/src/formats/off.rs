//! OFF, the object file format of Geomview, in text: meshes of polygons. See `docs/formats/off.md`.

mod read;
mod write;

pub use write::{off_text, write_off};

use crate::error::Error;
use crate::mesh::{LEFT_OUT, Reading};
use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};

/// Whether the first word is a keyword of OFF.
pub(crate) fn begins(bytes: &[u8]) -> bool {
    let head = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let end = head.iter().position(|b| b.is_ascii_whitespace() || *b == b'#').unwrap_or(head.len());
    (3..=9).contains(&end) && head[..end].ends_with(b"OFF")
}

pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let document = OffDocument::parse_until(file, bytes, &reading.interrupt)?;
    if document.faces.iter().any(|face| face.corners.len() < 3) {
        (reading.remark)(LEFT_OUT);
    }
    document.to_mesh(file)
}

/// A colour, in the form in which an OFF file has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OffColor {
    /// Index into a colour map.
    Map(u64),
    /// Red, green, blue, 0 to 255.
    Rgb([u8; 3]),
    /// Red, green, blue, alpha, 0 to 255.
    Rgba([u8; 4]),
    /// Red, green, blue, 0 to 1.
    RgbF([f64; 3]),
    /// Red, green, blue, alpha, 0 to 1.
    RgbaF([f64; 4]),
}

impl OffColor {
    /// Red, green, blue and alpha from 0 to 1; `None` for an index into a colour map.
    #[must_use]
    pub fn rgba(self) -> Option<[f64; 4]> {
        let unit = |v: u8| f64::from(v) / 255.0;
        match self {
            Self::Map(_) => None,
            Self::Rgb([r, g, b]) => Some([unit(r), unit(g), unit(b), 1.0]),
            Self::Rgba(c) => Some(c.map(unit)),
            Self::RgbF([r, g, b]) => Some([r, g, b, 1.0]),
            Self::RgbaF(c) => Some(c),
        }
    }
}

/// A face: a polygon, and its colour if it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct OffFace {
    /// Its corners, as indices of vertices. One or two make a point or a segment, which is not a surface.
    pub corners: Vec<u32>,
    /// Its colour.
    pub color: Option<OffColor>,
}

/// The whole content of an OFF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OffDocument {
    /// The comments, without the `#`, in the order of the file.
    pub comments: Vec<String>,
    /// Positions of the vertices.
    pub vertices: Vec<Point3<f64>>,
    /// Normals of the vertices (`NOFF`): empty, or one for each.
    pub normals: Vec<Vector3<f64>>,
    /// Colours of the vertices (`COFF`): empty, or one for each.
    pub colors: Vec<OffColor>,
    /// Texture coordinates of the vertices (`STOFF`): empty, or one for each.
    pub texture: Vec<[f64; 2]>,
    /// The faces, as indices of vertices.
    pub faces: Vec<OffFace>,
    /// The number of edges that the file states; readers do not use it.
    pub edges: Option<u64>,
}
