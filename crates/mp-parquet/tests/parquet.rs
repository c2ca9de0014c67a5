//! What was exported reads back with the same values, for results of every kind and any number.

use mp_parquet::{Exported, export};
use mp_plan::{Cancel, Interrupt, ItemResult, ListResults, ManyOptions, ManyOutcome, ProblemList};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row, RowAccessor};
use std::path::Path;

/// Plans the list, up to an item.
fn planned(folder: &Path, list: &str, items: u64, times: bool) -> std::path::PathBuf {
    let (list_file, out) = (folder.join("list.jsonl"), folder.join("results.jsonl"));
    std::fs::write(&list_file, list).unwrap();
    let problems = ProblemList::load(&list_file).unwrap().with_scenes(&Interrupt::never()).unwrap();
    let cancel = Cancel::new();
    let stop = |now: &ManyOutcome| {
        if now.tally.items == items {
            cancel.cancel()
        }
    };
    problems.run(&out, &ManyOptions { times, ..ManyOptions::default() }, &cancel, stop).unwrap();
    out
}

fn rows(file: &Path) -> (SerializedFileReader<std::fs::File>, Vec<Row>) {
    let reader = SerializedFileReader::new(std::fs::File::open(file).unwrap()).unwrap();
    let rows = reader.get_row_iter(None).unwrap().collect::<Result<_, _>>().unwrap();
    (reader, rows)
}

fn field<'r>(row: &'r Row, name: &str) -> &'r Field {
    row.get_column_iter().find(|(column, _)| *column == name).unwrap().1
}

fn list(field: &Field) -> Option<Vec<Field>> {
    match field {
        Field::Null => None,
        Field::ListInternal(list) => Some(list.elements().to_vec()),
        other => panic!("{other:?} is no list"),
    }
}

fn path(field: &Field) -> Option<Vec<Vec<f64>>> {
    let number = |field: Field| match field {
        Field::Double(number) => number,
        other => panic!("{other:?} is no number"),
    };
    let row = |field: Field| list(&field).unwrap().into_iter().map(number).collect();
    list(field).map(|rows| rows.into_iter().map(row).collect())
}

fn text(field: &Field) -> Option<&str> {
    match field {
        Field::Null => None,
        Field::Str(text) => Some(text),
        other => panic!("{other:?} is no text"),
    }
}

fn equal(row: &Row, item: &ItemResult) {
    assert_eq!(*field(row, "item"), Field::ULong(item.item));
    let count = |name: &str| match field(row, name) {
        Field::Null => None,
        Field::ULong(count) => Some(*count),
        other => panic!("{name}: {other:?}"),
    };
    let double = |name: &str| match field(row, name) {
        Field::Null => None,
        Field::Double(double) => Some(*double),
        other => panic!("{name}: {other:?}"),
    };
    let bool = |name: &str| match field(row, name) {
        Field::Null => None,
        Field::Bool(bool) => Some(*bool),
        other => panic!("{name}: {other:?}"),
    };
    let error = item.error.as_ref();
    assert_eq!(text(field(row, "error")), error.map(|e| e.message.as_str()));
    assert_eq!(text(field(row, "help")), error.and_then(|e| e.help.as_deref()));
    let Some(report) = &item.report else {
        let names = row.get_column_iter().filter(|(_, field)| **field != Field::Null).map(|(name, _)| name);
        assert_eq!(names.collect::<Vec<_>>(), ["item", "error", "help"]);
        return;
    };
    assert_eq!(text(field(row, "scene")), Some(&*report.scene));
    assert_eq!(text(field(row, "scene_file")), report.scene_file.as_deref());
    assert_eq!(text(field(row, "planner")), Some(&*report.planner));
    assert_eq!(text(field(row, "stopped_by")), report.stopped_by.map(|by| by.word()));
    assert_eq!(text(field(row, "fingerprint")), report.fingerprint.as_deref());
    let counts = ["seed", "iterations", "nodes", "edges", "collision_checks", "rejected"].map(count);
    let [nodes, edges] = [Some(report.nodes), report.edges].map(|size| size.map(|size| size as u64));
    let [iterations, checks] = [report.iterations, report.collision_checks].map(Some);
    assert_eq!(counts, [Some(report.seed), iterations, nodes, edges, checks, Some(report.rejected)]);
    assert_eq!(["solved", "shortened"].map(bool), [report.solved, report.shortened].map(Some));
    let doubles = ["time_s", "first_length", "path_length", "clearance"].map(double);
    assert_eq!(doubles, [Some(report.time_s), report.first_length, report.path_length, report.clearance]);
    let names: Vec<_> = list(field(row, "columns")).unwrap();
    assert!(names.iter().map(text).eq(report.columns.iter().map(|column| Some(&*column.name))));
    assert_eq!(path(field(row, "path")), report.path);
    assert_eq!(path(field(row, "first_path")), report.first_path);
}

/// Solved, improved, without a path, with errors, and a seed that has all bits.
const LIST: &str = r#"{"scene": "easy", "seeds": [3, 18446744073709551615]}
{"scene": "easy", "request": {"planner": "rrt-star", "budget": {"iterations": 60}}}
{"scene": "easy", "request": {"budget": {"iterations": 1}, "seed": 9}}
{"scene": "easy", "request": {"planner": "no-such-planner"}}
{"scene": "easy", "goal": [1]}
{"scene": "easy", "seeds": [8]}
"#;

#[test]
fn results_read_back() {
    for (items, times) in [(7, false), (7, true), (3, false), (0, false)] {
        let folder = tempfile::tempdir().unwrap();
        let results = planned(folder.path(), LIST, items, times);
        let out = folder.path().join("new/results.parquet");
        let exported = export(&results, &out).unwrap();
        assert_eq!(exported, Exported { rows: items, items: 7 });
        assert_eq!(exported.is_complete(), items == 7);
        let (reader, rows) = rows(&out);
        let saved: Vec<ItemResult> =
            ListResults::open(&results).unwrap().partial().collect::<Result<_, _>>().unwrap();
        assert_eq!((rows.len() as u64, saved.len() as u64), (items, items));
        rows.iter().zip(&saved).for_each(|(row, item)| equal(row, item));
        assert!(items < 7 || (rows[0].get_bool(8).unwrap() && !rows[3].get_bool(8).unwrap()));
        assert!(items < 7 || text(field(&rows[5], "help")).is_some());
        let head = reader.metadata().file_metadata().key_value_metadata().unwrap();
        let header = head.iter().find(|pair| pair.key == "mp-many").unwrap().value.clone().unwrap();
        assert!(header.contains("\"items\":7"), "{header}");
        let bytes = std::fs::read(&out).unwrap();
        export(&results, &out).unwrap();
        assert!(bytes == std::fs::read(&out).unwrap(), "the same results, other bytes");
    }
}

#[test]
fn many_rows_are_several_groups() {
    let folder = tempfile::tempdir().unwrap();
    let list = r#"{"scene": "easy", "request": {"planner": "nobody"}, "seeds": {"from": 1, "count": 70000}}"#;
    let results = planned(folder.path(), list, u64::MAX, false);
    let out = folder.path().join("results.parquet");
    assert_eq!(export(&results, &out).unwrap(), Exported { rows: 70_000, items: 70_000 });
    let (reader, rows) = rows(&out);
    assert_eq!(reader.metadata().num_row_groups(), 2);
    assert!(rows.iter().enumerate().all(|(i, row)| *field(row, "item") == Field::ULong(i as u64)));
}

#[test]
fn damaged_results_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let results = planned(folder.path(), LIST, 7, false);
    let out = folder.path().join("results.parquet");
    std::fs::write(&out, "before").unwrap();
    let text = std::fs::read_to_string(&results).unwrap();
    for damage in
        [text.replace("\"seed\":8", "\"seed\":9"), text.replace("\"item\":4", "\"item\":5"), LIST.into()]
    {
        std::fs::write(&results, damage).unwrap();
        let e = export(&results, &out).unwrap_err();
        assert!(e.remedy().is_some(), "{e}");
        assert_eq!(std::fs::read(&out).unwrap(), b"before");
    }
    assert!(export(&folder.path().join("none.jsonl"), &out).is_err());
}
