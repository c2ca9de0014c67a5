//! Paths in JSON, alone or in a result of planning.

use crate::error::{Error, ErrorKind};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The names of the columns, if the file has any: texts, or objects with a name and a unit.
#[derive(Deserialize)]
struct HasNames {
    #[serde(alias = "names", alias = "joint_names")]
    columns: Option<Vec<Value>>,
}

/// The names of the columns of a path, with units if the file says them.
pub(crate) fn names(file: &str, text: &str) -> Result<Option<Vec<String>>, Error> {
    let what = "\"columns\": [\"NAME [UNIT]\", …]";
    // What is no JSON at all is said of the whole file, by what reads the path.
    if serde_json::from_str::<HasNames>(text).is_err_and(|e| !e.is_data()) {
        return Ok(None);
    }
    let read: HasNames = parse(file, text, what, "the format is described in docs/formats/path.md")?;
    let name = |value: Value| match (value.get("name"), value.get("unit"), value.as_str()) {
        (Some(Value::String(name)), Some(Value::String(unit)), _) => format!("{name} [{unit}]"),
        (Some(Value::String(name)), _, _) => name.clone(),
        (_, _, Some(name)) => name.to_owned(),
        _ => value.to_string(),
    };
    Ok(read.columns.map(|columns| columns.into_iter().map(name).collect()))
}

/// The part of a result that is read: its path. All other members are skipped.
#[derive(Deserialize)]
struct HasPath<R> {
    path: Option<Vec<R>>,
}

#[derive(Serialize)]
struct OnlyPath<'a, R> {
    path: &'a [R],
}

/// `text` as JSON: `what` is expected, and `help` says where it is described.
///
/// # Errors
/// When it is not.
pub fn parse<T: DeserializeOwned>(file: &str, text: &str, what: &str, help: &str) -> Result<T, Error> {
    serde_json::from_str(text).map_err(|e| {
        let at = offset(text, e.line(), e.column());
        let shown = e.to_string();
        let shown = shown.split(" at line ").next().unwrap_or(&shown);
        let message = match shown.split_once(", expected") {
            Some((found, _)) => found.to_owned(),
            None if e.is_data() => shown.to_owned(),
            None => format!("this is not JSON: {shown}"),
        };
        Error::at(ErrorKind::Format, file, text, at, 1, message).expected(what).help(help)
    })
}

/// The member `path` of an object; at least one row.
pub(crate) fn parse_rows<R: DeserializeOwned>(file: &str, text: &str, what: &str) -> Result<Vec<R>, Error> {
    let read: HasPath<R> = parse(file, text, what, "the format is described in docs/formats/path.md")?;
    let content = |message: &str| {
        Error::at(ErrorKind::Content, file, text, 0, 1, message.to_owned())
            .expected(what)
            .help("a result that is not solved has no path")
    };
    match read.path {
        Some(rows) if !rows.is_empty() => Ok(rows),
        Some(_) => Err(content("the path has no configurations")),
        None => Err(content("there is no path in this file")),
    }
}

/// An object with the member `path`, one row on a line.
pub(crate) fn rows_text<R: Serialize>(path: &[R]) -> String {
    // Numbers of a path are finite and its shape is fixed, so this cannot fail.
    let one_line = serde_json::to_string(&OnlyPath { path }).unwrap_or_default();
    one_line.replace("[[", "[\n[").replace("],[", "],\n[").replace("]]", "]\n]") + "\n"
}

/// The byte at which serde_json found the error; its lines count from 1, its columns are the bytes read.
fn offset(text: &str, line: usize, column: usize) -> usize {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    (start + column.saturating_sub(1)).min(text.len())
}
