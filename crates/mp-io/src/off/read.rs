//! Reading OFF.

use super::{OffColor, OffDocument, OffFace};
use crate::error::{Error, ErrorKind};
use crate::mesh;
use crate::source::{MAX_MESH_BYTES, read_file};
use crate::text::{Lexer, Text, Token, clipped};
use mp_geom::TriMesh;
use nalgebra::{Point3, Vector3};
use std::path::Path;

#[derive(Clone, Copy, Debug, Default)]
struct Header {
    texture: bool,
    colors: bool,
    normals: bool,
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
        refuse_binary(file, bytes)?;
        let text = Text::new(file, bytes)?;
        Reader { text, lexer: Lexer::new(&text) }.document()
    }

    /// The triangle mesh: faces cut into triangles, points and segments left out.
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
        let mut ahead = self.lexer.clone();
        let Some(word) = ahead.next() else {
            return Err(self.text.error_at_end(what));
        };
        let Some(prefix) = word.text.strip_suffix("OFF") else {
            if word.text.parse::<usize>().is_ok() {
                return Ok(Header::default()); // the keyword may be left out
            }
            let message = format!("the file begins with `{}`", clipped(word.text));
            return Err(self.text.error(word, message).expected(what));
        };
        let mut rest = prefix;
        let mut take = |letters| match rest.strip_prefix(letters) {
            Some(r) => {
                rest = r;
                true
            }
            None => false,
        };
        let header = Header { texture: take("ST"), colors: take("C"), normals: take("N") };
        if rest.is_empty() {
            self.lexer = ahead;
            return Ok(header);
        }
        let dimensions = matches!(rest, "4" | "n" | "4n");
        let message = format!("`{}` is not read", clipped(word.text));
        let mut e = self.text.error(word, message).expected(what);
        if dimensions {
            e = e.help("vertices must have three coordinates: convert the file to OFF");
        }
        Err(e.with_kind(if dimensions { ErrorKind::Unsupported } else { ErrorKind::Format }))
    }

    /// The number of edges may be missing. It is there if it is on the line of the counts, or alone on the
    /// next one.
    fn edges(&mut self, what: &str) -> Result<Option<u64>, Error> {
        let mut ahead = self.lexer.clone();
        let token = match ahead.next_on_line() {
            Some(t) => t,
            None => match ahead.next() {
                Some(t) if ahead.left_on_line() == 0 && t.text.parse::<u64>().is_ok() => t,
                _ => return Ok(None),
            },
        };
        if let Some(extra) = ahead.next_on_line() {
            let message = format!("`{}` follows the counts", clipped(extra.text));
            return Err(self.text.error(extra, message).expected("three counts"));
        }
        self.lexer = ahead;
        self.text.count(token, what).map(|n| Some(n as u64))
    }

    /// Columns that the keyword does not announce would be read as coordinates of the next vertex: said
    /// here, where it can be said clearly.
    fn check_columns(&self, nv: usize, nf: usize, header: Header) -> Result<(), Error> {
        let mut ahead = self.lexer.clone();
        let Some(first) = ahead.next() else { return Ok(()) };
        let columns = 1 + ahead.left_on_line();
        if header.colors || header.normals || header.texture || nv < 2 || !matches!(columns, 6 | 7 | 9 | 10) {
            return Ok(());
        }
        let mut lines = 0;
        let mut count = self.lexer.clone();
        while lines < nv.saturating_add(nf) {
            if count.next().is_none() {
                return Ok(()); // several vertices on a line: breaks mean nothing
            }
            while count.next_on_line().is_some() {}
            lines += 1;
        }
        let line = Token { text: &self.text.text[first.at..ahead.position()], at: first.at };
        let message = format!("the vertices have {columns} numbers each");
        Err(self
            .text
            .error(line, message)
            .expected("three numbers: x y z")
            .help("begin the file with COFF if the others are colours, NOFF if they are normals"))
    }

    fn vertices(&mut self, nv: usize, header: Header, doc: &mut OffDocument) -> Result<(), Error> {
        for i in 0..nv {
            let what = || format!("x y z of vertex {i} of {nv}");
            let p = self.three(&what)?;
            doc.vertices.push(Point3::from(p));
            if header.normals {
                doc.normals.push(Vector3::from(self.three(&|| format!("the normal of vertex {i}"))?));
            }
            if header.colors {
                let color = self.vertex_color(i, header.texture)?;
                doc.colors.push(color);
            }
            if header.texture {
                let what = || format!("texture coordinates of vertex {i}");
                doc.texture.push([self.real(&what)?, self.real(&what)?]);
            }
        }
        Ok(())
    }

    /// Three numbers or four; which is told by the line when it holds one vertex, and is four otherwise.
    fn vertex_color(&mut self, vertex: usize, texture: bool) -> Result<OffColor, Error> {
        let what = || format!("the colour of vertex {vertex}, three or four numbers");
        let left = self.lexer.left_on_line();
        let len = if left == if texture { 5 } else { 3 } { 3 } else { 4 };
        let mut tokens = Vec::with_capacity(4);
        for _ in 0..len {
            tokens.push(self.word(&what())?);
        }
        self.color(&tokens, &what())
    }

    fn faces(&mut self, nf: usize, nv: usize, doc: &mut OffDocument) -> Result<(), Error> {
        for i in 0..nf {
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
        let real = |t: &Token<'a>| self.text.number(*t, what);
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
