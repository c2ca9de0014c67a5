//! Experiments on several ranks: each comes to the same calls, the master keeps the log, and all learn what was measured.

use super::log::{CaseKey, Log, RunRecord};
use crate::error::{IntoError, Result};
use mp_ranks::{Hand, Items, Link, Options, broadcast, run};
use std::cell::RefCell;
use std::rc::Rc;

thread_local! {
    static LINK: RefCell<Option<Rc<dyn Link>>> = const { RefCell::new(None) };
}

/// The link to the other ranks of the thread that measures, if there are any.
pub(crate) fn link() -> Option<Rc<dyn Link>> {
    LINK.with_borrow(Clone::clone)
}

/// Does `job` with this link.
pub(crate) fn with<T>(link: Rc<dyn Link>, job: impl FnOnce() -> T) -> T {
    LINK.set(Some(link));
    let result = job();
    LINK.set(None);
    result
}

/// Tells all ranks what is known; the master calls it.
pub(crate) fn shared<K: CaseKey, R: RunRecord>(link: &dyn Link, runs: &[(&K, &R)]) -> Result<()> {
    broadcast(link, serde_json::to_vec(runs).into_error()?).map(drop).into_error()
}

/// What the master [tells](shared); the others call it.
pub(crate) fn learned<K: CaseKey, R: RunRecord>(link: &dyn Link) -> Result<Vec<(K, R)>> {
    serde_json::from_slice(&broadcast(link, Vec::new()).into_error()?).into_error()
}

/// Runs groups of cases, each on some rank, and appends them to the log of the master. Returns all runs, on all ranks; none when it was
/// cancelled.
pub(crate) fn measured<K: CaseKey, R: RunRecord>(
    link: &dyn Link,
    options: &Options,
    log: &Log<K, R>,
    groups: &[Vec<K>],
    group: impl Fn(&Vec<K>) -> Result<Vec<(K, R)>> + Sync,
) -> Result<Vec<(K, R)>> {
    let work = |item: u64, hand: &Hand| {
        let runs = group(&groups[item as usize]).map_err(|e| e.to_string())?;
        match hand.cancel.is_raised() {
            true => Err("interrupted".to_owned()),
            false => serde_json::to_vec(&runs).map_err(|e| e.to_string()),
        }
    };
    if !link.is_master() {
        run(link, options, None, &work).into_error()?;
        return if options.cancel.is_raised() { Ok(Vec::new()) } else { learned(link) };
    }
    let mut all: Vec<(K, R)> = Vec::new();
    let take = |_, _, result: Vec<u8>| {
        let runs: Vec<(K, R)> = serde_json::from_slice(&result).map_err(|e| e.to_string())?;
        runs.iter().try_for_each(|(case, run)| log.write(case, run)).map_err(|e| e.to_string())?;
        all.extend(runs);
        Ok(())
    };
    let ran = run(link, options, Some(&mut Items::new(0..groups.len() as u64, take)), &work).into_error()?;
    if !ran.cancelled {
        shared(link, &all.iter().map(|(case, run)| (case, run)).collect::<Vec<_>>())?;
    }
    Ok(all)
}
