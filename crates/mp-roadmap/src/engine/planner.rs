//! The loop that plans one path: the roadmap grows until start and goal are connected.

use super::end_trees::EndTrees;
use super::{
    Builder, Candidate, Connector, EdgeChecker, EndGrowth, GraphPath, MilestoneKind, NodeGenerator, Pace,
    Query, QueryMeter, Roadmap, RoadmapPlannerParts,
};
use mp_cspace::{
    BuildError, Direction, Event, Goals, LocalPlanner, NearestNeighbors, NodeId, Observer, PathOf, Planner,
    Problem, Progress, Reversible, Rng, Space, Stop, StopReason, Workers,
};
use std::ops::Range;

/// Rejected paths after which each new motion is verified.
pub const PATIENCE: u64 = 10;

/// Every this many iterations a new goal is drawn, where there is a sampler.
const GOAL_EVERY: u64 = 16;

/// A planner that grows a roadmap until it connects start and goal.
///
/// The first step adds the start and the listed goals as nodes. Each step makes one attempt of the generator;
/// where start and a goal are in the same component it searches for a path and verifies it.
#[derive(Debug)]
pub struct RoadmapPlanner<'c, C: Space, L: LocalPlanner<C::State>, G, K, Q, N> {
    builder: Builder<'c, C, L, G, K, N>,
    query: Q,
    pace: Pace,
    improves: bool,
    start: C::State,
    goals: Goals<'c, C::State>,
    /// The node of the start, and those of goals.
    ends: Option<(NodeId, Vec<NodeId>)>,
    trees: EndTrees,
    iterations: u64,
    /// The length of the path returned last, and the number of nodes at the last search.
    best: f64,
    looked: usize,
}

impl<'c, C, L, G, K, Q, N> RoadmapPlanner<'c, C, L, G, K, Q, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    G: NodeGenerator<C, L>,
    K: Connector<C, L>,
    Q: Query<C, L>,
    N: NearestNeighbors<C>,
{
    /// A planner of these parts. The index must be empty: it gets every node of the roadmap.
    pub fn assemble(problem: Problem<'c, C, L>, index: N, parts: RoadmapPlannerParts<G, K, Q>) -> Self {
        let (checker, start, goals) = EdgeChecker::of(problem, PATIENCE);
        Self {
            builder: Builder::new(checker, parts.generator, parts.connector, index),
            query: parts.query,
            pace: parts.pace,
            improves: parts.improves,
            start,
            goals,
            ends: None,
            trees: EndTrees::new(parts.ends),
            iterations: 0,
            best: f64::INFINITY,
            looked: 0,
        }
    }

    /// Builds on several threads: see [`Builder::on`].
    #[must_use]
    pub fn on(self, workers: Workers, checkers: impl IntoIterator<Item = EdgeChecker<'c, C, L>>) -> Self
    where
        C::State: 'c,
        L: Send + 'c,
        L::Edge: 'c,
        G: Clone + Send + Sync + 'c,
        K: Sync,
        N: Sync,
    {
        Self { builder: self.builder.on(workers, checkers), ..self }
    }

    /// Also lets trees grow from start and goal. To be called before the first step.
    #[must_use]
    pub fn growing_ends(self, growth: EndGrowth) -> Self {
        Self { trees: EndTrees::new(growth), ..self }
    }

    /// Counts queries by `meter`: see [`Builder::metered`].
    #[must_use]
    pub fn metered(self, meter: QueryMeter<'c>) -> Self {
        Self { builder: self.builder.metered(meter), ..self }
    }

    /// The roadmap; without start and goal before the first step.
    #[must_use]
    pub fn map(&self) -> &Roadmap<C::State, L::Edge> {
        self.builder.map()
    }

    /// What builds the roadmap.
    #[must_use]
    pub fn builder(&self) -> &Builder<'c, C, L, G, K, N> {
        &self.builder
    }

    /// The builder of the roadmap, without the planner.
    #[must_use]
    pub fn into_builder(self) -> Builder<'c, C, L, G, K, N> {
        self.builder
    }

    fn begin(&mut self, observer: &mut dyn Observer<C::State>) {
        let start = self.builder.adopt(Candidate::new(self.start.clone(), MilestoneKind::End), observer);
        let mut goals = Vec::new();
        if self.goals.reached(&self.start) {
            goals.push(start);
        }
        for goal in self.goals.listed() {
            let same = *goal == self.start;
            goals.push(if same {
                start
            } else {
                self.builder.adopt(Candidate::new(goal.clone(), MilestoneKind::End), observer)
            });
        }
        self.trees.plant(start, &goals);
        self.ends = Some((start, goals));
    }

    /// Draws a goal and adds it, if it may be an end of a path.
    fn draw_goal(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) {
        let Some(goal) = self.goals.sample(rng) else { return };
        if !self.builder.checker.accepts(&goal) {
            return;
        }
        let id = self.builder.adopt(Candidate::new(goal, MilestoneKind::End), observer);
        self.add_goals(&[id]);
    }

    fn add_goals(&mut self, ids: &[NodeId]) {
        self.trees.add_goals(ids);
        if let Some((_, goals)) = &mut self.ends {
            goals.extend(ids);
        }
    }

    /// A verified path from the start to a goal, if the roadmap has one. Tells of edges that turn out to be
    /// blocked.
    fn answer(&mut self, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        let (start, goals) = self.ends.as_ref()?;
        let Builder { map, checker, .. } = &mut self.builder;
        let before = map.blocked();
        self.looked = map.len();
        let better = self.improves.then_some(self.best * (1.0 - 1e-9));
        let found = find_path(&mut self.query, map, checker, (*start, goals.as_slice()), better, observer);
        let path = found.map(|(path, length)| {
            self.best = length;
            path
        });
        for [from, to] in map.blocked_after(before).iter().map(|&edge| map.ends(edge)) {
            observer.on(Event::Unlinked { from, to });
        }
        path
    }

    /// One iteration, which may have been cut short.
    fn iterate(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.iterations += 1;
        if self.ends.is_none() {
            self.begin(observer);
            if let Some(path) = self.answer(observer) {
                return Some(path);
            }
        }
        let new = match self.trees.is_next() {
            true => self.trees.grow(&mut self.builder, rng, observer),
            false => self.builder.step(rng, observer),
        };
        if self.goals.has_region() {
            let arrived = reached(&self.goals, self.builder.map().states(), new);
            self.add_goals(&arrived);
        }
        if self.goals.has_sampler() && self.iterations % GOAL_EVERY == 1 {
            self.draw_goal(rng, observer);
        }
        if self.due() { self.answer(observer) } else { None }
    }

    /// Whether it is time to search for a path. A better path is searched for whenever there are a tenth more
    /// nodes.
    fn due(&self) -> bool {
        let nodes = self.builder.map.len();
        let better = if self.best.is_finite() && self.improves { self.looked / 10 } else { 0 };
        nodes >= self.pace.first && nodes - self.looked >= self.pace.more.max(better)
    }
}

/// Which of these states are in the goal.
fn reached<S>(goals: &Goals<'_, S>, states: &[S], ids: Range<NodeId>) -> Vec<NodeId> {
    ids.filter(|&id| goals.reached(&states[id as usize])).collect()
}

/// A verified path from the start to a goal, shorter than `better`, and its length; if the roadmap has one.
fn find_path<C, L, Q>(
    query: &mut Q,
    map: &mut Roadmap<C::State, L::Edge>,
    checker: &mut EdgeChecker<'_, C, L>,
    (start, goals): (NodeId, &[NodeId]),
    better: Option<f64>,
    observer: &mut dyn Observer<C::State>,
) -> Option<(PathOf<C, L>, f64)>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    Q: Query<C, L>,
{
    loop {
        let near: Vec<_> =
            goals.iter().filter(|&&goal| map.connected(start, goal)).map(|&goal| (goal, 0.0)).collect();
        if near.is_empty() {
            return None;
        }
        let path = query.search(map, checker, &[(start, 0.0)], &near)?;
        if better.is_some_and(|better| path.length >= better) {
            return None;
        }
        if verify(map, checker, &path) {
            return map.path(&path).map(|found| (found, path.length));
        }
        if checker.is_interrupted() {
            return None;
        }
        observer.on(Event::Rejected);
    }
}

/// Verifies the edges of a path that have not passed yet, in the direction of the path. Blocks the first that
/// fails, unless the checker was interrupted. Returns whether none did.
pub(crate) fn verify<C, L>(
    map: &mut Roadmap<C::State, L::Edge>,
    checker: &mut EdgeChecker<'_, C, L>,
    path: &GraphPath,
) -> bool
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    for (&edge, ends) in path.edges.iter().zip(path.nodes.windows(2)) {
        let backward = map.ends(edge)[0] != ends[0];
        if map.edge(edge).verified[usize::from(backward)] {
            continue;
        }
        let passes = map.motion(edge, ends[0]).is_some_and(|motion| {
            checker.passes(map.state(ends[0]), &motion.edge, &motion.end, Direction::Forward)
        });
        if !passes && checker.interrupt().raised().is_some() {
            return false;
        }
        if !passes {
            map.block(edge);
            checker.count_rejected();
            return false;
        }
        map.passed(edge, backward);
    }
    true
}

/// A planner whose roadmap can be inspected, saved and continued.
pub trait HasRoadmap<S, E>: Planner<S, Edge = E>
where
    E: Clone,
{
    /// The roadmap; without start and goal before the first step.
    fn map(&self) -> &Roadmap<S, E>;
    /// The roadmap, mutable to compute its components.
    fn map_mut(&mut self) -> &mut Roadmap<S, E>;
    /// Continues with a roadmap made by a planner of the same kind, instead of its own. To be called before
    /// the first step.
    ///
    /// # Errors
    /// When a state of it is outside the space.
    fn resume(&mut self, map: Roadmap<S, E>) -> Result<(), BuildError>;
    /// Grows the roadmap until stopped, whether or not it connects start and goal, for many queries later.
    fn build(&mut self, rng: &mut Rng, stop: &mut dyn Stop, observer: &mut dyn Observer<S>) -> StopReason;
}

impl<C, L, G, K, Q, N> HasRoadmap<C::State, L::Edge> for RoadmapPlanner<'_, C, L, G, K, Q, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    G: NodeGenerator<C, L>,
    K: Connector<C, L>,
    Q: Query<C, L>,
    N: NearestNeighbors<C>,
{
    fn map(&self) -> &Roadmap<C::State, L::Edge> {
        self.builder.map()
    }
    fn map_mut(&mut self) -> &mut Roadmap<C::State, L::Edge> {
        self.builder.map_mut()
    }
    fn resume(&mut self, map: Roadmap<C::State, L::Edge>) -> Result<(), BuildError> {
        (self.ends, self.looked) = (None, 0);
        self.builder.replace(map)
    }
    fn build(
        &mut self,
        rng: &mut Rng,
        stop: &mut dyn Stop,
        observer: &mut dyn Observer<C::State>,
    ) -> StopReason {
        let before = self.builder.progress().iterations;
        let reason = self.builder.build(rng, stop, observer);
        self.iterations += self.builder.progress().iterations - before;
        reason
    }
}

impl<C, L, G, K, Q, N> Planner<C::State> for RoadmapPlanner<'_, C, L, G, K, Q, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    G: NodeGenerator<C, L>,
    K: Connector<C, L>,
    Q: Query<C, L>,
    N: NearestNeighbors<C>,
{
    type Edge = L::Edge;

    /// An iteration that was cut short leaves the roadmap as it was before.
    fn step(&mut self, rng: &mut Rng, observer: &mut dyn Observer<C::State>) -> Option<PathOf<C, L>> {
        self.builder.map.mark();
        let path = self.iterate(rng, observer);
        if self.builder.checker.interrupt().raised().is_some() {
            self.builder.map.roll_back();
            return None;
        }
        path
    }

    fn progress(&self) -> Progress {
        let mut progress = self.builder.progress();
        progress.iterations = self.iterations;
        progress
    }

    fn improves(&self) -> bool {
        self.improves
    }
}
