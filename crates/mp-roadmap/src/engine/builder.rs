//! The one loop that builds roadmaps.

use super::prefetch::{PrefetchJob, Prefetched, Prefetcher, QueryMeter};
use super::{Candidate, Connector, EdgeChecker, Growing, NodeGenerator, Piece, Roadmap};
use mp_cspace::{
    BuildError, Event, LocalPlanner, Motion, NearestNeighbors, NodeId, Observer, Progress, Reversible, Rng,
    Space, Stop, StopReason,
};
use rand::RngExt;
use std::ops::Range;

/// Builds a roadmap: each attempt generates candidates and connects them.
///
/// Attempt i draws from stream (seed, i), where the seed is the first number drawn from the random numbers of
/// the first step.
#[derive(Debug)]
pub struct Builder<'c, C: Space, L: LocalPlanner<C::State>, G, K, N> {
    pub(crate) checker: EdgeChecker<'c, C, L>,
    pub(crate) map: Roadmap<C::State, L::Edge>,
    pub(crate) index: N,
    generator: G,
    connector: K,
    seed: Option<u64>,
    attempts: u64,
    candidates: Vec<Candidate<C::State, L::Edge>>,
    pub(crate) prefetcher: Prefetcher<'c, C, L, G, K, N>,
}

impl<'c, C, L, G, K, N> Builder<'c, C, L, G, K, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    G: NodeGenerator<C, L>,
    K: Connector<C, L>,
    N: NearestNeighbors<C>,
{
    /// A builder of a roadmap without nodes; `index` is empty.
    pub fn new(checker: EdgeChecker<'c, C, L>, generator: G, connector: K, index: N) -> Self {
        let map = Roadmap::new();
        Self {
            checker,
            map,
            index,
            generator,
            connector,
            seed: None,
            attempts: 0,
            candidates: Vec::new(),
            prefetcher: Prefetcher::default(),
        }
    }

    /// Continues a roadmap that was built before.
    ///
    /// # Errors
    /// When a state of it is outside the space.
    pub fn resume(mut self, map: Roadmap<C::State, L::Edge>) -> Result<Self, BuildError> {
        self.replace(map)?;
        Ok(self)
    }

    pub(crate) fn replace(&mut self, map: Roadmap<C::State, L::Edge>) -> Result<(), BuildError> {
        map.fill(self.checker.space(), &mut self.index)?;
        self.map = map;
        self.connector.resumed(&self.map);
        self.prefetcher.ready.clear();
        Ok(())
    }

    /// Adds another roadmap of the same space and scene: its nodes and edges as they are, and then an edge
    /// from each of its nodes to the nearest node that is in another component and can be connected, among
    /// its `neighbours` nearest. Edges that were verified before are verified again when a path uses them.
    ///
    /// # Errors
    /// When a state of it is outside the space.
    pub fn merge(
        &mut self,
        other: &Roadmap<C::State, L::Edge>,
        neighbours: usize,
        observer: &mut dyn Observer<C::State>,
    ) -> Result<(), BuildError> {
        other.check_within(self.checker.space())?;
        let before = self.map.len() as NodeId;
        self.map.append(other);
        for id in before..self.map.len() as NodeId {
            self.index.inserted(self.checker.space(), self.map.states(), id);
            let kind = Some(self.map.tag(id).kind.name());
            observer.on(Event::Rooted { tree: 0, id, state: self.map.state(id), kind });
        }
        let mut near = Vec::new();
        let (_, mut growing) = self.growing(Vec::new(), observer);
        for id in before..growing.map.len() as NodeId {
            let q = growing.map.state(id).clone();
            growing.near(&q, neighbours.saturating_add(1), f64::INFINITY, &mut near);
            // One edge per node is enough to join all components that can be joined.
            for hit in near.iter().filter(|hit| hit.id != id) {
                if growing.checker().is_interrupted() {
                    break;
                }
                if !growing.map.connected(hit.id, id) && growing.try_link(hit.id, id) {
                    break;
                }
            }
        }
        self.connector.resumed(&self.map);
        Ok(())
    }

    /// Counts queries by `meter`, so that the count is the same on any number of threads.
    #[must_use]
    pub fn metered(mut self, meter: QueryMeter<'c>) -> Self {
        self.prefetcher.meter = Some(meter);
        self
    }

    /// The roadmap as it has grown so far.
    #[must_use]
    pub fn map(&self) -> &Roadmap<C::State, L::Edge> {
        &self.map
    }

    /// The roadmap, mutable to compute its components.
    pub fn map_mut(&mut self) -> &mut Roadmap<C::State, L::Edge> {
        &mut self.map
    }

    /// The connector, which chooses the neighbours that a new node is connected to.
    #[must_use]
    pub fn connector(&self) -> &K {
        &self.connector
    }

    /// The roadmap, without the builder.
    #[must_use]
    pub fn into_map(self) -> Roadmap<C::State, L::Edge> {
        self.map
    }

    /// One attempt: generates candidates and connects them. Returns the ids of the nodes that were added.
    pub fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Range<NodeId> {
        let seed = *self.seed.get_or_insert_with(|| rng.random());
        let before = self.map.len() as NodeId;
        self.generator.begin(self.attempts, &self.map, self.checker.space());
        self.prefetch(seed);
        if let Some(prefetched) = self.prefetcher.ready.pop_front() {
            self.attempts += 1;
            if let Some(meter) = self.prefetcher.meter {
                meter.used(prefetched.queries);
            }
            let mut last = None;
            for (candidate, answers) in prefetched.candidates {
                observer.on(Event::Sampled(&candidate.state));
                last = self.take(candidate, answers, last, observer);
            }
            insert(prefetched.piece, (&mut self.map, &mut self.index), &mut self.checker, observer);
            return before..self.map.len() as NodeId;
        }
        let mut candidates = std::mem::take(&mut self.candidates);
        let mut stream = Rng::stream(seed, self.attempts);
        self.generator.generate(self.attempts, &self.map, &mut self.checker, &mut stream, &mut candidates);
        let piece = self.generator.piece(self.attempts, &self.map, &mut self.checker, &mut stream);
        self.attempts += 1;
        let mut last = None;
        for candidate in candidates.drain(..) {
            observer.on(Event::Sampled(&candidate.state));
            last = self.take(candidate, Vec::new(), last, observer);
        }
        self.candidates = candidates;
        insert(piece, (&mut self.map, &mut self.index), &mut self.checker, observer);
        before..self.map.len() as NodeId
    }

    /// Lets the threads prefetch the next attempts, where there are threads and no attempt is prefetched
    /// already.
    fn prefetch(&mut self, seed: u64) {
        let Some(work) = &mut self.prefetcher.work else { return };
        let independent = self.generator.independent(&self.map);
        if independent == 0 {
            // Others than attempts add nodes too: trees from the ends, and queries.
            self.prefetcher.ready.clear();
        }
        let most = independent.min(self.prefetcher.most);
        if !self.prefetcher.ready.is_empty() || most < 2 {
            return;
        }
        self.map.refresh();
        let attempts = self.attempts..self.attempts + most;
        let (map, index) = (&self.map, &self.index);
        let job = PrefetchJob {
            map,
            index,
            generator: &self.generator,
            connector: &self.connector,
            seed,
            attempts,
            meter: self.prefetcher.meter,
        };
        self.prefetcher.ready = work(job).into();
    }

    /// Connects a candidate; `answers` are motions to it that were prefetched.
    fn take(
        &mut self,
        mut candidate: Candidate<C::State, L::Edge>,
        answers: Prefetched<C::State, L::Edge>,
        last: Option<NodeId>,
        observer: &mut dyn Observer<C::State>,
    ) -> Option<NodeId> {
        if let Some(parent) = &mut candidate.parent {
            parent.from = Some(parent.from.or(last)?);
        }
        let (connector, mut growing) = self.growing(answers, observer);
        connector.connect(candidate, &mut growing)
    }

    /// The connector, and what it works with.
    fn growing<'a>(
        &'a mut self,
        answers: Prefetched<C::State, L::Edge>,
        observer: &'a mut dyn Observer<C::State>,
    ) -> (&'a mut K, Growing<'a, 'c, C, L, N>) {
        let Self { checker, map, index, connector, prefetcher, .. } = self;
        let meter = prefetcher.meter;
        (connector, Growing { map, index, checker, observer, answers, meter, uncounted: false })
    }

    /// Adds a configuration that the connector may not refuse: an end of a path.
    pub fn adopt(
        &mut self,
        candidate: Candidate<C::State, L::Edge>,
        observer: &mut dyn Observer<C::State>,
    ) -> NodeId {
        let (connector, mut growing) = self.growing(Vec::new(), observer);
        connector.adopt(candidate, &mut growing)
    }

    /// Builds until stopped. Call again to go on. An attempt that was [cut short](Stop::cut_short) leaves the
    /// roadmap as it was before.
    pub fn build(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<C::State>,
    ) -> StopReason {
        loop {
            let progress = self.progress();
            let exhausted = || progress.exhausted.then_some(StopReason::Exhausted);
            if let Some(reason) = stop.check(&progress).or_else(exhausted) {
                built(&progress, self.map.edges(), reason);
                return reason;
            }
            observer.on(Event::Iteration(progress));
            self.map.mark();
            self.step(rng, observer);
            if let Some(reason) = stop.cut_short() {
                self.map.roll_back();
                built(&progress, self.map.edges(), reason);
                return reason;
            }
        }
    }

    /// The progress so far.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let mut progress = Progress::new(self.attempts, self.map.len(), self.checker.motions());
        (progress.rejected, progress.exhausted) = (self.checker.rejected(), self.connector.exhausted());
        progress
    }
}

/// Adds a piece to the roadmap. Its motions count now; where the local planner is not trusted any more, its
/// edges are verified.
fn insert<C, L, N>(
    piece: Option<Piece<C::State, L::Edge>>,
    (map, index): (&mut Roadmap<C::State, L::Edge>, &mut N),
    checker: &mut EdgeChecker<'_, C, L>,
    observer: &mut dyn Observer<C::State>,
) where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    let Some(piece) = piece else { return };
    let (nodes, edges) = (map.len() as NodeId, map.all_edges().len());
    let blocked = piece.motions() - piece.edges() as u64;
    piece.insert_kept(map, &mut |from, link, to| {
        let motion = link.edge.clone().map(|edge| Motion { end: to.clone(), edge, cost: link.length });
        checker.replay(from, motion, to).is_some()
    });
    for id in nodes..map.len() as NodeId {
        index.inserted(checker.space(), map.states(), id);
        let kind = Some(map.tag(id).kind.name());
        observer.on(Event::Rooted { tree: 0, id, state: map.state(id), kind });
    }
    for (_, [from, to], _) in map.all_edges().skip(edges) {
        observer.on(Event::Linked { from, to });
    }
    if let Some(q) = map.states().first() {
        (0..blocked).for_each(|_| drop(checker.replay(q, None, q)));
    }
}

/// Logs that building has ended. Not generic, so that it is compiled once.
fn built(progress: &Progress, edges: usize, reason: StopReason) {
    tracing::debug!(attempts = progress.iterations, nodes = progress.nodes, edges, ?reason, "built");
}
