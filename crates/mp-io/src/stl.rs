//! STL, text and binary: a triangle soup. See `docs/formats/meshes.md`.

use crate::error::{Error, ErrorKind};
use crate::mesh::mesh_error;
use crate::number::Row;
use crate::text::{Lexer, Text, Token, clipped};
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::Point3;
use std::fmt::Write as _;
use std::path::Path;

/// Bytes before the triangles of a binary file, and of each triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Reads `bytes`, the content of an STL file, text or binary, that errors call `file`. All solids of a file
/// become one mesh; identical vertices become one; the normals are skipped.
///
/// # Errors
/// [`Error`] when it is not STL: for text with line and column, for binary with the triangle.
pub fn parse_stl(file: &str, bytes: &[u8]) -> Result<TriMesh, Error> {
    parse_stl_until(file, bytes, &Interrupt::never())
}

pub(crate) fn parse_stl_until(file: &str, bytes: &[u8], interrupt: &Interrupt) -> Result<TriMesh, Error> {
    let mut interrupt = interrupt.clone();
    // Binary files may begin with "solid" too, so their size decides.
    let soup = if binary_size(bytes) == Some(bytes.len() as u64) || !begins_with_solid(bytes) {
        binary(file, bytes, &mut interrupt)?
    } else {
        text(&Text::new(file, bytes, "meshes.md")?, (file, &mut interrupt))?
    };
    if interrupt.ask() {
        return Err(Error::interrupted(file));
    }
    TriMesh::from_soup(&soup).map_err(|e| mesh_error(file, &e))
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let head = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    head.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"))
}

/// The length of a binary file with this header, bytes.
fn binary_size(bytes: &[u8]) -> Option<u64> {
    let count: [u8; 4] = bytes.get(HEAD - 4..HEAD)?.try_into().ok()?;
    Some(HEAD as u64 + TRIANGLE as u64 * u64::from(u32::from_le_bytes(count)))
}

type Soup = Vec<[Point3<f64>; 3]>;

/// The triangles of a binary file.
fn binary(file: &str, bytes: &[u8], interrupt: &mut Interrupt) -> Result<Soup, Error> {
    let bad = |message: String| Error::new(ErrorKind::Format, file, message);
    let Some(size) = binary_size(bytes) else {
        return Err(bad(format!("the file has {} bytes and does not begin with `solid`", bytes.len()))
            .expected("text STL, or binary STL with a header of 84 bytes")
            .help("the file may be cut short, or be of another format: export it again"));
    };
    if size != bytes.len() as u64 {
        let triangles = (size - HEAD as u64) / TRIANGLE as u64;
        return Err(bad(format!("the file has {} bytes", bytes.len()))
            .expected(format!(
                "{size} bytes of binary STL for the {triangles} triangles its header announces"
            ))
            .help("the file may be cut short, or be of another format: export it again"));
    }
    let mut soup = Vec::with_capacity((bytes.len() - HEAD) / TRIANGLE);
    for (i, record) in bytes[HEAD..].chunks_exact(TRIANGLE).enumerate() {
        if i % 1024 == 0 && interrupt.ask() {
            return Err(Error::interrupted(file));
        }
        let mut triangle = [Point3::origin(); 3];
        // 12 bytes of normal, then nine numbers, then two bytes that mean nothing.
        for (k, number) in record[12..48].chunks_exact(4).enumerate() {
            let v = f32::from_le_bytes([number[0], number[1], number[2], number[3]]);
            if !v.is_finite() {
                return Err(bad(format!("corner {} of triangle {i} is not finite: {v}", k / 3))
                    .expected("finite coordinates")
                    .help("correct the program that wrote the file"));
            }
            triangle[k / 3][k % 3] = f64::from(v);
        }
        soup.push(triangle);
    }
    Ok(soup)
}

/// The triangles of a text file.
fn text(text: &Text<'_>, (file, interrupt): (&str, &mut Interrupt)) -> Result<Soup, Error> {
    let mut lexer = Lexer::new(text);
    let mut soup = Vec::new();
    while let Some(word) = lexer.next() {
        expect(text, Some(word), "solid")?;
        lexer.next_line(); // the rest of the line is a name
        loop {
            if interrupt.ask() {
                return Err(Error::interrupted(file));
            }
            let word = lexer.next();
            if word.is_some_and(|w| w.text.eq_ignore_ascii_case("endsolid")) {
                lexer.next_line();
                break;
            }
            if word.is_some_and(|w| !w.text.eq_ignore_ascii_case("facet")) || word.is_none() {
                return Err(unexpected(text, word, "`facet` or `endsolid`"));
            }
            soup.push(facet(text, &mut lexer)?);
        }
    }
    Ok(soup)
}

/// Reads what follows the word `facet`.
fn facet(text: &Text<'_>, lexer: &mut Lexer<'_>) -> Result<[Point3<f64>; 3], Error> {
    expect(text, lexer.next(), "normal")?;
    for _ in 0..3 {
        // Normals are recomputed from the corners; writers put NaN here for thin triangles.
        let word = lexer.next().ok_or_else(|| text.error_at_end("the normal, three numbers"))?;
        if word.text.parse::<f64>().is_err() {
            text.number(word, "the normal, three numbers")?;
        }
    }
    expect(text, lexer.next(), "outer")?;
    expect(text, lexer.next(), "loop")?;
    let mut triangle = [Point3::origin(); 3];
    for corner in &mut triangle {
        expect(text, lexer.next(), "vertex")?;
        for axis in 0..3 {
            let what = "x y z of the vertex";
            let word = lexer.next().ok_or_else(|| text.error_at_end(what))?;
            corner[axis] = text.number(word, what)?;
        }
    }
    expect(text, lexer.next(), "endloop")?;
    expect(text, lexer.next(), "endfacet")?;
    Ok(triangle)
}

fn expect(text: &Text<'_>, word: Option<Token<'_>>, keyword: &str) -> Result<(), Error> {
    match word {
        Some(w) if w.text.eq_ignore_ascii_case(keyword) => Ok(()),
        _ => Err(unexpected(text, word, &format!("`{keyword}`"))),
    }
}

fn unexpected(text: &Text<'_>, word: Option<Token<'_>>, expected: &str) -> Error {
    match word {
        None => text.error_at_end(expected),
        Some(w) => text.error(w, format!("`{}` is out of place", clipped(w.text))).expected(expected),
    }
}

/// Writes `mesh` to `path` as text STL, in one step.
///
/// # Errors
/// [`Error`] when the file cannot be written; then nothing is left of it.
pub fn write_stl(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), Error> {
    Ok(mp_store::write(path.as_ref(), stl_text(mesh).as_bytes())?)
}

/// The text of `mesh` as text STL. Coordinates have the fewest digits that read back to the same bits.
#[must_use]
pub fn stl_text(mesh: &TriMesh) -> String {
    let mut out = String::from("solid mesh\n");
    for i in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.triangle(i);
        // Both edges are first divided by their largest coordinate, so that no product overflows or vanishes.
        let (u, v) = (b - a, c - a);
        let scaled =
            u.unscale(u.amax().max(f64::MIN_POSITIVE)).cross(&v.unscale(v.amax().max(f64::MIN_POSITIVE)));
        let normal = scaled.try_normalize(0.0).unwrap_or_default();
        let _ = writeln!(out, "facet normal {}\nouter loop", Row(normal.as_slice()));
        for p in [a, b, c] {
            let _ = writeln!(out, "vertex {}", Row(p.coords.as_slice()));
        }
        out.push_str("endloop\nendfacet\n");
    }
    out.push_str("endsolid mesh\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> TriMesh {
        mp_geom::primitives::tetrahedron(1.0).unwrap()
    }

    fn as_binary(mesh: &TriMesh) -> Vec<u8> {
        let mut out = b"solid but binary".to_vec();
        out.resize(80, 0);
        out.extend(u32::try_from(mesh.triangles().len()).unwrap().to_le_bytes());
        for i in 0..mesh.triangles().len() {
            out.extend([0; 12]);
            for p in mesh.triangle(i) {
                p.iter().for_each(|v| out.extend((*v as f32).to_le_bytes()));
            }
            out.extend([0; 2]);
        }
        out
    }

    #[test]
    fn text_round_trips() {
        let mesh = tetrahedron();
        let again = parse_stl("t.stl", stl_text(&mesh).as_bytes()).unwrap();
        assert_eq!(again.vertices().len(), 4);
        for i in 0..4 {
            assert_eq!(again.triangle(i), mesh.triangle(i));
        }
    }

    #[test]
    fn binary_even_when_it_begins_with_solid() {
        let mesh = parse_stl("t.stl", &as_binary(&tetrahedron())).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (4, 4));
        let mut cut = as_binary(&tetrahedron());
        cut[0] = b'S' + 1;
        cut.pop();
        let e = parse_stl("t.stl", &cut).unwrap_err();
        assert_eq!(
            e.to_string(),
            "t.stl: the file has 283 bytes; expected 284 bytes of binary STL for the 4 triangles its header announces"
        );
    }

    #[test]
    fn several_solids_and_odd_layout() {
        let one = "SOLID a b\nfacet normal nan 0 0 outer loop vertex 0 0 0 vertex 1 0 0\nvertex 0 1 0 endloop endfacet\nEndSolid a b\n";
        assert_eq!(parse_stl("t.stl", one.repeat(2).as_bytes()).unwrap().triangles().len(), 2);
    }
}
