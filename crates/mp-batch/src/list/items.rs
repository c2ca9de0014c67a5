//! Results of a list, item by item.

use super::merge::incomplete;
use super::reader::{Next, ResultsReader};
use super::run::open;
use super::{ItemResult, ResultsHeader};
use mp_plan::Error;
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// The results in a file of `mp many` or `mp merge`, item by item: each is checked as it is read, and memory
/// does not grow with their number.
///
/// A file that was cut off, or whose run still goes on, ends with an error, unless results
/// [may be missing](Self::partial). After an error there is nothing more.
///
/// ```no_run
/// let results = mp_batch::ListResults::open("results.jsonl".as_ref())?;
/// println!("{} items of {}", results.header().items, results.header().list);
/// for result in results {
///     let result = result?;
///     match (result.item, result.into_result()) {
///         (item, Ok(report)) => println!("{item}: {:?} m", report.path_length),
///         (item, Err(e)) => println!("{item}: {e}"),
///     }
/// }
/// # Ok::<(), mp_plan::Error>(())
/// ```
pub struct ListResults {
    reader: ResultsReader<BufReader<File>>,
    partial: bool,
    ended: bool,
}

impl ListResults {
    /// Opens the file, and reads its header.
    ///
    /// # Errors
    /// When it cannot be read, or does not begin as results do.
    pub fn open(file: &Path) -> Result<Self, Error> {
        Ok(Self { reader: open(file)?, partial: false, ended: false })
    }

    /// Results may be missing at the end.
    #[must_use]
    pub fn partial(self) -> Self {
        Self { partial: true, ..self }
    }

    /// The first line of the file: which list, which part of it, and of which scenes.
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

impl Iterator for ListResults {
    type Item = Result<ItemResult, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.reader.read();
        self.ended = !matches!(next, Ok(Next::Item(_)));
        match next {
            Ok(Next::Item(result)) => Some(Ok(*result)),
            Ok(Next::Cut) if !self.partial => Some(Err(incomplete(&self.reader))),
            Ok(Next::End | Next::Cut) => None,
            Err(e) => Some(Err(e)),
        }
    }
}

impl fmt::Debug for ListResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ListResults").field("file", &self.reader.name).finish_non_exhaustive()
    }
}
