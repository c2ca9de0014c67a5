//! GEMPA `.txt` meshes: a triangle soup in text.
//!
//! The papers name the format but do not show it; `docs/formats/gempa-mesh.md` defines it here: the
//! number of triangles, then nine numbers for each, the corners x y z one after the other.

use crate::error::Error;
use crate::mesh::{Reading, mesh_error};
use crate::number::Row;
use crate::text::{Lexer, Text, clipped};
use mp_geom::TriMesh;
use nalgebra::Point3;
use std::fmt::Write as _;
use std::path::Path;

/// Reads `bytes`, the content of a GEMPA `.txt` mesh that errors call `file`. Identical vertices become one.
///
/// # Errors
/// [`Error`] when it is not such a mesh, with the line and column.
pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let text = Text::new(file, bytes, "gempa-mesh.md")?;
    let mut lexer = Lexer::new(&text);
    let what = "the number of triangles";
    let first = lexer.next().ok_or_else(|| text.error_at_end(what))?;
    let n = text.count(first, what)?;
    if let Some(extra) = lexer.next_on_line() {
        let message = format!("`{}` follows the number of triangles", clipped(extra.text));
        return Err(text.error(extra, message).expected("the number of triangles alone on its line"));
    }
    let mut soup = Vec::new();
    for i in 0..n {
        reading.interrupt.go_on().map_err(|_| Error::interrupted(file))?;
        let mut corners = [Point3::origin(); 3];
        for (c, corner) in corners.iter_mut().enumerate() {
            for (k, axis) in ["x", "y", "z"].iter().enumerate() {
                let what = || format!("{axis} of corner {} of triangle {} of {n}", c + 1, i + 1);
                let token = lexer.next().ok_or_else(|| text.error_at_end(what()))?;
                corner[k] = match token.text.parse::<f64>() {
                    Ok(v) if v.is_finite() => v,
                    _ => text.number(token, &what())?,
                };
            }
        }
        soup.push(corners);
    }
    if let Some(extra) = lexer.next() {
        return Err(text
            .error(extra, format!("`{}` follows the last triangle", clipped(extra.text)))
            .expected(format!("the end of the file after {n} triangles of nine numbers"))
            .help("correct the count on the first line, or remove what follows"));
    }
    let mesh = TriMesh::from_soup_until(&soup, &reading.interrupt).map_err(|_| Error::interrupted(file))?;
    mesh.map_err(|e| mesh_error(file, &e))
}

/// The text of `mesh` as a GEMPA `.txt` mesh. Numbers have the fewest digits that read back to the same
/// bits.
#[must_use]
pub fn gempa_mesh_text(mesh: &TriMesh) -> String {
    let mesh = &mesh.faceted();
    let mut out = format!("{}\n", mesh.triangles().len());
    for i in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.triangle(i);
        let _ = writeln!(out, "{}", Row(&[a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z]));
    }
    out
}

/// Writes `mesh` to `path` as a GEMPA `.txt` mesh, in one step.
///
/// # Errors
/// [`Error`] when the file cannot be written; then nothing is left of it.
pub fn write_gempa_mesh(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), Error> {
    Ok(mp_store::write(path.as_ref(), gempa_mesh_text(mesh).as_bytes())?)
}
