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

#[derive(Serialize, Deserialize)]
struct Line<K, R> {
    /// The limit of a run: seconds, iterations or queries.
    cap: f64,
    case: K,
    run: R,
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

impl<K: CaseKey, R: RunRecord> Log<K, R> {
    /// Opens the log at `path`, or creates it; `fresh` empties it. Only runs of the same cap are used.
    /// An incomplete last line is dropped.
    pub(crate) fn open(path: &Path, cap: f64, fresh: bool) -> Result<Self> {
        mp_store::make_folder(mp_store::folder_of(path))?;
        let text = match path.exists() && !fresh {
            true => String::from_utf8_lossy(&mp_store::read(path, MAX_LOG_BYTES)?).into_owned(),
            false => String::new(),
        };
        let (mut runs, mut earlier, mut kept) = (HashMap::new(), HashMap::new(), String::new());
        let lines: Vec<&str> = text.lines().collect();
        for (i, line) in lines.iter().enumerate() {
            match serde_json::from_str::<Line<K, R>>(line) {
                Ok(known) => {
                    kept.push_str(line);
                    kept.push('\n');
                    if known.cap == cap {
                        earlier
                            .insert(known.case.clone(), known.commit.unwrap_or_else(|| "unknown".to_owned()));
                        runs.insert(known.case, known.run);
                    }
                }
                Err(_) if i + 1 == lines.len() => {}
                Err(e) => {
                    let message = format!("{}, line {}: {e}", path.display(), i + 1);
                    return Err(Error::new(message).help("delete it to measure anew"));
                }
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

    /// Appends a finished run to the file; [`learn`](Self::learn) adds it to the runs in memory.
    pub(crate) fn write(&self, case: &K, run: &R) -> Result<()> {
        let commit = commit().map(str::to_owned);
        let line = Line { cap: self.cap, case: case.clone(), run: run.clone(), commit };
        let text = serde_json::to_string(&line).into_error()?;
        self.journal.as_ref().map_or(Ok(()), |journal| Ok(journal.append(&text)?))
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
            let mut row = members(serde_json::to_value(case).into_error()?);
            row.extend(members(serde_json::to_value(run).into_error()?));
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
        log.write(&case(2), &run).unwrap();
        log.write(&case(4), &run).unwrap();
        std::fs::write(&path, std::fs::read_to_string(&path).unwrap() + "{\"cap\":6").unwrap();
        let mut log = open(6.0, false).unwrap();
        assert_eq!(log.get(&case(4)), Some(&run));
        assert_eq!(log.get(&case(8)), None);
        log.write(&case(8), &run).unwrap();
        log.learn([(case(8), run)]);
        assert_eq!(log.all().len(), 3);
        assert_eq!(open(6.0, false).unwrap().all().len(), 3);
        assert_eq!(open(7.0, false).unwrap().all().len(), 0, "another cap");
        assert_eq!(open(6.0, true).unwrap().all().len(), 0, "afresh");
        std::fs::write(&path, "nonsense\nnonsense\n").unwrap();
        assert!(open(6.0, false).unwrap_err().to_string().contains("line 1"));
    }
}
