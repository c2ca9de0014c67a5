//! Files of points. See `docs/formats/shapes.md`. Coordinates need not be finite: depth cameras give NaN where they see nothing.

mod las;
mod npy;
mod pcd;

use crate::columns::{Column, bracketed, factor, find};
use crate::encoding::decode_mesh;
use crate::error::{Error, ErrorKind};
use crate::files::{Files, MAX_MESH_BYTES};
use crate::formats::{Content, ply};
use crate::text::{Text, Token, clipped};
use mp_geom::{Points, TriMesh};
use mp_stop::Interrupt;
use nalgebra::Point3;
use std::path::Path;

pub(crate) const GUIDE: &str = "shapes.md";

/// Reads the points of a file in the format that its name says; text, if it says none.
///
/// # Errors
/// When it cannot be read, or is not in that format.
pub fn read_points(files: &dyn Files, path: &Path) -> Result<Vec<Point3<f64>>, Error> {
    let bytes = files.read(path, MAX_MESH_BYTES)?;
    parse_points(path, &bytes, files.interrupt())
}

/// Reads `bytes`, the content of a file of points.
///
/// # Errors
/// When they are not in the format that its name says.
pub fn parse_points(path: &Path, bytes: &[u8], mut interrupt: Interrupt) -> Result<Vec<Point3<f64>>, Error> {
    let file = path.display().to_string();
    let points = match Content::of(path).next() {
        Some(Content::Ply) => ply::read_points(&file, bytes, interrupt)?,
        Some(Content::Pcd) => pcd::read(&file, bytes, &mut interrupt)?,
        Some(Content::NumpyArray) => npy::read(&file, bytes, &mut interrupt)?,
        Some(Content::Las) => las::read(&file, bytes, &mut interrupt)?,
        _ => text(&file, bytes, &mut interrupt)?,
    };
    match points.is_empty() {
        true => Err(Error::new(ErrorKind::Content, file, "there are no points in the file")
            .help("write at least one point, or leave the obstacle out")),
        false => Ok(points),
    }
}

/// Balls around points, as their [`Points`] say; says to `note` what is left out.
///
/// # Errors
/// When none is left, or radius or cell do not suit them.
pub fn balls(points: &Points, mut note: impl FnMut(&str)) -> Result<TriMesh, String> {
    let thinned = mp_geom::thin(&points.at, points.cell).map_err(|e| e.to_string())?;
    let (all, kept) = (points.at.len(), thinned.centers.len());
    if thinned.not_finite > 0 {
        let left = if thinned.not_finite == 1 { "is" } else { "are" };
        note(&format!("{} of {all} points {left} not finite and left out", thinned.not_finite));
    }
    if kept + thinned.not_finite < all {
        let (cell, padding) = (points.cell, thinned.padding);
        note(&format!(
            "{all} points became {kept}, one for each cell of {cell} m, with a radius larger by {padding:.3e} m"
        ));
    }
    TriMesh::of_balls(thinned.centers, points.radius + thinned.padding).map_err(|e| e.to_string())
}

/// Text: a line for each point, between blanks, commas or semicolons: x, y and z (m) first, or where a line of names above says. Lines that begin
/// with `#` or `//` are comments. Where the first line is a whole number alone, points follow in blocks that begin with their number, as in `.pts`.
fn text(file: &str, bytes: &[u8], interrupt: &mut Interrupt) -> Result<Vec<Point3<f64>>, Error> {
    let decoded = decode_mesh(file, bytes)?;
    let text = Text { file, text: &decoded, guide: GUIDE };
    let comment = |line: &Token<'_>| line.text.starts_with('#') || line.text.starts_with("//");
    // Names may be in a comment too, if there are as many as numbers below.
    let mut lines = text.lines().peekable();
    let (mut names, mut block) = (None, None);
    while let Some(line) = lines.next_if(|line| {
        comment(line) || axes(*line).is_some() || block.is_none() && announced(*line).is_some()
    }) {
        match announced(line) {
            Some(_) => block = Some((line, 0)),
            None => names = axes(line).map(|axes| (line, axes)).or(names),
        }
    }
    let counted = block.is_some();
    let mut axes = [0, 1, 2].map(|at| (at, 1.0, 1.0));
    if let (Some((line, named)), Some(first)) = (names, lines.peek()) {
        let words = cells(uncommented(line));
        let (given, there) = (words.len(), cells(*first).len());
        // A comment may have words before the names, and may be no line of names if the numbers are x y z.
        let before = given.saturating_sub(there);
        let first_three = |from: usize| named.map(|(at, ..)| at) == [from, from + 1, from + 2];
        let after_colon = before.checked_sub(1).is_some_and(|last| words[last].text.ends_with(':'));
        let apart = |word: &Token<'_>| {
            let unit = bracketed(word.text).filter(|(name, _)| name.is_empty()).map(|(_, unit)| unit);
            unit.and_then(|unit| factor(Some(unit), "m")).is_some_and(|(times, over)| times != over)
        };
        if given == there {
            axes = named;
        } else if !comment(&line) || words.iter().any(apart) {
            let message = format!("this line has {given} names, and the next one {there} numbers");
            return Err(text
                .error(line, message)
                .expected("a name for each column, such as x,y,z,intensity, with its unit: x[mm]"));
        } else if after_colon && named.iter().all(|(at, ..)| *at >= before) {
            axes = named.map(|(at, times, over)| (at - before, times, over));
        } else if there > 3 && !first_three(0) && !first_three(before) {
            let message = format!(
                "this comment names x, y and z among {given} words, and the next line has {there} numbers"
            );
            return Err(text.error(line, message).expected("as many names as numbers, or none"));
        }
    }
    let point = |line: Token<'_>| {
        let (cells, mut point) = (cells(line), Point3::origin());
        for (number, (at, times, over)) in point.iter_mut().zip(axes) {
            let missing = || text.error(line, "a number is missing").expected(EXPECTED);
            let value = any_number(&text, *cells.get(at).ok_or_else(missing)?)?;
            *number = if times == over { value } else { value * times / over };
        }
        Ok::<_, Error>(point)
    };
    let mut points = Vec::new();
    for line in lines.filter(|line| !comment(line)) {
        interrupt.go_on().map_err(|_| Error::interrupted(file))?;
        if counted && announced(line).is_some() {
            check_block(&text, block.replace((line, points.len())), points.len())?;
        } else {
            points.push(point(line)?);
        }
    }
    check_block(&text, block, points.len())?;
    Ok(points)
}

/// The number of points that a line says will follow: a whole number alone.
fn announced(line: Token<'_>) -> Option<usize> {
    line.text.trim().parse().ok()
}

/// Refuses a block that has not as many points as its line says: that line, and how many points there were before it, and are now.
fn check_block(text: &Text<'_>, block: Option<(Token<'_>, usize)>, now: usize) -> Result<(), Error> {
    match block {
        Some((line, before)) if announced(line) != Some(now - before) => {
            let message =
                format!("{} points are announced here, and {} follow", clipped(line.text), now - before);
            Err(text.error(line, message).expected("the number of points that follow"))
        }
        _ => Ok(()),
    }
}

/// The parts of a line.
fn cells(line: Token<'_>) -> Vec<Token<'_>> {
    match [',', ';'].into_iter().find(|separator| line.text.contains(*separator)) {
        Some(separator) => line.cells_between(separator).collect(),
        None => line.words().collect(),
    }
}

/// A line without the mark of a comment.
fn uncommented(line: Token<'_>) -> Token<'_> {
    let text = line.text.trim_start_matches(['#', '/']);
    Token { text, at: line.at + (line.text.len() - text.len()) }
}

/// In which columns a line of names has x, y and z, and what these are multiplied with and divided by to be in metres; `None` if it is no
/// such line.
fn axes(line: Token<'_>) -> Option<[(usize, f64, f64); 3]> {
    let cells = cells(uncommented(line));
    NAMES.into_iter().find_map(|names| axes_named(&cells, names))
}

/// The names of x, y and z: as all write them, and as ParaView does.
const NAMES: [[&str; 3]; 3] =
    [["x", "y", "z"], ["Points:0", "Points:1", "Points:2"], ["Points_0", "Points_1", "Points_2"]];

/// As [`axes`], where the columns have these names.
fn axes_named(cells: &[Token<'_>], names: [&str; 3]) -> Option<[(usize, f64, f64); 3]> {
    let wanted = names.map(|name| Column::new(name, "m"));
    let mut axes = [None; 3];
    for (at, cell) in cells.iter().enumerate() {
        let Some((axis, unit)) = find(cell.text, &wanted) else { continue };
        let (times, over) = factor(unit, "m")?;
        if axes[axis].replace((at, times, over)).is_some() {
            return None;
        }
    }
    let [x, y, z] = axes;
    Some([x?, y?, z?])
}

const EXPECTED: &str = "x y z of a point, metres";

/// A number, which need not be finite.
fn any_number(text: &Text<'_>, word: Token<'_>) -> Result<f64, Error> {
    match word.text.parse() {
        Ok(number) => Ok(number),
        Err(_) if crate::text::is_not_a_number(word.text) => Ok(f64::NAN),
        Err(_) => text.number(word, EXPECTED),
    }
}

/// An error in a binary file, `at` which byte.
fn error(file: &str, at: usize, message: impl std::fmt::Display) -> Error {
    Error::new(ErrorKind::Format, file, format!("{message} (at byte {at})"))
        .help("correct the program that wrote the points, or export them again: docs/formats/shapes.md")
}

/// The bytes from `at` on, an array of `N`.
fn bytes_at<const N: usize>(file: &str, bytes: &[u8], at: usize) -> Result<[u8; N], Error> {
    let taken = bytes.get(at..).and_then(|rest| rest.first_chunk());
    taken.copied().ok_or_else(|| error(file, bytes.len(), "the file ends too early"))
}

/// `count` rows of `row` bytes from `at` on, which must be there.
fn rows<'b>(
    file: &str,
    bytes: &'b [u8],
    at: usize,
    count: usize,
    row: usize,
) -> Result<std::slice::ChunksExact<'b, u8>, Error> {
    let size = count.checked_mul(row).filter(|_| row > 0);
    let all = size.and_then(|size| bytes.get(at..)?.get(..size));
    let all = all.ok_or_else(|| {
        error(
            file,
            bytes.len(),
            format!("the file ends too early: it announces {count} points of {row} bytes"),
        )
    })?;
    Ok(all.chunks_exact(row))
}

/// All of these points, unless `interrupt` says to end.
fn all(
    file: &str,
    points: impl Iterator<Item = Result<Point3<f64>, Error>>,
    interrupt: &mut Interrupt,
) -> Result<Vec<Point3<f64>>, Error> {
    let asked = |point| interrupt.go_on().map_err(|_| Error::interrupted(file)).and(point);
    points.map(asked).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Vec<[f64; 3]>, Error> {
        let points = parse_points(Path::new(name), bytes, Interrupt::never())?;
        Ok(points.into_iter().map(Into::into).collect())
    }

    #[test]
    fn text_of_any_kind() {
        let expected = [[1.0, 2.0, 3.0], [4.5, -1.0, 0.0]];
        for (name, text) in [
            ("a.xyz", "# scan\n1 2 3 255\n\n4.5 -1 0\n"),
            ("a.csv", "1, 2, 3\n4.5,-1,0\n"),
            ("a.txt", "1\t2 3\r\n4.5 -1 0"),
            ("a.csv", "x,y,z,intensity\n1,2,3,9\n4.5,-1,0,9\n"),
            ("a.csv", "\"\",\"Z\",\"r\",\"y [cm]\",\"x_mm\"\n0,3,a,200,1000\n# c\n1,0,b,-100,4500\n"),
            ("a.xyz", "// by a tool\n//R X Y Z\n9 1 2 3\n9 4.5 -1 0\n"),
            ("a.xyz", "# x y z of a scan\n1 2 3\n4.5 -1 0\n"),
            ("a.xyz", "# i x y z\n\n# done\n1 1 2 3\n2 4.5 -1 0\n"),
            ("a.xyz", "# columns: i x y z\n1 1 2 3\n2 4.5 -1 0\n"),
            ("a.xyz", "# Format: z y x[cm]\n3 2 100\n0 -1 450\n"),
            ("a.xyz", "# x y z intensity (0 to 255)\n1 2 3 9\n4.5 -1 0 9\n"),
            ("a.xyz", "# scan of x y z intensity\n1 2 3 9\n4.5 -1 0 9\n"),
            ("a.csv", "z;y;x\n3;2;1\n0;-1;4.5\n"),
            ("a.pts", "2\n1 2 3 10 0 0 0\n4.5 -1 0 1 1 1 1\n"),
            ("a.pts", " 1 \n1 2 3\n# next scan\n1\n4.5 -1 0\n0\n"),
            ("a.txt", "//X Y Z R\n2\n1 2 3 9\n4.5 -1 0 9\n"),
            ("a.txt", "2\n//R X Y Z\n9 1 2 3\n9 4.5 -1 0\n"),
            ("a.csv", "\"Points:0\",\"Points:1\",\"Points:2\"\n1,2,3\n4.5,-1,0\n"),
            ("a.csv", "\"v:0\",\"Points:2\",\"Points:1\",\"Points:0\"\n9,3,2,1\n9,0,-1,4.5\n"),
            ("a.csv", "i,Points_0,Points_1,Points_2\n0,1,2,3\n1,4.5,-1,0\n"),
        ] {
            assert_eq!(read(name, text.as_bytes()).unwrap(), expected, "{name}");
        }
        assert_eq!(read("a.xyz", b"# Gr\xf6\xdfe\n1 2 3\n4.5 -1 0\n").unwrap(), expected);
        let found = read("a.xyz", b"nan nan nan\n1 2 -1.#IND\n1 2 3\n").unwrap();
        assert!(found[0][0].is_nan() && found[1][2].is_nan() && found[2] == [1.0, 2.0, 3.0]);
        for (text, line) in [
            ("1 2\n", Some(1)),
            ("1 2 3\n1 x 3", Some(2)),
            ("# none\n", None),
            ("", None),
            ("x,y\n1,2\n", Some(1)),
            ("x y z\n1 2 3 4\n", Some(1)),
            ("x,y,x,z\n1,2,3,4\n", Some(1)),
            ("x,y,z [s]\n1,2,3\n", Some(1)),
            ("# r g b x y z (metres)\n9 9 9 1 2 3\n", Some(1)),
            ("# y x z\n1 2 3 4\n", Some(1)),
            ("# x [mm] y [mm] z [mm]\n1 2 3\n", Some(1)),
            ("1 2 3\nx y z\n", Some(2)),
            ("3\n1 2 3\n", Some(1)),
            ("1\n1 2 3\n1 2 3\n", Some(1)),
            ("1\n1 2 3\n2\n1 2 3\n", Some(3)),
            ("1 2 3\n1\n1 2 3\n", Some(2)),
            ("2.5\n1 2 3\n", Some(1)),
            ("0\n", None),
        ] {
            let e = read("a.xyz", text.as_bytes()).unwrap_err();
            crate::error::check_error(&e);
            assert_eq!(e.line(), line, "{text}");
        }
    }

    #[test]
    fn points_of_ply() {
        let head = |format: &str| {
            format!(
                "ply\nformat {format} 1.0\nelement vertex 2\nproperty float x\nproperty uchar red\nproperty double y\nproperty float z\nend_header\n"
            )
        };
        let text = head("ascii") + "1 255 2 3\n-nan(ind) 0 1.#QNAN nan\n";
        let mut binary = head("binary_little_endian").into_bytes();
        for [x, y, z] in [[1.0_f32, 2.0, 3.0], [f32::NAN; 3]] {
            binary
                .extend([&x.to_le_bytes()[..], &[7], &f64::from(y).to_le_bytes(), &z.to_le_bytes()].concat());
        }
        for bytes in [text.as_bytes(), &binary] {
            let found = read("a.ply", bytes).unwrap();
            assert!(found[0] == [1.0, 2.0, 3.0] && found[1].iter().all(|x| x.is_nan()));
            assert!(read("a.ply", &bytes[..bytes.len() - 9]).is_err());
        }
        // Vertices of a mesh.
        let mesh = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        assert_eq!(read("a.ply", mesh.as_bytes()).unwrap().len(), 3);
        assert!(
            read("a.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n")
                .is_err()
        );
    }

    #[test]
    fn what_is_left_out_is_said() {
        let at = [[0.0, 0.0, 0.0], [0.001, 0.0, 0.0], [1.0, 0.0, 0.0], [f64::NAN; 3]].map(Point3::from);
        let mut said = Vec::new();
        let mesh = balls(&Points::new(at.to_vec(), 0.01), |note| said.push(note.to_owned())).unwrap();
        assert_eq!(mesh.vertices().len(), 2);
        assert_eq!(
            said,
            [
                "1 of 4 points is not finite and left out",
                "4 points became 2, one for each cell of 0.005 m, with a radius larger by 5.000e-4 m",
            ]
        );
        assert_eq!(
            balls(&Points::new(vec![at[3]], 0.01), |_| ()).unwrap_err(),
            "none of 1 points has finite coordinates"
        );
        let one = balls(&Points::new(vec![at[2]], 0.01), |note| panic!("{note}")).unwrap();
        assert_eq!((one.vertices(), one.rounding()), (&at[2..3], Some(0.01)));
    }
}
