//! Paths of joint values: text and JSON.

use crate::error::{Error, ErrorKind};
use crate::json::parse_rows;
use crate::number::Row;
use crate::source::{MAX_TEXT_BYTES, decode, read_file, write_atomic};
use crate::text::{Text, clipped};
use std::fmt::Write as _;
use std::path::Path;

/// A path of joint values, in the order of the coordinates of the robot: radians and metres. Never empty when read,
/// and all configurations are of one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointPath {
    /// The configurations, from start to goal.
    pub configurations: Vec<Vec<f64>>,
}

impl JointPath {
    /// Reads the file `path`: text, or a `.json` file with a member `path`, a list of lists.
    ///
    /// # Errors
    /// [`Error`] when it cannot be read or holds no path.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let (file, bytes) = (path.display().to_string(), read_file(path, MAX_TEXT_BYTES)?);
        if is_json(path) { Self::parse_json(&file, &bytes) } else { Self::parse(&file, &bytes) }
    }

    /// Reads `bytes`, the content of a text that errors call `file`: the numbers of configurations and of joints
    /// on the first line, then one configuration on each line.
    ///
    /// # Errors
    /// [`Error`] with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = Text::new(file, bytes, "path.md")?;
        let what = "two counts: of configurations and of joints";
        let mut lines = text.lines();
        let first = lines.next().ok_or_else(|| text.error_at_end(what))?;
        let words: Vec<_> = first.words().take(3).collect();
        let [count, joints] = words[..] else {
            return Err(text.error(first, "the file does not begin with two counts").expected(what));
        };
        let (n, joints) = (text.count(count, what)?, text.count(joints, what)?);
        if n == 0 || joints == 0 {
            let message = "a path without configurations or without joints";
            return Err(text.error(first, message).expected(what).with_kind(ErrorKind::Content));
        }
        let expected = format!("{joints} numbers, one for each joint");
        let mut configurations: Vec<Vec<f64>> = Vec::new();
        for line in lines {
            if configurations.len() == n {
                return Err(text
                    .error(line, format!("`{}` follows the last configuration", clipped(line.text)))
                    .expected(format!("the end of the file, as the count is {n}"))
                    .help("correct the count on the first line, or remove what follows"));
            }
            let row = line.words().map(|word| text.number(word, &expected)).collect::<Result<Vec<_>, _>>()?;
            if row.len() != joints {
                let subject = format!("configuration {} of {n}", configurations.len() + 1);
                let message = format!("{subject} has {} numbers", row.len());
                return Err(text.error(line, message).expected(expected));
            }
            configurations.push(row);
        }
        if configurations.len() < n {
            let next = configurations.len() + 1;
            return Err(text.error_at_end(format!("configuration {next} of {n}: {expected}")));
        }
        Ok(Self { configurations })
    }

    /// Reads `bytes`, the content of a JSON file that errors call `file`: an object with a member `path`, a list
    /// of lists of one length; its other members are skipped.
    ///
    /// # Errors
    /// [`Error`] with the line and column.
    pub fn parse_json(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = decode(file, bytes)?;
        let what = "{\"path\": [[q1, q2, …], …]}";
        let configurations: Vec<Vec<f64>> = parse_rows(file, text, what)?;
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
        let mut out = format!("{} {joints}\n", self.configurations.len());
        for row in &self.configurations {
            let _ = writeln!(out, "{}", Row(row));
        }
        out
    }

    /// The path as JSON: an object with the member `path`, one configuration on a line.
    #[must_use]
    pub fn to_json(&self) -> String {
        crate::json::rows_text(&self.configurations)
    }

    /// Writes the file `path` in one step: `.json` as JSON, all else as text.
    ///
    /// # Errors
    /// [`Error`] when the file cannot be written (then nothing is left of it) or a number is not finite.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        if self.configurations.iter().flatten().any(|v| !v.is_finite()) {
            let message = "the path has a number that is not finite: nothing is written";
            return Err(Error::new(ErrorKind::Content, path.display(), message));
        }
        write_atomic(path, if is_json(path) { self.to_json() } else { self.to_text() }.as_bytes())
    }
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("json"))
}
