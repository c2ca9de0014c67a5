//! PCD, the point clouds of PCL: text, binary, and binary compressed by LZF.

use super::{GUIDE, all, any_number, bytes_at, error, rows};
use crate::encoding::decode_mesh;
use crate::error::{Error, ErrorKind};
use crate::files::MAX_MESH_BYTES;
use crate::text::{Text, Token, clipped};
use mp_stop::Interrupt;
use nalgebra::Point3;

/// The size (bytes) of a value, and where the values of one point begin: in a row, and in words of text.
#[derive(Clone, Copy)]
struct Axis {
    size: usize,
    byte: usize,
    word: usize,
}

struct Header {
    axes: [Axis; 3],
    /// The size of a point, bytes.
    row: usize,
    points: usize,
    data: Data,
}

#[derive(Clone, Copy)]
enum Data {
    Text,
    Binary,
    Compressed,
}

pub(super) fn read(file: &str, bytes: &[u8], interrupt: &mut Interrupt) -> Result<Vec<Point3<f64>>, Error> {
    let start = body_of(bytes).unwrap_or(bytes.len());
    let head = decode_mesh(file, &bytes[..start])?;
    let header = Header::parse(&Text { file, text: &head, guide: GUIDE })?;
    match header.data {
        Data::Text => text(file, bytes, &header, interrupt),
        Data::Binary => {
            let rows = rows(file, bytes, start, header.points, header.row)?;
            all(file, rows.map(|row| header.point(file, |axis| row.get(axis.byte..))), interrupt)
        }
        Data::Compressed => {
            let [packed, size] = [0, 4].map(|at| bytes_at(file, bytes, start + at).map(u32::from_le_bytes));
            let (packed, size) = (packed? as usize, size? as usize);
            let expected =
                header.points.checked_mul(header.row).filter(|size| *size as u64 <= MAX_MESH_BYTES);
            if expected != Some(size) {
                let message =
                    format!("{size} bytes announced for {} points of {} bytes", header.points, header.row);
                return Err(error(file, start + 4, message));
            }
            let packed = bytes[start + 8..].get(..packed);
            let packed = packed.ok_or_else(|| error(file, bytes.len(), "the file ends too early"))?;
            let bytes = unpacked(packed, size)
                .ok_or_else(|| error(file, start + 8, "the compressed points are damaged"))?;
            // All values of a field, then all of the next.
            let n = header.points;
            let point = |i| header.point(file, |axis| bytes.get(n * axis.byte + i * axis.size..));
            all(file, (0..n).map(point), interrupt)
        }
    }
}

fn text(
    file: &str,
    bytes: &[u8],
    header: &Header,
    interrupt: &mut Interrupt,
) -> Result<Vec<Point3<f64>>, Error> {
    let decoded = decode_mesh(file, bytes)?;
    let text = Text { file, text: &decoded, guide: GUIDE };
    let mut lines = text.lines().skip_while(|line| !is_last(line.text)).skip(1);
    let mut points = Vec::new();
    for i in 0..header.points {
        interrupt.go_on().map_err(|_| Error::interrupted(file))?;
        let line =
            lines.next().ok_or_else(|| text.error_at_end(format!("point {} of {}", i + 1, header.points)))?;
        let words: Vec<Token<'_>> = line.words().collect();
        let mut point = Point3::origin();
        for (number, axis) in point.iter_mut().zip(&header.axes) {
            let word =
                words.get(axis.word).ok_or_else(|| text.error(line, "a number of the point is missing"))?;
            *number = any_number(&text, *word)?;
        }
        points.push(point);
    }
    match lines.next() {
        Some(line) => {
            Err(text.error(line, "a line follows the last point").expected("as many points as POINTS says"))
        }
        None => Ok(points),
    }
}

/// Whether a line is the last one of the header.
fn is_last(line: &str) -> bool {
    line.split_whitespace().next() == Some("DATA")
}

/// Where the header ends.
fn body_of(bytes: &[u8]) -> Option<usize> {
    let mut at = 0;
    loop {
        let line = bytes[at..].iter().position(|b| *b == b'\n')?;
        let last = bytes[at..at + line].trim_ascii().starts_with(b"DATA");
        at += line + 1;
        if last {
            return Some(at);
        }
    }
}

impl Header {
    fn parse(text: &Text<'_>) -> Result<Self, Error> {
        let (mut fields, mut sizes, mut types, mut counts) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut points, mut area, mut data) = (None, Some(1_usize), None);
        for line in text.lines().filter(|line| !line.text.starts_with('#')) {
            let words: Vec<Token<'_>> = line.words().collect();
            let [name, values @ ..] = words.as_slice() else { continue };
            let numbers =
                || values.iter().map(|word| text.count(*word, "a count")).collect::<Result<Vec<_>, _>>();
            match name.text {
                "FIELDS" | "COLUMNS" => fields = values.iter().map(|word| word.text).collect(),
                "SIZE" => sizes = numbers()?,
                "TYPE" => types = values.iter().map(|word| word.text).collect(),
                "COUNT" => counts = numbers()?,
                "WIDTH" | "HEIGHT" => {
                    let sides = numbers()?;
                    area = area.and_then(|area| area.checked_mul(*sides.first()?));
                }
                "POINTS" => points = numbers()?.first().copied(),
                "VERSION" | "VIEWPOINT" => {}
                "DATA" => {
                    data = Some(match values.first().map(|word| word.text) {
                        Some("ascii") => Data::Text,
                        Some("binary") => Data::Binary,
                        Some("binary_compressed") => Data::Compressed,
                        _ => {
                            let message = "the points are written in no known way";
                            return Err(text
                                .error(line, message)
                                .expected("DATA ascii, binary or binary_compressed"));
                        }
                    });
                }
                other => {
                    let message = format!("`{}` is not a line of a header of PCD", clipped(other));
                    return Err(text
                        .error(*name, message)
                        .expected("FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, POINTS, DATA"));
                }
            }
        }
        let incomplete = |what: &str| {
            let expected =
                "FIELDS with x, y and z, SIZE and TYPE of each (floats of 4 or 8 bytes), POINTS, DATA";
            let help = "correct the program that wrote the points, or export them again";
            Error::new(ErrorKind::Format, text.file, what).expected(expected).help(help)
        };
        counts.resize(fields.len().max(counts.len()), 1);
        if sizes.len() != fields.len() || types.len() != fields.len() || counts.len() != fields.len() {
            return Err(incomplete("the header has not a size, a type and a count for each field"));
        }
        let (mut axes, mut byte, mut word) = ([None; 3], 0_usize, 0_usize);
        for (i, name) in fields.iter().enumerate() {
            if let Some(k) = ["x", "y", "z"].iter().position(|axis| axis == name) {
                let known = types[i] == "F" && counts[i] == 1 && matches!(sizes[i], 4 | 8);
                axes[k] = known.then_some(Axis { size: sizes[i], byte, word });
            }
            let next = sizes[i].checked_mul(counts[i]).and_then(|size| byte.checked_add(size));
            let next = next.zip(word.checked_add(counts[i]));
            (byte, word) = next.ok_or_else(|| incomplete("the fields are too large"))?;
        }
        let [Some(x), Some(y), Some(z)] = axes else {
            return Err(incomplete("the header has not x, y and z as floats"));
        };
        let points = points.or(area).ok_or_else(|| incomplete("the header has no number of points"))?;
        let data = data.ok_or_else(|| incomplete("the header has no line DATA"))?;
        Ok(Self { axes: [x, y, z], row: byte, points, data })
    }

    /// The point whose values begin where `at` says.
    fn point<'b>(&self, file: &str, at: impl Fn(Axis) -> Option<&'b [u8]>) -> Result<Point3<f64>, Error> {
        let mut point = Point3::origin();
        for (number, axis) in point.iter_mut().zip(self.axes) {
            let bytes = at(axis).unwrap_or_default();
            *number = match axis.size {
                4 => f32::from_le_bytes(bytes_at(file, bytes, 0)?).into(),
                _ => f64::from_le_bytes(bytes_at(file, bytes, 0)?),
            };
        }
        Ok(point)
    }
}

/// What LZF made of `size` bytes; `None` when it is damaged.
fn unpacked(packed: &[u8], size: usize) -> Option<Vec<u8>> {
    let (mut out, mut input) = (Vec::new(), packed.iter().copied());
    while let Some(control) = input.next() {
        let control = usize::from(control);
        if control < 32 {
            for _ in 0..=control {
                out.push(input.next()?);
            }
        } else {
            // A copy of what came before.
            let long = if control >> 5 == 7 { usize::from(input.next()?) } else { 0 };
            let back = ((control & 31) << 8 | usize::from(input.next()?)) + 1;
            let from = out.len().checked_sub(back)?;
            for i in from..from + (control >> 5) + long + 2 {
                out.push(out[i]);
            }
        }
        if out.len() > size {
            return None;
        }
    }
    (out.len() == size).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::super::tests::read;

    fn head(data: &str) -> String {
        format!(
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x rgb y z\nSIZE 4 4 8 4\nTYPE F U F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n\
             VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA {data}\n"
        )
    }

    fn binary(rows: bool) -> Vec<u8> {
        let points = [[1.0, 2.0, 3.0], [f64::NAN; 3]];
        let field = |k: usize, [x, y, z]: [f64; 3]| match k {
            0 => (x as f32).to_le_bytes().to_vec(),
            1 => vec![7; 4],
            2 => y.to_le_bytes().to_vec(),
            _ => (z as f32).to_le_bytes().to_vec(),
        };
        match rows {
            true => points.iter().flat_map(|p| (0..4).flat_map(|k| field(k, *p))).collect(),
            false => (0..4).flat_map(|k| points.iter().flat_map(move |p| field(k, *p))).collect(),
        }
    }

    fn compressed() -> Vec<u8> {
        let fields = binary(false);
        // The four sevens of the second point are a copy, the rest is as it is.
        let mut packed = vec![11];
        packed.extend(&fields[..12]);
        packed.extend([2 << 5, 3]);
        packed.push(23);
        packed.extend(&fields[16..]);
        let sizes = [packed.len() as u32, fields.len() as u32].map(u32::to_le_bytes).concat();
        [head("binary_compressed").into_bytes(), sizes, packed].concat()
    }

    #[test]
    fn all_kinds_are_the_same_points() {
        let text = head("ascii") + "1 7 2 3\nnan 7 nan nan\n";
        let files = [text.into_bytes(), [head("binary").into_bytes(), binary(true)].concat(), compressed()];
        for bytes in &files {
            let found = read("a.pcd", bytes).unwrap();
            assert!(found.len() == 2 && found[0] == [1.0, 2.0, 3.0], "{found:?}");
            assert!(found[1].iter().all(|x| x.is_nan()));
            for end in [0, 5, bytes.len() / 2, bytes.len() - 12] {
                assert!(read("a.pcd", &bytes[..end]).is_err(), "{end}");
            }
        }
    }

    #[test]
    fn headers_that_make_no_sense() {
        let good = head("ascii") + "1 7 2 3\n4 7 5 6\n";
        for (from, to) in [
            ("FIELDS x rgb y z", "FIELDS x rgb y w"),
            ("TYPE F U F F", "TYPE F U F I"),
            ("SIZE 4 4 8 4", "SIZE 4 4 8"),
            ("SIZE 4 4 8 4", "SIZE 4 4 2 4"),
            ("COUNT 1 1 1 1", "COUNT 1 99999999999999999999 1 1"),
            ("COUNT 1 1 1 1", "COUNT 1 9999999999999999999 1 1"),
            ("POINTS 2", "POINTS 3"),
            ("POINTS 2", "POINTS 1"),
            ("DATA ascii", "DATA zipped"),
            ("DATA ascii", "DATA binary_compressed"),
            ("VERSION", "VERSIO"),
            ("4 7 5 6", "4 7 5"),
            ("4 7 5 6", "4 7 x 6"),
        ] {
            assert!(good.contains(from) && read("a.pcd", good.as_bytes()).is_ok());
            let error = read("a.pcd", good.replace(from, to).as_bytes()).unwrap_err();
            assert!(error.to_string().contains("a.pcd"), "{error}");
        }
    }
}
