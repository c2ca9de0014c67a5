//! Prefetching: several threads make attempts beforehand, without changing the result.
//!
//! Most time goes into motions of the local planner, and its answers do not depend on when they are made. So
//! threads make the motions that the next attempts will probably need, given the roadmap as it is, and keep
//! them. The attempts are then made one after the other as usual, and use the motions that were prefetched.

use super::{Builder, Candidate, Connector, EdgeChecker, NodeGenerator, Piece, Reachable, Roadmap};
use mp_cspace::{
    Direction, Hit, LocalPlanner, Motion, NearestNeighbors, NodeId, Reversible, Rng, Space, Workers,
};
use std::collections::VecDeque;
use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts queries so that the count does not depend on the number of threads: a prefetched answer counts when
/// it is used, and not at all if it never is.
#[derive(Clone, Copy, Debug)]
pub struct QueryMeter<'c> {
    /// How many queries the present thread has made so far, counted from any beginning.
    pub of_thread: fn() -> u64,
    /// The count of all queries. Checkers add each query to it at once.
    pub common: &'c AtomicU64,
}

/// An answer of the local planner.
pub(crate) struct PrefetchedMotion<S, E> {
    /// The node where the motion begins.
    pub(crate) from: NodeId,
    pub(crate) motion: Option<Motion<S, E>>,
    /// How many queries it took.
    pub(crate) queries: u64,
}

pub(crate) type Prefetched<S, E> = Vec<PrefetchedMotion<S, E>>;

/// The candidates of an attempt.
pub(crate) struct PrefetchedAttempt<S, E> {
    /// The candidates, with the motions prefetched for each.
    pub(crate) candidates: Vec<(Candidate<S, E>, Prefetched<S, E>)>,
    pub(crate) piece: Option<Piece<S, E>>,
    /// How many queries it took to generate them.
    pub(crate) queries: u64,
}

impl<S, E> PrefetchedAttempt<S, E> {
    /// How many queries all of it took.
    fn all_queries(&self) -> u64 {
        let motions = self.candidates.iter().flat_map(|(_, motions)| motions);
        self.queries + motions.map(|motion| motion.queries).sum::<u64>()
    }
}

impl QueryMeter<'_> {
    /// Does `work`; returns how many queries it took.
    fn during<T>(meter: Option<QueryMeter<'_>>, work: impl FnOnce() -> T) -> (T, u64) {
        let now = || meter.map_or(0, |meter| (meter.of_thread)());
        let before = now();
        let done = work();
        (done, now() - before)
    }

    /// Takes the queries of what was prefetched from the count, until it is used.
    fn unused<S, E>(&self, prefetched: &[PrefetchedAttempt<S, E>]) {
        let queries = prefetched.iter().map(PrefetchedAttempt::all_queries).sum();
        self.common.fetch_sub(queries, Ordering::Relaxed);
    }

    /// Counts the queries of what was prefetched and is used.
    pub(crate) fn used(&self, queries: u64) {
        self.common.fetch_add(queries, Ordering::Relaxed);
    }
}

/// What a connector prefetches with: the roadmap as it is, to which candidates are not added.
#[allow(missing_debug_implementations)] // verifiers need not have any
pub struct Prefetching<'a, 'c, C: Space, L: LocalPlanner<C::State>, N> {
    map: &'a Roadmap<C::State, L::Edge>,
    index: &'a N,
    checker: &'a mut EdgeChecker<'c, C, L>,
    q: &'a C::State,
    meter: Option<QueryMeter<'c>>,
    answers: Prefetched<C::State, L::Edge>,
}

impl<C, L, N> Prefetching<'_, '_, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    /// The `k` nodes nearest to the candidate in order of distance, none farther than `radius`.
    #[must_use]
    pub fn near(&self, k: usize, radius: f64) -> Vec<Hit> {
        let mut near = Vec::new();
        self.index.k_nearest(self.checker.space(), self.map.states(), self.q, k, &mut near);
        near.retain(|hit| hit.distance <= radius);
        near
    }

    /// The component of a node, named by one of its nodes.
    #[must_use]
    pub fn component(&self, id: NodeId) -> NodeId {
        self.map.component_now(id)
    }

    /// How many nodes there are.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.map.len()
    }

    /// Prefetches the motions from the nearest nodes, one for each component that can be joined; with cycles
    /// all of them.
    pub(crate) fn reach_nearest(&mut self, within: &Reachable) {
        let mut joined = Vec::new();
        for hit in self.near(within.neighbours, within.radius) {
            if self.checker.is_interrupted() {
                return;
            }
            let component = self.component(hit.id);
            if (within.cycles || !joined.contains(&component)) && self.reach(hit.id) {
                joined.push(component);
            }
        }
    }

    /// Prefetches the motion from a node to the candidate. Returns whether there is one.
    pub fn reach(&mut self, from: NodeId) -> bool {
        let reach = || self.checker.reach(self.map.state(from), self.q, Direction::Forward);
        let (motion, queries) = QueryMeter::during(self.meter, reach);
        let found = motion.is_some();
        self.answers.push(PrefetchedMotion { from, motion, queries });
        found
    }
}

/// What the threads prefetch from: the roadmap and its index, the policies, the seed, and the range of
/// attempts.
pub(crate) struct PrefetchJob<'a, 'c, C: Space, L: LocalPlanner<C::State>, G, K, N> {
    pub(crate) map: &'a Roadmap<C::State, L::Edge>,
    pub(crate) index: &'a N,
    pub(crate) generator: &'a G,
    pub(crate) connector: &'a K,
    pub(crate) seed: u64,
    pub(crate) attempts: Range<u64>,
    pub(crate) meter: Option<QueryMeter<'c>>,
}

/// The prefetched attempts, in order.
type Prefetches<C, L> =
    Vec<PrefetchedAttempt<<C as Space>::State, <L as LocalPlanner<<C as Space>::State>>::Edge>>;

type Work<'c, C, L, G, K, N> =
    Box<dyn FnMut(PrefetchJob<'_, 'c, C, L, G, K, N>) -> Prefetches<C, L> + Send + 'c>;

/// Prefetches attempts on several threads, and keeps them.
pub(crate) struct Prefetcher<'c, C: Space, L: LocalPlanner<C::State>, G, K, N> {
    pub(crate) ready: VecDeque<PrefetchedAttempt<C::State, L::Edge>>,
    pub(crate) work: Option<Work<'c, C, L, G, K, N>>,
    /// Most attempts prefetched at a time.
    pub(crate) most: u64,
    pub(crate) meter: Option<QueryMeter<'c>>,
}

impl<C: Space, L: LocalPlanner<C::State>, G, K, N> Default for Prefetcher<'_, C, L, G, K, N> {
    fn default() -> Self {
        Self { ready: VecDeque::new(), work: None, most: 0, meter: None }
    }
}

impl<C: Space, L: LocalPlanner<C::State>, G, K, N> fmt::Debug for Prefetcher<'_, C, L, G, K, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Prefetcher")
            .field("ready", &self.ready.len())
            .field("most", &self.most)
            .finish_non_exhaustive()
    }
}

/// The attempts that one edge checker prefetches.
struct PrefetchTask<'c, C: Space, L: LocalPlanner<C::State>, G> {
    checker: EdgeChecker<'c, C, L>,
    generator: Option<G>,
    attempts: Range<u64>,
    prefetched: Vec<PrefetchedAttempt<C::State, L::Edge>>,
}

/// The most attempts that one edge checker prefetches at a time.
const SHARE: u64 = 16;

impl<'c, C, L, G, K, N> Builder<'c, C, L, G, K, N>
where
    C: Space,
    C::State: 'c,
    L: LocalPlanner<C::State, Edge: Reversible> + Send + 'c,
    L::Edge: 'c,
    G: NodeGenerator<C, L> + Clone + Send + Sync + 'c,
    K: Connector<C, L> + Sync,
    N: NearestNeighbors<C> + Sync,
{
    /// Builds on several threads, where the generator has [independent](NodeGenerator::independent) attempts.
    /// Each of `checkers`, which must equal the checker of the builder, prefetches some attempts at a time;
    /// give at least as many as there are threads. The roadmap is the same to the bit for any number of
    /// checkers and threads.
    #[must_use]
    pub fn on(mut self, workers: Workers, checkers: impl IntoIterator<Item = EdgeChecker<'c, C, L>>) -> Self {
        let none = 0..0;
        let tasks = checkers.into_iter().map(|checker| PrefetchTask {
            checker,
            generator: None::<G>,
            attempts: none.clone(),
            prefetched: Vec::new(),
        });
        let mut tasks: Vec<_> = tasks.collect();
        self.prefetcher.most = SHARE * tasks.len() as u64;
        self.prefetcher.work = Some(Box::new(move |job: PrefetchJob<'_, 'c, C, L, G, K, N>| {
            let mut next = job.attempts.start;
            let share = (job.attempts.end - next).div_ceil(tasks.len().max(1) as u64);
            for task in &mut tasks {
                let end = (next + share).min(job.attempts.end);
                task.attempts = next..end;
                task.generator = Some(job.generator.clone());
                next = end;
            }
            workers.each(&mut tasks, |task| task.work(&job));
            let mut prefetched: Prefetches<C, L> = Vec::new();
            for task in &mut tasks {
                prefetched.append(&mut task.prefetched);
            }
            if let Some(meter) = job.meter {
                meter.unused(&prefetched);
            }
            prefetched
        }));
        self
    }
}

impl<'c, C, L, G> PrefetchTask<'c, C, L, G>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    G: NodeGenerator<C, L>,
{
    fn work<K: Connector<C, L>, N: NearestNeighbors<C>>(&mut self, job: &PrefetchJob<'_, 'c, C, L, G, K, N>) {
        let Some(generator) = &mut self.generator else { return };
        for attempt in self.attempts.clone() {
            if self.checker.is_interrupted() {
                return;
            }
            let mut rng = Rng::stream(job.seed, attempt);
            let mut candidates = Vec::new();
            let (checker, meter) = (&mut self.checker, job.meter);
            let generate = || {
                generator.generate(attempt, job.map, checker, &mut rng, &mut candidates);
                generator.piece(attempt, job.map, checker, &mut rng)
            };
            let (piece, queries) = QueryMeter::during(meter, generate);
            // A piece that was cut short is less than the whole.
            if piece.is_some() && self.checker.interrupt().raised().is_some() {
                return;
            }
            let prefetched = candidates.into_iter().map(|candidate| {
                let (map, index) = (job.map, job.index);
                let q = &candidate.state;
                let mut prefetching =
                    Prefetching { map, index, checker: &mut self.checker, q, meter, answers: Vec::new() };
                job.connector.prefetch(&mut prefetching);
                let answers = prefetching.answers;
                (candidate, answers)
            });
            let candidates = prefetched.collect();
            self.prefetched.push(PrefetchedAttempt { candidates, piece, queries });
        }
    }
}
