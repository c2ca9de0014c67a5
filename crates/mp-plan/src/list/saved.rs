//! Results in a file, read one after the other.

use super::reader::{Next, ResultsReader};
use super::run::open;
use super::{ItemResult, ResultsHeader};
use crate::Error;
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The results in a file, in the order of their items. They end where those of a run that was interrupted do; what is damaged is an error,
/// after which there are no more.
///
/// ```no_run
/// for result in mp_plan::SavedResults::open("results.jsonl".as_ref())? {
///     let result = result?;
///     println!("{}: {}", result.item, result.report.is_some_and(|report| report.solved));
/// }
/// # Ok::<(), mp_plan::Error>(())
/// ```
pub struct SavedResults {
    reader: ResultsReader<BufReader<File>>,
    over: bool,
}

impl SavedResults {
    /// Opens a file of results, and reads its header.
    ///
    /// # Errors
    /// When the file cannot be read, or does not begin as results do.
    pub fn open(file: &Path) -> Result<Self, Error> {
        Ok(Self { reader: open(file)?, over: false })
    }

    /// Of what the results are.
    #[must_use]
    pub fn header(&self) -> &ResultsHeader {
        &self.reader.header
    }

    /// How many items there are, of the list or of its shard.
    #[must_use]
    pub fn items(&self) -> u64 {
        self.reader.expected()
    }
}

impl Iterator for SavedResults {
    type Item = Result<ItemResult, Error>;
    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let next = match self.reader.read() {
            Ok(Next::Item(result)) => return Some(Ok(*result)),
            Ok(Next::End | Next::Cut) => None,
            Err(e) => Some(Err(e)),
        };
        self.over = true;
        next
    }
}

impl fmt::Debug for SavedResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SavedResults").field("header", self.header()).finish_non_exhaustive()
    }
}
