//! Writing OFF.

use super::{OffColor, OffDocument};
use crate::error::Error;
use crate::number::Row;
use mp_geom::TriMesh;
use std::fmt::Write as _;
use std::path::Path;

impl OffDocument {
    /// The text of the file. Numbers have the fewest digits that read back to the same bits.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut out = String::with_capacity(40 * (self.vertices.len() + self.faces.len()));
        let prefix = |on: bool, letters| if on { letters } else { "" };
        out.push_str(prefix(!self.texture.is_empty(), "ST"));
        out.push_str(prefix(!self.colors.is_empty(), "C"));
        out.push_str(prefix(!self.normals.is_empty(), "N"));
        out.push_str("OFF\n");
        for comment in &self.comments {
            // A line break inside a comment would end it.
            out.extend(["#", &comment.replace(['\n', '\r'], " "), "\n"]);
        }
        let edges = self.edges.map_or_else(String::new, |e| format!(" {e}"));
        let _ = writeln!(out, "{} {}{edges}", self.vertices.len(), self.faces.len());
        for (i, v) in self.vertices.iter().enumerate() {
            let _ = write!(out, "{}", Row(v.coords.as_slice()));
            if let Some(n) = self.normals.get(i) {
                let _ = write!(out, " {}", Row(n.as_slice()));
            }
            if let Some(c) = self.colors.get(i) {
                write_color(&mut out, *c);
            }
            if let Some(st) = self.texture.get(i) {
                let _ = write!(out, " {}", Row(st));
            }
            out.push('\n');
        }
        for face in &self.faces {
            let _ = write!(out, "{}", face.corners.len());
            for i in &face.corners {
                let _ = write!(out, " {i}");
            }
            if let Some(c) = face.color {
                write_color(&mut out, c);
            }
            out.push('\n');
        }
        out
    }
}

fn write_color(out: &mut String, color: OffColor) {
    // `{:?}` keeps the point in 1.0, which distinguishes numbers from 0 to 1 from those up to 255.
    let _ = match color {
        OffColor::Map(i) => write!(out, " {i}"),
        OffColor::Rgb([r, g, b]) => write!(out, " {r} {g} {b}"),
        OffColor::Rgba([r, g, b, a]) => write!(out, " {r} {g} {b} {a}"),
        OffColor::RgbF([r, g, b]) => write!(out, " {r:?} {g:?} {b:?}"),
        OffColor::RgbaF([r, g, b, a]) => write!(out, " {r:?} {g:?} {b:?} {a:?}"),
    };
}

/// The text of `mesh` as an OFF file of triangles; the number of edges is written as 0, as is the custom.
#[must_use]
pub fn off_text(mesh: &TriMesh) -> String {
    let mesh = &mesh.faceted();
    let mut out = String::with_capacity(40 * (mesh.vertices().len() + mesh.triangles().len()));
    let _ = writeln!(out, "OFF\n{} {} 0", mesh.vertices().len(), mesh.triangles().len());
    for v in mesh.vertices() {
        let _ = writeln!(out, "{}", Row(v.coords.as_slice()));
    }
    for [a, b, c] in mesh.triangles() {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    out
}

/// Writes `mesh` to `path` as an OFF file of triangles, in one step.
///
/// # Errors
/// [`Error`] when the file cannot be written; then nothing is left of it.
pub fn write_off(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), Error> {
    Ok(mp_store::write(path.as_ref(), off_text(mesh).as_bytes())?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

    #[test]
    fn text() {
        let corners = [[0.0, -0.0, 1e-9], [0.1, 1e300, 0.0], [10.0, 1.0 / 3.0, 2.0]].map(Point3::from);
        let mesh = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        assert_eq!(off_text(&mesh), "OFF\n3 1 0\n0 -0 1e-9\n0.1 1e300 0\n10 0.3333333333333333 2\n3 0 1 2\n");
    }
}
