//! GEMPA configuration files: a path, as a count and six-tuples.

use super::environment::six;
use crate::error::{Error, ErrorKind};
use crate::number::Row;
use crate::source::{MAX_TEXT_BYTES, read_file, write_atomic};
use crate::text::{Text, clipped};
use mp_geom::{pose_from_six, six_from_pose};
use nalgebra::Isometry3;
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
    /// The path through `poses`.
    #[must_use]
    pub fn from_poses<'a>(poses: impl IntoIterator<Item = &'a Isometry3<f64>>) -> Self {
        Self { configurations: poses.into_iter().map(six_from_pose).collect() }
    }

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
        let path = path.as_ref();
        let (file, bytes) = (path.display().to_string(), read_file(path, MAX_TEXT_BYTES)?);
        if is_json(path) { Self::parse_json(&file, &bytes) } else { Self::parse(&file, &bytes) }
    }

    /// Reads `bytes`, the content of a GEMPA configuration file that errors call `file`.
    ///
    /// # Errors
    /// [`Error`] when it is not a configuration file, with the line and column.
    pub fn parse(file: &str, bytes: &[u8]) -> Result<Self, Error> {
        let text = Text::new(file, bytes, "path.md")?;
        let what = "the number of configurations, alone on the first line";
        let mut lines = text.lines();
        let first = lines.next().ok_or_else(|| text.error_at_end(what))?;
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
        let mut configurations = Vec::new();
        for line in lines {
            if configurations.len() == n {
                return Err(text
                    .error(line, format!("`{}` follows the last configuration", clipped(line.text)))
                    .expected(format!("the end of the file, as the count is {n}"))
                    .help("correct the count on the first line, or remove what follows"));
            }
            let subject = format!("configuration {} of {n}", configurations.len() + 1);
            configurations.push(six(&text, line, &subject, "six numbers: x y z α β γ")?);
        }
        if configurations.len() < n {
            let next = configurations.len() + 1;
            return Err(text.error_at_end(format!("configuration {next} of {n}: x y z α β γ")));
        }
        Ok(Self { configurations })
    }

    /// The text of a GEMPA configuration file. Numbers have the fewest digits that read back to the same
    /// bits.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut out = format!("{}\n", self.configurations.len());
        for c in &self.configurations {
            let _ = writeln!(out, "{}", Row(c));
        }
        out
    }

    /// Writes the file `path` in one step: `.json` as JSON, all else as a GEMPA configuration file.
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
