//! Portfolios: many runs of one request, with random numbers of their own, over threads and over the ranks of
//! a cluster.

mod group;
mod rounds;

use crate::job;
use crate::ranks::{ranks_error, run};
use group::{RunGroup, Start};
use mp_cspace::Rng;
use mp_plan::{
    Clock, Control, Error, FoundRun, PortfolioSchedule, Report, Request, Scene, StopReason, StoppedBy,
};
use mp_ranks::{ItemContext, Job, Link, Options};
use mp_tree::Schedule;
use rounds::Rounds;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::PathBuf;

/// The most runs of a portfolio.
const MAX_RUNS: u64 = 1 << 30;
/// The most runs of a round: all of them are in memory.
const MAX_ROUND: u64 = 1 << 20;
/// The largest unit, as that of `restart-` planners.
const MAX_UNIT: u64 = 1_000_000_000_000;

/// Which runs are made.
///
/// A portfolio is a fixed list of runs, numbered from 1. Run i draws from stream *(seed, i)*, and its *cap*,
/// the most iterations it may make, is that of the [schedule](PortfolioSchedule). The runs are made in
/// *rounds* of a fixed number; a round begins when the one before has no path. The winner is the run of the
/// first round with a path that has the fewest iterations, and of several such the one with the least number.
/// So it depends on the request and the portfolio alone, whoever finished first, and on how many machines.
///
/// - Portfolios: C. Gomes and B. Selman, *Algorithm portfolios*, Artificial Intelligence 126, 2001. For trees
///   of motion planning, N. Wedge and M. Branicky, *On heavy-tailed runtimes and restarts in
///   rapidly-exploring random trees*, AAAI workshop, 2008.
/// - Schedules over many processors: M. Luby and W. Ertel, *Optimal parallelization of Las Vegas algorithms*,
///   STACS 1994; A. Cire, S. Kadioglu and M. Sellmann, *Parallel restarted search*, AAAI 2014, where
///   processors take the runs of one sequence of lengths in turn, as here. There the first to finish wins;
///   that the one with the fewest iterations does is as in `or-` planners
///   ([there](mp_tree::algo::or_parallel)).
///
/// How it is worked on, which changes nothing in the result:
/// 1. the runs of a round are dealt to as many *groups* as there are threads on all ranks, the largest caps
///    first, one to each group in turn, there and back again;
/// 2. a group advances its runs by turns, the one as far as the other, until each has a path, has reached its
///    cap, or has made as many iterations as the best run known: then it cannot win any more;
/// 3. a group that is an eighth ahead of the one that is furthest behind waits for it, which must come as far
///    as the winner anyway;
/// 4. when a group is done, the others hear of its best run.
///
/// All runs may reach their caps without a path. If the request has no budget of iterations, queries or
/// nodes, as many further runs follow, until the time is up. Their caps are the next ones of the schedule;
/// under the wide schedule they are twice the caps of the runs before.
///
/// So a round costs each run as many iterations as the winner needs, and at most a sixteenth or an eighth of
/// that more, or what is made until news have spread. A round keeps the trees of all its runs.
///
/// ```
/// use mp_batch::{Portfolio, PortfolioOptions};
/// use mp_plan::{Control, PortfolioSchedule, Request, Scene};
/// let scene = Scene::find("easy")?;
/// let portfolio = Portfolio { schedule: PortfolioSchedule::Luby, unit: 50, ..Portfolio::new(20) };
/// let on = |threads| {
///     let options = PortfolioOptions { threads, ..PortfolioOptions::default() };
///     portfolio.plan(&scene, &Request::new("rrt-connect"), &options, &mut Control::default())
/// };
/// let (one, two) = (on(1)?.report.without_times(), on(2)?.report.without_times());
/// assert!(one.solved && one.portfolio.as_ref().is_some_and(|runs| runs.winner.is_some()));
/// assert_eq!(one, two);
/// # Ok::<(), mp_plan::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Portfolio {
    /// How many runs there are, 1 to 2^30; at most as many where the request has a budget of iterations,
    /// queries or nodes.
    pub runs: u64,
    /// Their caps.
    pub schedule: PortfolioSchedule,
    /// How many iterations a run of length 1 may make, 1 to 10^12. Runs without caps have no unit.
    pub unit: u64,
    /// How many runs are in a round, 1 to 2^20. Ranks and threads beyond that number have nothing to do, and
    /// where caps differ they are all busy only if there are some times as many runs as threads.
    pub round: u64,
}

impl Portfolio {
    /// A portfolio of `runs` runs without caps, at most 64 of them in a round.
    #[must_use]
    pub fn new(runs: u64) -> Self {
        Self { runs, schedule: PortfolioSchedule::None, unit: 1000, round: 64 }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// When one is out of its range.
    pub fn check(&self) -> Result<(), Error> {
        let range = |what: &str, value: u64, most: u64| match (1..=most).contains(&value) {
            true => Ok(()),
            false => Err(Error::new(format!("a portfolio has {what} {value}"))
                .help(format!("give a whole number from 1 to {most}"))),
        };
        range("the number of runs", self.runs, MAX_RUNS)?;
        range("rounds of", self.round, MAX_ROUND)?;
        range("the unit", self.unit, MAX_UNIT)
    }

    /// The caps of the runs, that of run 1 first, without end; `None` for a run without one.
    fn caps(&self, seed: u64) -> impl Iterator<Item = Option<u64>> {
        let schedule = match self.schedule {
            PortfolioSchedule::None => None,
            PortfolioSchedule::Luby => Some(Schedule::Luby),
            PortfolioSchedule::Counter => Some(Schedule::Counter),
            PortfolioSchedule::Zeta => Some(Schedule::Zeta),
            PortfolioSchedule::Wide => Some(Schedule::Wide),
        };
        let mut lengths = schedule.map(|schedule| schedule.lengths(Rng::stream(seed, 0)));
        let (runs, wide, unit) = (self.runs, schedule == Some(Schedule::Wide), self.unit);
        (0..).map(move |before: u64| {
            let length = match wide {
                true => (runs / (before % runs + 1)).saturating_mul(1 << (before / runs).min(62)),
                false => lengths.as_mut()?.next()?,
            };
            Some(length.saturating_mul(unit))
        })
    }

    /// How many rounds all runs are.
    fn rounds(&self) -> u64 {
        self.runs.div_ceil(self.round)
    }

    /// The runs of a round, counted from 0. Those after the [last](Self::rounds) are of runs that follow.
    fn round_runs(&self, round: u64) -> std::ops::RangeInclusive<u64> {
        let (turn, round) = (round / self.rounds(), round % self.rounds());
        let first = turn.saturating_mul(self.runs);
        let before = first.saturating_add(round.saturating_mul(self.round));
        before + 1..=before.saturating_add(self.round).min(first.saturating_add(self.runs))
    }

    fn round_of(&self, run: u64) -> u64 {
        let (turn, run) = ((run - 1) / self.runs, (run - 1) % self.runs);
        turn * self.rounds() + run / self.round
    }
}

/// What a rank has done for a portfolio. Depends on who was faster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RankWork {
    /// How many runs it has advanced.
    pub runs: u64,
    /// Their iterations.
    pub iterations: u64,
    /// Their collision and clearance queries.
    pub queries: u64,
}

/// How a portfolio is worked on. Results do not depend on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortfolioOptions {
    /// On how many threads; of several ranks, on how many each. The same on all ranks.
    pub threads: usize,
    /// Keeps finished runs in this file, and goes on with those in it; it is deleted in the end. Used by the
    /// first rank alone.
    pub checkpoint: Option<PathBuf>,
}

/// One thread, without a checkpoint.
impl Default for PortfolioOptions {
    fn default() -> Self {
        Self { threads: 1, checkpoint: None }
    }
}

/// What became of a portfolio.
#[derive(Clone, Debug, PartialEq)]
pub struct PortfolioOutcome {
    /// The report of the winner, with the [counts](Report::portfolio) of the portfolio. Without a winner its
    /// counts are sums over all runs, and the nodes those of the largest run.
    pub report: Report,
    /// What each rank has done.
    pub work: Vec<RankWork>,
    /// How many runs were known from the checkpoint.
    pub known: u64,
}

impl PortfolioOutcome {
    /// The iterations that the result needs, divided by those that could have been made while the busiest
    /// rank worked. Means something only when nothing came from a checkpoint.
    #[must_use]
    pub fn efficiency(&self) -> f64 {
        let needed = self.report.portfolio.as_ref().map_or(0, |counts| counts.iterations);
        let most = self.work.iter().map(|work| work.iterations).max().unwrap_or(0);
        needed as f64 / (self.work.len() as f64 * most as f64).max(1.0)
    }
}

impl Portfolio {
    /// Plans for a scene: makes many runs of one request, of which the one with the fewest iterations wins.
    /// Anytime planners end with their first path. The budget of time is for the whole portfolio, other budgets
    /// are for each run. The stop of `control` is not asked, and its watch gets no single events.
    ///
    /// # Errors
    /// As [`Scene::plan`], when a number is out of its range, the request names a file for a roadmap, or the
    /// checkpoint cannot be used.
    pub fn plan(
        &self,
        scene: &Scene,
        request: &Request,
        options: &PortfolioOptions,
        control: &mut Control<'_>,
    ) -> Result<PortfolioOutcome, Error> {
        let link = mp_ranks::threads(1).remove(0);
        let outcome = self.plan_on(&link, scene, request, options, control)?;
        outcome.ok_or_else(|| Error::new("there is no rank that hands out the runs"))
    }

    /// The planner of the runs where none is named: that of the scene, but `rrt-connect` in place of `auto`,
    /// as one portfolio is enough.
    #[must_use]
    pub fn default_planner(scene: &Scene) -> &'static str {
        match scene.default_planner() {
            "auto" => "rrt-connect",
            planner => planner,
        }
    }

    /// As [`plan`](Self::plan), on all ranks of `link`: each calls this with the same scene, request,
    /// portfolio and number of threads. The first has the outcome, the others `None`.
    ///
    /// ```
    /// use mp_batch::{Portfolio, PortfolioOptions};
    /// use mp_plan::{Control, Request, Scene};
    /// let (scene, request) = (Scene::find("easy")?, Request::new("rrt-connect"));
    /// let on = |link: &dyn mp_ranks::Link| {
    ///     let options = PortfolioOptions::default();
    ///     Portfolio::new(8).plan_on(link, &scene, &request, &options, &mut Control::default())
    /// };
    /// let mut links = mp_ranks::threads(3);
    /// let master = links.remove(0);
    /// let outcome = std::thread::scope(|scope| {
    ///     links.into_iter().for_each(|link| drop(scope.spawn(move || on(&link))));
    ///     on(&master)
    /// })?;
    /// assert!(outcome.is_some_and(|outcome| outcome.report.solved && outcome.work.len() == 3));
    /// # Ok::<(), mp_plan::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`plan`](Self::plan), and when the ranks cannot reach each other, or have different requests.
    pub fn plan_on(
        &self,
        link: &dyn Link,
        scene: &Scene,
        request: &Request,
        options: &PortfolioOptions,
        control: &mut Control<'_>,
    ) -> Result<Option<PortfolioOutcome>, Error> {
        self.check()?;
        request.check_single("a portfolio")?;
        if request.roadmap.is_some() {
            return Err(Error::new("a portfolio keeps no roadmap").help("leave the file of the roadmap out"));
        }
        // Each run has one thread, and ends with its first path.
        let request = Request { threads: 1, first_only: true, ..request.clone() };
        let scene = &scene.for_request(&request)?;
        let request = Request { clearance: scene.clearance_kept(), ..request };
        let before = control.clock.now();
        let prepared = scene.prepare(&request)?;
        let began = control.clock.now();
        if request.budget.time_s.is_some() {
            control.spent += began.saturating_sub(before);
        }
        // What is wrong with the request is said as always, before it is said of a run.
        drop(prepared.begin(control)?);
        let identity = job::identity(scene, &(job::timeless(&request), self))?;
        let threads = options.threads.max(1);
        let budget = &request.budget;
        let goes_on = budget.iterations.is_none() && budget.queries.is_none() && budget.nodes.is_none();
        let allocation = Allocation {
            portfolio: *self,
            seed: request.seed,
            groups: (threads * link.ranks()) as u64,
            goes_on,
        };
        let clocks = Clocks { clock: control.clock, began, spent: control.spent };
        // The others wait for the first rank.
        let refused = |e: Error| {
            let _ = Start::shared(link, None);
            e
        };
        let checkpoint = match (&options.checkpoint, link.is_master()) {
            (Some(file), true) => {
                Some(job::checkpoint(scene, "portfolio", file, &identity).map_err(refused)?)
            }
            _ => None,
        };
        let watch = control.watch.as_deref_mut();
        let mut rounds =
            Rounds::new(&allocation, link.ranks(), checkpoint.as_ref(), watch).map_err(refused)?;
        let known = rounds.known_runs();
        let identity = format!("{identity}, {} groups", allocation.groups);
        let start = Start::shared(link, Some(Start::new(identity, &rounds)))?;
        let run_options = Options { threads, cancel: control.cancel.clone() };
        let work = |item: u64, context: &ItemContext| {
            RunGroup { prepared: &prepared, allocation: &allocation, start: &start, clocks: &clocks }
                .work(item, context)
        };
        let job = link.is_master().then_some(&mut rounds as &mut dyn Job);
        let ran = run(link, &run_options, job, &work)?;
        if !link.is_master() {
            return Ok(None);
        }
        let cancelled = ran.cancelled.then(|| control.cancel.reason().unwrap_or(StopReason::Cancelled));
        let (found, counts, work, by_schedule) = rounds.into_found(cancelled);
        let time = control.clock.now().saturating_sub(began);
        let complete = found.ended_by.is_none_or(|reason| !is_of_machine(reason));
        let mut report = scene.found_report(&request, found, time, control)?;
        report.portfolio = Some(counts);
        if by_schedule {
            let by = StoppedBy::Schedule;
            (report.stopped_by, report.why) = (Some(by), Some(by.to_string()));
            report.stages.iter_mut().for_each(|stage| stage.ended_by = stage.ended_by.map(|_| by));
        }
        if let (Some(checkpoint), true) = (checkpoint, complete) {
            checkpoint.delete().map_err(ranks_error)?;
        }
        Ok(Some(PortfolioOutcome { report, work, known }))
    }
}

/// How the runs are allocated: the same on all ranks.
#[derive(Clone, Copy, Debug)]
struct Allocation {
    portfolio: Portfolio,
    seed: u64,
    groups: u64,
    /// Whether further runs follow when no run has a path.
    goes_on: bool,
}

impl Allocation {
    /// The runs of a group of a round, with their caps, the largest first; those that `known` says are left
    /// out before.
    fn group(&self, item: u64, known: impl Fn(u64) -> bool) -> Vec<(u64, Option<u64>)> {
        let (round, group) = (item / self.groups, item % self.groups);
        let runs = self.portfolio.round_runs(round);
        let caps =
            self.portfolio.caps(self.seed).skip(usize::try_from(*runs.start() - 1).unwrap_or(usize::MAX));
        let mut open: Vec<_> = runs.zip(caps).filter(|(run, _)| !known(*run)).collect();
        open.sort_by_key(|(run, cap)| (std::cmp::Reverse(cap.unwrap_or(u64::MAX)), *run));
        let mine = (0..).zip(open).filter(|(place, _)| group_of(*place, self.groups) == group);
        mine.map(|(_, run)| run).collect()
    }
}

/// The group that gets the run in a place: there and back again, so that none has the larger cap of each
/// turn.
fn group_of(place: u64, groups: u64) -> u64 {
    let (turn, group) = (place / groups, place % groups);
    if turn.is_multiple_of(2) { group } else { groups - 1 - group }
}

/// When a rank began, and what its time budget had spent by then.
#[derive(Clone, Copy, Debug)]
struct Clocks {
    clock: Clock,
    began: std::time::Duration,
    spent: std::time::Duration,
}

/// What a run came to, as ranks tell it and checkpoints keep it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RunOutcome {
    run: u64,
    iterations: u64,
    nodes: usize,
    motions: u64,
    rejected: u64,
    queries: u64,
    map: Option<[usize; 2]>,
    /// What ended a run without a path. A run that was stopped because it could no longer win has neither this
    /// nor a path.
    stopped_by: Option<StoppedBy>,
    /// The states of its path as numbers.
    path: Option<Vec<Vec<f64>>>,
}

impl RunOutcome {
    fn of(run: u64, found: FoundRun) -> Self {
        let FoundRun { progress, queries, map, path, ended_by } = found;
        let stopped_by = match path {
            Some(_) => None,
            None => ended_by.map(StoppedBy::from),
        };
        let (iterations, nodes, motions) = (progress.iterations, progress.nodes, progress.motions);
        Self { run, iterations, nodes, motions, rejected: progress.rejected, queries, map, stopped_by, path }
    }

    /// Where it stands among runs with a path.
    fn rank(&self) -> Option<(u64, u64)> {
        self.path.as_ref().map(|_| (self.iterations, self.run))
    }

    /// Whether more of it changes nothing, if the best run has this many iterations.
    fn is_settled(&self, best: Option<u64>) -> bool {
        self.path.is_some() || self.stopped_by.is_some() || best.is_some_and(|best| best <= self.iterations)
    }

    /// Whether it ended by itself, and would so on every machine.
    fn is_lasting(&self) -> bool {
        self.stopped_by.is_none_or(|by| !is_of_machine(reason_of(by)))
    }
}

/// Whether it depends on the machine that this ended a run.
fn is_of_machine(reason: StopReason) -> bool {
    matches!(reason, StopReason::Deadline | StopReason::Cancelled | StopReason::Memory)
}

/// The reason that a report calls so.
fn reason_of(by: StoppedBy) -> StopReason {
    match by {
        StoppedBy::Time => StopReason::Deadline,
        StoppedBy::Nodes => StopReason::Nodes,
        StoppedBy::Queries => StopReason::Motions,
        StoppedBy::Memory => StopReason::Memory,
        StoppedBy::Interrupted => StopReason::Cancelled,
        StoppedBy::Exhausted => StopReason::Exhausted,
        _ => StopReason::Iterations,
    }
}

/// Runs of a round by their numbers.
type Known = HashMap<u64, RunOutcome>;
