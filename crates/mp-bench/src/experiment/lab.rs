//! Running the cases of experiments, and writing their results.

use super::log::{self, Appender, CaseKey, Log, OnFinished, RunRecord};
use super::provenance;
use super::ranks;
use super::table::Table;
use crate::error::{IntoError, Result};
use crate::options::Common;
use crate::output::{note, print};
use indicatif::{ProgressBar, ProgressStyle};
use mp_batch::Shard;
use mp_cspace::Cancel;
use mp_plan::{Error, write_file};
use mp_stop::signals;
use mp_store::Lock;
use rayon::prelude::*;
use serde_json::Value;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// The number of groups of cases for each thread of a rank that makes all threads end at about the same time.
const GROUPS: usize = 8;

/// How often ranks tell how far they are.
const TELL: Duration = Duration::from_secs(10);

/// Runs experiments: the folder for results, the threads, and cancellation.
#[derive(Debug)]
pub(crate) struct Lab {
    options: Common,
    pool: rayon::ThreadPool,
    /// Whether the first of several ranks measures, or there is one alone. Others write nothing.
    is_master: bool,
    /// Two processes that measure into one folder would overwrite each other's results.
    _lock: Option<Lock>,
    /// Cancels all runs; finished ones are kept.
    pub(crate) cancel: Cancel,
}

impl Lab {
    /// A lab with as many runs at once as the options say: on each rank, if there are several. Ctrl-C cancels
    /// them.
    pub(crate) fn new(options: &Common) -> Result<Self> {
        let threads = options.threads.map_or_else(|| usize::from(ranks::link().is_some()), usize::from);
        let is_master = ranks::link().is_none_or(|link| link.is_master());
        Self::with(options, threads, is_master, interrupt())
    }

    /// A lab with one run at a time, for measurements of time that other runs would disturb.
    pub(crate) fn one_at_a_time(options: &Common) -> Result<Self> {
        if options.shard != Shard::WHOLE || !options.merge.is_empty() || ranks::link().is_some() {
            let message =
                "this suite measures the time of one run at a time, and cannot be spread over machines";
            return Err(
                Error::new(message).help("leave out --shard and --merge; of one rank, run mp-bench itself")
            );
        }
        Self::with(options, 1, true, interrupt())
    }

    fn with(options: &Common, threads: usize, is_master: bool, cancel: Cancel) -> Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().into_error()?;
        let lock = || {
            mp_store::make_folder(&options.out)?;
            Lock::of_folder(&options.out)
        };
        let _lock = is_master.then(lock).transpose()?;
        Ok(Self { options: options.clone(), pool, is_master, _lock, cancel })
    }

    /// A lab for tests, without Ctrl-C.
    #[cfg(test)]
    pub(crate) fn test(out: &std::path::Path, threads: usize) -> Self {
        let threads = u16::try_from(threads).unwrap();
        let options = Common { quick: true, threads: Some(threads), out: out.to_owned(), ..Common::test() };
        Self::with(&options, threads.into(), true, Cancel::new()).unwrap()
    }

    /// The name of an experiment in files; a short run has its own.
    pub(crate) fn name(&self, name: &str) -> String {
        if self.options.quick { format!("{name}-quick") } else { name.to_owned() }
    }

    /// The path of a file in the folder for results.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.options.out.join(name)
    }

    /// The log of the experiment called `name`, whose runs have the limit `cap`.
    pub(crate) fn log<K: CaseKey, R: RunRecord>(&self, name: &str, cap: f64) -> Result<Log<K, R>> {
        let file = self.file(&format!("{name}-runs.jsonl"));
        match ranks::link() {
            None => Log::open(&file, cap, self.options.fresh),
            Some(link) if self.is_master => {
                let log = Log::open(&file, cap, self.options.fresh)?;
                ranks::share(&*link, &log.values()?)?;
                Ok(log)
            }
            Some(link) => {
                let mut log = Log::in_memory(cap);
                log.learn_values(ranks::learn(&*link)?)?;
                Ok(log)
            }
        }
    }

    fn interrupted(&self) -> bool {
        self.cancel.is_raised()
    }

    /// Whether all is measured here, not a shard.
    fn is_whole(&self) -> bool {
        self.options.shard == Shard::WHOLE
    }

    /// Does all jobs; returns their results in the same order. `None` when a job was interrupted or not
    /// started: `job` returns `None` when it is interrupted.
    pub(crate) fn all<J: Sync, R: Send + Sync>(
        &self,
        what: &str,
        jobs: &[J],
        job: impl Fn(&J) -> Result<Option<R>> + Sync,
    ) -> Result<Option<Vec<R>>> {
        let bar = bar(what, jobs.len(), 0);
        let results: Vec<OnceLock<R>> = jobs.iter().map(|_| OnceLock::new()).collect();
        let done = self.parallel(jobs.len(), &|i| {
            if let Some(result) = job(&jobs[i])? {
                let _ = results[i].set(result);
            }
            bar.inc(1);
            Ok(())
        });
        bar.finish_and_clear();
        done?;
        Ok(results.into_iter().map(OnceLock::into_inner).collect())
    }

    /// Runs the cases that are not in the log. False when it was interrupted; finished runs are kept.
    pub(crate) fn measure<K: CaseKey, R: RunRecord>(
        &self,
        log: &mut Log<K, R>,
        what: &str,
        cases: &[K],
        run: impl Fn(&K) -> Result<Option<R>> + Sync,
    ) -> Result<bool> {
        self.measure_in(log, what, cases, |_, _| false, |_| Ok(()), |(), case| run(case))
    }

    /// As [`measure`](Self::measure), for cases that share a costly setup: cases that are `together` are run
    /// in order, with one setup.
    pub(crate) fn measure_in<K: CaseKey, R: RunRecord, P>(
        &self,
        log: &mut Log<K, R>,
        what: &str,
        cases: &[K],
        together: impl Fn(&K, &K) -> bool,
        set_up: impl Fn(&K) -> Result<P> + Sync,
        run: impl Fn(&P, &K) -> Result<Option<R>> + Sync,
    ) -> Result<bool> {
        let mut ends = 0;
        let groups = cases.chunk_by(&together).map(|group| {
            ends += group.len();
            ends - group.len()..ends
        });
        let groups: Vec<_> = groups.collect();
        let missing: Vec<bool> = cases.iter().map(|case| log.get(case).is_none()).collect();
        let group = |group: &[usize], done: &OnFinished<'_>| -> Result<()> {
            let setup = set_up(&cases[group[0]])?;
            for &i in group {
                if self.interrupted() {
                    break;
                }
                let Some(run) = run(&setup, &cases[i])? else { break };
                done(i, log::value(&run)?)?;
            }
            Ok(())
        };
        let case = |i: usize| log::value(&cases[i]);
        let runs = self.run_groups(&log.appender(), what, &groups, &missing, &case, &group)?;
        for (i, run) in runs {
            log.learn([(cases[i].clone(), log::from_value(run)?)]);
        }
        if self.interrupted() {
            note("interrupted: the same command goes on from here");
        }
        // A shard is complete without being all.
        Ok(!self.interrupted() && self.is_whole())
    }

    /// Runs those cases of the groups that are missing, and appends them to the log. `group` runs some cases of a
    /// group in order.
    ///
    /// Cases are numbers here, and runs are JSON: so it is compiled once for all experiments.
    fn run_groups(
        &self,
        log: &Appender<'_>,
        what: &str,
        groups: &[Range<usize>],
        missing: &[bool],
        case: &(dyn Fn(usize) -> Result<Value> + Sync),
        group: &(dyn Fn(&[usize], &OnFinished<'_>) -> Result<()> + Sync),
    ) -> Result<Vec<(usize, Value)>> {
        let mine =
            || (0..).zip(groups).filter(|(nth, _)| self.options.shard.has(*nth)).map(|(_, group)| group);
        let count: usize = mine().map(ExactSizeIterator::len).sum();
        let open = mine().map(|group| group.clone().filter(|i| missing[*i]).collect());
        let mut open: Vec<Vec<usize>> = open.filter(|group: &Vec<usize>| !group.is_empty()).collect();
        let known = count - open.iter().map(Vec::len).sum::<usize>();
        if known > 0 {
            note(&format!("{what}: {known} of {count} runs are known already; --fresh measures anew"));
        }
        let bar = bar(what, count, known);
        let runs = match ranks::link() {
            Some(link) => {
                let options = mp_ranks::Options {
                    threads: self.pool.current_num_threads(),
                    cancel: self.cancel.clone(),
                };
                // Few groups are cut, each into no more pieces than there are threads, as each piece has a
                // setup of its own.
                let workers = link.ranks() * options.threads;
                let pieces = (GROUPS * workers).div_ceil(open.len().max(1)).min(workers);
                let cut = |group: &Vec<usize>| -> Vec<Vec<usize>> {
                    group.chunks(group.len().div_ceil(pieces)).map(<[usize]>::to_vec).collect()
                };
                open = open.iter().flat_map(cut).collect();
                let mut told = Instant::now();
                let took = |runs: &[(usize, Value)]| {
                    runs.iter().try_for_each(|(i, run)| log.append(case(*i)?, run.clone()))?;
                    bar.inc(runs.len() as u64);
                    // Ranks have no terminal.
                    if bar.is_hidden() && told.elapsed() >= TELL {
                        told = Instant::now();
                        note(&format!("{what}: {} of {count} runs", bar.position()));
                    }
                    Ok(())
                };
                ranks::measured(&*link, &options, &open, group, took)
            }
            None => {
                let runs = Mutex::new(Vec::new());
                let done = |i: usize, run: Value| {
                    bar.inc(1);
                    log.append(case(i)?, run.clone())?;
                    runs.lock().unwrap_or_else(PoisonError::into_inner).push((i, run));
                    Ok(())
                };
                self.parallel(open.len(), &|nth| group(&open[nth], &done))
                    .map(|()| runs.into_inner().unwrap_or_else(PoisonError::into_inner))
            }
        };
        bar.finish_and_clear();
        runs
    }

    /// Does jobs in parallel, by their numbers; none is started after an interruption.
    fn parallel(&self, jobs: usize, job: &(dyn Fn(usize) -> Result<()> + Sync)) -> Result<()> {
        let one = |i: usize| if self.interrupted() { Ok(()) } else { job(i) };
        self.pool.install(|| (0..jobs).into_par_iter().with_max_len(1).try_for_each(one))
    }

    /// Writes a file in the folder for results.
    pub(crate) fn write(&self, name: &str, text: &str) -> Result<()> {
        match self.is_master && self.is_whole() {
            true => write_file(&self.file(name), text.as_bytes()),
            false => Ok(()),
        }
    }

    /// Writes charts, with the name of the experiment before their own.
    pub(crate) fn charts(&self, name: &str, charts: Vec<(String, Result<String>)>) -> Result<()> {
        charts.into_iter().try_for_each(|(file, chart)| self.write(&format!("{name}-{file}.svg"), &chart?))
    }

    /// Prints `text`, and writes it as Markdown.
    pub(crate) fn text(&self, name: &str, text: &str) -> Result<()> {
        let text = text.trim_end();
        if self.is_whole() {
            print(text)?;
        }
        self.write(&format!("{name}.md"), &format!("{text}\n"))
    }

    /// Prints `text` and writes it, with `each` as comma-separated values.
    pub(crate) fn report(&self, name: &str, text: &str, each: &Table) -> Result<()> {
        let made_by = provenance::lines(each).into_iter();
        let made_by: Vec<String> = made_by.map(|(name, said)| format!("{name} `{said}`")).collect();
        match made_by.is_empty() {
            true => self.text(name, text)?,
            false => self.text(name, &format!("{}\n\nMeasured: {}.", text.trim_end(), made_by.join(", ")))?,
        }
        let csv = self.csv(name, each)?;
        if self.is_whole() {
            let file = |name: &str| self.file(name).display().to_string();
            note(&format!("written: {}, {}", file(&format!("{name}.md")), file(&csv)));
        }
        Ok(())
    }

    /// Writes comma-separated values, with what made them in the head. Returns the file's name.
    pub(crate) fn csv(&self, name: &str, each: &Table) -> Result<String> {
        let file = format!("{name}.csv");
        self.write(&file, &each.csv_file())?;
        Ok(file)
    }
}

/// A progress bar of finished runs, shown only on a terminal.
fn bar(what: &str, total: usize, known: usize) -> ProgressBar {
    let bar = ProgressBar::new(total as u64).with_position(known as u64).with_message(what.to_owned());
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} runs, {elapsed} {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Whether Ctrl-C was pressed, or the work of all ranks was cancelled.
pub(crate) fn interrupted() -> bool {
    interrupt().is_raised()
}

/// A flag that is set by the first Ctrl-C or SIGTERM. The next one ends the program at once. Among other ranks, that
/// of who began the measurement.
fn interrupt() -> Cancel {
    if let Some(cancel) = ranks::cancel() {
        return cancel;
    }
    static RAISED: OnceLock<Cancel> = OnceLock::new();
    let raised = RAISED.get_or_init(|| {
        let raised = Cancel::new();
        let shared = raised.clone();
        if let Err(e) = signals::on_first(signals::BY_HAND, move || shared.cancel()) {
            tracing::warn!("Ctrl-C will end the program at once: {e}");
        }
        raised
    });
    raised.clone()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;

    #[test]
    fn nothing_is_run_twice_and_places_are_made_once() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Lab::test(folder.path(), 2);
        let cases: Vec<(u32, u32)> = (0..3).flat_map(|a| (0..4).map(move |b| (a, b))).collect();
        let made = std::sync::atomic::AtomicUsize::new(0);
        let measure = |lab: &Lab, fails: u32| {
            let mut log: Log<(u32, u32), f64> = lab.log("x", 1.0).unwrap();
            let complete = lab.measure_in(
                &mut log,
                "x",
                &cases,
                |a, b| a.0 == b.0,
                |case| {
                    made.fetch_add(1, Ordering::Relaxed);
                    Ok(case.0)
                },
                |place, case| {
                    assert_eq!(*place, case.0);
                    if case.1 == fails {
                        lab.cancel.cancel();
                        return Ok(None);
                    }
                    Ok(Some(f64::from(10 * case.0 + case.1)))
                },
            );
            (complete.unwrap(), log.all().len())
        };
        let (complete, known) = measure(&lab, 2);
        assert!(!complete && (2..=4).contains(&known), "{known}");
        drop(lab);
        let lab = Lab::test(folder.path(), 2);
        assert_eq!(measure(&lab, 9), (true, 12));
        let before = made.load(Ordering::Relaxed);
        assert_eq!(measure(&lab, 0), (true, 12));
        assert_eq!(made.load(Ordering::Relaxed), before);
    }

    #[test]
    fn results_are_in_order_and_an_interrupted_whole_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let lab = Lab::test(folder.path(), 3);
        let jobs: Vec<u32> = (0..50).collect();
        assert_eq!(lab.all("x", &jobs, |i| Ok(Some(2 * i))).unwrap().unwrap()[49], 98);
        assert!(lab.all("x", &jobs, |i| Ok((*i != 7).then_some(()))).unwrap().is_none());
        assert!(lab.all("x", &jobs, |_| -> Result<Option<()>> { Err(mp_plan::Error::new("no")) }).is_err());
    }
}
