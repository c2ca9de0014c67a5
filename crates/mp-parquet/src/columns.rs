//! The columns: what each is called, holds, and takes from a result.

use mp_plan::{ItemResult, Report, StoppedBy};
use parquet::errors::Result;
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::TypePtr;
use std::sync::Arc;

/// What a column holds. All but the number of the item may be null.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The number of the item.
    Number,
    Count,
    Double,
    Text,
    Bool,
    /// A list of texts.
    Texts,
    /// A list of lists of numbers.
    Rows,
}

/// A value of a column.
#[derive(Clone, Debug)]
pub(crate) enum Cell<'r> {
    Count(Option<u64>),
    Double(Option<f64>),
    Text(Option<String>),
    Bool(Option<bool>),
    Texts(Option<Vec<String>>),
    Rows(Option<&'r [Vec<f64>]>),
}

/// A column.
#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) name: &'static str,
    pub(crate) kind: Kind,
    pub(crate) cell: fn(&ItemResult) -> Cell<'_>,
}

const fn column(name: &'static str, kind: Kind, cell: fn(&ItemResult) -> Cell<'_>) -> Column {
    Column { name, kind, cell }
}

fn count(item: &ItemResult, of: fn(&Report) -> Option<u64>) -> Cell<'_> {
    Cell::Count(item.report.as_ref().and_then(of))
}

fn double(item: &ItemResult, of: fn(&Report) -> Option<f64>) -> Cell<'_> {
    Cell::Double(item.report.as_ref().and_then(of))
}

fn text(item: &ItemResult, of: fn(&Report) -> Option<&str>) -> Cell<'_> {
    Cell::Text(item.report.as_ref().and_then(of).map(str::to_owned))
}

fn bool(item: &ItemResult, of: fn(&Report) -> bool) -> Cell<'_> {
    Cell::Bool(item.report.as_ref().map(of))
}

fn size(size: Option<usize>) -> Option<u64> {
    size.and_then(|size| u64::try_from(size).ok())
}

/// All columns, in order.
pub(crate) const COLUMNS: [Column; 34] = [
    column("item", Kind::Number, |r| Cell::Count(Some(r.item))),
    column("scene", Kind::Text, |r| text(r, |r| Some(&r.scene))),
    column("scene_file", Kind::Text, |r| text(r, |r| r.scene_file.as_deref())),
    column("space", Kind::Text, |r| text(r, |r| Some(&r.space))),
    column("planner", Kind::Text, |r| text(r, |r| Some(&r.planner))),
    column("metric", Kind::Text, |r| text(r, |r| Some(&r.metric))),
    column("motion", Kind::Text, |r| text(r, |r| Some(&r.motion))),
    column("seed", Kind::Count, |r| count(r, |r| Some(r.seed))),
    column("solved", Kind::Bool, |r| bool(r, |r| r.solved)),
    column("verified", Kind::Bool, |r| bool(r, |r| r.verified)),
    column("stopped_by", Kind::Text, |r| text(r, |r| r.stopped_by.map(StoppedBy::word))),
    column("timed", Kind::Bool, |r| Cell::Bool(r.report.as_ref().map(|_| r.tally().timed > 0))),
    column("iterations", Kind::Count, |r| count(r, |r| Some(r.iterations))),
    column("nodes", Kind::Count, |r| count(r, |r| size(Some(r.nodes)))),
    column("edges", Kind::Count, |r| count(r, |r| size(r.edges))),
    column("components", Kind::Count, |r| count(r, |r| size(r.components))),
    column("motion_checks", Kind::Count, |r| count(r, |r| Some(r.motion_checks))),
    column("collision_checks", Kind::Count, |r| count(r, |r| Some(r.collision_checks))),
    column("rejected", Kind::Count, |r| count(r, |r| Some(r.rejected))),
    column("time_s", Kind::Double, |r| double(r, |r| Some(r.time_s))),
    column("finish_s", Kind::Double, |r| double(r, |r| Some(r.finish_s))),
    column("first_s", Kind::Double, |r| double(r, |r| r.first_s)),
    column("first_length", Kind::Double, |r| double(r, |r| r.first_length)),
    column("path_length_found", Kind::Double, |r| double(r, |r| r.path_length_found)),
    column("path_length", Kind::Double, |r| double(r, |r| r.path_length)),
    column("clearance", Kind::Double, |r| double(r, |r| r.clearance)),
    column("shortened", Kind::Bool, |r| bool(r, |r| r.shortened)),
    column("fingerprint", Kind::Text, |r| text(r, |r| r.fingerprint.as_deref())),
    column("columns", Kind::Texts, |r| {
        Cell::Texts(r.report.as_ref().map(|r| r.columns.iter().map(|c| c.name.clone()).collect()))
    }),
    column("units", Kind::Texts, |r| {
        Cell::Texts(r.report.as_ref().map(|r| r.columns.iter().map(|c| c.unit.clone()).collect()))
    }),
    column("path", Kind::Rows, |r| Cell::Rows(r.report.as_ref().and_then(|r| r.path.as_deref()))),
    column("first_path", Kind::Rows, |r| Cell::Rows(r.report.as_ref().and_then(|r| r.first_path.as_deref()))),
    column("error", Kind::Text, |r| Cell::Text(r.error.as_ref().map(|e| e.message.clone()))),
    column("help", Kind::Text, |r| Cell::Text(r.error.as_ref().and_then(|e| e.help.clone()))),
];

/// The schema of the file. Lists are as [the format](https://github.com/apache/parquet-format/blob/master/LogicalTypes.md#lists) says.
pub(crate) fn schema() -> Result<TypePtr> {
    let fields = COLUMNS.iter().map(|Column { name, kind, .. }| match kind {
        Kind::Number => format!("required int64 {name} (INTEGER(64,false));"),
        Kind::Count => format!("optional int64 {name} (INTEGER(64,false));"),
        Kind::Double => format!("optional double {name};"),
        Kind::Text => format!("optional binary {name} (STRING);"),
        Kind::Bool => format!("optional boolean {name};"),
        Kind::Texts => {
            format!("optional group {name} (LIST) {{ repeated group list {{ required binary element (STRING); }} }}")
        }
        Kind::Rows => format!(
            "optional group {name} (LIST) {{ repeated group list {{ required group element (LIST) {{ \
             repeated group list {{ required double element; }} }} }} }}"
        ),
    });
    let message = format!("message results {{ {} }}", fields.collect::<Vec<_>>().join(" "));
    parse_message_type(&message).map(Arc::new)
}
