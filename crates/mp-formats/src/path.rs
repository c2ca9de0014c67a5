//! Paths as text and JSON: poses of a rigid body as in GEMPA configuration files, and joint values of an arm.

use crate::columns::{Column, Fault, Matching, matched};
use crate::error::{Error, ErrorKind};
use crate::files::{decode, read_text};
use crate::formats::Content;
use crate::json::{names, parse_rows, rows_text};
use crate::number::Row;
use crate::text::{Text, Token, clipped};
use mp_geom::pose_from_six;
use nalgebra::Isometry3;
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;

/// A path of configurations, each x, y, z (metres), α yaw about Z, β pitch about Y and γ roll about X
/// (radians), as in a GEMPA configuration file. Never empty when read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathFile {
    /// The configurations, from start to goal.
    pub configurations: Vec<[f64; 6]>,
}

impl PathFile {
    /// The poses of the robot along the path.
    #[must_use]
    pub fn poses(&self) -> Vec<Isometry3<f64>> {
        self.configurations.iter().map(|c| pose_from_six(*c)).collect()
    }

    /// Reads the file `path`: a GEMPA configuration file, or a `.json` file with a member `path`, a list of
    /// six-tuples.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read or holds no path.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        read(path.as_ref(), Self::parse, |file, bytes| Self::parse_json(file, bytes, &Column::of_pose()))
    }

    /// Reads `bytes`, the content of a GEMPA configuration file that errors call `file`; or a matrix as OMPL prints it, with x y z qx qy qz qw on
    /// each line.
    ///
    /// # Errors
    /// [`Error`] when it is not a configuration file, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = Text::new(file, bytes, "path.md")?;
        let what = "the number of configurations, alone on the first line";
        let mut lines = text.lines();
        let first = lines.next().ok_or_else(|| text.error_at_end(what))?;
        if first.words().count() == OMPL_POSE.len() {
            let fault =
                |line: Token<'_>, fault: Fault| text.error(line, fault.message).expected(fault.expected);
            let matching = Matching::new(&OMPL_POSE.map(str::to_owned), &Column::of_pose());
            let matching = matching.map_err(|e| fault(first, e))?;
            let six = |(line, row): (Token<'_>, Vec<f64>)| {
                let row = matching.configuration(&row).map_err(|e| fault(line, e))?;
                Ok::<[f64; 6], Error>(std::array::from_fn(|i| row[i]))
            };
            let configurations = matrix(&text)?.into_iter().map(six).collect::<Result<Vec<_>, _>>()?;
            crate::trace::path(file, configurations.len());
            return Ok(Self { configurations });
        }
        if first.words().count() != 1 {
            return Err(text.error(first, "the file does not begin with a count").expected(what));
        }
        let n = text.count(first, what)?;
        if n == 0 {
            return Err(text
                .error(first, "a path without configurations")
                .expected("at least one configuration")
                .with_kind(ErrorKind::Content));
        }
        let row = |line, subject: &str| six(&text, line, subject, "six numbers: x y z α β γ");
        let configurations = configurations(&text, lines, n, "x y z α β γ", row)?;
        crate::trace::path(file, configurations.len());
        Ok(Self { configurations })
    }

    /// Reads `bytes`, the content of a JSON file that errors call `file`: an object with a member `path`, a
    /// list of six-tuples. Where it has a member `columns` too, these are matched by name to the `columns` given, which are those of
    /// a pose if there are none. Its other members are skipped.
    ///
    /// # Errors
    /// [`Error`] when it is not JSON or has no path, with the line and column, or its columns are others.
    pub fn parse_json(file: &str, bytes: &[u8], columns: &[Column]) -> Result<Self, Error> {
        let (text, what) = (decode(file, bytes)?, "{\"path\": [[x, y, z, α, β, γ], …]}");
        let pose = Column::of_pose();
        let columns = if columns.is_empty() { &pose } else { columns };
        let Some(names) = names(file, text, columns)? else {
            return Ok(Self { configurations: parse_rows(file, text, what)? });
        };
        let rows = matched(file, &names, &parse_rows::<Vec<f64>>(file, text, what)?, columns)?;
        let six = |row: &Vec<f64>| <[f64; 6]>::try_from(row.as_slice()).ok();
        let configurations = rows.iter().map(six).collect::<Option<_>>();
        let error = || Error::new(ErrorKind::Content, file, "the path has no six columns").expected(what);
        Ok(Self { configurations: configurations.ok_or_else(error)? })
    }

    /// The text of a GEMPA configuration file. Numbers have the fewest digits that read back to the same
    /// bits.
    #[must_use]
    pub fn to_text(&self) -> String {
        text_of(&self.configurations.len().to_string(), &self.configurations)
    }

    /// The path as JSON: an object with the member `path`, one six-tuple on a line.
    #[must_use]
    pub fn to_json(&self) -> String {
        rows_text(&self.configurations)
    }

    /// Writes the file `path` in one step: `.json` as JSON, all else as a GEMPA configuration file.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written (then nothing is left of it) or a number is not finite.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        write(path.as_ref(), &self.configurations, || self.to_text())
    }
}

/// A path of joint values, in the order of the coordinates of the robot: radians and metres. When read, it is not
/// empty and all configurations have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointPath {
    /// The configurations, from start to goal.
    pub configurations: Vec<Vec<f64>>,
}

impl JointPath {
    /// Reads the file `path`: text, or a `.json` file as [`parse_json`](Self::parse_json) does.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read or holds no path.
    pub fn read(path: impl AsRef<Path>, columns: &[Column]) -> Result<Self, Error> {
        read(path.as_ref(), Self::parse, |file, bytes| Self::parse_json(file, bytes, columns))
    }

    /// Reads `bytes`, the content of a text that errors call `file`: the numbers of configurations and of joints
    /// on the first line, then one configuration on each line; or, of three joints and more, the configurations alone, as OMPL prints them.
    ///
    /// # Errors
    /// [`Error`] with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = Text::new(file, bytes, "path.md")?;
        let what = "two counts: of configurations and of joints";
        let mut lines = text.lines();
        let first = lines.next().ok_or_else(|| text.error_at_end(what))?;
        let words: Vec<_> = first.words().take(3).collect();
        if words.len() > 2 {
            let configurations: Vec<_> = matrix(&text)?.into_iter().map(|(_, row)| row).collect();
            crate::trace::path(file, configurations.len());
            return Ok(Self { configurations });
        }
        let [count, joints] = words[..] else {
            return Err(text.error(first, "the file does not begin with two counts").expected(what));
        };
        let (n, joints) = (text.count(count, what)?, text.count(joints, what)?);
        if n == 0 || joints == 0 {
            let message = "a path without configurations or without joints";
            return Err(text.error(first, message).expected(what).with_kind(ErrorKind::Content));
        }
        let expected = format!("{joints} numbers, one for each joint");
        let row = |line: Token<'_>, subject: &str| {
            let row = line.words().map(|word| text.number(word, &expected)).collect::<Result<Vec<_>, _>>()?;
            if row.len() == joints {
                return Ok(row);
            }
            let message = format!("{subject} has {} numbers", row.len());
            Err(text.error(line, message).expected(expected.as_str()))
        };
        let configurations = configurations(&text, lines, n, &expected, row)?;
        crate::trace::path(file, configurations.len());
        Ok(Self { configurations })
    }

    /// Reads `bytes`, the content of a JSON file that errors call `file`: an object with a member `path`, a list
    /// of lists of one length. Where it has a member `columns` too, these are matched by name to the `columns` given, unless there are
    /// none. Its other members are skipped.
    ///
    /// # Errors
    /// [`Error`] with the line and column, or when its columns are others.
    pub fn parse_json(file: &str, bytes: &[u8], columns: &[Column]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let what = "{\"path\": [[q1, q2, …], …]}";
        let mut configurations: Vec<Vec<f64>> = parse_rows(file, text, what)?;
        if let Some(names) = names(file, text, columns)?
            && !columns.is_empty()
        {
            configurations = matched(file, &names, &configurations, columns)?;
        }
        let joints = configurations.first().map_or(0, Vec::len);
        match configurations.iter().position(|row| row.len() != joints || row.is_empty()) {
            None => Ok(Self { configurations }),
            Some(i) => {
                let message =
                    format!("configuration {} of the path has {} numbers", i + 1, configurations[i].len());
                Err(Error::at(ErrorKind::Content, file, text, 0, 1, message)
                    .expected(format!("as many as the first: {}", joints.max(1)))
                    .help("the format is described in docs/formats/path.md"))
            }
        }
    }

    /// The path as text. Numbers have the fewest digits that read back to the same bits.
    #[must_use]
    pub fn to_text(&self) -> String {
        let joints = self.configurations.first().map_or(0, Vec::len);
        text_of(&format!("{} {joints}", self.configurations.len()), &self.configurations)
    }

    /// The path as JSON: an object with the member `path`, one configuration on a line.
    #[must_use]
    pub fn to_json(&self) -> String {
        rows_text(&self.configurations)
    }

    /// Writes the file `path` in one step: `.json` as JSON, all else as text.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written (then nothing is left of it) or a number is not finite.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        write(path.as_ref(), &self.configurations, || self.to_text())
    }
}

/// Reads the file `path`, as JSON when its name ends in `.json`. Both make a path of bytes, given the name that errors call them.
fn read<P>(
    path: &Path,
    parse_text: impl Fn(&str, &[u8]) -> Result<P, Error>,
    parse_json: impl Fn(&str, &[u8]) -> Result<P, Error>,
) -> Result<P, Error> {
    let (file, bytes) = read_text(path)?;
    if is_json(path) { parse_json(&file, &bytes) } else { parse_text(&file, &bytes) }
}

/// What OMPL prints of a pose.
const OMPL_POSE: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];

/// Lines of numbers, all with as many as the first.
fn matrix<'a>(text: &Text<'a>) -> Result<Vec<(Token<'a>, Vec<f64>)>, Error> {
    let mut rows: Vec<(Token<'a>, Vec<f64>)> = Vec::new();
    for line in text.lines() {
        let width = rows.first().map(|(_, row)| row.len());
        let expected = width.map_or("numbers".to_owned(), |width| {
            format!("{width} numbers, as on the first line; or the number of configurations alone on that")
        });
        let row = line.words().map(|word| text.number(word, &expected)).collect::<Result<Vec<_>, _>>()?;
        if width.is_some_and(|width| width != row.len()) {
            let message = format!("configuration {} has {} numbers", rows.len() + 1, row.len());
            return Err(text.error(line, message).expected(expected));
        }
        rows.push((line, row));
    }
    Ok(rows)
}

/// The `count` configurations in `lines`, one on each, with nothing after them. `numbers` says what is on a line;
/// `row` reads a line, given the name of the configuration in errors.
fn configurations<'a, C>(
    text: &Text<'a>,
    lines: impl Iterator<Item = Token<'a>>,
    count: usize,
    numbers: &str,
    row: impl Fn(Token<'a>, &str) -> Result<C, Error>,
) -> Result<Vec<C>, Error> {
    let mut configurations = Vec::new();
    for line in lines {
        if configurations.len() == count {
            return Err(text
                .error(line, format!("`{}` follows the last configuration", clipped(line.text)))
                .expected(format!("the end of the file, as the count is {count}"))
                .help("correct the count on the first line, or remove what follows"));
        }
        let subject = format!("configuration {} of {count}", configurations.len() + 1);
        configurations.push(row(line, &subject)?);
    }
    if configurations.len() < count {
        let next = configurations.len() + 1;
        return Err(text.error_at_end(format!("configuration {next} of {count}: {numbers}")));
    }
    Ok(configurations)
}

/// The line `first`, then a line for each configuration.
fn text_of(first: &str, configurations: &[impl AsRef<[f64]>]) -> String {
    let mut out = format!("{first}\n");
    for configuration in configurations {
        let _ = writeln!(out, "{}", Row(configuration.as_ref()));
    }
    out
}

/// Writes the file `path` in one step: as JSON when its name ends in `.json`, else as `text`.
fn write<C: AsRef<[f64]> + Serialize>(
    path: &Path,
    configurations: &[C],
    text: impl FnOnce() -> String,
) -> Result<(), Error> {
    if configurations.iter().flat_map(AsRef::as_ref).any(|v| !v.is_finite()) {
        let message = "the path has a number that is not finite: nothing is written";
        return Err(
            Error::new(ErrorKind::Content, path.display(), message).help("correct what made the path")
        );
    }
    let content = if is_json(path) { rows_text(configurations) } else { text() };
    Ok(mp_store::write(path, content.as_bytes())?)
}

/// The six numbers of a line.
///
/// # Errors
/// When they are not six, or one is no finite number.
pub fn six(text: &Text<'_>, line: Token<'_>, subject: &str, expected: &str) -> Result<[f64; 6], Error> {
    let mut out = [0.0; 6];
    let mut found = 0;
    for word in line.words() {
        let value = text.number(word, expected)?;
        if let Some(slot) = out.get_mut(found) {
            *slot = value;
        }
        found += 1;
    }
    if found == 6 {
        return Ok(out);
    }
    let numbers = if found == 1 { "number" } else { "numbers" };
    Err(text.error(line, format!("{subject} has {found} {numbers}")).expected(expected))
}

fn is_json(path: &Path) -> bool {
    Content::of(path).any(|content| content == Content::JsonPath)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ompl_prints_is_read() {
        let read = |text: &str| PathFile::parse("p", text.as_bytes()).map_err(|e| e.report());
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let path = read(&format!("0 0 0 0 0 0 1 \n1 2 3 0 0 {half} {half} \n\n")).unwrap();
        let [x, y, z, yaw, pitch, roll] = path.configurations[1];
        assert_eq!(([x, y, z], path.configurations[0]), ([1.0, 2.0, 3.0], [0.0; 6]));
        assert!((yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-12 && [pitch, roll] == [0.0, 0.0], "{yaw}");
        for (text, words) in [
            ("0 0 0 0 0 0 2\n", "p:1:1: the quaternion has the length 2"),
            ("0 0 0 0 0 0 1\n1 2 3\n", "p:2:1: configuration 2 has 3 numbers"),
            ("0 0 0 0 0 0 1\n1 2 3 0 0 x 1\n", "p:2:11"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
        let read = |text: &str| JointPath::parse("p", text.as_bytes()).map_err(|e| e.report());
        assert_eq!(
            read("0 1 2 \n3 4 5 \n").unwrap().configurations,
            [vec![0.0, 1.0, 2.0], vec![3.0, 4.0, 5.0]]
        );
        assert!(read("0 1 2\n3 4\n").unwrap_err().contains("configuration 2 has 2 numbers"));
    }

    #[test]
    fn poses_round_trip_as_text_and_json() {
        let dir = tempfile::tempdir().unwrap();
        let path = PathFile { configurations: vec![[0.1, 2.0, -0.0, 1e-9, 0.25, 3.0], [1.0; 6]] };
        for name in ["p.txt", "p.json"] {
            let file = dir.path().join(name);
            path.write(&file).unwrap();
            assert_eq!(PathFile::read(&file).unwrap(), path);
        }
        assert_eq!(path.to_text(), "2\n0.1 2 -0 1e-9 0.25 3\n1 1 1 1 1 1\n");
        assert_eq!(
            path.to_json(),
            "{\"path\":[\n[0.1,2.0,-0.0,1e-9,0.25,3.0],\n[1.0,1.0,1.0,1.0,1.0,1.0]\n]}\n"
        );
        let e =
            PathFile::parse_json("r.json", b"{\"solved\": true,\n \"path\": [[1,2,3]]}", &[]).unwrap_err();
        assert_eq!(e.line(), Some(2), "{e}");
    }

    #[test]
    fn columns_of_json_are_matched_by_name() {
        let columns = [("lift", "m"), ("elbow", "rad")].map(|(name, unit)| Column::new(name, unit));
        let read = |text: &str| JointPath::parse_json("p.json", text.as_bytes(), &columns);
        for names in [
            r#""columns": ["elbow", "lift"]"#,
            r#""columns": ["elbow [rad]", "lift [m]"]"#,
            r#""names": ["elbow", {"name": "lift"}]"#,
            r#""name": ["elbow", "lift"], "position": [0, 0]"#,
            r#""name": "arm", "jointNames": ["elbow", "lift"]"#,
            r#""joint_names": ["elbow", "lift"], "columns": ["elbow", "lift"], "joints": ["lift", "elbow"]"#,
            r#""joint_names": [{"name": "elbow", "unit": "rad"}, {"name": "lift", "unit": "m"}]"#,
        ] {
            for text in [
                format!("{{{names}, \"path\": [[1, 2], [3, 4]]}}"),
                format!("{{\"path\": [[1, 2], [3, 4]], {names}}}"),
            ] {
                assert_eq!(read(&text).unwrap().configurations, [[2.0, 1.0], [4.0, 3.0]], "{text}");
            }
        }
        let degrees = r#"{"columns": ["lift [mm]", "elbow [deg]"], "path": [[250, 180]]}"#;
        assert_eq!(read(degrees).unwrap().configurations, [[0.25, std::f64::consts::PI]]);
        for columns in [
            r#"["lift"]"#,
            r#"["lift", "wrist"]"#,
            r#"["lift", "lift"]"#,
            r#"["lift", "elbow [m]"]"#,
            "7",
            "[]",
        ] {
            let text = format!("{{\"columns\": {columns}, \"path\": [[1, 2]]}}");
            assert!(read(&text).is_err(), "{text}");
        }
        for (names, words) in [
            (
                r#""columns": ["lift", "elbow"], "name": ["elbow", "lift"]"#,
                "p.json:1:32: `columns` and `name`",
            ),
            (
                r#""joints": ["elbow", "lift"]"#,
                "p.json:1:2: `joints` has the names of the columns in another",
            ),
        ] {
            let e = read(&format!("{{{names}, \"path\": [[1, 2]]}}")).unwrap_err();
            crate::error::check_error(&e);
            assert!(e.to_string().starts_with(words), "{e}");
        }
        // Units that would be skipped.
        for unit in [
            r#""units": "deg""#,
            r#""unit": "degrees""#,
            r#""angle_units": "Degrees""#,
            r#""degrees": true"#,
            r#""units": "mm", "columns": ["elbow", "lift"]"#,
        ] {
            let e = read(&format!("{{{unit}, \"path\": [[1, 2]]}}")).unwrap_err();
            crate::error::check_error(&e);
            assert!(e.to_string().contains("not in radians and metres"), "{e}");
        }
        for own in [
            r#""units": "rad""#,
            r#""unit": "m""#,
            r#""units": "px""#,
            r#""degrees": false"#,
            r#""units": ["m", "rad"]"#,
            r#""units": "deg", "columns": ["lift [m]", "elbow [rad]"]"#,
        ] {
            let read = read(&format!("{{{own}, \"path\": [[1, 2]]}}")).unwrap();
            assert_eq!(read.configurations, [[1.0, 2.0]], "{own}");
        }
        let plain = r#"{"joints": ["lift", "elbow"], "tags": ["a", "b"], "name": "n", "path": [[1, 2]]}"#;
        assert_eq!(read(plain).unwrap().configurations, [[1.0, 2.0]]);
        // Numbers name nothing.
        assert_eq!(read(r#"{"columns": [0, 1], "path": [[1, 2]]}"#).unwrap().configurations, [[1.0, 2.0]]);
        let pose =
            r#"{"columns": ["yaw", "pitch", "roll [deg]", "z", "y", "x"], "path": [[1, 2, 180, 4, 5, 6]]}"#;
        let read = PathFile::parse_json("p.json", pose.as_bytes(), &[]).unwrap();
        assert_eq!(read.configurations, [[6.0, 5.0, 4.0, 1.0, 2.0, std::f64::consts::PI]]);
        assert!(
            PathFile::parse_json("p.json", br#"{"columns": ["x", "y"], "path": [[1, 2]]}"#, &[]).is_err()
        );
    }

    #[test]
    fn joint_values_round_trip_and_faults_are_placed() {
        let dir = tempfile::tempdir().unwrap();
        let path = JointPath { configurations: vec![vec![0.1, -0.0, 1e-9], vec![1.0, 2.0, 3.0]] };
        for name in ["p.txt", "p.json"] {
            path.write(dir.path().join(name)).unwrap();
            assert_eq!(JointPath::read(dir.path().join(name), &[]).unwrap(), path);
        }
        for (text, line, words) in [
            ("", None, "empty"),
            ("2\n0 0\n", Some(1), "two counts"),
            ("2 2 2\n0 0\n", Some(2), "as on the first line"),
            ("0 2\n", Some(1), "without"),
            ("2 2\n0 0\n", Some(2), "configuration 2 of 2"),
            ("1 2\n0 0\n1 1\n", Some(3), "follows"),
            ("1 2\n0 0 0\n", Some(2), "3 numbers"),
            ("1 2\n0 x\n", Some(2), "not a number"),
        ] {
            let error = JointPath::parse("p.txt", text.as_bytes()).unwrap_err();
            assert!(line.is_none() || error.line() == line, "{error}");
            assert!(error.to_string().contains(words), "{error}");
        }
        for text in ["{}", "[]", "{\"path\": []}", "{\"path\": [[]]}", "{\"path\": [[1], [1, 2]]}"] {
            assert!(JointPath::parse_json("p.json", text.as_bytes(), &[]).is_err(), "{text}");
        }
    }
}
