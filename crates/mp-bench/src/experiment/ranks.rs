//! Experiments on several ranks: each comes to the same calls, the master keeps the log, and all learn what
//! was measured.

use super::log::OnFinished;
use crate::clock;
use crate::error::{IntoError, Result};
use mp_cspace::Cancel;
use mp_ranks::{ItemContext, Items, Link, Options, Shares, broadcast, run};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::{Mutex, PoisonError};

/// What a thread that measures has to do with other ranks.
struct RankContext {
    link: Rc<dyn Link>,
    cancel: Cancel,
    /// What each rank did so far; on the master.
    shares: Shares,
}

thread_local! {
    static CONTEXT: RefCell<Option<RankContext>> = const { RefCell::new(None) };
}

/// The link to the other ranks of the thread that measures, if there are any.
pub(crate) fn link() -> Option<Rc<dyn Link>> {
    CONTEXT.with_borrow(|context| context.as_ref().map(|context| context.link.clone()))
}

/// What ends the work of the thread that measures, if there are other ranks.
pub(crate) fn cancel() -> Option<Cancel> {
    CONTEXT.with_borrow(|context| context.as_ref().map(|context| context.cancel.clone()))
}

/// Does `job` with this link, until `cancel` is raised. Also returns what each rank did.
pub(crate) fn with<T>(link: Rc<dyn Link>, cancel: Cancel, job: impl FnOnce() -> T) -> (T, Shares) {
    let shares = Shares::new(link.ranks());
    CONTEXT.set(Some(RankContext { link, cancel, shares }));
    let result = job();
    (result, CONTEXT.take().map(|context| context.shares).unwrap_or_default())
}

/// Tells all ranks what is known; the master calls it.
pub(crate) fn share<T: Serialize>(link: &dyn Link, known: &T) -> Result<()> {
    broadcast(link, serde_json::to_vec(known).into_error()?).map(drop).into_error()
}

/// What the master [tells](share); the others call it.
pub(crate) fn learn<T: DeserializeOwned>(link: &dyn Link) -> Result<T> {
    serde_json::from_slice(&broadcast(link, Vec::new()).into_error()?).into_error()
}

/// Runs groups of cases, each on some rank. `took` learns the runs of each group, on the master. Returns all
/// runs with the numbers of their cases, on all ranks; none when it was cancelled.
pub(crate) fn measured(
    link: &dyn Link,
    options: &Options,
    groups: &[Vec<usize>],
    group: &(dyn Fn(&[usize], &OnFinished<'_>) -> Result<()> + Sync),
    mut took: impl FnMut(&[(usize, Value)]) -> Result<()>,
) -> Result<Vec<(usize, Value)>> {
    let work = |item: u64, context: &ItemContext| {
        let began = clock::nanoseconds();
        let runs = Mutex::new(Vec::new());
        let done = |i: usize, run: Value| {
            runs.lock().unwrap_or_else(PoisonError::into_inner).push((i, run));
            Ok(())
        };
        group(&groups[item as usize], &done).map_err(|e| e.to_string())?;
        match context.cancel.is_raised() {
            true => Err("interrupted".to_owned()),
            false => serde_json::to_vec(&(clock::seconds_since(began), runs)).map_err(|e| e.to_string()),
        }
    };
    if !link.is_master() {
        run(link, options, None, &work).into_error()?;
        return if options.cancel.is_raised() { Ok(Vec::new()) } else { learn(link) };
    }
    let mut all: Vec<(usize, Value)> = Vec::new();
    let take = |_, rank, result: Vec<u8>| {
        let (work, runs): (f64, Vec<(usize, Value)>) =
            serde_json::from_slice(&result).map_err(|e| e.to_string())?;
        CONTEXT.with_borrow_mut(|context| context.as_mut().map(|context| context.shares.add(rank, work)));
        took(&runs).map_err(|e| e.to_string())?;
        all.extend(runs);
        Ok(())
    };
    // What a run costs is not known before. A group of more runs probably takes longer.
    let runs = |item: u64| groups[item as usize].len() as f64;
    let mut job = Items::dearest_first(0..groups.len() as u64, runs, take);
    let ran = run(link, options, Some(&mut job), &work).into_error()?;
    if !ran.cancelled {
        share(link, &all)?;
    }
    Ok(all)
}
