//! PLY, the polygon file format of Stanford, text and binary. See `docs/formats/meshes.md`.

use crate::encoding::decode_mesh;
use crate::error::{Error, ErrorKind};
use crate::mesh::{Axes, LEFT_OUT, Reading, build};
use crate::text::{Lexer, Text, Token, clipped, is_not_a_number};
use mp_geom::TriMesh;
use mp_stop::Interrupt;
use nalgebra::Point3;

/// Whether the first line is that of PLY.
pub(crate) fn begins(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"ply").is_some_and(|rest| rest.starts_with(b"\n") || rest.starts_with(b"\r"))
}

/// Reads `bytes`, the content of a PLY file that errors call `file`: its vertices and faces. Other elements and properties are
/// skipped.
pub(crate) fn read(file: &str, bytes: &[u8], reading: &mut Reading<'_>) -> Result<TriMesh, Error> {
    let (vertices, corners, ends) = elements(file, bytes, true, reading)?;
    let faces = ends.iter().enumerate().map(|(i, &end)| &corners[if i == 0 { 0 } else { ends[i - 1] }..end]);
    build(file, vertices, faces)
}

/// Reads the vertices alone, as points. They need not be finite.
pub(crate) fn read_points(file: &str, bytes: &[u8], interrupt: Interrupt) -> Result<Vec<Point3<f64>>, Error> {
    let reading =
        &mut Reading { axes: Axes::OfFile, interrupt, remark: &mut |_| (), beside: &crate::mesh::alone };
    elements(file, bytes, false, reading).map(|(vertices, ..)| vertices)
}

/// The vertices of a file, the corners of all its faces, and where those of each end.
type Elements = (Vec<Point3<f64>>, Vec<u32>, Vec<usize>);

/// Reads all elements; only vertices unless `with_faces`.
fn elements(
    file: &str,
    bytes: &[u8],
    with_faces: bool,
    reading: &mut Reading<'_>,
) -> Result<Elements, Error> {
    let start = body_of(bytes).unwrap_or(bytes.len());
    let head = decode_mesh(file, &bytes[..start])?;
    let header = Header::parse(&Text { file, text: &head, guide: "meshes.md" }, with_faces)?;
    let decoded;
    let mut body = if let Some(big) = header.big_endian {
        Body::Binary { file, bytes: &bytes[start..], big }
    } else {
        decoded = decode_mesh(file, bytes)?;
        let text = Text { file, text: &decoded, guide: "meshes.md" };
        let mut lexer = Lexer::new(&text);
        while lexer.next_on_line().is_none_or(|word| word.text != END) && lexer.position() < decoded.len() {
            lexer.next_line();
        }
        Body::Text(text, lexer)
    };
    let (mut vertices, mut corners, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        for row in 0..element.count {
            if reading.interrupt.ask() {
                return Err(Error::interrupted(file));
            }
            let (mut point, first) = (Point3::origin(), corners.len());
            for property in &element.properties {
                let what = || format!("`{}` of {} {row} of {}", property.name, element.name, element.count);
                let many = property.count.map(|of| body.whole(of, &what)).transpose()?;
                for _ in 0..many.map_or(1, |(many, _)| many) {
                    match property.role {
                        Role::Corners if !with_faces => body.skip(property.of, &what)?,
                        Role::Unused => body.skip(property.of, &what)?,
                        Role::Axis(k) if !with_faces => point[k] = body.any_number(property.of, &what)?.0,
                        Role::Axis(k) => point[k] = body.number(property.of, &what)?.0,
                        Role::Corners => {
                            let (corner, word) = body.whole(property.of, &what)?;
                            let known = u32::try_from(corner).ok().filter(|_| corner < header.vertices);
                            corners.push(known.ok_or_else(|| {
                                body.error(word, format!("vertex {corner} does not exist"))
                                    .expected(format!("{}: indices below {}", what(), header.vertices))
                                    .help("indices of PLY count from 0")
                            })?);
                        }
                    }
                }
            }
            match element.name {
                VERTEX => vertices.push(point),
                FACE if !with_faces => {}
                FACE if corners.len() - first < 3 => corners.truncate(first),
                FACE => ends.push(corners.len()),
                _ => {}
            }
        }
    }
    body.end(reading.remark)?;
    if with_faces && ends.len() < header.faces {
        (reading.remark)(LEFT_OUT);
    }
    Ok((vertices, corners, ends))
}

const VERTEX: &str = "vertex";
const FACE: &str = "face";
/// The last line of the header.
const END: &str = "end_header";

/// Where the header ends. Its lines end as the first one does: in binary, a line feed after a carriage return may be a number.
fn body_of(bytes: &[u8]) -> Option<usize> {
    let first = bytes.iter().position(|b| matches!(b, b'\n' | b'\r'))?;
    let length = if bytes[first..].starts_with(b"\r\n") { 2 } else { 1 };
    let end = &bytes[first..first + length];
    let mut at = 0;
    loop {
        let line = bytes[at..].windows(length).position(|window| window == end)?;
        let is_last = bytes[at..at + line].trim_ascii() == END.as_bytes();
        at += line + length;
        if is_last {
            return Some(at);
        }
    }
}

/// What a property is for.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// A coordinate of a vertex: 0 to 2.
    Axis(usize),
    /// The vertices of a face.
    Corners,
    Unused,
}

struct Property<'a> {
    name: &'a str,
    /// The type of the number of values, if it is a list.
    count: Option<Type>,
    of: Type,
    role: Role,
}

struct Element<'a> {
    name: &'a str,
    count: usize,
    properties: Vec<Property<'a>>,
}

struct Header<'a> {
    /// The order of bytes; `None` for text.
    big_endian: Option<bool>,
    elements: Vec<Element<'a>>,
    vertices: usize,
    faces: usize,
}

impl<'a> Header<'a> {
    fn parse(text: &Text<'a>, with_faces: bool) -> Result<Self, Error> {
        let mut lines = text.lines();
        let what = "`ply`, then `format ascii 1.0`, `binary_little_endian 1.0` or `binary_big_endian 1.0`";
        let mut line =
            || lines.next().ok_or_else(|| text.error_at_end(format!("a header that ends with `{END}`")));
        let (first, format) = (line()?, line()?);
        let big_endian = match (first.text, format.text.split_whitespace().nth(1)) {
            ("ply", Some("ascii")) => None,
            ("ply", Some("binary_little_endian")) => Some(false),
            ("ply", Some("binary_big_endian")) => Some(true),
            (begin, _) => {
                let wrong = if begin == "ply" { format } else { first };
                let message = format!("`{}` does not begin PLY", clipped(wrong.text));
                return Err(text.error(wrong, message).expected(what));
            }
        };
        let mut elements: Vec<Element<'_>> = Vec::new();
        loop {
            let line = line()?;
            let words: Vec<Token<'a>> = line.words().collect();
            let types: Vec<Option<Type>> = words.iter().map(|word| Type::of(word.text)).collect();
            let texts: Vec<&str> = words.iter().map(|word| word.text).collect();
            match (texts.as_slice(), elements.last_mut()) {
                ([END], _) => break,
                (["comment" | "obj_info", ..], _) => {}
                (["element", name, _], _) => {
                    let count = text.count(words[2], "the number of these elements")?;
                    if elements.iter().any(|element| element.name == *name) {
                        return Err(text.error(line, format!("`{}` is given twice", clipped(name))));
                    }
                    elements.push(Element { name, count, properties: Vec::new() });
                }
                (["property", _, name], Some(element)) if types[1].is_some() => {
                    let axis = ["x", "y", "z"].iter().position(|axis| axis == name);
                    let role = axis.filter(|_| element.name == VERTEX).map_or(Role::Unused, Role::Axis);
                    element.add(
                        text,
                        line,
                        Property { name, count: None, of: types[1].unwrap_or(Type::F64), role },
                    )?;
                }
                (["property", "list", _, _, name], Some(element))
                    if types[2].is_some() && types[3].is_some() =>
                {
                    let corners = element.name == FACE && matches!(*name, "vertex_indices" | "vertex_index");
                    let role = if corners { Role::Corners } else { Role::Unused };
                    element.add(
                        text,
                        line,
                        Property { name, count: types[2], of: types[3].unwrap_or(Type::F64), role },
                    )?;
                }
                _ => {
                    let message = format!("`{}` is not a line of a header", clipped(line.text));
                    return Err(text.error(line, message).expected(
                        "element NAME COUNT, property TYPE NAME, property list TYPE TYPE NAME, comment or end_header",
                    ));
                }
            }
        }
        if with_faces && elements.iter().any(|element| element.name == "tristrips" && element.count > 0) {
            let message = "the file has strips of triangles, which would be missing from the mesh";
            return Err(Error::new(ErrorKind::Unsupported, text.file, message)
                .expected("the element `face` alone")
                .help("export the mesh as polygons"));
        }
        let count = |name: &str, roles: &[Role]| {
            let element = elements.iter().find(|element| element.name == name)?;
            let has = |role: &Role| element.properties.iter().any(|property| property.role == *role);
            roles.iter().all(has).then_some(element.count)
        };
        let vertices = count(VERTEX, &[Role::Axis(0), Role::Axis(1), Role::Axis(2)]);
        let faces = count(FACE, &[Role::Corners]).or((!with_faces).then_some(0));
        let (Some(vertices), Some(faces)) = (vertices, faces) else {
            if !with_faces {
                let message = "the header announces no vertices";
                return Err(Error::new(ErrorKind::Unsupported, text.file, message)
                    .expected("the element `vertex` with x, y and z")
                    .help("export the points again"));
            }
            return Err(Error::new(
                ErrorKind::Unsupported,
                text.file,
                "the header announces no faces among vertices",
            )
            .expected(
                "the element `vertex` with x, y and z, and the element `face` with the list `vertex_indices`",
            )
            .help("export the mesh as polygons, not as strips of triangles; points alone are an obstacle of the shape `points`"));
        };
        Ok(Self { big_endian, elements, vertices, faces })
    }
}

impl<'a> Element<'a> {
    fn add(&mut self, text: &Text<'_>, line: Token<'_>, property: Property<'a>) -> Result<(), Error> {
        if self.properties.iter().any(|known| known.role != Role::Unused && known.role == property.role) {
            return Err(text.error(line, format!("`{}` is given twice", clipped(property.name))));
        }
        self.properties.push(property);
        Ok(())
    }
}

/// A type of numbers.
#[derive(Clone, Copy)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number in the first bytes, in little endian.
    fn value(self, bytes: [u8; 8]) -> f64 {
        let [a, b, c, d, ..] = bytes;
        match self {
            Self::I8 => i8::from_le_bytes([a]).into(),
            Self::U8 => a.into(),
            Self::I16 => i16::from_le_bytes([a, b]).into(),
            Self::U16 => u16::from_le_bytes([a, b]).into(),
            Self::I32 => i32::from_le_bytes([a, b, c, d]).into(),
            Self::U32 => u32::from_le_bytes([a, b, c, d]).into(),
            Self::F32 => f32::from_le_bytes([a, b, c, d]).into(),
            Self::F64 => f64::from_le_bytes(bytes),
        }
    }
}

/// What follows the header, as far as it is not read yet.
enum Body<'a> {
    Text(Text<'a>, Lexer<'a>),
    Binary { file: &'a str, bytes: &'a [u8], big: bool },
}

/// A number, and its word in text.
type Read<'a, T> = Result<(T, Option<Token<'a>>), Error>;

impl<'a> Body<'a> {
    /// The next number, which is finite.
    fn number(&mut self, of: Type, what: &dyn Fn() -> String) -> Read<'a, f64> {
        let (number, word) = self.any_number(of, what)?;
        match (&*self, word) {
            _ if number.is_finite() => Ok((number, word)),
            (Self::Text(text, _), Some(word)) => Ok((text.number(word, &what())?, Some(word))),
            _ => Err(self.error(word, format!("{number} is not finite")).expected(what())),
        }
    }

    /// The next number.
    fn any_number(&mut self, of: Type, what: &dyn Fn() -> String) -> Read<'a, f64> {
        Ok(match self {
            Self::Text(text, lexer) => {
                let word = lexer.next().ok_or_else(|| text.error_at_end(what()))?;
                match word.text.parse::<f64>() {
                    Ok(number) => (number, Some(word)),
                    Err(_) if is_not_a_number(word.text) => (f64::NAN, Some(word)),
                    Err(_) => (text.number(word, &what())?, Some(word)),
                }
            }
            Self::Binary { big, .. } => {
                let big = *big;
                let taken = self.take(of, what)?;
                let mut bytes = [0; 8];
                bytes[..taken.len()].copy_from_slice(taken);
                if big {
                    bytes[..taken.len()].reverse();
                }
                (of.value(bytes), None)
            }
        })
    }

    /// The next number, which is a count or an index.
    fn whole(&mut self, of: Type, what: &dyn Fn() -> String) -> Read<'a, usize> {
        let (number, word) = self.number(of, what)?;
        if number < 0.0 || number.fract() != 0.0 || number > f64::from(u32::MAX) {
            return Err(self.error(word, format!("{number} is no index or count")).expected(what()));
        }
        Ok((number as usize, word))
    }

    /// Passes over a number that is not used.
    fn skip(&mut self, of: Type, what: &dyn Fn() -> String) -> Result<(), Error> {
        match self {
            Self::Text(text, lexer) => lexer.next().map(drop).ok_or_else(|| text.error_at_end(what())),
            Self::Binary { .. } => self.take(of, what).map(drop),
        }
    }

    /// The bytes of the next number, in binary.
    fn take(&mut self, of: Type, what: &dyn Fn() -> String) -> Result<&'a [u8], Error> {
        let Self::Binary { bytes, file, .. } = self else { return Ok(&[]) };
        let (taken, rest) = bytes.split_at_checked(of.size()).ok_or_else(|| {
            Error::new(ErrorKind::Format, *file, "the file ends too early")
                .expected(what())
                .help("the file may be cut short: copy or export it again")
        })?;
        *bytes = rest;
        Ok(taken)
    }

    /// Refuses words after the last element; remarks on bytes.
    fn end(&mut self, remark: &mut dyn FnMut(&str)) -> Result<(), Error> {
        match self {
            Self::Binary { bytes: [], .. } => {}
            Self::Binary { bytes, .. } => {
                remark(&format!("{} bytes after the last element of PLY are passed over", bytes.len()));
            }
            Self::Text(text, lexer) => {
                if let Some(extra) = lexer.next() {
                    let message = format!("`{}` follows the last element", clipped(extra.text));
                    let help = "correct the counts in the header, or remove what follows";
                    return Err(text.error(extra, message).expected("the end of the file").help(help));
                }
            }
        }
        Ok(())
    }

    fn error(&self, word: Option<Token<'_>>, message: String) -> Error {
        match (self, word) {
            (Self::Text(text, _), Some(word)) => text.error(word, message),
            (Self::Text(Text { file, .. }, _) | Self::Binary { file, .. }, _) => {
                Error::new(ErrorKind::Format, *file, message)
                    .help("correct the program that wrote the mesh, or export it again")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{parse_mesh, parse_noting};

    /// A square in two faces with a normal, a colour, an edge and a point that is no face.
    const TEXT: &str = "ply\nformat ascii 1.0\ncomment by #hand\nelement vertex 4\nproperty float x\nproperty float y\n\
                        property float nx\nproperty double z\nelement edge 1\nproperty int a\nproperty list uchar int b\n\
                        element face 3\nproperty uchar red\nproperty list uchar int vertex_indices\nend_header\n\
                        0 0 nan 5\n1 0 0 5\n1 1 -1.#IND 5\n0 1.5 0 5\n7 2 8 9\n255 3 0 1 2\n0 1 3\n255 3 0 2 3\n";

    /// The same in binary.
    fn binary(big: bool, line_end: &str) -> Vec<u8> {
        let (head, body) = TEXT.split_once("end_header\n").unwrap();
        let head = format!("{head}end_header\n")
            .replace("ascii", if big { "binary_big_endian" } else { "binary_little_endian" });
        let mut out = head.replace('\n', line_end).into_bytes();
        let mut push = |bytes: &[u8]| match big {
            true => out.extend(bytes.iter().rev()),
            false => out.extend(bytes),
        };
        let rows: Vec<Vec<f64>> = body
            .lines()
            .map(|line| line.split(' ').map(|word| word.parse().unwrap_or(f64::NAN)).collect())
            .collect();
        for row in &rows[..4] {
            row[..3].iter().for_each(|&number| push(&(number as f32).to_le_bytes()));
            push(&row[3].to_le_bytes());
        }
        push(&7_i32.to_le_bytes());
        for row in &rows[4..] {
            let first = if row[0] == 7.0 { 1 } else { 0 };
            row[first..2].iter().for_each(|&number| push(&[number as u8]));
            row[2..].iter().for_each(|&number| push(&(number as i32).to_le_bytes()));
        }
        out
    }

    #[test]
    fn text_and_binary_give_the_same_mesh() {
        let mut remarks = Vec::new();
        let mesh =
            parse_noting("t.ply", TEXT.as_bytes(), &mut |remark| remarks.push(remark.to_owned())).unwrap();
        assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.vertices()[3], Point3::new(0.0, 1.5, 5.0));
        assert_eq!(remarks, [LEFT_OUT]);
        for big in [false, true] {
            for line_end in ["\n", "\r\n", "\r"] {
                let mut bytes = binary(big, line_end);
                assert_eq!(parse_mesh("told by content", &bytes).unwrap(), mesh, "{big} {line_end:?}");
                bytes.pop();
                let e = parse_mesh("t.ply", &bytes).unwrap_err();
                assert!(e.to_string().contains("too early; expected `vertex_indices` of face 2 of 3"), "{e}");
            }
        }
        assert_eq!(parse_mesh("t.ply", TEXT.replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    }

    #[test]
    fn a_number_may_look_like_the_end_of_a_line() {
        let mut bytes =
            b"ply\rformat binary_little_endian 1.0\relement face 1\rproperty list uchar uchar vertex_index\r\
                          element vertex 10\rproperty char x\rproperty char y\rproperty char z\rend_header\r"
                .to_vec();
        bytes.extend([10, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
        bytes.extend((0..10_u8).flat_map(|i| [i, i * i, 0]));
        assert_eq!(parse_mesh("t.ply", &bytes).unwrap().triangles().len(), 8);
    }

    /// Faces beside them would be read alone.
    #[test]
    fn strips_of_triangles_are_refused() {
        let strips = "element tristrips 1\nproperty list int int vertex_indices\nend_header";
        let text = TEXT.replace("end_header", strips) + "4 0 1 2 3\n";
        let e = parse_mesh("t.ply", text.as_bytes()).unwrap_err();
        assert!(e.message().contains("strips of triangles"), "{e}");
        crate::error::check_error(&e);
        let none = TEXT.replace("end_header", &strips.replace("tristrips 1", "tristrips 0"));
        assert_eq!(parse_mesh("t.ply", none.as_bytes()).unwrap().triangles().len(), 2);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        for (good, bad, message) in [
            ("ply", "plx", "t.ply:1:1: `plx` does not begin PLY"),
            ("ascii", "utf8", "t.ply:2:1: `format utf8 1.0` does not begin PLY"),
            ("float y", "real y", "t.ply:6:1: `property real y` is not a line of a header"),
            ("float y", "float x", "t.ply:6:1: `x` is given twice"),
            ("edge 1", "vertex 1", "t.ply:9:1: `vertex` is given twice"),
            ("vertex 4", "vertex many", "t.ply:4:16: `many` is not a count"),
            ("float y", "float v", "t.ply: the header announces no faces"),
            ("0 2 3\n", "0 2 4\n", "t.ply:23:11: vertex 4 does not exist"),
            ("0 2 3\n", "0 2 0.5\n", "t.ply:23:11: 0.5 is no index or count"),
            ("255 3 0 2", "255 -3 0 2", "t.ply:23:5: -3 is no index or count"),
            ("0 1.5 0 5", "0 inf 0 5", "t.ply:19:3: `inf` is not a finite number"),
            ("0 1.5 0 5", "0 1.#QNAN 0 5", "t.ply:19:3: `1.#QNAN` is not a number"),
            ("0 1.5 0 5", "0 1.5 0 1.#INF", "t.ply:19:9: `1.#INF` is not a number"),
            ("0 2 3\n", "0 2 3 1\n", "t.ply:23:13: `1` follows the last element"),
            ("0 2 3\n", "0 2\n", "t.ply:23:10: the file ends too early"),
            ("end_header", "end", "t.ply:15:1: `end` is not a line of a header"),
        ] {
            let text = TEXT.replacen(good, bad, 1);
            assert_ne!(text, TEXT, "{good}");
            let e = parse_mesh("t.ply", text.as_bytes()).unwrap_err();
            assert!(e.to_string().starts_with(message), "{e}");
            assert!(e.remedy().is_some(), "{e}");
        }
        let mut bytes = binary(false, "\n");
        let last = bytes.len() - 4;
        bytes[last] = 9;
        let e = parse_mesh("t.ply", &bytes).unwrap_err();
        assert!(
            e.to_string().starts_with("t.ply: vertex 9 does not exist; expected `vertex_indices` of face 2"),
            "{e}"
        );
    }
}
