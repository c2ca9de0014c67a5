//! Finished runs, one line of JSON each: a measurement that was interrupted goes on where it was.

use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What was run.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Case {
    pub(super) mover: String,
    pub(super) model: String,
    pub(super) metric: String,
    pub(super) planner: String,
    pub(super) obstacles: usize,
    pub(super) instance: u64,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) solved: bool,
    /// Processor time, with the verification of candidate paths.
    pub(super) seconds: f64,
    pub(super) iterations: u64,
    pub(super) nodes: usize,
    /// Configurations asked of the collision checker.
    pub(super) checks: u64,
    /// Times a node was expanded: motions asked of the local planner.
    pub(super) expansions: u64,
    /// Candidate paths that failed verification.
    pub(super) rejected: u64,
    /// Time along the path, in steps of the inputs (positions: number of edges).
    pub(super) edges: usize,
}

#[derive(Serialize, Deserialize)]
struct Line {
    /// Seconds of processor time a run might take.
    cap: f64,
    case: Case,
    run: Run,
}

/// The runs there are, and the file that grows by each new one.
#[derive(Debug)]
pub(super) struct Log {
    path: PathBuf,
    cap: f64,
    runs: HashMap<Case, Run>,
    file: Mutex<File>,
}

impl Log {
    /// Opens the log at `path`, or begins it; `fresh` forgets what is in it. Only runs of the same cap count.
    /// A last line that was cut off is left out.
    pub(super) fn open(path: &Path, cap: f64, fresh: bool) -> Result<Self> {
        let failed = || format!("cannot use {}", path.display());
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).into_diagnostic().wrap_err_with(failed)?;
        }
        let text = match path.exists() && !fresh {
            true => std::fs::read_to_string(path).into_diagnostic().wrap_err_with(failed)?,
            false => String::new(),
        };
        let (mut runs, mut kept) = (HashMap::new(), String::new());
        let lines: Vec<&str> = text.lines().collect();
        for (i, line) in lines.iter().enumerate() {
            match serde_json::from_str::<Line>(line) {
                Ok(known) => {
                    kept.push_str(line);
                    kept.push('\n');
                    if known.cap == cap {
                        runs.insert(known.case, known.run);
                    }
                }
                Err(_) if i + 1 == lines.len() => {}
                Err(e) => {
                    let help = "delete it to measure anew";
                    return Err(miette!(help = help, "{}, line {}: {e}", path.display(), i + 1));
                }
            }
        }
        crate::output::write(path, kept.as_bytes())?;
        let file = File::options().append(true).open(path).into_diagnostic().wrap_err_with(failed)?;
        Ok(Self { path: path.to_owned(), cap, runs, file: Mutex::new(file) })
    }

    /// What is known of `case`.
    pub(super) fn get(&self, case: &Case) -> Option<&Run> {
        self.runs.get(case)
    }

    /// Appends a finished run to the file. [`learn`](Self::learn) makes it known.
    pub(super) fn write(&self, case: &Case, run: &Run) -> Result<()> {
        let line = Line { cap: self.cap, case: case.clone(), run: *run };
        let text = serde_json::to_string(&line).into_diagnostic()? + "\n";
        let mut file = self.file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(text.as_bytes())
            .into_diagnostic()
            .wrap_err_with(|| format!("cannot write to {}", self.path.display()))
    }

    /// Makes finished runs known.
    pub(super) fn learn(&mut self, runs: impl IntoIterator<Item = (Case, Run)>) {
        self.runs.extend(runs);
    }

    /// All runs, sorted.
    pub(super) fn all(&self) -> Vec<(&Case, &Run)> {
        let mut all: Vec<_> = self.runs.iter().collect();
        all.sort_by_key(|(case, _)| *case);
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(obstacles: usize) -> Case {
        let [mover, model, metric, planner] = ["arm", "positions", "manhattan", "rsrt"].map(str::to_owned);
        Case { mover, model, metric, planner, obstacles, instance: 3 }
    }

    #[test]
    fn what_was_interrupted_goes_on() {
        let run = Run {
            solved: true,
            seconds: 0.1,
            iterations: 5,
            nodes: 4,
            checks: 9,
            expansions: 5,
            rejected: 0,
            edges: 3,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/runs.jsonl");
        let log = Log::open(&path, 6.0, false).unwrap();
        log.write(&case(2), &run).unwrap();
        log.write(&case(4), &run).unwrap();
        std::fs::write(&path, std::fs::read_to_string(&path).unwrap() + "{\"cap\":6").unwrap();
        let mut log = Log::open(&path, 6.0, false).unwrap();
        assert_eq!(log.get(&case(4)), Some(&run));
        assert_eq!(log.get(&case(8)), None);
        log.write(&case(8), &run).unwrap();
        log.learn([(case(8), run)]);
        assert_eq!(log.all().len(), 3);
        assert_eq!(Log::open(&path, 6.0, false).unwrap().all().len(), 3);
        assert_eq!(Log::open(&path, 7.0, false).unwrap().all().len(), 0, "another cap");
        assert_eq!(Log::open(&path, 6.0, true).unwrap().all().len(), 0, "afresh");
        std::fs::write(&path, "nonsense\nnonsense\n").unwrap();
        assert!(Log::open(&path, 6.0, false).unwrap_err().to_string().contains("line 1"));
    }
}
