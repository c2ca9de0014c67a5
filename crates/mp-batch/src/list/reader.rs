//! Reads results, and checks them.

use super::results::{END, EndLine, FORMAT};
use super::{ItemResult, MAX_ITEMS, RESULTS_VERSION, ResultsHeader, Tally, json_fault};
use mp_io::shortened;
use mp_plan::{Error, REPORT_VERSION, Report};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::HashSet;
use std::io::{BufRead, Read};
use xxhash_rust::xxh3::Xxh3;

/// The largest line that is read, bytes: 64 MiB.
const MAX_LINE_BYTES: u64 = mp_io::MAX_TEXT_BYTES;

/// What follows in results.
#[derive(Debug)]
pub(crate) enum Next {
    /// The result of the next item: its line is that of the reader.
    Item(Box<ItemResult>),
    /// The end: there are all items.
    End,
    /// The log was cut off here.
    Cut,
}

/// Reads results line by line, and checks that they are what their header says.
pub(crate) struct ResultsReader<R> {
    /// What errors call the file.
    pub(super) name: String,
    source: R,
    pub(super) header: ResultsHeader,
    files: HashSet<String>,
    number: u64,
    bytes: Vec<u8>,
    pub(super) tally: Tally,
    /// The hash of all whole lines read so far.
    pub(super) hash: Xxh3,
    /// The number of bytes of these lines.
    pub(super) length: u64,
}

impl<R: BufRead> ResultsReader<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// When the file cannot be read, or does not begin as results do.
    pub(crate) fn new(name: String, source: R) -> Result<Self, Error> {
        #[derive(Deserialize)]
        struct Begins {
            format: String,
            version: u32,
        }
        let mut reader = Self {
            name,
            source,
            header: ResultsHeader::new(String::new(), 0, Vec::new(), 0),
            files: HashSet::new(),
            number: 0,
            bytes: Vec::new(),
            tally: Tally::default(),
            hash: Xxh3::new(),
            length: 0,
        };
        let no_results = |name: &str| {
            Error::new(format!("{} is no file of results of `mp many`", shortened(name, 120)))
                .help("name another file")
        };
        if !reader.read_line()? {
            return Err(no_results(&reader.name));
        }
        match serde_json::from_slice::<Begins>(&reader.bytes) {
            Ok(Begins { format, version }) if format == FORMAT => {
                if version > RESULTS_VERSION {
                    let message =
                        format!("{} has version {version} of results", shortened(&reader.name, 120));
                    let help = format!("this program reads versions up to {RESULTS_VERSION}");
                    return Err(Error::new(message).help(help));
                }
            }
            _ => return Err(no_results(&reader.name)),
        }
        reader.header = reader.parsed()?;
        if reader.header.items > MAX_ITEMS {
            return Err(reader.damaged("a list has at most 2^30 items"));
        }
        reader.files = reader.header.scenes.iter().map(|scene| scene.file.clone()).collect();
        reader.keep();
        Ok(reader)
    }

    /// How many items the shard has.
    pub(crate) fn expected(&self) -> u64 {
        self.header.shard.count(self.header.items)
    }

    /// The bytes of the last line read, with its line break.
    pub(crate) fn line(&self) -> &[u8] {
        &self.bytes
    }

    /// Reads the next line.
    ///
    /// # Errors
    /// When the file cannot be read, or the line is not what the header says.
    pub(crate) fn read(&mut self) -> Result<Next, Error> {
        if !self.read_line()? {
            return Ok(Next::Cut);
        }
        if self.bytes.starts_with(END.as_bytes()) {
            return self.end();
        }
        let result: Box<ItemResult> = self.parsed()?;
        let (header, tally) = (&self.header, &self.tally);
        let wrong = if tally.items >= self.expected() {
            Some(format!("there are more than the {} items of shard {}", self.expected(), header.shard))
        } else if result.item != header.shard.item(tally.items) {
            let expected = header.shard.item(tally.items);
            Some(format!("it is of item {}, and that of shard {} is {expected}", result.item, header.shard))
        } else {
            match (&result.report, &result.error) {
                (Some(report), None) => self.misfit(report),
                (None, Some(_)) => None,
                _ => Some("it needs either a report or an error".to_owned()),
            }
        };
        if let Some(wrong) = wrong {
            return Err(self.damaged(&wrong));
        }
        self.tally += result.tally();
        self.keep();
        Ok(Next::Item(result))
    }

    /// What in a report is not as the header says.
    fn misfit(&self, report: &Report) -> Option<String> {
        let of_list = report.scene_file.as_ref().is_some_and(|file| self.files.contains(file));
        if report.version > REPORT_VERSION {
            Some(format!("its report has version {}", report.version))
        } else if !of_list {
            Some("its scene is not one of the header".to_owned())
        } else if !self.header.times && report.has_times() {
            Some("it has times, and the header says that there are none".to_owned())
        } else {
            None
        }
    }

    fn end(&mut self) -> Result<Next, Error> {
        let EndLine { end, checksum } = self.parsed()?;
        if self.tally.items < self.expected() {
            let (items, expected) = (self.tally.items, self.expected());
            return Err(self.damaged(&format!("the end, after {items} of {expected} items")));
        }
        if end != self.tally {
            return Err(self.damaged("the counts are not those of the items"));
        }
        if checksum != format!("{:016x}", self.hash.digest()) {
            return Err(self.damaged("the checksum is not that of the lines before: some byte has changed"));
        }
        self.keep();
        let mut more = [0];
        match self.source.read(&mut more) {
            Ok(0) => Ok(Next::End),
            Ok(_) => Err(self.damaged("there is more behind the end")),
            Err(e) => Err(self.unreadable(&e)),
        }
    }

    /// Reads a line with its line break; false at the end of the file, or when it ends within the line.
    fn read_line(&mut self) -> Result<bool, Error> {
        self.bytes.clear();
        self.number += 1;
        let read = self.source.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut self.bytes);
        let read = read.map_err(|e| self.unreadable(&e))?;
        if read as u64 == MAX_LINE_BYTES {
            return Err(self.damaged(&format!("the line has more than {MAX_LINE_BYTES} bytes")));
        }
        Ok(self.bytes.ends_with(b"\n"))
    }

    fn parsed<T: DeserializeOwned>(&self) -> Result<T, Error> {
        serde_json::from_slice(&self.bytes).map_err(|e| self.damaged(&json_fault(&e)))
    }

    /// The line belongs to the file.
    fn keep(&mut self) {
        self.hash.update(&self.bytes);
        self.length += self.bytes.len() as u64;
    }

    fn damaged(&self, what: &str) -> Error {
        let message =
            format!("{}, line {}: {}", shortened(&self.name, 120), self.number, shortened(what, 200));
        Error::new(message).help("the file is damaged: delete it, and make it again")
    }

    fn unreadable(&self, error: &std::io::Error) -> Error {
        mp_store::Error::reading(self.name.as_ref(), error).into()
    }
}
