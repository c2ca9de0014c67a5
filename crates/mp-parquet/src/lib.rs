//! Results of `mp many` as [Parquet](https://parquet.apache.org), for data frames and databases.
//!
//! [`export`] makes a file with a row for each item. Its columns are those of the [report](mp_plan::Report), flat, and the error of an item
//! that could not be planned; docs/formats/many.md lists them. A path is a list of configurations, each a list of numbers. Rows are
//! written in groups, so that memory does not grow with their number.
//!
//! ```no_run
//! let exported = mp_parquet::export("results.jsonl".as_ref(), "results.parquet".as_ref())?;
//! println!("{} rows", exported.rows);
//! # Ok::<(), mp_plan::Error>(())
//! ```

mod columns;
mod rows;

use columns::{COLUMNS, schema};
use mp_plan::{Error, ListResults};
use mp_store::Lock;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use rows::RowGroup;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// The most rows of a group, and the most numbers of paths (32 MiB).
const GROUP_ROWS: usize = 1 << 16;
const GROUP_NUMBERS: usize = 1 << 22;

/// What was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exported {
    /// How many rows.
    pub rows: u64,
    /// How many items the results should have.
    pub items: u64,
}

impl Exported {
    /// Whether the results are those of all items, and not of a run that was interrupted.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.rows == self.items
    }
}

/// Writes the results in the file `from`, whole or of a shard, as Parquet to the file `to`. Of a run that was interrupted, those that are
/// there. The same results make the same bytes.
///
/// # Errors
/// When the results cannot be read or are damaged, or the file cannot be written; it is then as before.
pub fn export(from: &Path, to: &Path) -> Result<Exported, Error> {
    let results = ListResults::open(from)?.partial();
    let items = results.items();
    mp_store::make_folder(mp_store::folder_of(to))?;
    let _lock = Lock::of_file(to)?;
    let mut parts = Parts::new(results)?;
    mp_store::write_parts(to, &mut parts)?;
    Ok(Exported { rows: parts.rows, items })
}

/// Bytes of the file that have not been taken yet.
#[derive(Clone, Debug, Default)]
struct Sink(Arc<Mutex<Vec<u8>>>);

impl Sink {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The file, a row group after the other.
struct Parts {
    results: ListResults,
    sink: Sink,
    /// None when the file is closed.
    writer: Option<SerializedFileWriter<Sink>>,
    rows: u64,
}

impl Parts {
    fn new(results: ListResults) -> Result<Self, Error> {
        let header = serde_json::to_string(results.header())
            .map_err(|e| Error::new(format!("the header of the results cannot be written: {e}")))?;
        let head = KeyValue::new("mp-many".to_owned(), header);
        let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![head])).build();
        let sink = Sink::default();
        let schema = schema().map_err(failed)?;
        let writer = SerializedFileWriter::new(sink.clone(), schema, Arc::new(properties)).map_err(failed)?;
        Ok(Self { results, sink, writer: Some(writer), rows: 0 })
    }

    /// The bytes of the next rows; those of the end, when there are no more.
    fn part(&mut self) -> Result<Option<Vec<u8>>, Error> {
        let Some(writer) = &mut self.writer else { return Ok(None) };
        let mut group = RowGroup::new();
        while group.rows() < GROUP_ROWS && group.numbers() < GROUP_NUMBERS {
            match self.results.next() {
                Some(item) => group.push(&item?),
                None => break,
            }
        }
        match group.rows() {
            0 => {
                let mut writer = self.writer.take();
                writer.as_mut().map(SerializedFileWriter::finish).transpose().map_err(failed)?;
            }
            rows => {
                group.write(writer).map_err(failed)?;
                self.rows += rows as u64;
            }
        }
        Ok(Some(self.sink.take()))
    }
}

impl Iterator for Parts {
    type Item = Result<Vec<u8>, Error>;
    fn next(&mut self) -> Option<Self::Item> {
        let part = self.part().transpose();
        if let Some(Err(_)) = part {
            self.writer = None;
        }
        part
    }
}

fn failed(error: ParquetError) -> Error {
    Error::new(format!("the results cannot be written as Parquet: {error}"))
        .help(format!("this is a fault of the program: it has {} columns", COLUMNS.len()))
}
