//! A group: runs of one round that are advanced by turns in one thread.

use super::{Allocation, Clocks, RunOutcome, rounds::Rounds};
use crate::ranks::{broadcast, ranks_error};
use mp_cspace::{Iterations, Rng};
use mp_plan::{Control, Error, PreparedRun, Run, StoppedBy};
use mp_ranks::{ItemContext, Link, Pace};
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::time::Duration;

/// The least number of iterations in a turn.
const LEAST_TURN: u64 = 4;
/// A turn is at most this part of what the run has made.
const TURN_PART: u64 = 16;

/// What all ranks must know before they begin: the same for all.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Start {
    /// What is run.
    identity: String,
    /// The runs that are settled already.
    known: HashSet<u64>,
    /// The iterations of the best of them.
    best: Option<u64>,
}

impl Start {
    pub(super) fn new(identity: String, rounds: &Rounds<'_, '_>) -> Self {
        Self { identity, known: rounds.known(), best: rounds.best() }
    }

    /// That of the master, on all ranks. The master has none when it cannot begin.
    ///
    /// # Errors
    /// When the ranks cannot reach each other, or have different requests: then on all of them.
    pub(super) fn shared(link: &dyn Link, mine: Option<Self>) -> Result<Self, Error> {
        let bytes = serde_json::to_vec(&mine).map_err(|e| Error::new(format!("cannot write JSON: {e}")))?;
        let start = serde_json::from_slice::<Option<Self>>(&broadcast(link, bytes)?).ok().flatten();
        let identity = mine.map(|mine| mine.identity);
        let start = start.filter(|start| Some(&start.identity) == identity.as_ref());
        // Nobody waits for a rank that has ended.
        let mut other = start.is_none().then(|| link.rank());
        if link.is_master() {
            for _ in 1..link.ranks() {
                let (from, agrees) = received(link)?;
                other = if agrees { other } else { other.or(Some(from)) };
            }
            let send = |rank| link.send(rank, answer(other.is_none()));
            (1..link.ranks()).try_for_each(send).map_err(ranks_error)?;
        } else {
            link.send(0, answer(start.is_some())).map_err(ranks_error)?;
            let (from, all_agree) = received(link)?;
            other = if all_agree { other } else { other.or(Some(from)) };
        }
        match (start, other) {
            (Some(start), None) => Ok(start),
            (_, rank) => {
                let which =
                    rank.filter(|rank| *rank > 0).map_or("a rank".to_owned(), |rank| format!("rank {rank}"));
                Err(Error::new(format!("{which} has another scene, request or portfolio than the first"))
                    .help("start all ranks with the same program, files and options"))
            }
        }
    }
}

/// Whether a rank agrees, as a message.
fn answer(agrees: bool) -> Vec<u8> {
    vec![b'p', u8::from(agrees)]
}

/// Waits for an answer.
fn received(link: &dyn Link) -> Result<(usize, bool), Error> {
    loop {
        match link.poll().map_err(ranks_error)? {
            Some((from, message)) => return Ok((from, message == answer(true))),
            None => link.wait(Duration::from_millis(5)),
        }
    }
}

/// What came out of a group.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GroupResult {
    pub(super) runs: Vec<RunOutcome>,
}

/// All that a group needs.
pub(super) struct RunGroup<'a> {
    pub(super) prepared: &'a PreparedRun<'a>,
    pub(super) allocation: &'a Allocation,
    pub(super) start: &'a Start,
    pub(super) clocks: &'a Clocks,
}

/// A run under way.
struct RunInGroup<'p> {
    number: u64,
    cap: u64,
    run: Option<Run<'p>>,
    iterations: u64,
    /// The time that it took.
    time: Duration,
}

impl RunGroup<'_> {
    /// Advances the runs of the group `item` until none can win any more.
    pub(super) fn work(&self, item: u64, context: &ItemContext) -> Result<Vec<u8>, String> {
        let runs = self.raced(item, context).map_err(|e| e.to_string())?;
        serde_json::to_vec(&GroupResult { runs })
            .map_err(|e| format!("a path has a number that is not finite: {e}"))
    }

    fn raced(&self, item: u64, context: &ItemContext) -> Result<Vec<RunOutcome>, Error> {
        let runs = self.allocation.group(item, |run| self.start.known.contains(&run));
        let prepared = runs.iter().map(|_| self.prepared.again()).collect::<Result<Vec<_>, _>>()?;
        let mut racers = Vec::new();
        for ((number, cap), prepared) in runs.into_iter().zip(&prepared) {
            let began = self.clocks.clock.now();
            let rng = Rng::stream(self.allocation.seed, number);
            let run = Some(prepared.begin_with(rng, &mut self.control(context, Duration::ZERO))?);
            let time = self.clocks.clock.now().saturating_sub(began);
            racers.push(RunInGroup { number, cap: cap.unwrap_or(u64::MAX), run, iterations: 0, time });
        }
        let mut outcomes: Vec<RunOutcome> = Vec::new();
        let mut best: Option<(u64, u64)> = None;
        // Runs with as many iterations cannot win.
        let bound = |best: Option<(u64, u64)>| {
            let known = self.start.best.unwrap_or(u64::MAX).min(context.bound());
            best.map_or(known, |(iterations, _)| iterations.min(known))
        };
        let mut reach = 0;
        let mut pace = Pace::new(item);
        while racers.iter().any(|racer| racer.run.is_some()) && !context.cancel.is_raised() {
            // Where nothing but the end of runs that cannot win is left, nobody is waited for.
            let over = || context.cancel.is_raised() || bound(best) <= reach;
            pace.keep(context, reach, || self.clocks.clock.now(), over);
            reach = next_reach(reach);
            for racer in &mut racers {
                let Some(mut run) = racer.run.take() else { continue };
                let bound = bound(best);
                let began = self.clocks.clock.now();
                let mut control = self.control(context, racer.time);
                let over = run.advance(&mut Iterations(reach.min(racer.cap).min(bound)), &mut control);
                racer.time += self.clocks.clock.now().saturating_sub(began);
                racer.iterations = run.progress().iterations;
                if !over && racer.iterations < racer.cap.min(bound) {
                    racer.run = Some(run);
                    continue;
                }
                let mut outcome = RunOutcome::of(racer.number, run.into_found()?);
                if !over && racer.iterations >= racer.cap && outcome.path.is_none() {
                    outcome.stopped_by = Some(StoppedBy::Schedule);
                }
                match (outcome.rank(), best) {
                    (Some(rank), Some(other)) if other < rank => outcome.path = None,
                    (Some(rank), _) => {
                        // The path of the best run before is not needed any more.
                        outcomes.iter_mut().for_each(|outcome| outcome.path = None);
                        best = Some(rank);
                    }
                    (None, _) => {}
                }
                outcomes.push(outcome);
            }
        }
        Ok(outcomes)
    }

    /// The control of a run that took the time `time` itself: time is that of the whole portfolio.
    fn control(&self, context: &ItemContext, time: Duration) -> Control<'static> {
        let Clocks { clock, began, spent } = *self.clocks;
        let passed = spent + clock.now().saturating_sub(began);
        Control {
            cancel: context.cancel.clone(),
            spent: passed.saturating_sub(time),
            clock,
            ..Control::default()
        }
    }
}

/// How far runs have come after the next turn.
fn next_reach(reach: u64) -> u64 {
    reach.saturating_add(LEAST_TURN.max(reach / TURN_PART))
}
