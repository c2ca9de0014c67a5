//! The log of finished runs, one line of JSON each, so that an interrupted measurement can be continued.

use super::provenance::commit;
use super::table::{Table, bit};
use crate::error::{IntoError, Result};
use mp_plan::Error;
use mp_store::Journal;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;
use std::path::Path;

/// The largest log that is read, bytes (1 GiB).
const MAX_LOG_BYTES: u64 = 1 << 30;

/// Cases and runs are values of JSON in it: so it is read and written by the same code in all experiments.
#[derive(Serialize, Deserialize)]
struct Line {
    /// The limit of a run: seconds, iterations or queries.
    cap: f64,
    case: Value,
    run: Value,
    /// The commit of the program that ran it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    commit: Option<String>,
}

/// All finished runs, and the file to which new ones are appended.
#[derive(Debug)]
pub(crate) struct Log<K, R> {
    cap: f64,
    runs: HashMap<K, R>,
    /// The commits of runs that are known from before.
    earlier: HashMap<K, String>,
    /// The file; `None` where another process keeps it.
    journal: Option<Journal>,
}

/// Runs whose cases have a key in common.
#[derive(Clone, Debug)]
pub(crate) struct Group<'a, G, K, R> {
    pub(crate) key: G,
    pub(crate) runs: Vec<(&'a K, &'a R)>,
}

impl<G, K, R> Group<'_, G, K, R> {
    /// The number of runs for which `such` is true.
    pub(crate) fn count(&self, such: impl Fn(&R) -> bool) -> usize {
        self.runs.iter().filter(|(_, run)| such(run)).count()
    }

    /// The value of each run.
    pub(crate) fn values(&self, of: impl Fn(&R) -> f64) -> impl Iterator<Item = f64> {
        self.runs.iter().map(move |(_, run)| of(run))
    }
}

/// The input of a run.
pub(crate) trait CaseKey:
    Clone + Eq + Hash + Ord + Serialize + DeserializeOwned + Send + Sync
{
}
impl<K: Clone + Eq + Hash + Ord + Serialize + DeserializeOwned + Send + Sync> CaseKey for K {}

/// The result of a run.
pub(crate) trait RunRecord: Clone + Serialize + DeserializeOwned + Send + Sync {}
impl<R: Clone + Serialize + DeserializeOwned + Send + Sync> RunRecord for R {}

/// Called for each finished run, with the number of its case and its result.
pub(crate) type OnFinished<'a> = dyn Fn(usize, Value) -> Result<()> + Sync + 'a;

/// As JSON.
pub(crate) fn value(of: &impl Serialize) -> Result<Value> {
    serde_json::to_value(of).into_error()
}

/// From JSON.
pub(crate) fn from_value<T: DeserializeOwned>(value: Value) -> Result<T> {
    serde_json::from_value(value).into_error()
}

/// Appends finished runs to the file of a log.
#[derive(Debug)]
pub(crate) struct Appender<'a> {
    cap: f64,
    journal: Option<&'a Journal>,
}

impl Appender<'_> {
    /// Appends a finished run.
    pub(crate) fn append(&self, case: Value, run: Value) -> Result<()> {
        let line = Line { cap: self.cap, case, run, commit: commit().map(str::to_owned) };
        let text = serde_json::to_string(&line).into_error()?;
        self.journal.map_or(Ok(()), |journal| Ok(journal.append(&text)?))
    }
}

/// The lines of the log at `path`, of whatever cap, and all that is whole of it as text. An incomplete last line is
/// left out.
fn lines(path: &Path) -> Result<(Vec<Line>, String)> {
    let text = String::from_utf8_lossy(&mp_store::read(path, MAX_LOG_BYTES)?).into_owned();
    let (mut lines, mut kept) = (Vec::new(), String::new());
    let count = text.lines().count();
    for (i, line) in text.lines().enumerate() {
        match serde_json::from_str(line) {
            Ok(known) => {
                kept.push_str(line);
                kept.push('\n');
                lines.push(known);
            }
            Err(_) if i + 1 == count => {}
            Err(e) => return Err(bad_line(path, i, &e)),
        }
    }
    Ok((lines, kept))
}

fn bad_line(path: &Path, nth: usize, why: &impl std::fmt::Display) -> Error {
    Error::new(format!("{}, line {}: {why}", path.display(), nth + 1)).help("delete it to measure anew")
}

impl<K: CaseKey, R: RunRecord> Log<K, R> {
    /// Opens the log at `path`, or creates it; `fresh` empties it. Only runs of the same cap are used.
    /// An incomplete last line is dropped.
    pub(crate) fn open(path: &Path, cap: f64, fresh: bool) -> Result<Self> {
        mp_store::make_folder(mp_store::folder_of(path))?;
        let (lines, kept) = if path.exists() && !fresh { lines(path)? } else { Default::default() };
        let (mut runs, mut earlier) = (HashMap::new(), HashMap::new());
        for (i, line) in lines.into_iter().enumerate() {
            let known = from_value(line.case).and_then(|case: K| Ok((case, from_value(line.run)?)));
            let (case, run) = known.map_err(|e| bad_line(path, i, &e))?;
            if line.cap == cap {
                earlier.insert(case.clone(), line.commit.unwrap_or_else(|| "unknown".to_owned()));
                runs.insert(case, run);
            }
        }
        Ok(Self { cap, runs, earlier, journal: Some(Journal::create(path, &kept)?) })
    }

    /// A log without a file.
    pub(crate) fn in_memory(cap: f64) -> Self {
        Self { cap, runs: HashMap::new(), earlier: HashMap::new(), journal: None }
    }

    /// The result of `case`, if it was run.
    pub(crate) fn get(&self, case: &K) -> Option<&R> {
        self.runs.get(case)
    }

    /// What appends finished runs to the file; [`learn`](Self::learn) adds them to the runs in memory.
    pub(crate) fn appender(&self) -> Appender<'_> {
        Appender { cap: self.cap, journal: self.journal.as_ref() }
    }

    /// All runs as JSON, sorted.
    pub(crate) fn values(&self) -> Result<Vec<(Value, Value)>> {
        self.all().into_iter().map(|(case, run)| Ok((value(case)?, value(run)?))).collect()
    }

    /// Adds finished runs in JSON to those in memory.
    pub(crate) fn learn_values(&mut self, runs: Vec<(Value, Value)>) -> Result<()> {
        for (case, run) in runs {
            self.runs.insert(from_value(case)?, from_value(run)?);
        }
        Ok(())
    }

    /// Adds finished runs to those in memory.
    pub(crate) fn learn(&mut self, runs: impl IntoIterator<Item = (K, R)>) {
        self.runs.extend(runs);
    }

    /// The results of those `cases` that were run, in the same order.
    pub(crate) fn runs(&self, cases: impl IntoIterator<Item = K>) -> Vec<&R> {
        cases.into_iter().filter_map(|case| self.get(&case)).collect()
    }

    /// The results of those `cases` that were run; consecutive cases with the same `key` make a group.
    pub(crate) fn groups<'a, G: PartialEq>(
        &'a self,
        cases: &'a [K],
        key: impl Fn(&'a K) -> G,
    ) -> Vec<Group<'a, G, K, R>> {
        let mut groups: Vec<Group<'_, G, K, R>> = Vec::new();
        for case in cases {
            let Some(run) = self.get(case) else { continue };
            let key = key(case);
            match groups.last_mut() {
                Some(last) if last.key == key => last.runs.push((case, run)),
                _ => groups.push(Group { key, runs: vec![(case, run)] }),
            }
        }
        groups
    }

    /// Those `cases` that were run, each with its result.
    pub(crate) fn each<'a>(&'a self, cases: &'a [K]) -> impl Iterator<Item = (&'a K, &'a R)> {
        cases.iter().filter_map(|case| Some((case, self.get(case)?)))
    }

    /// Those `cases` that were run, sorted, a row for each: the members of the case and of its result,
    /// numbers with six digits.
    pub(crate) fn table(&self, cases: &[K]) -> Result<Table> {
        let members = |value: Value| match value {
            Value::Object(members) => members.into_iter().collect(),
            other => vec![("case".to_owned(), other)],
        };
        let cell = |value: Value| match value {
            Value::String(text) => text,
            Value::Bool(yes) => bit(yes),
            Value::Number(number) if number.is_f64() => number.as_f64().map_or(String::new(), six_digits),
            Value::Null => String::new(),
            other => other.to_string(),
        };
        let mut table = Table::new(Vec::<String>::new());
        let mut sorted = cases.to_vec();
        sorted.sort();
        for (case, run) in self.each(&sorted) {
            let mut row = members(value(case)?);
            row.extend(members(value(run)?));
            if table.head.is_empty() {
                table.head = row.iter().map(|(name, _)| name.clone()).collect();
            }
            table.rows.push(row.into_iter().map(|(_, value)| cell(value)).collect());
        }
        table.commits = self.commits(cases);
        Ok(table)
    }

    /// The commits at which those `cases` that were run were, and how many at each.
    pub(crate) fn commits(&self, cases: &[K]) -> BTreeMap<String, usize> {
        let mut commits = BTreeMap::new();
        for (case, _) in self.each(cases) {
            let now = || commit().unwrap_or("unknown").to_owned();
            *commits.entry(self.earlier.get(case).cloned().unwrap_or_else(now)).or_default() += 1;
        }
        commits
    }

    /// All runs, sorted.
    pub(crate) fn all(&self) -> Vec<(&K, &R)> {
        let mut all: Vec<_> = self.runs.iter().collect();
        all.sort_by_key(|(case, _)| *case);
        all
    }
}

/// The number with at most six significant digits.
fn six_digits(v: f64) -> String {
    format!("{v:.5e}").parse::<f64>().unwrap_or(v).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
    struct Named {
        scene: String,
        seed: u64,
    }

    #[derive(Clone, Serialize, Deserialize)]
    struct Took {
        solved: bool,
        seconds: f64,
        first: Option<f64>,
    }

    #[test]
    fn a_log_is_a_table_of_its_members() {
        let folder = tempfile::tempdir().unwrap();
        let mut log = Log::open(&folder.path().join("runs.jsonl"), 1.0, false).unwrap();
        for (seed, seconds) in [(2, 0.123_456_789), (1, 1234.5), (3, 1.0)] {
            let case = Named { scene: "maze, small".into(), seed };
            log.learn([(case, Took { solved: seed < 2, seconds, first: None })]);
        }
        let case = |seed| Named { scene: "maze, small".into(), seed };
        let table = log.table(&[case(2), case(1), case(7)]).unwrap();
        let mut head = table.head.clone();
        head.sort();
        assert_eq!(head, ["first", "scene", "seconds", "seed", "solved"]);
        let at = |name: &str| table.head.iter().position(|h| h == name).unwrap();
        let of = |row: usize| {
            ["scene", "seed", "solved", "seconds", "first"].map(|n| table.rows[row][at(n)].as_str())
        };
        assert_eq!(of(0), ["maze, small", "1", "1", "1234.5", ""]);
        assert_eq!(of(1), ["maze, small", "2", "0", "0.123457", ""]);
        assert_eq!(table.rows.len(), 2);
    }

    fn case(obstacles: usize) -> (String, usize) {
        ("rsrt".to_owned(), obstacles)
    }

    #[test]
    fn what_was_interrupted_goes_on() {
        let run = (true, 0.1);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/runs.jsonl");
        let open = |cap, fresh| Log::<(String, usize), (bool, f64)>::open(&path, cap, fresh);
        let log = open(6.0, false).unwrap();
        let write =
            |log: &Log<_, _>, n| log.appender().append(value(&case(n)).unwrap(), value(&run).unwrap());
        write(&log, 2).unwrap();
        write(&log, 4).unwrap();
        std::fs::write(&path, std::fs::read_to_string(&path).unwrap() + "{\"cap\":6").unwrap();
        let mut log = open(6.0, false).unwrap();
        assert_eq!(log.get(&case(4)), Some(&run));
        assert_eq!(log.get(&case(8)), None);
        write(&log, 8).unwrap();
        log.learn([(case(8), run)]);
        assert_eq!(log.all().len(), 3);
        assert_eq!(open(6.0, false).unwrap().all().len(), 3);
        assert_eq!(open(7.0, false).unwrap().all().len(), 0, "another cap");
        assert_eq!(open(6.0, true).unwrap().all().len(), 0, "afresh");
        std::fs::write(&path, "nonsense\nnonsense\n").unwrap();
        assert!(open(6.0, false).unwrap_err().to_string().contains("line 1"));
    }
}
