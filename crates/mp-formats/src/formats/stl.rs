//! STL, text and binary: a triangle soup. See `docs/formats/meshes.md`.

use crate::encoding::decode_mesh;
use crate::error::{Error, ErrorKind};
use crate::mesh::{Reading, mesh_error};
use crate::number::Row;
use crate::text::{Lexer, Text, Token, clipped, is_not_a_number};
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::Point3;
use std::fmt::Write as _;
use std::path::Path;

/// Bytes before the triangles of a binary file, and of each triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Whether bytes begin like STL in text; binary files begin with anything.
pub(crate) fn begins(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(4096)];
    head.trim_ascii_start().starts_with(b"solid") && head.windows(5).any(|word| word == b"facet")
}

/// Reads `bytes`, the content of an STL file, text or binary, that errors call `file`. All solids of a file
/// become one mesh; identical vertices become one; the normals are skipped.
pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let Reading { interrupt, remark, .. } = reading;
    let soup = if is_binary(bytes) {
        if begins_with_solid(bytes) {
            remark("binary STL, although its header begins with `solid`");
        }
        binary(file, bytes, interrupt, remark)?
    } else {
        let decoded = decode_mesh(file, bytes)?;
        text(&Text { file, text: &decoded, guide: "meshes.md" }, interrupt, remark)?
    };
    let mesh = TriMesh::from_soup_until(&soup, interrupt).map_err(|_| Error::interrupted(file))?;
    mesh.map_err(|e| mesh_error(file, &e))
}

fn begins_with_solid(bytes: &[u8]) -> bool {
    let head = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    head.get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"))
}

/// Binary files may begin with "solid" too. Then their size decides, or the last byte of the number of triangles: it is zero in
/// all files that are small enough to be read, and no text has a zero byte.
fn is_binary(bytes: &[u8]) -> bool {
    binary_size(bytes) == Some(bytes.len() as u64)
        || !begins_with_solid(bytes)
        || bytes.get(HEAD - 1) == Some(&0)
}

/// The length of a binary file with this header, bytes.
fn binary_size(bytes: &[u8]) -> Option<u64> {
    let count: [u8; 4] = bytes.get(HEAD - 4..HEAD)?.try_into().ok()?;
    Some(HEAD as u64 + TRIANGLE as u64 * u64::from(u32::from_le_bytes(count)))
}

type Soup = Vec<[Point3<f64>; 3]>;

/// The triangles of a binary file. Bytes after them are passed over, unless they are more triangles.
fn binary(
    file: &str,
    bytes: &[u8],
    interrupt: &mut Interrupt,
    remark: &mut dyn FnMut(&str),
) -> Result<Soup, Error> {
    let bad = |message: String| Error::new(ErrorKind::Format, file, message);
    let Some(size) = binary_size(bytes) else {
        return Err(bad(format!("the file has {} bytes and does not begin with `solid`", bytes.len()))
            .expected("text STL, or binary STL with a header of 84 bytes")
            .help("the file may be cut short, or be of another format: export it again"));
    };
    let triangles = (size - HEAD as u64) / TRIANGLE as u64;
    if size > bytes.len() as u64 {
        return Err(bad(format!("the file has {} bytes", bytes.len()))
            .expected(format!(
                "{size} bytes of binary STL for the {triangles} triangles its header announces"
            ))
            .help("the file may be cut short, or be of another format: export it again"));
    }
    let (records, mut rest) = bytes[HEAD..].split_at(size as usize - HEAD);
    let mut records: Vec<_> = records.chunks_exact(TRIANGLE).collect();
    if let Some(spread) = with_attributes(bytes, records.len()).filter(|_| !rest.is_empty()) {
        (records, rest) = (spread, &[]);
    }
    let more = rest.len() / TRIANGLE;
    if rest.chunks_exact(TRIANGLE).any(|record| is_triangle(&corners(record))) {
        return Err(bad(format!(
            "the header announces {triangles} triangles, but {more} more seem to follow them"
        ))
        .expected("the number of all triangles in bytes 81 to 84")
        .help("the program that wrote the file did not complete it: export it again"));
    }
    if !rest.is_empty() {
        remark(&format!("{} bytes after the last triangle of binary STL are passed over", rest.len()));
    }
    let mut soup = Vec::with_capacity(records.len());
    for (i, record) in records.into_iter().enumerate() {
        if i % 1024 == 0 && interrupt.ask() {
            return Err(Error::interrupted(file));
        }
        let triangle = corners(record);
        for (k, v) in triangle.iter().enumerate().flat_map(|(k, corner)| corner.iter().map(move |v| (k, v))) {
            if !v.is_finite() {
                return Err(bad(format!("corner {k} of triangle {i} is not finite: {v}"))
                    .expected("finite coordinates")
                    .help("correct the program that wrote the file"));
            }
        }
        soup.push(triangle);
    }
    Ok(soup)
}

/// So many triangles, where each is followed by as many bytes as its last two say, to the end of the file. Mostly these two mean nothing.
fn with_attributes(bytes: &[u8], count: usize) -> Option<Vec<&[u8]>> {
    let (mut records, mut at) = (Vec::with_capacity(count), HEAD);
    for _ in 0..count {
        let record = bytes.get(at..at + TRIANGLE)?;
        at += TRIANGLE + usize::from(u16::from_le_bytes([record[TRIANGLE - 2], record[TRIANGLE - 1]]));
        records.push(record);
    }
    (at == bytes.len()).then_some(records)
}

/// The corners of a triangle of a binary file: 12 bytes of normal, then nine numbers.
fn corners(record: &[u8]) -> [Point3<f64>; 3] {
    let number = |i: usize| {
        let at = 12 + 4 * i;
        f64::from(f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]))
    };
    [0, 3, 6].map(|i| Point3::new(number(i), number(i + 1), number(i + 2)))
}

/// Whether these can be the corners of a triangle of a mesh: three places less than a million metres away. Bytes that are all the same give one place.
fn is_triangle(corners: &[Point3<f64>; 3]) -> bool {
    let [a, b, c] = corners;
    a != b && b != c && c != a && corners.iter().flat_map(|p| p.iter()).all(|v| v.abs() < 1e6)
}

/// The triangles of a text file.
fn text(text: &Text<'_>, interrupt: &mut Interrupt, remark: &mut dyn FnMut(&str)) -> Result<Soup, Error> {
    let mut lexer = Lexer::new(text);
    let mut soup = Vec::new();
    while let Some(word) = lexer.next() {
        let rest = &text.text[word.at..];
        if !soup.is_empty() && !word.text.eq_ignore_ascii_case("solid") && !has_facets(rest) {
            remark(&format!("{} bytes after the last solid are passed over", rest.trim_end().len()));
            break;
        }
        expect(text, Some(word), "solid")?;
        lexer.next_line(); // the rest of the line is a name
        loop {
            if interrupt.ask() {
                return Err(Error::interrupted(text.file));
            }
            let word = lexer.next();
            if word.is_some_and(|w| w.text.to_ascii_lowercase().starts_with("end")) {
                expect_end(text, word, &mut lexer, "solid")?;
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

/// Whether a text may have facets, well written or not.
fn has_facets(text: &str) -> bool {
    let text = text.to_ascii_lowercase();
    ["facet", "vertex"].iter().any(|word| text.contains(word))
}

/// Reads what follows the word `facet`.
fn facet(text: &Text<'_>, lexer: &mut Lexer<'_>) -> Result<[Point3<f64>; 3], Error> {
    expect(text, lexer.next(), "normal")?;
    for _ in 0..3 {
        // Normals are recomputed from the corners; writers put what is no number here for thin triangles.
        let word = lexer.next().ok_or_else(|| text.error_at_end("the normal, three numbers"))?;
        if word.text.parse::<f64>().is_err() && !is_not_a_number(word.text) {
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
    for part in ["loop", "facet"] {
        let word = lexer.next();
        expect_end(text, word, lexer, part)?;
    }
    Ok(triangle)
}

/// The end of a part, such as `endloop`. Some writers make two words of it.
fn expect_end(
    text: &Text<'_>,
    word: Option<Token<'_>>,
    lexer: &mut Lexer<'_>,
    part: &str,
) -> Result<(), Error> {
    match word {
        Some(w) if w.text.eq_ignore_ascii_case("end") => expect(text, lexer.next(), part),
        word => expect(text, word, &format!("end{part}")),
    }
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
    let mesh = &mesh.faceted();
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
    use crate::mesh::{parse_mesh, parse_noting};

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
        let again = parse_mesh("t.stl", stl_text(&mesh).as_bytes()).unwrap();
        assert_eq!(again.vertices().len(), 4);
        for i in 0..4 {
            assert_eq!(again.triangle(i), mesh.triangle(i));
        }
    }

    #[test]
    fn binary_even_when_it_begins_with_solid() {
        let mesh = parse_mesh("t.stl", &as_binary(&tetrahedron())).unwrap();
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (4, 4));
        let mut cut = as_binary(&tetrahedron());
        cut[0] = b'S' + 1;
        cut.pop();
        let e = parse_mesh("t.stl", &cut).unwrap_err();
        assert_eq!(
            e.to_string(),
            "t.stl: the file has 283 bytes; expected 284 bytes of binary STL for the 4 triangles its header announces"
        );
    }

    /// What is read, in how many triangles, and what is remarked.
    fn remarks(bytes: &[u8]) -> (Result<usize, String>, Vec<String>) {
        let mut remarks = Vec::new();
        let mesh = parse_noting("t.stl", bytes, &mut |remark| remarks.push(remark.to_owned()));
        (mesh.map(|mesh| mesh.triangles().len()).map_err(|e| e.to_string()), remarks)
    }

    #[test]
    fn bytes_after_binary_are_passed_over_and_said() {
        let solid = as_binary(&tetrahedron());
        let mut other = solid.clone();
        other[..5].copy_from_slice(b"SOLID");
        other[0] = b'X';
        for tail in [
            vec![0, 0],
            vec![b'\n'],
            b"made by some program".to_vec(),
            vec![0; 50],
            vec![b' '; 150],
            vec![7; 4096],
        ] {
            let said = format!("{} bytes after the last triangle", tail.len());
            let (read, remarked) = remarks(&[other.as_slice(), &tail].concat());
            assert!(
                read == Ok(4) && remarked.len() == 1 && remarked[0].starts_with(&said),
                "{read:?} {remarked:?}"
            );
            // A header that begins as text does: said as well.
            let (read, remarked) = remarks(&[solid.as_slice(), &tail].concat());
            assert!(
                read == Ok(4) && remarked.len() == 2 && remarked[0].contains("`solid`"),
                "{read:?} {remarked:?}"
            );
        }
        assert_eq!(remarks(&other), (Ok(4), Vec::new()));
        // A file cut short is binary all the same.
        let (read, _) = remarks(&solid[..200]);
        assert_eq!(
            read.unwrap_err(),
            "t.stl: the file has 200 bytes; expected 284 bytes of binary STL for the 4 triangles its header announces"
        );
        // Triangles beyond the number in the header would be missing from the mesh.
        for (announced, more) in [(3_u32, 1), (1, 3), (0, 4)] {
            let mut short = solid.clone();
            short[80..84].copy_from_slice(&announced.to_le_bytes());
            let e = remarks(&short).0.unwrap_err();
            assert!(e.contains(&format!("announces {announced} triangles, but {more} more")), "{e}");
            // Also with a line break after them.
            short.extend(b"\r\n");
            assert_eq!(remarks(&short).0.unwrap_err(), e);
        }
    }

    #[test]
    fn bytes_may_follow_each_triangle() {
        let plain = as_binary(&tetrahedron());
        let mut spread = plain[..HEAD].to_vec();
        spread[0] = b'-';
        for (record, count) in plain[HEAD..].chunks_exact(TRIANGLE).zip([0_u8, 3, 50, 1]) {
            spread.extend(&record[..TRIANGLE - 2]);
            spread.extend([count, 0]);
            spread.extend(vec![0x40; count.into()]);
        }
        assert_eq!(parse_mesh("t.stl", &spread).unwrap(), parse_mesh("t.stl", &plain).unwrap());
        assert_eq!(remarks(&spread), (Ok(4), Vec::new()));
    }

    #[test]
    fn normals_that_are_no_numbers() {
        let facet = |normal: &str| {
            format!(
                "solid a\nfacet normal {normal}\n outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"
            )
        };
        for word in [
            "-nan(ind)",
            "nan(snan)",
            "-NaN(0x8000000000000)",
            "nan",
            "+nanq",
            "-1.#IND",
            "1.#QNAN",
            "-1.#IND00",
            "1.#SNAN",
            "1.#INF",
            "-inf",
            "Infinity",
            "1.#J",
        ] {
            assert_eq!(remarks(facet(&[word; 3].join(" ")).as_bytes()), (Ok(1), Vec::new()), "{word}");
            assert_eq!(remarks(facet(&format!("0 {word} 1")).as_bytes()).0, Ok(1), "{word}");
        }
        for bad in ["0 0", "0 0 north", "x nan nan"] {
            assert!(remarks(facet(bad).as_bytes()).0.is_err(), "{bad}");
        }
        // Coordinates are used.
        let bad = facet("0 0 1").replace("vertex 1 0 0", "vertex 1 -nan(ind) 0");
        assert!(remarks(bad.as_bytes()).0.is_err());
    }

    /// numpy-stl#206, meshlab#194.
    #[test]
    fn ends_of_two_words() {
        let facet = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 end loop End Facet";
        let two = format!("solid a\n{facet}\n{facet}\nend solid a\nsolid b\n{facet}\nEND SOLID\n");
        assert_eq!(remarks(two.as_bytes()), (Ok(3), Vec::new()));
        let e = remarks(two.replacen("end loop", "end facet", 1).as_bytes()).0.unwrap_err();
        assert!(e.contains("`facet` is out of place; expected `loop`"), "{e}");
    }

    #[test]
    fn names_in_any_encoding() {
        let facet = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
        for name in [b"Geh\xe4use".as_slice(), "Gehäuse".as_bytes(), b"\x83n\x83E\x83W", b"\xb2\xbf\xbc\xfe"]
        {
            let text = [b"solid ", name, b"\n", facet.as_bytes(), b"\nendsolid ", name, b"\n"].concat();
            assert_eq!(remarks(&text), (Ok(1), Vec::new()), "{name:?}");
        }
    }

    #[test]
    fn words_after_text_are_passed_over_and_said() {
        let one = "solid a\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0\nvertex 0 1 0 endloop endfacet\nendsolid a\n";
        let (read, said) = remarks(format!("{one}made in SolidWorks,\n2x\n").as_bytes());
        assert_eq!((read, said), (Ok(1), vec!["22 bytes after the last solid are passed over".to_owned()]));
        assert_eq!(remarks(format!("{one}# by hand\n\0\x1a").as_bytes()), (Ok(1), Vec::new()));
        // What may be surface is not passed over.
        for more in ["facet normal 0 0 1", "by hand\nFacet", "v\nvertex 1 2 3"] {
            assert!(remarks(format!("{one}{more}\n").as_bytes()).0.is_err(), "{more}");
        }
        assert!(remarks(b"by hand").0.is_err());
    }

    #[test]
    fn several_solids_and_odd_layout() {
        let one = "SOLID a b\nfacet normal nan 0 0 outer loop vertex 0 0 0 vertex 1 0 0\nvertex 0 1 0 endloop endfacet\nEndSolid a b\n";
        assert_eq!(parse_mesh("t.stl", one.repeat(2).as_bytes()).unwrap().triangles().len(), 2);
    }
}
