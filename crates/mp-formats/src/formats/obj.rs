//! Wavefront OBJ: polygons. See `docs/formats/meshes.md`.

use crate::encoding::decode_mesh;
use crate::error::{Error, ErrorKind};
use crate::mesh::{LEFT_OUT, Reading, build};
use crate::text::{Text, Token, clipped, comment_at, is_not_a_number};
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::Point3;

/// Statements that are skipped: they describe no surface, or only its appearance.
const SKIPPED: [&str; 21] = [
    "vt",
    "vn",
    "vp",
    "p",
    "l",
    "g",
    "o",
    "s",
    "mg",
    "usemtl",
    "mtllib",
    "usemap",
    "maplib",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
];

/// Statements of curved surfaces, which would be missing from the mesh.
const CURVED: [&str; 13] =
    ["cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "con"];

/// Reads `bytes`, the content of an OBJ file that errors call `file`: its vertices and polygons. All groups
/// and objects become one mesh; texture, normals, materials, points and lines are skipped.
pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let interrupt = &mut reading.interrupt;
    let decoded = decode_mesh(file, bytes)?;
    let text = Text { file, text: &decoded, guide: "meshes.md" };
    // Faces may name vertices of later lines.
    let total = vertices_of(&text, interrupt);
    let mut vertices = Vec::with_capacity(total);
    let mut corners: Vec<u32> = Vec::new();
    let mut ends: Vec<usize> = Vec::new();
    let mut left_out = false;
    let mut lines = text.lines();
    let mut words = Vec::new();
    while let Some(line) = lines.next() {
        if interrupt.ask() {
            return Err(Error::interrupted(file));
        }
        statement(line, &mut lines, &mut words);
        let Some(&keyword) = words.first() else { continue };
        let values = &words[1..];
        match keyword.text {
            "v" => vertices.push(vertex(&text, line, values)?),
            "f" | "fo" => {
                if values.is_empty() {
                    return Err(text
                        .error(line, "a face without corners")
                        .expected("three or more vertices: v, v/vt, v//vn or v/vt/vn"));
                }
                for value in values {
                    corners.push(corner(&text, *value, vertices.len(), total)?);
                }
                // Points and segments are not surfaces, as in OFF.
                if values.len() < 3 {
                    corners.truncate(ends.last().copied().unwrap_or(0));
                    left_out = true;
                    continue;
                }
                ends.push(corners.len());
            }
            k if SKIPPED.contains(&k) => {}
            k => {
                let message = format!("`{}` is not a statement that is read here", clipped(k));
                let e = text.error(keyword, message).expected("v, f, or a statement of OBJ without surface");
                return Err(if CURVED.contains(&k) {
                    e.with_kind(ErrorKind::Unsupported).help("export curved surfaces as polygons")
                } else {
                    e
                });
            }
        }
    }
    if left_out {
        (reading.remark)(LEFT_OUT);
    }
    let faces = ends.iter().enumerate().map(|(i, &end)| &corners[if i == 0 { 0 } else { ends[i - 1] }..end]);
    build(file, vertices, faces)
}

/// How many vertices the file has; any number when `interrupt` says to end.
fn vertices_of(text: &Text<'_>, interrupt: &mut Interrupt) -> usize {
    let (mut lines, mut words, mut count) = (text.lines(), Vec::new(), 0);
    while let Some(line) = lines.next().filter(|_| !interrupt.ask()) {
        statement(line, &mut lines, &mut words);
        count += usize::from(words.first().is_some_and(|word| word.text == "v"));
    }
    count
}

/// Statements whose words are names of groups, materials and files.
const NAMING: [&str; 8] = ["g", "o", "usemtl", "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj"];

/// The words of a statement: of this line, and of the next ones while a line ends with `\`. After a name that takes a blank
/// before it: names end with this byte too, such as folders and characters of Shift-JIS, Big5 and GBK.
fn statement<'a>(line: Token<'a>, lines: &mut impl Iterator<Item = Token<'a>>, words: &mut Vec<Token<'a>>) {
    words.clear();
    let mut line = line;
    loop {
        let before_comment =
            comment_at(line.text).map_or(line, |i| Token { text: &line.text[..i], at: line.at });
        let whole = before_comment.text.trim_end();
        let mut goes_on = whole.strip_suffix('\\');
        words.extend(Token { text: goes_on.unwrap_or(whole), at: line.at }.words());
        if words.first().is_some_and(|word| NAMING.contains(&word.text)) {
            goes_on = goes_on.filter(|before| before.ends_with([' ', '\t']));
        }
        match goes_on.and_then(|_| lines.next()) {
            Some(next) => line = next,
            None => return,
        }
    }
}

fn vertex(text: &Text<'_>, line: Token<'_>, values: &[Token<'_>]) -> Result<Point3<f64>, Error> {
    let what = "x y z, then perhaps a weight or a colour";
    // x y z, x y z w, x y z r g b, x y z r g b a
    if !matches!(values.len(), 3 | 4 | 6 | 7) {
        return Err(text.error(line, format!("a vertex with {} numbers", values.len())).expected(what));
    }
    let mut p = Point3::origin();
    for (i, word) in values.iter().enumerate() {
        // Weight and colour are not used.
        match p.coords.get_mut(i) {
            Some(axis) => *axis = text.number(*word, what)?,
            None if is_not_a_number(word.text) => {}
            None => drop(text.number(*word, what)?),
        }
    }
    Ok(p)
}

/// The index of the vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`, which counts from 1, or back from −1, the last vertex so far.
fn corner(text: &Text<'_>, word: Token<'_>, so_far: usize, total: usize) -> Result<u32, Error> {
    let what = "v, v/vt, v//vn or v/vt/vn";
    let mut parts = word.text.split('/');
    let first = parts.next().unwrap_or_default();
    let rest_is_fine = parts.clone().count() <= 2 && parts.all(|p| p.is_empty() || p.parse::<i64>().is_ok());
    let (true, Ok(number)) = (rest_is_fine, first.parse::<i64>()) else {
        return Err(text.error(word, format!("`{}` is not a corner", clipped(word.text))).expected(what));
    };
    let index = if number < 0 { number.checked_add_unsigned(so_far as u64) } else { number.checked_sub(1) };
    let known = if number < 0 { so_far } else { total };
    index.and_then(|i| u32::try_from(i).ok()).filter(|&i| (i as usize) < known).ok_or_else(|| {
        let help = "indices of OBJ count from 1, negative ones back from the last vertex above";
        text.error(word, format!("vertex {number} does not exist"))
            .expected(format!("an index from 1 to {total}"))
            .help(help)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{parse_mesh, parse_noting};

    fn parse(text: &str) -> TriMesh {
        parse_mesh("t.obj", text.as_bytes()).unwrap()
    }

    #[test]
    fn corners_of_all_forms() {
        let mesh = parse(
            "# c\nmtllib a.mtl\no box\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\ng side # x\nv 1 1 0\nv 0 1 0\n\
             f 1/1/1 2//1 3/1\nf -4 -2 \\\n  -1\nusemtl m\ns off\nl 1 2\n",
        );
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_face_may_come_before_its_vertices_and_be_concave() {
        let mesh = parse("f 1 2 3 4 5\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\n");
        assert_eq!(mesh.triangles().len(), 3);
        let area: f64 = (0..3)
            .map(|i| {
                let [a, b, c] = mesh.triangle(i);
                0.5 * (b - a).cross(&(c - a)).norm()
            })
            .sum();
        assert!((area - 10.0).abs() < 1e-12);
    }

    #[test]
    fn every_statement_may_go_on_in_the_next_line() {
        let mesh = parse(
            "g a \\\nb\nv \\\n0 0 0\nv\\\n1 0 0\n\\\nv 0 1 \\\r\n0\nf \\\n\\\n1 2\\\n 3\n# end \\\nf 1 3 2",
        );
        assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (3, 2));
        // The group takes the next line: what is missing then is said with its line.
        let e = parse_mesh("t.obj", b"v 0 0 0\ng a \\\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap_err();
        assert_eq!((e.line(), e.column()), (Some(5), Some(7)), "{e}");
    }

    #[test]
    fn names_may_end_with_the_byte_of_a_backslash() {
        // 表 of Shift-JIS, 功 of Big5, 誠 of GBK, a character that begins with 0xa0, and a folder of Windows.
        for name in [&b"\x95\\"[..], b"\xa5\\", b"\xd5\\", b"\xa0\\", b"C:\\tex\\", b"a \x95\\ ", b"\\"] {
            for keyword in NAMING {
                let statement = [keyword.as_bytes(), b" x", name, b"\n"].concat();
                let text =
                    [b"v 0 0 0\n", &*statement, b"v 1 0 0\nv 0 1 0\n", &statement, b"f 1 2 3\n"].concat();
                assert_eq!(remarks(&text), (Ok(1), Vec::new()), "{}", text.escape_ascii());
            }
        }
    }

    /// What is read, in how many triangles, and what is remarked.
    fn remarks(bytes: &[u8]) -> (Result<usize, String>, Vec<String>) {
        let mut remarks = Vec::new();
        let mesh = parse_noting("t.obj", bytes, &mut |remark| remarks.push(remark.to_owned()));
        (mesh.map(|mesh| mesh.triangles().len()).map_err(|e| e.to_string()), remarks)
    }

    #[test]
    fn faces_of_fewer_than_three_corners_are_left_out() {
        let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
        for faces in ["f 1 2\nf 1 2 3\n", "f 1 2 3\nf 3\nf 1//1 -1//1\n", "f 2 2\nf 1 2 3\nf 1 2\nf 2 3\n"] {
            let said = vec![LEFT_OUT.to_owned()];
            assert_eq!(remarks(format!("{corners}{faces}").as_bytes()), (Ok(1), said), "{faces}");
        }
        // Their corners must exist, and something must be left.
        for bad in ["f 1 4\nf 1 2 3\n", "f\nf 1 2 3\n", "f 1 2\n"] {
            assert!(remarks(format!("{corners}{bad}").as_bytes()).0.is_err(), "{bad}");
        }
    }

    #[test]
    fn names_and_comments_in_any_encoding() {
        let text = b"# Gr\xfc\xdfe\nmtllib M\xf6bel.mtl\ng Geh\xe4use\nusemtl \x83n\nv 0 0 0 # \xb0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
        assert_eq!(remarks(text), (Ok(1), Vec::new()));
        let e = parse_mesh("t.obj", b"# \xe4\nv 0 \xe4 0\n").unwrap_err();
        assert_eq!((e.line(), e.column()), (Some(2), Some(5)), "{e}");
    }

    #[test]
    fn colours_may_be_no_numbers_but_positions_may_not() {
        for word in ["nan", "-nan(ind)", "1.#QNAN"] {
            let text = |z: &str, blue: &str| format!("v 0 0 {z} 1 0 {blue}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
            assert_eq!(remarks(text("0", word).as_bytes()), (Ok(1), Vec::new()), "{word}");
            assert!(remarks(text(word, "0").as_bytes()).0.is_err(), "{word}");
            assert!(
                remarks(format!("v 0 0 {word}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").as_bytes()).0.is_err(),
                "{word}"
            );
        }
        assert!(remarks(b"v 0 0 0 1 0 red\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").0.is_err());
    }

    #[test]
    fn bad_corners() {
        for bad in ["0", "4", "-4", "1/x", "1/1/1/1", "a", "99999999999999999999", "-9223372036854775808"] {
            let e = parse_mesh("t.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {bad}\n").as_bytes())
                .unwrap_err();
            assert_eq!((e.line(), e.column()), (Some(4), Some(7)), "{e}");
        }
    }
}
