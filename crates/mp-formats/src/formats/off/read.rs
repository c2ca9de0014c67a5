//! Reading OFF.

use super::{OffColor, OffDocument, OffFace};
use crate::encoding::decode_mesh;
use crate::error::{Error, ErrorKind};
use crate::files::{MAX_MESH_BYTES, read_file};
use crate::mesh;
use crate::text::{Lexer, Text, Token, clipped, is_not_a_number};
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::{Point3, Vector3};
use std::path::Path;

/// What vertices have besides positions, by the keyword of the file.
#[derive(Clone, Copy, Debug, Default)]
struct Header {
    texture: bool,
    colors: bool,
    normals: bool,
    /// Whether the colour of a vertex is before its normal: MeshLab writes them so, and `N` before `C`.
    color_first: bool,
}

/// What the letters before `OFF` say, each at most once and in any order, and whether vertices have other dimensions than three.
fn announced(prefix: &str) -> Option<(Header, bool)> {
    let (mut header, mut dimensions, mut rest) = (Header::default(), [false; 2], prefix);
    while !rest.is_empty() {
        let letters = ["ST", "C", "N", "4", "n"].into_iter().find(|letters| rest.starts_with(letters))?;
        let known = match letters {
            "ST" => &mut header.texture,
            "C" => &mut header.colors,
            "N" => &mut header.normals,
            "4" => &mut dimensions[0],
            _ => &mut dimensions[1],
        };
        if std::mem::replace(known, true) {
            return None;
        }
        header.color_first |= letters == "C" && header.normals;
        rest = &rest[letters.len()..];
    }
    Some((header, dimensions.contains(&true)))
}

impl OffDocument {
    /// Reads the file `path`.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read or is not OFF.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        Self::parse(&path.display().to_string(), &read_file(path, MAX_MESH_BYTES)?)
    }

    /// Reads `bytes`, the content of a file that errors call `file`.
    ///
    /// # Errors
    /// [`Error`] when it is not OFF, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        Self::parse_until(file, bytes, &Interrupt::never())
    }

    pub(crate) fn parse_until(file: &str, bytes: &[u8], interrupt: &Interrupt) -> Result<Self, Error> {
        refuse_binary(file, bytes)?;
        let decoded = decode_mesh(file, bytes)?;
        let text = Text { file, text: &decoded, guide: "off.md" };
        Reader { text, lexer: Lexer::new(&text), interrupt: interrupt.clone() }.document()
    }

    /// The triangle mesh: faces are cut into triangles, points and segments are left out.
    ///
    /// # Errors
    /// [`Error`] naming `file` when no face is left, or one cannot be cut into triangles.
    pub fn to_mesh(&self, file: &str) -> Result<TriMesh, Error> {
        let faces = self.faces.iter().filter(|f| f.corners.len() >= 3).map(|f| f.corners.as_slice());
        mesh::build(file, self.vertices.clone(), faces)
    }
}

fn refuse_binary(file: &str, bytes: &[u8]) -> Result<(), Error> {
    let first = bytes.split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or_default();
    if first.len() < 40 && first.ends_with(b"OFF BINARY") {
        return Err(Error::new(ErrorKind::Unsupported, file, "binary OFF is not read")
            .with_position(1, 1)
            .expected("text OFF")
            .help("convert the file to text OFF with a mesh tool"));
    }
    Ok(())
}

struct Reader<'a> {
    text: Text<'a>,
    lexer: Lexer<'a>,
    interrupt: Interrupt,
}

impl<'a> Reader<'a> {
    fn document(mut self) -> Result<OffDocument, Error> {
        let header = self.header()?;
        let mut doc = OffDocument::default();
        let counts = "the numbers of vertices, faces and edges";
        let nv = self.word(counts).and_then(|t| self.text.count(t, counts))?;
        let nf = self.word(counts).and_then(|t| self.text.count(t, counts))?;
        doc.edges = self.edges(counts)?;
        self.check_columns(nv, nf, header)?;
        self.vertices(nv, header, &mut doc)?;
        self.faces(nf, nv, &mut doc)?;
        if let Some(extra) = self.lexer.next() {
            return Err(self
                .text
                .error(extra, format!("`{}` follows the last face", clipped(extra.text)))
                .expected(format!("the end of the file after {nv} vertices and {nf} faces"))
                .help("correct the counts in the header, or remove what follows"));
        }
        doc.comments = comments(&self.text);
        Ok(doc)
    }

    fn header(&mut self) -> Result<Header, Error> {
        let what = "the keyword OFF, COFF, NOFF or STOFF";
        let mut lookahead = self.lexer.clone();
        let Some(word) = lookahead.next() else {
            return Err(self.text.error_at_end(what));
        };
        let Some(prefix) = word.text.strip_suffix("OFF") else {
            if word.text.parse::<usize>().is_ok() {
                return Ok(Header::default()); // the keyword may be left out
            }
            let message = format!("the file begins with `{}`", clipped(word.text));
            return Err(self.text.error(word, message).expected(what));
        };
        let known = announced(prefix);
        if let Some((header, false)) = known {
            self.lexer = lookahead;
            return Ok(header);
        }
        let dimensions = known.is_some();
        let message = format!("`{}` is not read", clipped(word.text));
        let mut e = self.text.error(word, message).expected(what);
        if dimensions {
            e = e.help("vertices must have three coordinates: convert the file to OFF");
        }
        Err(e.with_kind(if dimensions { ErrorKind::Unsupported } else { ErrorKind::Format }))
    }

    /// The number of edges, which may be missing. It is there if it is on the line of the counts, or alone on the
    /// next one.
    fn edges(&mut self, what: &str) -> Result<Option<u64>, Error> {
        let mut lookahead = self.lexer.clone();
        let token = match lookahead.next_on_line() {
            Some(t) => t,
            None => match lookahead.next() {
                Some(t) if lookahead.left_on_line() == 0 && t.text.parse::<u64>().is_ok() => t,
                _ => return Ok(None),
            },
        };
        self.lexer = lookahead;
        self.text.count(token, what).map(|n| Some(n as u64))
    }

    /// Refuses columns that the keyword does not announce: they would be read as coordinates of the next
    /// vertex, and the error would be hard to understand.
    fn check_columns(&self, nv: usize, nf: usize, header: Header) -> Result<(), Error> {
        let mut lookahead = self.lexer.clone();
        let Some(first) = lookahead.next() else { return Ok(()) };
        let columns = 1 + lookahead.left_on_line();
        if header.colors || header.normals || header.texture || nv < 2 || !matches!(columns, 6 | 7 | 9 | 10) {
            return Ok(());
        }
        // Several vertices on a line are allowed: line breaks mean nothing. But there is a fault if all lines have the same
        // number of words and there is one line for each vertex and face.
        let mut count = self.lexer.clone();
        let mut interrupt = self.interrupt.clone();
        for line in 0..nv.saturating_add(nf) {
            if interrupt.ask() {
                return Ok(());
            }
            if count.next().is_none() || (line < nv && count.left_on_line() + 1 != columns) {
                return Ok(());
            }
            while count.next_on_line().is_some() {}
        }
        let line = Token { text: &self.text.text[first.at..lookahead.position()], at: first.at };
        let message = format!("the vertices have {columns} numbers each");
        Err(self
            .text
            .error(line, message)
            .expected("three numbers: x y z")
            .help("begin the file with COFF if the others are colours, NOFF if they are normals"))
    }

    /// # Errors
    /// When the reader is interrupted.
    fn go_on(&mut self) -> Result<(), Error> {
        if self.interrupt.ask() { Err(Error::interrupted(self.text.file)) } else { Ok(()) }
    }

    fn vertices(&mut self, nv: usize, header: Header, doc: &mut OffDocument) -> Result<(), Error> {
        for i in 0..nv {
            self.go_on()?;
            let what = || format!("x y z of vertex {i} of {nv}");
            let p = self.three(&what)?;
            doc.vertices.push(Point3::from(p));
            for color in [header.color_first, !header.color_first] {
                if color && header.colors {
                    let color = self.vertex_color(i, header)?;
                    doc.colors.push(color);
                }
                if !color && header.normals {
                    doc.normals.push(self.normal(&|| format!("the normal of vertex {i}"))?);
                }
            }
            if header.texture {
                let what = || format!("texture coordinates of vertex {i}");
                doc.texture.push([self.real(&what)?, self.real(&what)?]);
            }
        }
        Ok(())
    }

    /// The colour of a vertex: three numbers when the rest of the line has just as many as that needs, else four.
    fn vertex_color(&mut self, vertex: usize, header: Header) -> Result<OffColor, Error> {
        let what = || format!("the colour of vertex {vertex}, three or four numbers");
        let after = 3 * usize::from(header.color_first) + 2 * usize::from(header.texture);
        let len = if self.lexer.left_on_line() == 3 + after { 3 } else { 4 };
        let mut tokens = Vec::with_capacity(4);
        for _ in 0..len {
            tokens.push(self.word(&what())?);
        }
        self.color(&tokens, &what())
    }

    fn faces(&mut self, nf: usize, nv: usize, doc: &mut OffDocument) -> Result<(), Error> {
        for i in 0..nf {
            self.go_on()?;
            let what = || format!("face {i} of {nf}: a number of corners, then as many vertices");
            let token = self.word_or(&what)?;
            let n = self.text.count(token, &what())?;
            if n == 0 {
                return Err(self.text.error(token, "a face without corners").expected(what()));
            }
            let mut corners = Vec::with_capacity(n.min(8));
            for _ in 0..n {
                let t = self.word_or(&what)?;
                let v = t.text.parse::<u64>().map_err(|_| {
                    let message = format!("`{}` is not the index of a vertex", clipped(t.text));
                    self.text.error(t, message).expected(what())
                })?;
                match u32::try_from(v) {
                    Ok(index) if v < nv as u64 => corners.push(index),
                    _ => {
                        return Err(self
                            .text
                            .error(t, format!("vertex {v} does not exist"))
                            .expected(format!("an index from 0 to {}", nv.saturating_sub(1)))
                            .help("indices of OFF count from 0"));
                    }
                }
            }
            let tokens: Vec<_> = std::iter::from_fn(|| self.lexer.next_on_line()).collect();
            let color = match tokens.len() {
                0 => None,
                _ => Some(self.color(&tokens, "a colour of 1, 3 or 4 numbers, or the end of the line")?),
            };
            doc.faces.push(OffFace { corners, color });
        }
        Ok(())
    }

    fn color(&self, tokens: &[Token<'a>], what: &str) -> Result<OffColor, Error> {
        let whole = tokens.iter().all(|t| t.text.bytes().all(|b| b.is_ascii_digit()));
        let byte = |t: &Token<'a>| {
            t.text.parse::<u8>().map_err(|_| {
                let message = format!("`{}` is not a colour", clipped(t.text));
                self.text.error(*t, message).expected("whole numbers from 0 to 255, or decimals from 0 to 1")
            })
        };
        // A share that is no number is none.
        let real = |t: &Token<'a>| if is_not_a_number(t.text) { Ok(0.0) } else { self.text.number(*t, what) };
        match *tokens {
            [ref i] if whole => Ok(OffColor::Map(self.text.count(*i, what)? as u64)),
            [ref r, ref g, ref b] if whole => Ok(OffColor::Rgb([byte(r)?, byte(g)?, byte(b)?])),
            [ref r, ref g, ref b, ref a] if whole => {
                Ok(OffColor::Rgba([byte(r)?, byte(g)?, byte(b)?, byte(a)?]))
            }
            [ref r, ref g, ref b] => Ok(OffColor::RgbF([real(r)?, real(g)?, real(b)?])),
            [ref r, ref g, ref b, ref a] => Ok(OffColor::RgbaF([real(r)?, real(g)?, real(b)?, real(a)?])),
            _ => {
                let at = tokens[0];
                let message = format!("`{}` is not a colour of a face", clipped(at.text));
                Err(self.text.error(at, message).expected(what))
            }
        }
    }

    fn word(&mut self, what: &str) -> Result<Token<'a>, Error> {
        self.lexer.next().ok_or_else(|| self.text.error_at_end(what))
    }

    fn word_or(&mut self, what: &dyn Fn() -> String) -> Result<Token<'a>, Error> {
        self.lexer.next().ok_or_else(|| self.text.error_at_end(what()))
    }

    fn real(&mut self, what: &dyn Fn() -> String) -> Result<f64, Error> {
        let token = self.word_or(what)?;
        match token.text.parse::<f64>() {
            Ok(v) if v.is_finite() => Ok(v),
            _ => self.text.number(token, &what()),
        }
    }

    /// A normal, which is zero where the file has no number.
    fn normal(&mut self, what: &dyn Fn() -> String) -> Result<Vector3<f64>, Error> {
        let mut normal = Vector3::zeros();
        for axis in 0..3 {
            let word = self.lexer.next().ok_or_else(|| self.text.error_at_end(what()))?;
            if !is_not_a_number(word.text) {
                normal[axis] = self.text.number(word, &what())?;
            }
        }
        Ok(normal)
    }

    fn three(&mut self, what: &dyn Fn() -> String) -> Result<[f64; 3], Error> {
        Ok([self.real(what)?, self.real(what)?, self.real(what)?])
    }
}

fn comments(text: &Text<'_>) -> Vec<String> {
    let mut lexer = Lexer::new(text);
    let mut out = Vec::new();
    while lexer.position() < text.text.len() {
        out.extend(lexer.next_line().map(str::to_owned));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> OffDocument {
        OffDocument::parse("t.off", text.as_bytes()).unwrap()
    }

    /// The letters of the keyword in any order; where `N` is before `C`, as in files of MeshLab, colours are before normals.
    #[test]
    fn keywords_have_their_letters_in_any_order() {
        let row = |words: [&str; 4]| format!("{} {} {}{}", words[0], words[1], words[2], words[3]);
        let (normal, rgba, texture) = ("0 0 1", "200 100 50 255", " 0.5 0.25");
        for (keyword, first, second, last) in [
            ("STCNOFF", normal, rgba, texture),
            ("CNSTOFF", normal, rgba, texture),
            ("CNOFF", normal, rgba, ""),
            ("NCOFF", rgba, normal, ""),
            ("NCSTOFF", rgba, normal, texture),
            ("STNCOFF", rgba, normal, texture),
            ("NCOFF", "200 100 50", normal, ""),
            ("NCSTOFF", "200 100 50", normal, texture),
        ] {
            let rows = ["0 0 0", "1 0 0", "0 1 0"].map(|at| row([at, first, second, last])).join("\n");
            let doc = parse(&format!("{keyword}\n3 1 0\n{rows}\n3 0 1 2\n"));
            assert_eq!(
                (doc.vertices[1], doc.normals[1]),
                (Point3::new(1.0, 0.0, 0.0), Vector3::z()),
                "{keyword}"
            );
            assert!(matches!(
                doc.colors[1],
                OffColor::Rgba([200, 100, 50, 255]) | OffColor::Rgb([200, 100, 50])
            ));
            assert_eq!(doc.texture.len(), if last.is_empty() { 0 } else { 3 }, "{keyword}");
            assert!(super::super::begins(keyword.as_bytes()));
        }
        for keyword in ["CCOFF", "NSTNOFF", "SOFF", "XOFF"] {
            assert!(fails(&format!("{keyword}\n0 0 0\n")).contains("is not read"), "{keyword}");
        }
        for keyword in ["nOFF", "C4OFF", "4CnOFF", "STCN4nOFF"] {
            let e = OffDocument::parse("t.off", format!("{keyword}\n3\n0 0 0\n").as_bytes()).unwrap_err();
            assert!(e.kind() == ErrorKind::Unsupported && e.remedy().is_some(), "{e}");
        }
        // As it is written, normals are before colours.
        let doc = parse("NCOFF\n3 1 0\n0 0 0 1 2 3 0 0 1\n1 0 0 1 2 3 0 0 1\n0 1 0 1 2 3 0 0 1\n3 0 1 2\n");
        assert_eq!(parse(&doc.to_text()), doc);
    }

    fn fails(text: &str) -> String {
        OffDocument::parse("t.off", text.as_bytes()).unwrap_err().to_string()
    }

    const TETRA: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

    #[test]
    fn headers_and_counts() {
        let plain = parse(&format!("OFF\n4 4 6\n{TETRA}"));
        assert_eq!((plain.vertices.len(), plain.faces.len(), plain.edges), (4, 4, Some(6)));
        for head in [
            "OFF 4 4 6\n",
            "# c\n\nOFF # d\n#e\n4 4\n6\n",
            "4 4 6\n",
            "OFF\r\n4\r\n4\r\n6\r\n",
            "\u{feff}OFF 4 4 6 #x\n",
        ] {
            let doc = parse(&format!("{head}{TETRA}"));
            assert_eq!(
                (&doc.vertices, &doc.faces, doc.edges),
                (&plain.vertices, &plain.faces, Some(6)),
                "{head}"
            );
        }
        assert_eq!(parse(&format!("OFF 4 4\n{TETRA}")).edges, None);
        assert_eq!(parse(&format!("OFF\n4 4\n{TETRA}")).edges, None);
        assert_eq!(parse(&format!("# a\nOFF#b\n4 4 6\n{TETRA}#c\n")).comments, [" a", "b", "c"]);
    }

    #[test]
    fn line_breaks_among_vertices_mean_nothing() {
        let doc = parse("OFF 4 1 0\n0 0 0 1 0 0\n0 1\n0 0 0 1\n3\n0 1 2\n");
        assert_eq!(doc.vertices[3], Point3::new(0.0, 0.0, 1.0));
        assert_eq!(doc.faces[0].corners, [0, 1, 2]);
    }

    #[test]
    fn colours_of_faces() {
        let doc = parse(
            "OFF 3 7 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2 7\n3 0 1 2 255 0 1\n3 0 1 2 255 0 1 9\n\
             3 0 1 2 0.5 0 1\n3 0 1 2 1.0 0 0 .25 # x\n3 0 1 2\n",
        );
        let colors: Vec<_> = doc.faces.iter().map(|f| f.color).collect();
        assert_eq!(
            colors,
            [
                None,
                Some(OffColor::Map(7)),
                Some(OffColor::Rgb([255, 0, 1])),
                Some(OffColor::Rgba([255, 0, 1, 9])),
                Some(OffColor::RgbF([0.5, 0.0, 1.0])),
                Some(OffColor::RgbaF([1.0, 0.0, 0.0, 0.25])),
                None,
            ]
        );
        assert_eq!(OffColor::Rgb([255, 0, 51]).rgba(), Some([1.0, 0.0, 0.2, 1.0]));
    }

    #[test]
    fn vertices_with_more() {
        let doc = parse("COFF 3 1 0\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n");
        assert_eq!(doc.colors[2], OffColor::Rgb([0, 0, 255]));
        let doc = parse("COFF 3 1 0\n0 0 0 1 0 0 .5\n1 0 0 0 1 0 .5\n0 1 0 0 0 1 .5\n3 0 1 2\n");
        assert_eq!(doc.colors[1], OffColor::RgbaF([0.0, 1.0, 0.0, 0.5]));
        let doc = parse("COFF 3 1 0  0 0 0 1 2 3 4  1 0 0 1 2 3 4  0 1 0 1 2 3 5\n3 0 1 2\n");
        assert_eq!(doc.colors[2], OffColor::Rgba([1, 2, 3, 5]));
        let doc = parse("STCNOFF 1 1 0\n1 2 3 0 0 1 9 8 7 .25 .75\n3 0 0 0\n");
        assert_eq!(doc.normals, [Vector3::z()]);
        assert_eq!(doc.colors, [OffColor::Rgb([9, 8, 7])]);
        assert_eq!(doc.texture, [[0.25, 0.75]]);
        assert_eq!(parse(&doc.to_text()), doc);
    }

    #[test]
    fn normals_that_are_no_numbers_and_comments_in_any_encoding() {
        for word in ["-nan(ind)", "-1.#IND", "nan", "1.#QNAN"] {
            let doc = parse(&format!(
                "NOFF 3 1 0\n0 0 0 {word} {word} {word}\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"
            ));
            assert_eq!(doc.normals, [Vector3::zeros(), Vector3::z(), Vector3::z()], "{word}");
            assert_eq!(doc.to_mesh("t.off").unwrap().triangles().len(), 1);
            let colored =
                format!("COFF 3 1 0\n0 0 0 {word} 0 1\n1 0 0 1 0 1\n0 1 0 1 0 {word}\n3 0 1 2 {word} 1 1\n");
            let doc = parse(&colored);
            assert_eq!(doc.colors[2], OffColor::RgbF([1.0, 0.0, 0.0]), "{word}");
            assert_eq!(doc.faces[0].color, Some(OffColor::RgbF([0.0, 1.0, 1.0])), "{word}");
            let e =
                OffDocument::parse("t.off", colored.replace("1 0 0 1", &format!("1 0 {word} 1")).as_bytes());
            assert_eq!(e.unwrap_err().line(), Some(3), "{word}");
        }
        let doc =
            OffDocument::parse("t.off", b"OFF # Geh\xe4use\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap();
        assert_eq!(doc.comments, [" Gehäuse"]);
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        let doc = parse("OFF 5 1 0\n0 0 0\n4 0 0\n4 4 0\n2 1 0\n0 4 0\n5 0 1 2 3 4\n");
        let mesh = doc.to_mesh("t.off").unwrap();
        assert_eq!(mesh.triangles().len(), 3);
        let area = |i| {
            let [a, b, c] = mesh.triangle(i);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        assert!(((0..3).map(area).sum::<f64>() - 10.0).abs() < 1e-12);
    }

    #[test]
    fn points_and_segments_are_no_surface() {
        let doc = parse("OFF 3 3 0\n0 0 0\n1 0 0\n0 1 0\n1 0\n2 0 1\n3 0 1 2\n");
        assert_eq!(doc.faces.len(), 3);
        assert_eq!(doc.to_mesh("t.off").unwrap().triangles().len(), 1);
    }

    #[test]
    fn bad_files() {
        assert_eq!(
            fails("PLY\n"),
            "t.off:1:1: the file begins with `PLY`; expected the keyword OFF, COFF, NOFF or STOFF"
        );
        assert!(fails("4OFF 1 1 0\n").contains("`4OFF` is not read"));
        assert!(fails("nOFF 3\n").contains("`nOFF` is not read"));
        assert_eq!(fails("OFF BINARY\n\0\0\u{1}"), "t.off:1:1: binary OFF is not read; expected text OFF");
        assert!(
            fails("OFF 2 2 0\n0 0 0 1 1 1\n0 0 0 1 1 1\n3 0 1 0\n3 0 1 0\n").contains("have 6 numbers each")
        );
        assert_eq!(
            fails("OFF 99999999999 4 0\n0 0 0\n"),
            "t.off:2:6: the file ends too early; expected x y z of vertex 1 of 99999999999"
        );
    }
}
