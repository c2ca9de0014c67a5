//! Paths as rows of named numbers.

use crate::{Column, Error, PathFormat, Robot};
use mp_cspace::Configuration;
use mp_io::{Content, JointPath, PathFile};
use serde::Serialize;
use std::path::Path;

/// A path as rows of numbers, one configuration in each row, start first: the form in which paths are written, read and
/// shown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PathRows {
    /// The format in which it is written as text.
    #[serde(skip)]
    pub format: PathFormat,
    /// The meaning of each number; empty if nothing says it. Then the numbers are in the order of the robot's columns.
    pub columns: Vec<Column>,
    /// The configurations.
    pub rows: Vec<Vec<f64>>,
}

/// A format of files that hold a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PathFileKind {
    /// The text form of the robot.
    Text,
    /// JSON, as docs/formats/path.md describes it.
    Json,
    /// Comma-separated values: a line of names with units, then one configuration on each line.
    Csv,
}

impl PathFileKind {
    /// The kind of a file, by the ending of its name.
    ///
    /// # Errors
    /// When the name has another ending, or none.
    pub fn of(file: &Path) -> Result<Self, Error> {
        match Content::of(file).find(|content| content.is_path()) {
            Some(Content::TextPath) => Ok(Self::Text),
            Some(Content::JsonPath) => Ok(Self::Json),
            Some(Content::CsvPath) => Ok(Self::Csv),
            _ => Err(Content::not_named(file, "a path", Content::is_path).into()),
        }
    }
}

impl PathRows {
    /// The path as the text of its format.
    #[must_use]
    pub fn to_text(&self) -> String {
        match self.poses() {
            Some(path) => path.to_text(),
            None => JointPath { configurations: self.rows.clone() }.to_text(),
        }
    }

    /// The path as JSON: an object with the member `path`.
    #[must_use]
    pub fn to_json(&self) -> String {
        match self.poses() {
            Some(path) => path.to_json(),
            None => JointPath { configurations: self.rows.clone() }.to_json(),
        }
    }

    /// The path as comma-separated values.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let names: Vec<_> = self.columns.iter().map(ToString::to_string).collect();
        mp_io::csv_text(&names, &self.rows)
    }

    /// The content of a file of this kind with the path.
    #[must_use]
    pub fn to_file(&self, kind: PathFileKind) -> String {
        match kind {
            PathFileKind::Text => self.to_text(),
            PathFileKind::Json => self.to_json(),
            PathFileKind::Csv => self.to_csv(),
        }
    }

    /// Reads a path from a file: `.json`, `.csv`, anything else as text in the format `format`. If the file names its columns, these
    /// are matched to `columns`, those of the robot ([`Scene::columns`](crate::Scene::columns)), and brought to their order and units;
    /// without any, the path is as in the file.
    ///
    /// # Errors
    /// When the file cannot be read, or does not hold a path of such a robot: with file, line and column.
    pub fn read(file: impl AsRef<Path>, format: PathFormat, columns: &[Column]) -> Result<Self, Error> {
        let (name, bytes) = mp_io::read_text(file.as_ref())?;
        let kind = PathFileKind::of(file.as_ref()).unwrap_or(PathFileKind::Text);
        Self::parse(&name, &bytes, kind, format, columns)
    }

    /// As [`read`](Self::read), from the content of a file. Errors call the file `name`.
    ///
    /// # Errors
    /// When the content is not a path: with line and column.
    pub fn parse(
        name: &str,
        bytes: &[u8],
        kind: PathFileKind,
        format: PathFormat,
        columns: &[Column],
    ) -> Result<Self, Error> {
        let sixes = |path: PathFile| path.configurations.iter().map(|six| six.to_vec()).collect();
        let rows = match (kind, format) {
            (PathFileKind::Csv, _) => {
                let (columns, rows) = mp_io::parse_csv(name, bytes, columns)?;
                return Ok(Self { format, columns, rows });
            }
            (PathFileKind::Text, PathFormat::Poses) => sixes(PathFile::parse(name, bytes)?),
            (PathFileKind::Json, PathFormat::Poses) => sixes(PathFile::parse_json(name, bytes, columns)?),
            (PathFileKind::Text, PathFormat::Joints) => JointPath::parse(name, bytes)?.configurations,
            (PathFileKind::Json, PathFormat::Joints) => {
                JointPath::parse_json(name, bytes, columns)?.configurations
            }
        };
        Ok(Self { format, columns: columns.to_vec(), rows })
    }

    /// The path written as text and read again: its numbers may differ in the last digits.
    ///
    /// # Errors
    /// When the text is no path: a number is not finite, or a row has not as many numbers as its format.
    pub fn read_back(&self) -> Result<Self, Error> {
        let text = self.to_text();
        Self::parse("the path", text.as_bytes(), PathFileKind::Text, self.format, &self.columns)
    }

    /// The path as six-tuples, if its format is [`PathFormat::Poses`].
    fn poses(&self) -> Option<PathFile> {
        let six = |row: &Vec<f64>| <[f64; 6]>::try_from(row.as_slice()).ok();
        match self.format {
            PathFormat::Joints => None,
            PathFormat::Poses => {
                Some(PathFile { configurations: self.rows.iter().map(six).collect::<Option<_>>()? })
            }
        }
    }
}

pub(crate) fn states(kind: &dyn Robot, path: &PathRows) -> Result<Vec<Configuration>, Error> {
    let columns = kind.columns();
    if !path.columns.is_empty() && path.columns != columns {
        let listed =
            |columns: &[Column]| columns.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        let (name, own, others) = (kind.name(), listed(&columns), listed(&path.columns));
        return Err(Error::new(format!("the columns of the path are {others}; those of {name} are {own}"))
            .help("give `Scene::columns` to what reads the path: it matches them by name"));
    }
    let columns = columns.len();
    match path.rows.iter().find(|row| row.len() != columns) {
        None if path.rows.is_empty() => Err(Error::new("the path has no configurations")),
        None => Ok(path.rows.iter().map(|row| kind.state(row)).collect()),
        Some(row) => {
            let (name, found) = (kind.name(), row.len());
            let what = match found {
                1 => "1 number".to_owned(),
                n => format!("{n} numbers"),
            };
            Err(Error::new(format!(
                "a configuration of the path has {what}, the robot of {name} has {columns}"
            ))
            .help("is this a path of another robot?"))
        }
    }
}

pub(crate) fn state(kind: &dyn Robot, row: &[f64]) -> Result<Configuration, Error> {
    let columns = kind.columns();
    if row.len() == columns.len() && row.iter().all(|v| v.is_finite()) {
        return Ok(kind.state(row));
    }
    let names: Vec<_> = columns.iter().map(ToString::to_string).collect();
    Err(Error::new(format!("a configuration of {} has {} finite numbers", kind.name(), columns.len()))
        .help(format!("give in order: {}", names.join(", "))))
}
