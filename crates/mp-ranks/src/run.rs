//! The master and the others.

use crate::link::MASTER;
use crate::{Error, Job, Link};
use mp_stop::Cancel;
use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread::Thread;
use std::time::Duration;

/// How often it is asked at least whether the job is cancelled.
const CANCEL: Duration = Duration::from_millis(5);
/// While there are at least this number of items for each thread, each rank has one more than it works on,
/// and never waits for the next.
const PLENTY: u64 = 8;

/// How a job is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// How many items each rank works on at a time. The same on all ranks.
    pub threads: usize,
    /// Ends the job, on whichever rank it is raised: no further item is handed out, and those that are worked
    /// on are dropped. On the ranks other than the master it is also raised when the job ends early.
    pub cancel: Cancel,
}

/// One item at a time.
impl Default for Options {
    fn default() -> Self {
        Self { threads: 1, cancel: Cancel::new() }
    }
}

/// What the work on an item knows of the whole.
#[derive(Debug)]
pub struct ItemContext {
    /// Raised when the result is not wanted any more.
    pub cancel: Cancel,
    bound: AtomicU64,
    least: AtomicU64,
    /// What was reported and not yet passed on.
    reports: Mutex<Vec<(u64, u64)>>,
    /// Passes it on.
    reader: Thread,
    /// Wakes those who wait for news.
    waiting: Mutex<()>,
    news: Condvar,
}

impl ItemContext {
    /// The [bound](Job::bound) of the job, as far as it is known here.
    #[must_use]
    pub fn bound(&self) -> u64 {
        self.bound.load(Ordering::Relaxed)
    }

    /// Reports how far the work on an item is, by a measure that all items of the job share. Of items that
    /// never report it is 0.
    pub fn reached(&self, item: u64, far: u64) {
        let mut reports = self.reports.lock().unwrap_or_else(PoisonError::into_inner);
        reports.retain(|(other, _)| *other != item);
        reports.push((item, far));
        drop(reports);
        self.reader.unpark();
    }

    /// How far the item is that is furthest behind of all that are worked on, as far as it is known here:
    /// news take some tenths of a millisecond between processes.
    #[must_use]
    pub fn least_reached(&self) -> u64 {
        self.least.load(Ordering::Relaxed)
    }

    /// Waits while `not_yet`, which is asked again when there are news of
    /// [`least_reached`](Self::least_reached) or [`bound`](Self::bound), and each `interval`.
    pub fn wait_while(&self, interval: Duration, mut not_yet: impl FnMut() -> bool) {
        let mut held = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        while not_yet() {
            let woken = self.news.wait_timeout(held, interval);
            held = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn tell_news(&self) {
        // Whoever has asked before the news waits by now.
        drop(self.waiting.lock().unwrap_or_else(PoisonError::into_inner));
        self.news.notify_all();
    }
}

/// How a job ended, on the master; elsewhere there are no numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JobEnd {
    /// Whether it was cancelled. Then some items have no result.
    pub cancelled: bool,
    /// How many items each rank has done.
    pub items: Vec<u64>,
}

/// What messages say, by their first byte.
mod kind {
    /// To a rank: work on this item.
    pub(super) const WORK: u8 = b'w';
    /// To a rank: the bound has fallen.
    pub(super) const BOUND: u8 = b'b';
    /// To a rank: how far the item is that is furthest behind.
    pub(super) const LEAST: u8 = b'l';
    /// To a rank: drop everything.
    pub(super) const STOP: u8 = b's';
    /// To a rank: everything is done.
    pub(super) const END: u8 = b'e';
    /// To the master: the result of an item.
    pub(super) const DONE: u8 = b'd';
    /// To the master: how far an item is.
    pub(super) const REACHED: u8 = b'r';
    /// To the master: an item cannot be done.
    pub(super) const FAILED: u8 = b'f';
    /// To the master: an item was dropped, as this rank was cancelled.
    pub(super) const DROPPED: u8 = b'x';
    /// To the master: nothing is worked on any more.
    pub(super) const IDLE: u8 = b'i';
    /// To a rank: what all must know.
    pub(super) const SHARED: u8 = b'a';
}

fn message(kind: u8, number: u64, rest: &[u8]) -> Vec<u8> {
    let mut message = Vec::with_capacity(9 + rest.len());
    message.push(kind);
    message.extend(number.to_le_bytes());
    message.extend(rest);
    message
}

/// The kind, the number and the rest of a message.
fn parts(from: usize, message: &[u8]) -> Result<(u8, u64, &[u8]), Error> {
    let split = message.split_first_chunk::<9>();
    let Some(([kind, number @ ..], rest)) = split else { return Err(Error::OutOfStep { rank: from }) };
    Ok((*kind, u64::from_le_bytes(*number), rest))
}

/// Does an item: its result, or why there is none. The result must depend on the item alone.
pub type Work<'a> = dyn Fn(u64, &ItemContext) -> Result<Vec<u8>, String> + Sync + 'a;

/// What became of an item.
enum Outcome {
    Done(Vec<u8>),
    Failed(String),
    /// It was cancelled before its end.
    Dropped,
}

/// Threads that work on items.
struct Workers<'s> {
    queue: Sender<u64>,
    results: Receiver<(u64, Outcome)>,
    context: &'s ItemContext,
    /// How many items were given and have not come back.
    busy: usize,
}

impl Workers<'_> {
    fn give(&mut self, item: u64) {
        // The threads live as long as this value.
        let _ = self.queue.send(item);
        self.busy += 1;
    }

    /// A result, if there is one.
    fn result(&mut self) -> Option<(u64, Outcome)> {
        let done = self.results.try_recv().ok()?;
        self.busy -= 1;
        Some(done)
    }

    /// Drops all work.
    fn stop(&mut self) {
        self.context.cancel.cancel();
        self.context.tell_news();
        while self.busy > 0 && self.results.recv().is_ok() {
            self.busy -= 1;
        }
    }

    fn lower(&self, bound: u64) {
        self.context.bound.fetch_min(bound, Ordering::Relaxed);
        self.context.tell_news();
    }

    /// The item that is furthest behind is so far.
    fn set_least(&self, far: u64) {
        self.context.least.store(far, Ordering::Relaxed);
        self.context.tell_news();
    }

    /// What was reported since the last time.
    fn reports(&self) -> Vec<(u64, u64)> {
        std::mem::take(&mut self.context.reports.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Calls `with` with the workers: as many threads as the options say, which do `work`.
fn with_workers<T>(options: &Options, work: &Work<'_>, with: impl FnOnce(Workers<'_>) -> T) -> T {
    let context = ItemContext {
        cancel: options.cancel.clone(),
        bound: AtomicU64::new(u64::MAX),
        least: AtomicU64::new(0),
        reports: Mutex::default(),
        reader: std::thread::current(),
        waiting: Mutex::default(),
        news: Condvar::new(),
    };
    let (queue, items) = channel::<u64>();
    let (sender, results) = channel();
    let items = Mutex::new(items);
    std::thread::scope(|scope| {
        for _ in 0..options.threads.max(1) {
            let (items, sender, context) = (&items, sender.clone(), &context);
            scope.spawn(move || {
                loop {
                    let item = items.lock().unwrap_or_else(PoisonError::into_inner).recv();
                    let Ok(item) = item else { return };
                    if sender.send((item, outcome(item, context, work))).is_err() {
                        return;
                    }
                    context.reader.unpark();
                }
            });
        }
        drop(sender);
        with(Workers { queue, results, context: &context, busy: 0 })
    })
}

/// Works on an item. What was made under a cancel may be less than the whole, so it is dropped.
fn outcome(item: u64, context: &ItemContext, work: &Work<'_>) -> Outcome {
    if context.cancel.is_raised() {
        return Outcome::Dropped;
    }
    match std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(item, context))) {
        Err(panic) => Outcome::Failed(said(&*panic)),
        Ok(_) if context.cancel.is_raised() => Outcome::Dropped,
        Ok(Ok(result)) => Outcome::Done(result),
        Ok(Err(message)) => Outcome::Failed(message),
    }
}

fn said(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
    format!("a fault of the program: {}", text.unwrap_or("no message"))
}

/// Does a job on all ranks: each of them calls this, the master with the job.
///
/// # Errors
/// When an item fails, a result cannot be taken, or a rank cannot be reached. All ranks end then, the others
/// without an error.
pub fn run(
    link: &dyn Link,
    options: &Options,
    job: Option<&mut dyn Job>,
    work: &Work<'_>,
) -> Result<JobEnd, Error> {
    with_workers(options, work, |workers| match job {
        Some(job) if link.is_master() => {
            let mut master = Master::new(link, options, job, workers);
            let ran = master.hand_out();
            master.end(ran)
        }
        _ => other(link, workers).map(|()| JobEnd::default()),
    })
}

struct Master<'a, 'c> {
    link: &'a dyn Link,
    options: &'a Options,
    job: &'a mut dyn Job,
    workers: Workers<'c>,
    /// How many items each rank has that are not done.
    busy: Vec<usize>,
    done: Vec<u64>,
    bound: u64,
    /// How far each item is that is worked on, whether any ever said so, and the least that the ranks know
    /// of.
    reached: HashMap<u64, u64>,
    reported: bool,
    least: u64,
    /// Whether an item was dropped.
    dropped: bool,
}

impl<'a, 'c> Master<'a, 'c> {
    fn new(link: &'a dyn Link, options: &'a Options, job: &'a mut dyn Job, workers: Workers<'c>) -> Self {
        let ranks = link.ranks();
        let (busy, done) = (vec![0; ranks], vec![0; ranks]);
        let reached = HashMap::new();
        let (bound, reported, least, dropped) = (u64::MAX, false, 0, false);
        Self { link, options, job, workers, busy, done, bound, reached, reported, least, dropped }
    }

    /// Hands out items until there are none. False when it was cancelled.
    fn hand_out(&mut self) -> Result<bool, Error> {
        loop {
            if self.dropped || self.options.cancel.is_raised() {
                return Ok(false);
            }
            self.fill()?;
            self.tell_least()?;
            if self.busy.iter().all(|busy| *busy == 0) {
                return Ok(true);
            }
            let mut news = false;
            while let Some((from, message)) = self.link.poll()? {
                self.received(from, &message)?;
                news = true;
            }
            while let Some((item, result)) = self.workers.result() {
                self.took(item, MASTER, result)?;
                news = true;
            }
            for (item, far) in self.workers.reports() {
                self.is_at(item, far);
                news = true;
            }
            if !news {
                self.link.wait(CANCEL);
            }
        }
    }

    /// An item that is worked on is so far.
    fn is_at(&mut self, item: u64, far: u64) {
        // A report may come behind its result.
        if let Some(reached) = self.reached.get_mut(&item) {
            *reached = far;
            self.reported = true;
        }
    }

    /// Tells all how far the item is that is furthest behind, when that has changed.
    fn tell_least(&mut self) -> Result<(), Error> {
        let least = if self.reported { self.reached.values().min().copied().unwrap_or(0) } else { 0 };
        if least != self.least {
            self.least = least;
            self.workers.set_least(least);
            self.to_others(kind::LEAST, least)?;
        }
        Ok(())
    }

    /// Gives each rank as many items as it works on at a time, in turn, and while there are plenty one more.
    fn fill(&mut self) -> Result<(), Error> {
        let threads = self.options.threads.max(1);
        let plenty = PLENTY * (threads * self.link.ranks()) as u64;
        for wanted in 1..=threads + 1 {
            for rank in 0..self.busy.len() {
                let more = wanted <= threads || self.job.left() > plenty;
                if self.busy[rank] >= wanted || !more {
                    continue;
                }
                let Some(item) = self.job.next() else { return Ok(()) };
                self.busy[rank] += 1;
                self.reached.insert(item, 0);
                match rank {
                    MASTER => self.workers.give(item),
                    rank => self.link.send(rank, message(kind::WORK, item, &[]))?,
                }
            }
        }
        Ok(())
    }

    fn received(&mut self, from: usize, message: &[u8]) -> Result<(), Error> {
        let (kind, item, rest) = parts(from, message)?;
        match kind {
            kind::DONE => self.took(item, from, Outcome::Done(rest.to_vec())),
            kind::FAILED => {
                self.took(item, from, Outcome::Failed(String::from_utf8_lossy(rest).into_owned()))
            }
            kind::DROPPED => self.took(item, from, Outcome::Dropped),
            kind::REACHED => {
                let far = rest.try_into().map_err(|_| Error::OutOfStep { rank: from })?;
                self.is_at(item, u64::from_le_bytes(far));
                Ok(())
            }
            _ => Err(Error::OutOfStep { rank: from }),
        }
    }

    fn took(&mut self, item: u64, rank: usize, result: Outcome) -> Result<(), Error> {
        let failed = |message| Error::Item { item, rank, message };
        self.busy[rank] = self.busy[rank].checked_sub(1).ok_or(Error::OutOfStep { rank })?;
        self.reached.remove(&item);
        match result {
            Outcome::Done(result) => self.job.take(item, rank, result).map_err(failed)?,
            Outcome::Failed(message) => return Err(failed(message)),
            Outcome::Dropped => {
                self.dropped = true;
                return Ok(());
            }
        }
        self.done[rank] += 1;
        let bound = self.job.bound();
        if bound < self.bound {
            self.bound = bound;
            self.workers.lower(bound);
            self.to_others(kind::BOUND, bound)?;
        }
        Ok(())
    }

    fn to_others(&self, kind: u8, number: u64) -> Result<(), Error> {
        (1..self.link.ranks()).try_for_each(|rank| self.link.send(rank, message(kind, number, &[])))
    }

    /// Ends the job on all ranks, and waits until none of them works any more.
    fn end(mut self, ran: Result<bool, Error>) -> Result<JobEnd, Error> {
        if let Err(e @ Error::Link(_)) = ran {
            self.workers.stop();
            return Err(e);
        }
        let complete = matches!(ran, Ok(true));
        self.to_others(if complete { kind::END } else { kind::STOP }, 0)?;
        if !complete {
            self.workers.stop();
        }
        let mut idle = 1;
        while idle < self.link.ranks() {
            match self.link.poll()? {
                // Results that nobody wants any more come before.
                Some((from, message)) => idle += usize::from(parts(from, &message)?.0 == kind::IDLE),
                None => self.link.wait(CANCEL),
            }
        }
        Ok(JobEnd { cancelled: !ran?, items: self.done })
    }
}

/// Works on what the master says.
fn other(link: &dyn Link, mut workers: Workers<'_>) -> Result<(), Error> {
    let send = |item, result: Outcome| match result {
        Outcome::Done(result) => link.send(MASTER, message(kind::DONE, item, &result)),
        Outcome::Failed(text) => link.send(MASTER, message(kind::FAILED, item, text.as_bytes())),
        Outcome::Dropped => link.send(MASTER, message(kind::DROPPED, item, &[])),
    };
    loop {
        let mut news = false;
        while let Some((from, received)) = link.poll()? {
            news = true;
            match parts(from, &received)? {
                (kind::WORK, item, _) => workers.give(item),
                (kind::BOUND, bound, _) => workers.lower(bound),
                (kind::LEAST, far, _) => workers.set_least(far),
                (ended @ (kind::STOP | kind::END), ..) => {
                    if ended == kind::STOP {
                        workers.stop();
                    }
                    return link.send(MASTER, message(kind::IDLE, 0, &[]));
                }
                _ => return Err(Error::OutOfStep { rank: from }),
            }
        }
        while let Some((item, result)) = workers.result() {
            send(item, result)?;
            news = true;
        }
        for (item, far) in workers.reports() {
            link.send(MASTER, message(kind::REACHED, item, &far.to_le_bytes()))?;
            news = true;
        }
        if !news {
            link.wait(CANCEL);
        }
    }
}

/// What the master has, on all ranks: each of them calls this. The others' `bytes` are dropped.
///
/// # Errors
/// When a rank cannot be reached, or is at another call.
pub fn broadcast(link: &dyn Link, bytes: Vec<u8>) -> Result<Vec<u8>, Error> {
    if link.is_master() {
        let all = message(kind::SHARED, 0, &bytes);
        (1..link.ranks()).try_for_each(|rank| link.send(rank, all.clone()))?;
        return Ok(bytes);
    }
    loop {
        match link.poll()? {
            Some((from, message)) => {
                return match parts(from, &message)? {
                    (kind::SHARED, _, rest) => Ok(rest.to_vec()),
                    _ => Err(Error::OutOfStep { rank: from }),
                };
            }
            None => link.wait(CANCEL),
        }
    }
}
