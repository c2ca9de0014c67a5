//! Lists of planning problems: their items are numbered, and their results are logs that go on where they
//! ended.

mod items;
mod merge;
mod order;
mod parcel;
mod ranks;
mod reader;
mod results;
mod run;
mod scenes;
mod shard;

pub use items::ListResults;
pub use merge::merge_results;
pub(crate) use merge::merged;
pub use parcel::scene_on_ranks;
pub use ranks::RanksOutcome;
pub(crate) use reader::{Next, ResultsReader};
pub(crate) use results::checksum;
pub use results::{ItemError, ItemResult, RESULTS_VERSION, ResultsHeader, SceneFingerprint, Tally};
pub use run::{ManyOptions, ManyOutcome};
pub use scenes::ListedProblems;
pub(crate) use scenes::fingerprint_of;
pub use shard::Shard;

use mp_io::ErrorKind;
use mp_plan::{Error, RelaxField, Request};
use serde::Deserialize;
use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The largest number of items of a list.
const MAX_ITEMS: u64 = 1 << 30;

/// A list of planning problems: a text with one JSON object a line, which docs/formats/many.md describes. Its
/// *items* are the lines, each with each of its seeds, numbered from 0 in order.
///
/// ```
/// let text = r#"
///     {"scene": "easy", "seeds": {"from": 1, "count": 100}}
///     {"scene": "maze", "request": {"planner": "prm", "budget": {"iterations": 5000}}, "seeds": [7, 8]}
/// "#;
/// let list = mp_batch::ProblemList::parse("problems.jsonl", text.as_bytes())?;
/// assert_eq!((list.items(), list.scenes()), (102, &["easy".to_owned(), "maze".to_owned()][..]));
/// # Ok::<(), mp_plan::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct ProblemList {
    file: PathBuf,
    fingerprint: u64,
    scenes: Vec<String>,
    /// The first line that names each scene.
    lines: Vec<usize>,
    problems: Vec<Problem>,
    items: u64,
}

/// A line of a list.
#[derive(Clone, Debug)]
struct Problem {
    /// The number of its first item.
    first: u64,
    /// Which scene of the list.
    scene: usize,
    start: Option<Vec<f64>>,
    goals: Option<Vec<Vec<f64>>>,
    request: Request,
    /// Whether the request names a planner, and a budget of time.
    names_planner: bool,
    names_time: bool,
    seeds: Seeds,
}

/// A line as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    scene: String,
    start: Option<Vec<f64>>,
    goal: Option<Vec<f64>>,
    goals: Option<Vec<Vec<f64>>>,
    #[serde(default)]
    request: Request,
    seeds: Option<Seeds>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged, expecting = "expected seeds as a list, [1, 2], or as {\"from\": 1, \"count\": 100}")]
enum Seeds {
    Each(Vec<u64>),
    Range(SeedRange),
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct SeedRange {
    from: u64,
    count: u64,
}

impl Seeds {
    fn count(&self) -> u64 {
        match self {
            Self::Each(seeds) => seeds.len() as u64,
            Self::Range(range) => range.count,
        }
    }

    /// The seed `nth`, from 0. Ranges end before the largest number.
    fn get(&self, nth: u64) -> Option<u64> {
        match self {
            Self::Each(seeds) => seeds.get(usize::try_from(nth).ok()?).copied(),
            Self::Range(range) => range.from.checked_add(nth),
        }
    }
}

impl ProblemList {
    /// Reads a list of at most 64 MiB.
    ///
    /// # Errors
    /// When the file cannot be read, or as [`parse`](Self::parse).
    pub fn load(file: impl AsRef<Path>) -> Result<Self, Error> {
        let (_, bytes) = mp_io::read_text(file.as_ref())?;
        Self::parse(file, &bytes)
    }

    /// Reads a list from the content of `file`.
    ///
    /// # Errors
    /// When a line is not valid: with its number. Of a request only its form is checked here.
    pub fn parse(file: impl AsRef<Path>, bytes: &[u8]) -> Result<Self, Error> {
        let file = file.as_ref();
        let name = file.display();
        let text =
            std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).map_err(|e| {
                let before = &bytes[..e.valid_up_to()];
                let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
                let message = format!("line {line} is not UTF-8 text");
                mp_io::Error::new(ErrorKind::Format, &name, message).help("save the list as UTF-8")
            })?;
        let mut list = Self {
            file: file.to_owned(),
            fingerprint: xxhash_rust::xxh3::xxh3_64(bytes),
            scenes: Vec::new(),
            lines: Vec::new(),
            problems: Vec::new(),
            items: 0,
        };
        let mut known = HashMap::new();
        for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            list.add(number + 1, line, &mut known).map_err(|(message, help)| {
                mp_io::Error::in_line(ErrorKind::Format, &name, text, number + 1, message).help(help)
            })?;
        }
        if list.problems.is_empty() {
            let message = "there is no problem in the list";
            let help = "write a line for each, such as {\"scene\": \"cubicles\"}";
            return Err(mp_io::Error::new(ErrorKind::Content, &name, message).help(help).into());
        }
        Ok(list)
    }

    /// Adds the line of this number. The error is what is wrong, and what to do.
    fn add(
        &mut self,
        number: usize,
        text: &str,
        known: &mut HashMap<String, usize>,
    ) -> Result<(), (String, &'static str)> {
        const SHAPE: &str = "docs/formats/many.md describes the members of a line";
        let wrong = |message: &str, help| Err((message.to_owned(), help));
        let line: Line = serde_json::from_str(text).map_err(|e| (json_fault(&e), SHAPE))?;
        // What the request names itself cannot be told from defaults any more.
        let value: Value = serde_json::from_str(text).map_err(|e| (json_fault(&e), SHAPE))?;
        let names = |member: &str| value.pointer(&format!("/request/{member}")).is_some();
        if line.scene.is_empty() {
            return wrong("the scene has no name", "name a shipped scene, or a file relative to the list");
        }
        let request = line.request;
        if request.roadmap.is_some() {
            return wrong("a problem of a list keeps no roadmap", "leave `roadmap` out");
        }
        let named = request.settings.get("field").and_then(|name| name.parse().ok());
        if [Some(&request.field), named.as_ref()]
            .into_iter()
            .flatten()
            .any(|f| matches!(f, RelaxField::Image(_)))
        {
            return wrong(
                "a problem of a list reads no image",
                "take another field: clearance, paper or risk",
            );
        }
        let goals = match (line.goal, line.goals) {
            (Some(_), Some(_)) => return wrong("there are both `goal` and `goals`", "leave one out"),
            (Some(goal), None) => Some(vec![goal]),
            (None, goals) => goals,
        };
        let seeds = match line.seeds {
            Some(_) if names("seed") => {
                return wrong("there are both `seeds` and a `seed` in the request", "leave one out");
            }
            Some(seeds) => seeds,
            None => Seeds::Each(vec![request.seed]),
        };
        if seeds.count() == 0 {
            return wrong("there is no seed", "leave `seeds` out for one run with seed 1");
        }
        if let Seeds::Range(SeedRange { from, count }) = seeds
            && from.checked_add(count - 1).is_none()
        {
            return wrong("the seeds are too large", "begin with a smaller seed");
        }
        let first = self.items;
        self.items = match first.checked_add(seeds.count()) {
            Some(items) if items <= MAX_ITEMS => items,
            _ => return wrong("the list has more than 2^30 items", "split it into several lists"),
        };
        let scene = *known.entry(line.scene).or_insert_with_key(|name| {
            self.scenes.push(name.clone());
            self.lines.push(number);
            self.scenes.len() - 1
        });
        let (names_planner, names_time) = (names("planner"), names("budget/time_s"));
        let start = line.start;
        self.problems.push(Problem { first, scene, start, goals, request, names_planner, names_time, seeds });
        Ok(())
    }

    /// The file that it was loaded from, or the name that [`parse`](Self::parse) was given.
    #[must_use]
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The problems of all lines, each counted once for each of its seeds.
    #[must_use]
    pub fn items(&self) -> u64 {
        self.items
    }

    /// The scenes that it names, each once, in the order of their first lines.
    #[must_use]
    pub fn scenes(&self) -> &[String] {
        &self.scenes
    }

    /// The line of an item, and its seed.
    fn item(&self, item: u64) -> Option<(&Problem, u64)> {
        let after = self.problems.partition_point(|problem| problem.first <= item);
        let problem = self.problems.get(after.checked_sub(1)?)?;
        Some((problem, problem.seeds.get(item - problem.first).filter(|_| item < self.items)?))
    }
}

/// A file of a list is not what it was when the list was read.
fn changed(file: &Path) -> Error {
    Error::new(format!("{} has changed since the list was read", file.display())).help("start again")
}

/// What is wrong with a line of JSON: with the column, as the line is known.
fn json_fault(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at line ") {
        Some((what, _)) => format!("{what} (column {})", error.column()),
        None => text,
    }
}
