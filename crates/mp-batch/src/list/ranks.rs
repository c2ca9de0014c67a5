//! Plans the items of a list on all ranks of a cluster.

use super::order::Order;
use super::run::{Log, Planned};
use super::{ListedProblems, ManyOptions, ManyOutcome, Shard, Tally};
use crate::ranks::{broadcast, ranks_error, run};
use mp_plan::{Cancel, Error};
use mp_ranks::{Checkpoint, ItemContext, Job, Link, Options, Shares};
use mp_store::{FileId, Lock};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// How many results for each thread of a rank may wait for their place in the file.
const AHEAD: u64 = 64;
/// How many may wait at least, however few threads there are.
const AHEAD_AT_LEAST: u64 = 4096;

/// How far the items of a list are planned by all ranks, and what each rank did.
#[derive(Clone, Debug, PartialEq)]
pub struct RanksOutcome {
    /// How far the items are planned.
    pub outcome: ManyOutcome,
    /// What each rank did now: its items, and their collision queries as work.
    pub shares: Shares,
}

impl ListedProblems {
    /// As [`run`](Self::run), on all ranks: each of them calls this, with the same options. Only the master
    /// needs the disk: it calls `problems` for the list, sends all files of its scenes to the others, once,
    /// and writes the results, the same bytes as `run`. It hands out items one by one, beginning with those
    /// whose kind has taken longest so far. `progress` is called on the master, and the others get `None`.
    ///
    /// Results that come before their place in the file are kept beside it, in a file with the ending
    /// `.ahead`, until their turn. So a job that is killed loses only the items at work. The same call
    /// resumes it, on any number of ranks; so does `run`.
    ///
    /// When `cancel` is raised, on whichever rank, no further item begins, and those that are not finished
    /// leave no result.
    ///
    /// # Errors
    /// As [`run`](Self::run), those of `problems`, and when `out` is a file of the list; on the master. Where
    /// a rank cannot be reached, or has another version of the program or other scenes than the master.
    pub fn run_on(
        link: &dyn Link,
        out: &Path,
        options: &ManyOptions,
        cancel: &Cancel,
        problems: impl FnOnce() -> Result<Self, Error>,
        progress: impl FnMut(&ManyOutcome),
    ) -> Result<Option<RanksOutcome>, Error> {
        let ranks = Options { threads: options.threads, cancel: cancel.clone() };
        if !link.is_master() {
            let parcel = broadcast(link, Vec::new())?;
            // Empty when nothing is left to do, or nothing can be done.
            if !parcel.is_empty() {
                let problems = Self::unpacked(&parcel);
                drop(parcel);
                run(link, &ranks, None, &|item, context| match &problems {
                    Ok(problems) => problems.item_on(item, options, context),
                    Err(e) => Err(e.to_string()),
                })?;
            }
            return Ok(None);
        }
        let begun = problems().and_then(|problems| {
            let begun = OpenResults::new(&problems, out, options)?;
            // One rank needs to send nothing.
            let parcel =
                if link.ranks() == 1 || begun.is_complete() { Vec::new() } else { problems.packed()? };
            // The same for all, also where files change meanwhile.
            let problems = if parcel.is_empty() { problems } else { Self::unpacked(&parcel)? };
            Ok((problems, begun, parcel))
        });
        let (problems, begun, parcel) = match begun {
            Ok(begun) => begun,
            Err(e) => return broadcast(link, Vec::new()).and(Err(e)),
        };
        broadcast(link, parcel)?;
        begun.run(&problems, link, options, &ranks, progress).map(Some)
    }

    /// What a rank sends for an item.
    fn item_on(&self, item: u64, options: &ManyOptions, context: &ItemContext) -> Result<Vec<u8>, String> {
        match self.planned(item, options, &context.cancel) {
            Some(planned) => planned.map(|planned| planned.to_bytes()).map_err(|e| e.to_string()),
            // Then this result counts for nothing.
            None => Err("interrupted".to_owned()),
        }
    }
}

struct OpenResults {
    log: Log,
    ahead: EarlyResults,
    now: ManyOutcome,
    _lock: Lock,
}

impl OpenResults {
    fn new(problems: &ListedProblems, out: &Path, options: &ManyOptions) -> Result<Self, Error> {
        let is_out = |file: &&PathBuf| FileId::of(file) == FileId::of(out);
        if let Some(input) = problems.inputs().iter().find(is_out) {
            let (out, input) = (out.display(), input.display());
            return Err(Error::new(format!("the results {out} would overwrite the input {input}"))
                .help("name another file"));
        }
        mp_store::make_folder(mp_store::folder_of(out))?;
        let lock = Lock::of_file(out)?;
        let header = problems.header(options);
        let log = Log::open(out, &header)?;
        let job = serde_json::to_string(&header)
            .map_err(|e| Error::new(format!("the header cannot be written as JSON: {e}")))?;
        let ahead = EarlyResults::open(out, job, options.shard, log.tally.items)?;
        let now = ManyOutcome { items: options.shard.count(header.items), before: 0, tally: log.tally };
        let mut begun = Self { log, ahead, now, _lock: lock };
        begun.write_ready()?;
        begun.now.tally = begun.log.tally;
        begun.ahead.ready.values().for_each(|ready| begun.now.tally += ready.tally);
        begun.now.before = begun.now.tally.items;
        begun.end()?;
        Ok(begun)
    }

    fn is_complete(&self) -> bool {
        self.log.tally.items == self.now.items
    }

    fn run(
        mut self,
        problems: &ListedProblems,
        link: &dyn Link,
        options: &ManyOptions,
        ranks: &Options,
        mut progress: impl FnMut(&ManyOutcome),
    ) -> Result<RanksOutcome, Error> {
        let mut shares = Shares::new(link.ranks());
        progress(&self.now);
        if !self.is_complete() {
            let threads = (options.threads.max(1) * link.ranks()) as u64;
            let block = AHEAD.saturating_mul(threads).max(AHEAD_AT_LEAST);
            let (written, left) = (self.log.tally.items, self.now.items - self.now.before);
            let order = Order::new(&problems.list, options.shard, written, left, block);
            let mut job = ListJob {
                begun: &mut self,
                order,
                shares: &mut shares,
                progress: &mut progress,
                failed: None,
            };
            let ran =
                run(link, ranks, Some(&mut job), &|item, context| problems.item_on(item, options, context));
            if let Some(failed) = job.failed.take() {
                return Err(failed);
            }
            ran?;
            self.end()?;
        }
        Ok(RanksOutcome { outcome: self.now, shares })
    }

    /// Writes the results whose place has come.
    fn write_ready(&mut self) -> Result<(), Error> {
        while let Some(ready) = self.ahead.ready.remove(&self.log.tally.items) {
            self.log.append(&ready.line, ready.tally)?;
        }
        Ok(())
    }

    /// Ends the results, if there are all.
    fn end(&mut self) -> Result<(), Error> {
        if !self.is_complete() {
            return Ok(());
        }
        if !self.log.is_ended {
            self.log.end()?;
        }
        self.ahead.delete()
    }
}

/// The items of a list, as the master hands them out.
struct ListJob<'j, 'l> {
    begun: &'j mut OpenResults,
    order: Order<'l>,
    shares: &'j mut Shares,
    progress: &'j mut dyn FnMut(&ManyOutcome),
    failed: Option<Error>,
}

impl ListJob<'_, '_> {
    fn took(&mut self, item: u64, rank: usize, result: &[u8]) -> Result<(), Error> {
        let damaged = || Error::new("the result did not arrive whole");
        let planned = Planned::from_bytes(result).ok_or_else(damaged)?;
        let (begun, tally) = (&mut *self.begun, planned.tally);
        let place = begun.ahead.place(item);
        self.shares.add(rank, planned.checks as f64);
        self.order.learn(place, planned.seconds);
        if place == begun.log.tally.items {
            begun.log.append(&planned.line, planned.tally)?;
            begun.write_ready()?;
        } else {
            begun.ahead.keep(place, planned, result)?;
        }
        begun.now.tally += tally;
        (self.progress)(&begun.now);
        Ok(())
    }
}

impl Job for ListJob<'_, '_> {
    fn next(&mut self) -> Option<u64> {
        let begun = &self.begun;
        let written = begun.log.tally.items;
        // Results of an earlier job are written when their place comes.
        let known = |place| place < written || begun.ahead.ready.contains_key(&place);
        let place = self.order.next(written, known)?;
        Some(begun.ahead.shard.item(place))
    }
    fn left(&self) -> u64 {
        self.order.left()
    }
    fn take(&mut self, item: u64, rank: usize, result: Vec<u8>) -> Result<(), String> {
        self.took(item, rank, &result).map_err(|e| {
            let message = e.to_string();
            self.failed = Some(e);
            message
        })
    }
}

/// Results whose place in the file has not come, in memory and in a file beside it.
struct EarlyResults {
    file: PathBuf,
    job: String,
    shard: Shard,
    /// The file, if there is one.
    checkpoint: Option<Checkpoint>,
    /// How many results the file has, also those that have been written since.
    kept: usize,
    /// By their places in the shard.
    ready: BTreeMap<u64, Planned>,
}

impl EarlyResults {
    fn open(out: &Path, job: String, shard: Shard, written: u64) -> Result<Self, Error> {
        let mut file = out.as_os_str().to_owned();
        file.push(".ahead");
        let file = PathBuf::from(file);
        let mut ahead = Self { file, job, shard, checkpoint: None, kept: 0, ready: BTreeMap::new() };
        if ahead.file.exists() {
            let checkpoint = Checkpoint::open(&ahead.file, &ahead.job).map_err(ranks_error)?;
            let ready = checkpoint.known().iter().map(|(item, result)| {
                let damaged = || {
                    let message = format!("{}: the result of item {item} is damaged", ahead.file.display());
                    Error::new(message).help("delete the file: its items are done again")
                };
                Ok((ahead.place(*item), Planned::from_bytes(result).ok_or_else(damaged)?))
            });
            ahead.ready = ready.collect::<Result<_, Error>>()?;
            ahead.kept = ahead.ready.len();
            // What has been written since.
            ahead.ready = ahead.ready.split_off(&written);
            ahead.checkpoint = Some(checkpoint);
        }
        Ok(ahead)
    }

    /// The place of an item in the shard.
    fn place(&self, item: u64) -> u64 {
        item / u64::from(self.shard.of())
    }

    fn keep(&mut self, place: u64, planned: Planned, result: &[u8]) -> Result<(), Error> {
        // Most of the file may be of results that have found their place.
        if self.kept > 2 * self.ready.len() + AHEAD_AT_LEAST as usize {
            self.delete()?;
            let again: Vec<_> = self.ready.iter().map(|(place, ready)| (*place, ready.to_bytes())).collect();
            again.iter().try_for_each(|(place, result)| self.append(*place, result))?;
        }
        self.append(place, result)?;
        self.ready.insert(place, planned);
        Ok(())
    }

    fn append(&mut self, place: u64, result: &[u8]) -> Result<(), Error> {
        let checkpoint = match &mut self.checkpoint {
            Some(checkpoint) => checkpoint,
            none => none.insert(Checkpoint::open(&self.file, &self.job).map_err(ranks_error)?),
        };
        checkpoint.keep(self.shard.item(place), result).map_err(ranks_error)?;
        self.kept += 1;
        Ok(())
    }

    fn delete(&mut self) -> Result<(), Error> {
        self.kept = 0;
        self.checkpoint.take().map_or(Ok(()), Checkpoint::delete).map_err(ranks_error)
    }
}

impl Planned {
    /// As ranks send it: how it counts, how long it took, its checks, its line.
    fn to_bytes(&self) -> Vec<u8> {
        let Tally { solved, unsolved, timed, .. } = self.tally;
        let mut bytes = vec![(solved + 2 * unsolved + 4 * timed) as u8];
        bytes.extend(self.seconds.to_le_bytes());
        bytes.extend(self.checks.to_le_bytes());
        bytes.extend(self.line.as_bytes());
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (&[counts], rest) = bytes.split_first_chunk()?;
        let (seconds, rest) = rest.split_first_chunk()?;
        let (checks, line) = rest.split_first_chunk()?;
        let line = std::str::from_utf8(line).ok().filter(|line| line.ends_with('\n'))?.to_owned();
        let bit = |bit: u32| u64::from((counts >> bit) & 1);
        let (solved, unsolved, timed) = (bit(0), bit(1), bit(2));
        let tally = Tally { items: 1, solved, unsolved, failed: 1 - solved.max(unsolved), timed };
        Some(Self { line, tally, seconds: f64::from_le_bytes(*seconds), checks: u64::from_le_bytes(*checks) })
    }
}
