//! Results of the items of a list: a log of JSON lines, with a header first and an end last.

use super::Shard;
use mp_io::one_line;
use mp_plan::{Error, Report, StoppedBy};
use serde::{Deserialize, Serialize};
use std::fmt;
use xxhash_rust::xxh3::Xxh3;

/// The version of results that this program writes. It grows when a member changes its meaning or is removed.
pub const RESULTS_VERSION: u32 = 1;

/// The word in the header by which such files are known.
pub(super) const FORMAT: &str = "mp-many";

/// The first line of results: all that they depend on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResultsHeader {
    /// `mp-many`.
    pub format: String,
    /// The version of the format: [`RESULTS_VERSION`].
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
    /// Its place in the list, from 0.
    pub item: u64,
    /// What came of it; `None` where there is an error in place of a report.
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
pub(super) struct EndLine {
    pub(super) end: Tally,
    /// A hash of all bytes before this line (XXH3), 16 hexadecimal digits.
    pub(super) checksum: String,
}

/// How the last line begins.
pub(super) const END: &str = "{\"end\":";

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

    /// The first difference to `other` apart from the shard, as a sentence about this header.
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

    /// The report, or the error.
    ///
    /// # Errors
    /// When the item could not be planned.
    pub fn into_result(self) -> Result<Report, Error> {
        let Some(error) = self.error else {
            let neither = || Error::new(format!("item {} has neither a report nor an error", self.item));
            return self.report.ok_or_else(neither);
        };
        let planned = Error::new(error.message);
        Err(match error.help {
            Some(help) => planned.help(help),
            None => planned,
        })
    }

    /// How it counts: the tally of one item.
    #[must_use]
    pub fn tally(&self) -> Tally {
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

/// As a sentence: `3 problems: 2 solved, 1 unsolved, 0 failed`.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { items, solved, unsolved, failed, timed } = self;
        let problems = mp_plan::count(usize::try_from(*items).unwrap_or(usize::MAX), "problem");
        write!(f, "{problems}: {solved} solved, {unsolved} unsolved, {failed} failed")?;
        match timed {
            0 => Ok(()),
            _ => write!(f, "; the time was up for {timed}: their results depend on the machine"),
        }
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
