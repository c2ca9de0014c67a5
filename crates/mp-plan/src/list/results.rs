//! Results of the items of a list: a log of JSON lines, with a header first and an end last.

use super::{MAX_ITEMS, Shard, json_fault};
use crate::{Error, Report, StoppedBy};
use mp_io::{one_line, shortened};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::io::{BufRead, Read};
use xxhash_rust::xxh3::Xxh3;

/// The version of results that this program writes. It grows when a member changes its meaning or is removed.
pub const RESULTS_VERSION: u32 = 1;

/// The word in the header by which such files are known.
const FORMAT: &str = "mp-many";

/// The largest line that is read, bytes: 64 MiB.
const MAX_LINE_BYTES: u64 = mp_io::MAX_TEXT_BYTES;

/// The first line of results: all that they depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResultsHeader {
    /// `mp-many`.
    pub format: String,
    /// [`RESULTS_VERSION`].
    pub version: u32,
    /// The version of the program that planned.
    pub program: String,
    /// The file of the list, without its folder.
    pub list: String,
    /// A hash of its content (XXH3), 16 hexadecimal digits.
    pub list_fingerprint: String,
    /// Its scenes, in the order of their first lines.
    pub scenes: Vec<SceneFingerprint>,
    /// How many items the list has.
    pub items: u64,
    /// Which of them are here.
    pub shard: Shard,
    /// Whether reports have times.
    pub times: bool,
    /// The budget of problems that name none, seconds.
    pub time_s: Option<f64>,
}

/// A scene of a list, and what it was read from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SceneFingerprint {
    /// Its name in the list.
    pub scene: String,
    /// Its file, relative to the list, or that of the shipped scene.
    pub file: String,
    /// A hash of the content of all its files (XXH3), 16 hexadecimal digits.
    pub fingerprint: String,
}

/// The result of an item: a report, or the error for which there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ItemResult {
    /// The number of the item.
    pub item: u64,
    /// Its report.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub report: Option<Report>,
    /// Why it could not be planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<ItemError>,
}

/// Why an item could not be planned.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ItemError {
    /// What is wrong, in one line.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}

/// How many items ended how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// All of them.
    pub items: u64,
    /// With a verified path.
    pub solved: u64,
    /// Without a path.
    pub unsolved: u64,
    /// With an error.
    pub failed: u64,
    /// Ended, shortened or verified less by a budget of time: what they found depends on the machine.
    pub timed: u64,
}

/// The last line.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct EndLine {
    end: Tally,
    /// A hash of all bytes before this line (XXH3), 16 hexadecimal digits.
    checksum: String,
}

/// How the last line begins.
const END: &str = "{\"end\":";

impl ResultsHeader {
    pub(super) fn new(
        list: String,
        list_fingerprint: u64,
        scenes: Vec<SceneFingerprint>,
        items: u64,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: RESULTS_VERSION,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            list,
            list_fingerprint: format!("{list_fingerprint:016x}"),
            scenes,
            items,
            shard: Shard::WHOLE,
            times: false,
            time_s: None,
        }
    }

    /// What is different in `other`, but for the shard: a sentence about this one.
    pub(super) fn difference(&self, other: &Self) -> Option<String> {
        let short = |text: &str| one_line(text, 60);
        let seconds = |time: Option<f64>| time.map_or("no --time".to_owned(), |s| format!("--time {s}"));
        let times = |times: bool| if times { "with --times" } else { "without --times" };
        let scenes = || {
            let differ = self.scenes.iter().zip(&other.scenes).find(|(a, b)| a != b).map(|(a, _)| a);
            let which =
                differ.map_or("other scenes".to_owned(), |a| format!("another scene {}", short(&a.scene)));
            format!("it is of {which}: a file has changed")
        };
        let (a, b) = (self, other);
        if a.program != b.program {
            Some(format!("it is of version {} of the program, not {}", short(&a.program), short(&b.program)))
        } else if a.list != b.list {
            Some(format!("it is of the list {}, not {}", short(&a.list), short(&b.list)))
        } else if a.list_fingerprint != b.list_fingerprint || a.items != b.items {
            Some(format!("it is of another list {}: the list has changed", short(&a.list)))
        } else if a.scenes != b.scenes {
            Some(scenes())
        } else if a.times != b.times {
            Some(format!("it was made {}, not {}", times(a.times), times(b.times)))
        } else if a.time_s != b.time_s {
            Some(format!("it was made with {}, not {}", seconds(a.time_s), seconds(b.time_s)))
        } else {
            None
        }
    }

    /// The command that makes the results of a shard in a file.
    pub(super) fn command(&self, shard: Shard, out: &str) -> String {
        let mut command = format!("mp many {} --out {}", word(&self.list), word(out));
        if shard != Shard::WHOLE {
            command += &format!(" --shard {shard}");
        }
        if let Some(time) = self.time_s {
            command += &format!(" --time {time}");
        }
        if self.times {
            command += " --times";
        }
        command
    }
}

/// A file name as a word of a command.
fn word(name: &str) -> String {
    let name = one_line(name, 80);
    let plain = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c);
    if name.chars().all(plain) { name } else { format!("'{}'", name.replace('\'', r"'\''")) }
}

impl ItemResult {
    /// The result of an item. Reports have no times unless they are asked for.
    pub(super) fn new(item: u64, result: Result<Report, Error>, times: bool) -> Self {
        let (report, error) = match result {
            Ok(report) if times => (Some(report), None),
            Ok(report) => (Some(report.without_times()), None),
            Err(e) => {
                let help = e.remedy().map(str::to_owned);
                (None, Some(ItemError { message: e.to_string(), help }))
            }
        };
        Self { item, report, error }
    }

    /// It counted.
    pub(super) fn tally(&self) -> Tally {
        let solved = self.report.as_ref().is_some_and(|report| report.solved);
        let by_time = |report: &Report| {
            let time = Some(StoppedBy::Time);
            let late = [time, Some(StoppedBy::Unverified)].contains(&report.stopped_by);
            late || report.stages.iter().any(|stage| stage.ended_by == time)
        };
        Tally {
            items: 1,
            solved: u64::from(solved),
            unsolved: u64::from(self.report.is_some() && !solved),
            failed: u64::from(self.report.is_none()),
            timed: u64::from(self.report.as_ref().is_some_and(by_time)),
        }
    }
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.items += other.items;
        self.solved += other.solved;
        self.unsolved += other.unsolved;
        self.failed += other.failed;
        self.timed += other.timed;
    }
}

/// A line of results, with its line break.
pub(super) fn line(value: &impl Serialize) -> Result<String, Error> {
    let text = serde_json::to_string(value);
    Ok(text.map_err(|e| Error::new(format!("the result cannot be written as JSON: {e}")))? + "\n")
}

/// The last line, after bytes with this hash.
pub(super) fn end_line(tally: Tally, hash: &Xxh3) -> Result<String, Error> {
    line(&EndLine { end: tally, checksum: format!("{:016x}", hash.digest()) })
}

/// The bytes of results whose last line has the right hash: for fuzzing.
#[cfg(all(feature = "kinds", feature = "pictures", feature = "roadmaps"))]
pub(crate) fn checksum(bytes: &[u8]) -> Vec<u8> {
    let last =
        bytes[..bytes.len().saturating_sub(1)].iter().rposition(|b| *b == b'\n').map_or(0, |at| at + 1);
    let (before, end) = bytes.split_at(last);
    let Some(Ok(mut line)) = std::str::from_utf8(end).ok().map(serde_json::from_str::<EndLine>) else {
        return bytes.to_vec();
    };
    line.checksum = format!("{:016x}", xxhash_rust::xxh3::xxh3_64(before));
    let line = self::line(&line).unwrap_or_default();
    [before, line.as_bytes()].concat()
}

/// What follows in results.
#[derive(Debug)]
pub(crate) enum Next {
    /// The result of the next item: its line is that of the reader.
    Item(ItemResult),
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
    /// Of the bytes of all whole lines so far, and how many those are.
    pub(super) hash: Xxh3,
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
        let result: ItemResult = self.parsed()?;
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
        if report.version > crate::REPORT_VERSION {
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
