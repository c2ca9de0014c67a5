//! A roadmap by regions, built by the ranks of a cluster.

use crate::job;
use crate::pieces::{Reader, Writer};
use crate::ranks::{broadcast, run};
use mp_cspace::Interrupt;
use mp_plan::{Error, RegionalWork, Request, Scene, SceneRoadmap};
use mp_ranks::{Checkpoint, ItemContext, Items, Job, Link, Options, Work};
use std::ops::Range;
use std::path::Path;

/// Opens a file, or begins it, that keeps results of [`Scene::regions`] with this request: [`build_regions`]
/// goes on with those in it.
///
/// # Errors
/// When the file is in use, damaged, of another scene or request, or cannot be read or written.
pub fn regions_checkpoint(scene: &Scene, request: &Request, file: &Path) -> Result<Checkpoint, Error> {
    let identity = job::identity(scene, &job::timeless(request))?;
    job::checkpoint(scene, "roadmap by regions", file, &identity)
}

/// Does all of the work on a roadmap by regions on the ranks of `link`, the dearest items first. All ranks
/// call this, with the same scene and request; the results of items are kept in the `checkpoint` of the
/// master, and those in it are not done again. The roadmap is the same for any number of ranks and threads.
/// `None` on all ranks but the master, and when the job was cancelled.
///
/// # Errors
/// On the master, when an item fails or a rank cannot be reached.
pub fn build_regions(
    work: &RegionalWork<'_>,
    link: &dyn Link,
    options: &Options,
    checkpoint: Option<&Checkpoint>,
) -> Result<Option<SceneRoadmap>, Error> {
    let (regions, items) = (work.regions(), work.items());
    let mut job = Phases { link, options, checkpoint, results: Vec::new() };
    // Whatever happens on the master, the others wait for its messages.
    let begun = if link.is_master() { job.begin(items) } else { Ok(()) };
    if !together(link, begun.is_ok())? {
        return begun.map(|()| None);
    }
    let estimated = job.estimate(work);
    if !link.is_master() && estimated.is_err() || !together(link, matches!(estimated, Ok(Some(_))))? {
        return estimated.map(|_| None);
    }
    let estimates = estimated?.unwrap_or_default();
    let build = |region: u64, context: &ItemContext| {
        work.build(region, &Interrupt::new(context.cancel.clone())).map_err(|e| e.to_string())
    };
    let complete = job.run(0..regions, &|region| estimates[region as usize], &build);
    if !link.is_master() && complete.is_err() {
        return complete.map(|_| None);
    }
    let all = broadcast(link, if let Ok(true) = complete { job.joined(regions) } else { Vec::new() })?;
    if !complete? || all.is_empty() {
        return Ok(None);
    }
    let built = split(&all)?;
    let of_pair = |item: u64| {
        let pair = work.pair(item).unwrap_or_default();
        pair.map(|region| built.get(region as usize).copied().unwrap_or_default())
    };
    let connect = |item: u64, context: &ItemContext| {
        let interrupt = Interrupt::new(context.cancel.clone());
        work.connect(item, of_pair(item), &interrupt).map_err(|e| e.to_string())
    };
    let estimate = |item: u64| RegionalWork::estimate_pair(of_pair(item));
    if !job.run(regions..items, &estimate, &connect)? || !link.is_master() {
        return Ok(None);
    }
    let results: Vec<Vec<u8>> = job.results.into_iter().flatten().collect();
    let (built, connected) = results.split_at(regions as usize);
    work.finish(built, connected).map(Some)
}

/// Whether the master says that all go on.
fn together(link: &dyn Link, go_on: bool) -> Result<bool, Error> {
    Ok(broadcast(link, vec![u8::from(go_on)])? == [1])
}

/// Items that are done in phases, one after the other.
struct Phases<'a> {
    link: &'a dyn Link,
    options: &'a Options,
    checkpoint: Option<&'a Checkpoint>,
    /// On the master, for each item.
    results: Vec<Option<Vec<u8>>>,
}

impl Phases<'_> {
    fn begin(&mut self, items: u64) -> Result<(), Error> {
        self.results = vec![None; items as usize];
        for (item, result) in self.checkpoint.iter().flat_map(|checkpoint| checkpoint.known()) {
            let Some(slot) = self.results.get_mut(*item as usize) else {
                let message = format!("the checkpoint has a result of item {item}, of {items}");
                return Err(Error::new(message).help("delete it: it belongs to another roadmap"));
            };
            *slot = Some(result.clone());
        }
        Ok(())
    }

    /// Estimates of all regions, made by all ranks; `None` when cancelled.
    fn estimate(&self, work: &RegionalWork<'_>) -> Result<Option<Vec<f64>>, Error> {
        let mut estimates = vec![0.0; work.regions() as usize];
        let estimate = |region: u64, context: &ItemContext| {
            let estimate = work.estimate(region, &Interrupt::new(context.cancel.clone()));
            estimate.map(|estimate| estimate.to_le_bytes().to_vec()).map_err(|e| e.to_string())
        };
        let mut job = Items::new(0..work.regions(), |region, _, estimate: Vec<u8>| {
            let estimate = estimate.try_into().map_err(|_| "eight bytes were expected")?;
            estimates[region as usize] = f64::from_le_bytes(estimate);
            Ok(())
        });
        let job: Option<&mut dyn Job> = if self.link.is_master() { Some(&mut job) } else { None };
        let ran = run(self.link, self.options, job, &estimate)?;
        Ok((!ran.cancelled).then_some(estimates))
    }

    /// Does these items, the most expensive first, and skips those whose results are known. Whether all were
    /// done.
    fn run(&mut self, items: Range<u64>, cost: &dyn Fn(u64) -> f64, work: &Work<'_>) -> Result<bool, Error> {
        if !self.link.is_master() {
            run(self.link, self.options, None, work)?;
            return Ok(true);
        }
        let open: Vec<u64> = items.filter(|item| self.results[*item as usize].is_none()).collect();
        let Self { checkpoint, results, .. } = self;
        let take = |item: u64, _, result: Vec<u8>| {
            checkpoint
                .map_or(Ok(()), |checkpoint| checkpoint.keep(item, &result))
                .map_err(|e| e.to_string())?;
            results[item as usize] = Some(result);
            Ok(())
        };
        let mut job = Items::dearest_first(open, cost, take);
        Ok(!run(self.link, self.options, Some(&mut job), work)?.cancelled)
    }

    /// The results of the first items, for [`split`]. Not empty.
    fn joined(&self, items: u64) -> Vec<u8> {
        let mut joined = Writer::new();
        joined.number(items as usize);
        self.results.iter().take(items as usize).flatten().for_each(|result| joined.bytes(result));
        joined.0
    }
}

/// The results in what the master has joined.
fn split(joined: &[u8]) -> Result<Vec<&[u8]>, Error> {
    let mut joined = Reader::new(joined)?;
    (0..joined.number()?).map(|_| joined.bytes()).collect()
}
