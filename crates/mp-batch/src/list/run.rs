//! Plans the items of a list, and appends their results to a log.

use super::reader::{Next, ResultsReader};
use super::results::{end_line, line};
use super::{ItemResult, ListedProblems, ResultsHeader, Shard, Tally};
use crate::in_order;
use mp_io::shortened;
use mp_plan::{Cancel, Control, Error, Interrupt, Report};
use mp_store::{Journal, Lock};
use std::fs::File;
use std::io::BufReader;
use std::ops::ControlFlow;
use std::path::Path;
use xxhash_rust::xxh3::Xxh3;

/// The largest file of results that is read, bytes (4 TiB).
pub(super) const MAX_RESULTS_BYTES: u64 = 1 << 42;

/// How the items of a list are planned.
#[derive(Clone, Debug, PartialEq)]
pub struct ManyOptions {
    /// Which of them.
    pub shard: Shard,
    /// On how many threads. Results do not depend on it.
    pub threads: usize,
    /// Whether reports have times, which differ from run to run.
    pub times: bool,
    /// The budget of problems whose requests name none, seconds. `None` is that of
    /// [`Budget::default`](mp_plan::Budget).
    pub time_s: Option<f64>,
}

/// All items, on one thread, without times.
impl Default for ManyOptions {
    fn default() -> Self {
        Self { shard: Shard::WHOLE, threads: 1, times: false, time_s: None }
    }
}

/// How far the items of a list, or of a shard, are planned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ManyOutcome {
    /// How many there are.
    pub items: u64,
    /// How many results were in the file before.
    pub before: u64,
    /// Results in the file now. While several ranks write it, results that wait for their place count too.
    pub tally: Tally,
}

impl ManyOutcome {
    /// Whether all are planned.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.tally.items == self.items
    }
}

impl ListedProblems {
    /// Plans the items of a shard, and appends a line for each to the file `out`, in order: its report, or
    /// the error for which there is none. If the file holds the results of a run that ended early, planning
    /// resumes after its last whole line, and the finished file has the same bytes as that of an
    /// uninterrupted run. `progress` is called first, and after each item, in the calling thread.
    ///
    /// When `cancel` is raised, no further item begins, and items that are not finished then leave no line.
    ///
    /// ```no_run
    /// use mp_batch::{ManyOptions, ProblemList};
    /// use mp_plan::{Cancel, Interrupt};
    /// let list = ProblemList::load("problems.jsonl")?.with_scenes(&Interrupt::never())?;
    /// let options = ManyOptions { threads: 8, ..ManyOptions::default() };
    /// let outcome = list.run("results.jsonl".as_ref(), &options, &Cancel::new(), |_| ())?;
    /// println!("{} of {} problems are solved", outcome.tally.solved, outcome.items);
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// When the file cannot be written, is locked by another process, is damaged, or holds results of
    /// anything else: another list or version, other scenes, options or shards. Items that cannot be planned
    /// are no errors here.
    ///
    /// # Panics
    /// When planning or `progress` panics.
    pub fn run(
        &self,
        out: &Path,
        options: &ManyOptions,
        cancel: &Cancel,
        mut progress: impl FnMut(&ManyOutcome),
    ) -> Result<ManyOutcome, Error> {
        mp_store::make_folder(mp_store::folder_of(out))?;
        let _lock = Lock::of_file(out)?;
        let header = self.header(options);
        let mut log = Log::open(out, &header)?;
        let items = options.shard.count(header.items);
        let mut outcome = ManyOutcome { items, before: log.tally.items, tally: log.tally };
        progress(&outcome);
        if log.is_ended {
            return Ok(outcome);
        }
        let mut written = Ok(());
        let left = (log.tally.items..items).map(|nth| options.shard.item(nth));
        in_order(
            left,
            options.threads,
            cancel,
            |_, item| self.planned(item, options, cancel),
            |_, result| {
                written = match result {
                    Some(result) => result.and_then(|done| log.append(&done.line, done.tally)),
                    None => return ControlFlow::Break(()),
                };
                outcome.tally = log.tally;
                progress(&outcome);
                if written.is_ok() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
            },
        );
        written?;
        if outcome.is_complete() {
            log.end()?;
        }
        Ok(outcome)
    }

    /// The first line of the file of results: it says which list, scenes and part these are of, so that
    /// another run can go on.
    #[must_use]
    pub fn header(&self, options: &ManyOptions) -> ResultsHeader {
        let name = self.list.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let header =
            ResultsHeader::new(name, self.list.fingerprint, self.fingerprints.clone(), self.list.items);
        ResultsHeader { shard: options.shard, times: options.times, time_s: options.time_s, ..header }
    }

    /// The line of an item, and how it counts; `None` when planning was cancelled before it was done.
    pub(super) fn planned(
        &self,
        item: u64,
        options: &ManyOptions,
        cancel: &Cancel,
    ) -> Option<Result<Planned, Error>> {
        let plan = || {
            let (scene, request) =
                self.problem_until(item, options.time_s, &Interrupt::new(cancel.clone()))?;
            scene.plan_with(&request, &mut Control { cancel: cancel.clone(), ..Control::default() })
        };
        let report = plan();
        // A run that was cut short found less than it would have.
        if cancel.is_raised() {
            return None;
        }
        if let Some(file) = self.changed() {
            return Some(Err(super::changed(file)));
        }
        let of = |report: &Report| (report.time_s + report.finish_s, report.collision_checks);
        let (seconds, checks) = report.as_ref().map_or((0.0, 0), of);
        let result = ItemResult::new(item, report, options.times);
        let tally = result.tally();
        Some(line(&result).map(|line| Planned { line, tally, seconds, checks }))
    }
}

/// An item that is planned. Its costs are for the order in which ranks do items.
pub(super) struct Planned {
    /// Its line of the results.
    pub(super) line: String,
    /// How it counts.
    pub(super) tally: Tally,
    /// How long it took.
    pub(super) seconds: f64,
    /// Its collision queries.
    pub(super) checks: u64,
}

/// Results that grow.
pub(super) struct Log {
    journal: Journal,
    hash: Xxh3,
    /// How many are there.
    pub(super) tally: Tally,
    /// Whether they are complete.
    pub(super) is_ended: bool,
}

impl Log {
    /// Goes on with the file, which must have this header, or begins it.
    pub(super) fn open(out: &Path, header: &ResultsHeader) -> Result<Self, Error> {
        let is_new = std::fs::metadata(out).map_or_else(
            |e| e.kind() == std::io::ErrorKind::NotFound,
            |meta| meta.is_file() && meta.len() == 0,
        );
        if is_new {
            let first = line(header)?;
            let mut hash = Xxh3::new();
            hash.update(first.as_bytes());
            let journal = Journal::create(out, &first)?;
            return Ok(Self { journal, hash, tally: Tally::default(), is_ended: false });
        }
        let mut reader = open(out)?;
        let other = match &reader.header {
            there if there.shard != header.shard => {
                Some(format!("it is of shard {}, not {}", there.shard, header.shard))
            }
            there => there.difference(header),
        };
        if let Some(other) = other {
            let message = format!("{} cannot be gone on with: {other}", shortened(&reader.name, 120));
            return Err(Error::new(message).help("name another file, or delete it to begin anew"));
        }
        let is_ended = loop {
            match reader.read()? {
                Next::Item(_) => {}
                Next::End => break true,
                Next::Cut => break false,
            }
        };
        let ResultsReader { hash, tally, length, .. } = reader;
        Ok(Self { journal: Journal::resume(out, length)?, hash, tally, is_ended })
    }

    /// Appends a line, which ends with a line break.
    pub(super) fn append(&mut self, line: &str, tally: Tally) -> Result<(), Error> {
        self.journal.append(line.trim_end_matches('\n'))?;
        self.hash.update(line.as_bytes());
        self.tally += tally;
        Ok(())
    }

    /// Appends the last line.
    pub(super) fn end(&mut self) -> Result<(), Error> {
        let line = end_line(self.tally, &self.hash)?;
        self.journal.append(line.trim_end_matches('\n'))?;
        self.is_ended = true;
        Ok(())
    }
}

pub(super) fn open(file: &Path) -> Result<ResultsReader<BufReader<File>>, Error> {
    let source = mp_store::open(file, MAX_RESULTS_BYTES)?;
    ResultsReader::new(file.display().to_string(), BufReader::with_capacity(1 << 16, source))
}
