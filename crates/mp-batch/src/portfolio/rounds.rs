//! The master of a portfolio: hands out the groups of round after round, and finds the winner.

use super::group::GroupResult;
use super::{Allocation, Known, RankWork, RunOutcome, is_of_machine, reason_of};
use mp_plan::{Error, FoundRun, PortfolioCounts, Progress, StopReason, StoppedBy, Watch};
use mp_ranks::{Checkpoint, Job};
use std::collections::{HashMap, HashSet, VecDeque};

/// The rounds of a portfolio, as a job.
pub(super) struct Rounds<'a, 'w> {
    allocation: &'a Allocation,
    checkpoint: Option<&'a Checkpoint>,
    watch: Option<&'a mut (dyn Watch + 'w)>,
    /// The runs that are known of this round and later ones.
    outcomes: Known,
    /// The present round.
    round: u64,
    /// Its groups that are not handed out, and how many have not come back.
    left: VecDeque<u64>,
    open: usize,
    /// The best run with a path of this round: iterations and number.
    best: Option<(u64, u64)>,
    /// The sums over the rounds before.
    before: Sums,
    work: Vec<RankWork>,
}

/// Sums over runs.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    iterations: u64,
    /// The most nodes of one run.
    nodes: usize,
    motions: u64,
    rejected: u64,
    queries: u64,
}

impl Sums {
    fn add(&mut self, run: &RunOutcome) {
        self.iterations += run.iterations;
        self.nodes = self.nodes.max(run.nodes);
        self.motions += run.motions;
        self.rejected += run.rejected;
        self.queries += run.queries;
    }
}

impl<'a, 'w> Rounds<'a, 'w> {
    /// Begins with the runs in the checkpoint.
    ///
    /// # Errors
    /// When a run in it is none of this portfolio.
    pub(super) fn new(
        allocation: &'a Allocation,
        ranks: usize,
        checkpoint: Option<&'a Checkpoint>,
        watch: Option<&'a mut (dyn Watch + 'w)>,
    ) -> Result<Self, Error> {
        let mut outcomes = Known::new();
        for (run, bytes) in checkpoint.into_iter().flat_map(|checkpoint| checkpoint.known()) {
            match serde_json::from_slice::<RunOutcome>(bytes) {
                Ok(outcome)
                    if outcome.run == *run
                        && *run > 0
                        && (allocation.goes_on || *run <= allocation.portfolio.runs) =>
                {
                    outcomes.insert(*run, outcome);
                }
                _ => {
                    let message = format!("the checkpoint has a result of run {run} that is none");
                    return Err(Error::new(message).help("delete the file, and begin anew"));
                }
            }
        }
        // Runs that were outrun count only with the best run by which they were.
        let mut best: HashMap<u64, u64> = HashMap::new();
        let round_of = |run: u64| allocation.portfolio.round_of(run);
        for outcome in outcomes.values().filter(|outcome| outcome.path.is_some()) {
            let best = best.entry(round_of(outcome.run)).or_insert(u64::MAX);
            *best = outcome.iterations.min(*best);
        }
        outcomes.retain(|run, outcome| outcome.is_settled(best.get(&round_of(*run)).copied()));
        let mut rounds = Self {
            allocation,
            checkpoint,
            watch,
            outcomes,
            round: 0,
            left: VecDeque::new(),
            open: 0,
            best: None,
            before: Sums::default(),
            work: vec![RankWork::default(); ranks],
        };
        rounds.begin_round();
        Ok(rounds)
    }

    /// The runs of open rounds that are settled before anything is handed out.
    pub(super) fn known(&self) -> HashSet<u64> {
        self.outcomes.keys().copied().collect()
    }

    /// How many those are, with those of rounds that are over.
    pub(super) fn known_runs(&self) -> u64 {
        self.outcomes.len() as u64 + *self.allocation.portfolio.round_runs(self.round).start() - 1
    }

    /// The iterations of the best run known.
    pub(super) fn best(&self) -> Option<u64> {
        self.best.map(|(iterations, _)| iterations)
    }

    /// The known runs of this round, by their numbers.
    fn of_round(&self) -> impl Iterator<Item = &RunOutcome> {
        self.allocation.portfolio.round_runs(self.round).filter_map(|run| self.outcomes.get(&run))
    }

    /// Queues the groups of this round. Begins the next round, or ends, when no run of this one is open.
    fn begin_round(&mut self) {
        loop {
            self.best = self.of_round().filter_map(RunOutcome::rank).min();
            let first = self.round * self.allocation.groups;
            // Lanes get a run each in turn.
            let runs = self.allocation.portfolio.round_runs(self.round);
            let open = runs.filter(|run| !self.outcomes.contains_key(run)).count() as u64;
            self.left = (first..first + open.min(self.allocation.groups)).collect();
            self.open = self.left.len();
            if self.open > 0 || self.is_last() {
                return;
            }
            self.next_round();
        }
    }

    /// Whether the present round is the last: it has a path, time has ended it, or there are no further runs.
    fn is_last(&self) -> bool {
        self.best.is_some()
            || (self.round + 1 >= self.allocation.portfolio.rounds() && !self.goes_on())
            || !self.of_round().all(RunOutcome::is_lasting)
    }

    /// Whether runs follow those that there are: not where all of the last have tried all they can.
    fn goes_on(&self) -> bool {
        self.allocation.goes_on && self.of_round().any(|run| run.stopped_by != Some(StoppedBy::Exhausted))
    }

    fn next_round(&mut self) {
        for run in self.allocation.portfolio.round_runs(self.round) {
            if let Some(outcome) = self.outcomes.remove(&run) {
                self.before.add(&outcome);
            }
        }
        self.round += 1;
    }

    /// What was found, the counts, what each rank did, and whether the schedule is what ended it. `cancelled`
    /// is why it was cancelled, if it was.
    pub(super) fn into_found(
        self,
        cancelled: Option<StopReason>,
    ) -> (FoundRun, PortfolioCounts, Vec<RankWork>, bool) {
        let of_schedule = |run: &&RunOutcome| run.stopped_by == Some(StoppedBy::Schedule);
        let capped = self.of_round().any(|run| of_schedule(&run));
        let ended =
            self.of_round().filter(|run| !of_schedule(run)).filter_map(|run| run.stopped_by.map(reason_of));
        let ended: Vec<StopReason> = ended.collect();
        let of_machine = cancelled.or_else(|| ended.iter().copied().find(|reason| is_of_machine(*reason)));
        let mut sums = self.before;
        self.of_round().for_each(|run| sums.add(run));
        let most = self.best.map_or(u64::MAX, |(iterations, _)| iterations);
        let needed: u64 = self.of_round().map(|run| run.iterations.min(most)).sum();
        let portfolio = self.allocation.portfolio;
        let counts = PortfolioCounts {
            runs: portfolio.runs,
            schedule: portfolio.schedule,
            unit: portfolio.unit,
            round: portfolio.round,
            begun: *portfolio.round_runs(self.round).end(),
            winner: self.best.map(|(_, run)| run),
            iterations: self.before.iterations + needed,
        };
        let mut by_schedule = false;
        let winner = self.best.and_then(|(_, run)| self.outcomes.get(&run));
        let found = match winner {
            Some(run) => {
                let mut progress = Progress::new(run.iterations, run.nodes, run.motions);
                progress.rejected = run.rejected;
                let (queries, map, path) = (run.queries, run.map, run.path.clone());
                FoundRun { progress, queries, map, path, ended_by: of_machine }
            }
            None => {
                let mut progress = Progress::new(sums.iterations, sums.nodes, sums.motions);
                progress.rejected = sums.rejected;
                // Where all runs have tried all they can, that is why; otherwise what ended the first that
                // has not.
                let last = ended.iter().copied().find(|reason| *reason != StopReason::Exhausted);
                let reason = of_machine.or(last);
                by_schedule = reason.is_none() && capped;
                let reason = reason.or(capped.then_some(StopReason::Iterations)).or(ended.first().copied());
                let ended_by = Some(reason.unwrap_or(StopReason::Cancelled));
                FoundRun { progress, queries: sums.queries, map: None, path: None, ended_by }
            }
        };
        (found, counts, self.work, by_schedule)
    }
}

impl Job for Rounds<'_, '_> {
    fn next(&mut self) -> Option<u64> {
        self.left.pop_front()
    }

    fn left(&self) -> u64 {
        self.left.len() as u64
    }

    fn take(&mut self, item: u64, rank: usize, result: Vec<u8>) -> Result<(), String> {
        let result: GroupResult =
            serde_json::from_slice(&result).map_err(|e| format!("its result cannot be read: {e}"))?;
        let work = &mut self.work[rank];
        for outcome in result.runs {
            if !self.allocation.portfolio.round_runs(self.round).contains(&outcome.run) {
                return Err(format!("its result is of run {}, which is not of group {item}", outcome.run));
            }
            work.runs += 1;
            work.iterations += outcome.iterations;
            work.queries += outcome.queries;
            if let Some(rank) = outcome.rank() {
                self.best = Some(self.best.map_or(rank, |best| best.min(rank)));
            }
            if let (Some(checkpoint), true) = (self.checkpoint, outcome.is_lasting()) {
                let bytes = serde_json::to_vec(&outcome).map_err(|e| e.to_string())?;
                checkpoint.keep(outcome.run, &bytes).map_err(|e| e.to_string())?;
            }
            self.outcomes.insert(outcome.run, outcome);
        }
        if let Some(watch) = &mut self.watch {
            let mut sums = self.before;
            let runs = self.allocation.portfolio.round_runs(self.round);
            runs.filter_map(|run| self.outcomes.get(&run)).for_each(|run| sums.add(run));
            let mut progress = Progress::new(sums.iterations, sums.nodes, sums.motions);
            progress.rejected = sums.rejected;
            watch.progress(&progress);
        }
        self.open -= 1;
        if self.open == 0 && !self.is_last() {
            self.next_round();
            self.begin_round();
        }
        Ok(())
    }

    fn bound(&self) -> u64 {
        self.best().unwrap_or(u64::MAX)
    }
}
