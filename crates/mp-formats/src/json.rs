//! Paths in JSON, alone or in a result of planning.

use crate::columns::{Column, bracketed, factor};
use crate::error::{Error, ErrorKind};
use crate::text::clipped;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The names of the columns, if the file has any: texts, or objects with a name and a unit.
#[derive(Deserialize)]
struct HasNames {
    columns: Option<Vec<Value>>,
    names: Option<Vec<Value>>,
    joint_names: Option<Vec<Value>>,
    #[serde(rename = "jointNames")]
    camel: Option<Vec<Value>>,
    /// As `JointState` of ROS has them; as a text it is the name of something else.
    name: Option<Value>,
    #[serde(rename = "path")]
    _path: Option<IgnoredAny>,
    #[serde(flatten)]
    others: BTreeMap<String, Value>,
}

/// The names of the columns of a path, with units if the file says them. `wanted` are the columns of the robot, as far as they are known.
pub(crate) fn names(file: &str, text: &str, wanted: &[Column]) -> Result<Option<Vec<String>>, Error> {
    let what = "\"columns\": [\"NAME [UNIT]\", …]";
    // What is no JSON at all, or no object, is said of the whole file, by what reads the path.
    if !text.trim_start().starts_with('{')
        || serde_json::from_str::<HasNames>(text).is_err_and(|e| !e.is_data())
    {
        return Ok(None);
    }
    let read: HasNames = parse(file, text, what, "the format is described in docs/formats/path.md")?;
    let name = |value: Value| match (value.get("name"), value.get("unit"), value.as_str()) {
        (Some(Value::String(name)), Some(Value::String(unit)), _) => format!("{name} [{unit}]"),
        (Some(Value::String(name)), _, _) => name.clone(),
        (_, _, Some(name)) => name.to_owned(),
        _ => value.to_string(),
    };
    let error = |key: &str, message: String| {
        let at = text.find(&format!("\"{key}\"")).unwrap_or(0);
        Error::at(ErrorKind::Content, file, text, at, key.len() + 2, message)
    };
    let listed = |value| if let Value::Array(list) = value { Some(list) } else { None };
    let lists = [
        ("columns", read.columns),
        ("names", read.names),
        ("joint_names", read.joint_names),
        ("jointNames", read.camel),
        ("name", read.name.and_then(listed)),
    ];
    let lists =
        lists.into_iter().filter_map(|(key, list)| Some((key, list?.into_iter().map(name).collect())));
    let mut lists: Vec<(&str, Vec<String>)> = lists.collect();
    if let Some((key, _)) = lists.iter().find(|(_, list)| *list != lists[0].1) {
        return Err(error(key, format!("`{}` and `{key}` name other columns", lists[0].0))
            .expected("one list of names")
            .help("keep the list of the columns of `path`, and remove the other one"));
    }
    let with_units =
        lists.iter().flat_map(|(_, list): &(_, Vec<String>)| list).any(|name| bracketed(name).is_some());
    if let Some(key) = foreign_units(&read.others).filter(|_| !with_units) {
        return Err(error(key, not_in_radians(key))
            .expected("\"columns\": [\"NAME [deg]\", …]")
            .help("say the unit of each column by its name, or remove this member if it is not so"));
    }
    // A list of all columns in another order may say what the numbers are.
    let own: Vec<&str> = wanted.iter().map(|column| &*column.name).collect();
    let turned = |value: &Value| {
        let list = value.as_array()?.iter().map(Value::as_str).collect::<Option<Vec<_>>>()?;
        let (mut sorted, mut known) = (list.clone(), own.clone());
        sorted.sort_unstable();
        known.sort_unstable();
        (sorted == known && list != own).then_some(())
    };
    match read.others.iter().find_map(|(key, value)| turned(value).map(|()| key)) {
        Some(key) if lists.is_empty() => {
            Err(error(key, format!("`{}` has the names of the columns in another order", clipped(key)))
                .expected(what)
                .help(
                    "call the list `columns` if the numbers of `path` are in its order; otherwise remove it",
                ))
        }
        _ => Ok(lists.pop().map(|(_, list)| list)),
    }
}

/// A member that would be skipped, although it says that numbers are not in radians and metres.
#[must_use]
pub fn foreign_units(members: &BTreeMap<String, Value>) -> Option<&str> {
    let foreign = |(key, value): (&String, &Value)| {
        let lower = key.to_lowercase();
        let unit = value.as_str().filter(|_| lower.contains("unit"));
        let converted = |unit: &str| ["m", "rad"].iter().find_map(|own| factor(Some(unit), own));
        let other = unit.and_then(converted).is_some_and(|(times, over)| times != over);
        other || (lower.contains("degree") && *value == Value::Bool(true))
    };
    members.iter().find(|member| foreign(*member)).map(|(key, _)| key.as_str())
}

/// What is wrong with [`foreign_units`].
#[must_use]
pub fn not_in_radians(key: &str) -> String {
    format!("`{}` says that the numbers are not in radians and metres", clipped(key))
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
            // Or a list of so many numbers has more.
            None if shown == "trailing characters" && serde_json::from_str::<IgnoredAny>(text).is_ok() => {
                "this list is longer than it should be".to_owned()
            }
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
