//! Many queries on one roadmap.

use super::forest::Forest;
use super::planner::verify;
use super::search::check;
use super::{AStar, Builder, EdgeChecker, EdgeId, GraphPath, LinkState, Query, Roadmap};
use mp_cspace::shortest::{shortest_paths, shortest_via};
use mp_cspace::{
    BuildError, Direction, Endpoint, Hit, LocalPlanner, Motion, NearestNeighbors, NodeId, Path, PathOf,
    Reversible, Space,
};

/// Why a query has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unanswered {
    /// An end is outside the space.
    #[error("the {0} is outside the space")]
    Outside(Endpoint),
    /// An end is not free, or too close to an obstacle for the local planner.
    #[error("the {0} is not free")]
    NotFree(Endpoint),
    /// No node near an end can be connected to it: the roadmap needs more nodes there.
    #[error("no node of the roadmap near the {0} can be connected to it")]
    Unreached(Endpoint),
    /// The ends are connected to different components: the roadmap needs more nodes between them.
    #[error("start and goal are connected to different components of the roadmap")]
    Apart,
}

/// A roadmap that answers queries; it does not grow by them.
///
/// A query first tries a direct motion from start to goal. Then start and goal are each connected to one of
/// their nearest nodes, in order of distance, such that both are in one component, and a shortest path
/// between these nodes is searched for. The path is verified; edges that passed once are not verified again,
/// and an edge that fails is blocked permanently.
#[derive(Debug)]
pub struct RoadmapQueries<'c, C: Space, L: LocalPlanner<C::State>, N> {
    checker: EdgeChecker<'c, C, L>,
    indexed: IndexedRoadmap<C::State, L::Edge, N>,
}

/// A roadmap, an index of its nodes and the memory of searches: [`RoadmapQueries`] without the edge checker,
/// which each query brings along, always for the same space and scene.
#[derive(Clone, Debug)]
pub struct IndexedRoadmap<S, E, N> {
    map: Roadmap<S, E>,
    index: N,
    star: AStar,
    forest: Forest,
    neighbours: usize,
    near: [Vec<Hit>; 2],
}

impl<'c, C, L, G, K, N> Builder<'c, C, L, G, K, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    /// The roadmap that was built, to answer queries; each end is connected to one of its `neighbours`
    /// nearest nodes.
    #[must_use]
    pub fn into_answers(self, neighbours: usize) -> RoadmapQueries<'c, C, L, N> {
        let Self { checker, map, index, .. } = self;
        RoadmapQueries { checker, indexed: IndexedRoadmap::filled(map, index, neighbours) }
    }
}

/// The state where a motion begins, and the motion.
type Connection<S, E> = (S, Motion<S, E>);

/// Paths and their lengths.
pub type Listed<S, E> = Vec<(Path<S, E>, f64)>;

/// The motions that connect the ends of a path to the roadmap, and the nodes they lead to.
struct ConnectedEnds<S, E> {
    first: Connection<S, E>,
    last: Connection<S, E>,
    nodes: [NodeId; 2],
}

impl<'c, C, L, N> RoadmapQueries<'c, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    /// A roadmap built before, with an empty index. Each end of a query is connected to one of its
    /// `neighbours` nearest nodes.
    ///
    /// # Errors
    /// When a node is outside the space, as of a roadmap for another one.
    pub fn new(
        checker: EdgeChecker<'c, C, L>,
        map: Roadmap<C::State, L::Edge>,
        index: N,
        neighbours: usize,
    ) -> Result<Self, BuildError> {
        let indexed = IndexedRoadmap::new(checker.space(), map, index, neighbours)?;
        Ok(Self { checker, indexed })
    }

    /// As [`IndexedRoadmap::verify`].
    pub fn verify(&mut self) -> usize {
        self.indexed.verify(&mut self.checker)
    }

    /// The roadmap that answers; its edges are marked as they are verified.
    #[must_use]
    pub fn map(&self) -> &Roadmap<C::State, L::Edge> {
        &self.indexed.map
    }

    /// The roadmap, with the states of its edges as queries have found them.
    #[must_use]
    pub fn into_map(self) -> Roadmap<C::State, L::Edge> {
        self.indexed.map
    }

    /// How many motions the local planner was asked for.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.checker.motions()
    }

    /// A verified path from `start` to `goal`.
    ///
    /// # Errors
    /// When the roadmap has no such path, with the reason.
    pub fn answer(&mut self, start: &C::State, goal: &C::State) -> Result<PathOf<C, L>, Unanswered> {
        self.indexed.answer(&mut self.checker, start, goal)
    }

    /// As [`IndexedRoadmap::alternatives`].
    ///
    /// # Errors
    /// When the roadmap has no such path, with the reason.
    pub fn alternatives(
        &mut self,
        start: &C::State,
        goal: &C::State,
        k: usize,
    ) -> Result<Listed<C::State, L::Edge>, Unanswered> {
        self.indexed.alternatives(&mut self.checker, start, goal, k)
    }
}

impl<S, E, N> IndexedRoadmap<S, E, N> {
    /// A roadmap whose nodes are in the index already.
    fn filled(map: Roadmap<S, E>, index: N, neighbours: usize) -> Self {
        let (star, forest) = (AStar::new(), Forest::default());
        Self { map, index, star, forest, neighbours, near: Default::default() }
    }

    /// The roadmap that answers.
    #[must_use]
    pub fn map(&self) -> &Roadmap<S, E> {
        &self.map
    }

    /// The roadmap, mutable to compute its components.
    pub fn map_mut(&mut self) -> &mut Roadmap<S, E> {
        &mut self.map
    }

    /// The roadmap, with the states of its edges as queries have found them.
    #[must_use]
    pub fn into_map(self) -> Roadmap<S, E> {
        self.map
    }
}

impl<S, E, N> IndexedRoadmap<S, E, N>
where
    S: Clone + PartialEq + std::fmt::Debug + Send + Sync,
    E: Clone + Reversible,
{
    /// A roadmap built before, with an empty index. Each end of a query is connected to one of its
    /// `neighbours` nearest nodes.
    ///
    /// # Errors
    /// When a node is outside the space, as of a roadmap for another one.
    pub fn new<C: Space<State = S>>(
        space: &C,
        map: Roadmap<S, E>,
        mut index: N,
        neighbours: usize,
    ) -> Result<Self, BuildError>
    where
        N: NearestNeighbors<C>,
    {
        map.fill(space, &mut index)?;
        Ok(Self::filled(map, index, neighbours))
    }

    /// Verifies all edges now, in both directions, so that no query waits for it. Edges that were only
    /// guessed are checked first; edges that fail are blocked. Returns how many were blocked. Ends early when
    /// the checker is interrupted.
    ///
    /// Pays off for thousands of queries, where each edge is on many paths; for a single path verify only
    /// that path. Takes time by the number of edges not verified yet.
    pub fn verify<C, L>(&mut self, checker: &mut EdgeChecker<'_, C, L>) -> usize
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
    {
        let before = self.map.blocked();
        let edges: Vec<EdgeId> = self.map.all_edges().map(|(edge, ..)| edge).collect();
        for edge in edges {
            if checker.is_interrupted() {
                break;
            }
            if self.map.edge(edge).state == LinkState::Blocked {
                continue;
            }
            let [a, b] = self.map.ends(edge);
            for nodes in [vec![a, b], vec![b, a]] {
                let path = GraphPath { nodes, edges: vec![edge], length: self.map.edge(edge).length };
                if !check(&mut self.map, checker, &path) || !verify(&mut self.map, checker, &path) {
                    break;
                }
            }
        }
        self.map.blocked() - before
    }

    /// A verified path from `start` to `goal`.
    ///
    /// # Errors
    /// When the roadmap has no such path, with the reason.
    pub fn answer<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        start: &S,
        goal: &S,
    ) -> Result<Path<S, E>, Unanswered>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        RunningQuery { roadmap: self, checker, ends: [start, goal] }.answer()
    }

    /// At most `k` verified paths from `start` to `goal` with their lengths, the shortest first. They begin
    /// and end with the same motions, and visit no node twice (Yen 1971). A roadmap without cycles has only
    /// one.
    ///
    /// Takes time by the size of the roadmap, and a search for each node of each path.
    ///
    /// # Errors
    /// When the roadmap has no such path, with the reason.
    pub fn alternatives<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        start: &S,
        goal: &S,
        k: usize,
    ) -> Result<Listed<S, E>, Unanswered>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        RunningQuery { roadmap: self, checker, ends: [start, goal] }.alternatives(k)
    }

    /// At most `k` verified paths from `start` to `goal` that are far apart, with their lengths. The first is
    /// the shortest. Each further one is the shortest path through a node that is farther than `apart`, in
    /// the metric of the space, from all paths before it. The parts to and from that node are shortest paths.
    /// There is no detour at the node: within a length of `apart` before and behind it no path is shorter
    /// (Abraham, Delling, Goldberg and Werneck 2013). They begin and end with the same motions. A roadmap
    /// without cycles has only one.
    ///
    /// # Errors
    /// When the roadmap has no path, with the reason.
    pub fn routes<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        [start, goal]: [&S; 2],
        k: usize,
        apart: f64,
    ) -> Result<Listed<S, E>, Unanswered>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        RunningQuery { roadmap: self, checker, ends: [start, goal] }
            .listed(|query, nodes| query.far_apart(nodes, k, apart))
    }
}

/// A query that is being answered: the roadmap, how motions are checked, start and goal.
struct RunningQuery<'a, 'c, C: Space, L: LocalPlanner<C::State>, N> {
    roadmap: &'a mut IndexedRoadmap<C::State, L::Edge, N>,
    checker: &'a mut EdgeChecker<'c, C, L>,
    ends: [&'a C::State; 2],
}

/// What [`RunningQuery::ends`] are called in errors.
const ENDPOINTS: [Endpoint; 2] = [Endpoint::Start, Endpoint::Goal(0)];

impl<C, L, N> RunningQuery<'_, '_, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    fn answer(mut self) -> Result<PathOf<C, L>, Unanswered> {
        self.prepare()?;
        let [start, goal] = self.ends;
        if start == goal {
            return Ok(Path { states: vec![start.clone()], edges: Vec::new() });
        }
        if let Some(motion) = self.verified(start, goal) {
            return Ok(Path { states: vec![start.clone(), goal.clone()], edges: vec![motion.edge] });
        }
        loop {
            let ends = self.connect_ends()?;
            // Where there is no path, a lazy search has blocked what connected the ends.
            if let Some(path) = self.shortest(ends.nodes)
                && verify(&mut self.roadmap.map, self.checker, &path)
                && let Some(path) = self.roadmap.map.path(&path)
            {
                return Ok(with_ends(&ends, path));
            }
        }
    }

    fn alternatives(self, k: usize) -> Result<Listed<C::State, L::Edge>, Unanswered> {
        self.listed(|query, nodes| query.shortest_paths(nodes, k))
    }

    /// The paths that `choose` finds between two nodes, with the motions from the start and to the goal. It
    /// is called again when it returns `None`, as an edge had to be blocked.
    fn listed(
        mut self,
        choose: impl Fn(&mut Self, [NodeId; 2]) -> Option<Vec<GraphPath>>,
    ) -> Result<Listed<C::State, L::Edge>, Unanswered> {
        self.prepare()?;
        loop {
            let ends = self.connect_ends()?;
            if let Some(found) = choose(&mut self, ends.nodes) {
                let more = ends.first.1.cost + ends.last.1.cost;
                let map = &self.roadmap.map;
                let paths = found.iter().filter_map(|path| Some((map.path(path)?, path.length + more)));
                return Ok(paths.map(|(path, length)| (with_ends(&ends, path), length)).collect());
            }
        }
    }

    /// Checks the ends, and finds the nodes nearest to them.
    fn prepare(&mut self) -> Result<(), Unanswered> {
        for (i, q) in self.ends.into_iter().enumerate() {
            if !self.checker.space().contains(q) {
                return Err(Unanswered::Outside(ENDPOINTS[i]));
            }
            if !self.checker.admits(q) {
                return Err(Unanswered::NotFree(ENDPOINTS[i]));
            }
            let IndexedRoadmap { map, index, neighbours, near, .. } = &mut *self.roadmap;
            index.k_nearest(self.checker.space(), map.states(), q, *neighbours, &mut near[i]);
        }
        Ok(())
    }

    /// Connects both ends to the same component. Neighbours to which this fails are dropped for the rest of
    /// the query.
    fn connect_ends(&mut self) -> Result<ConnectedEnds<C::State, L::Edge>, Unanswered> {
        let mut reached = [false; 2];
        loop {
            let IndexedRoadmap { map, near: [from, to], .. } = &mut *self.roadmap;
            let shares = |hit: &&Hit| {
                let component = map.component(hit.id);
                to.iter().any(|other| map.component(other.id) == component)
            };
            let Some(&first) = from.iter().find(shares) else {
                return Err(self.reason(reached));
            };
            let Some(entry) = self.connection(0, first.id) else {
                self.roadmap.near[0].retain(|hit| hit.id != first.id);
                continue;
            };
            reached[0] = true;
            let component = self.roadmap.map.component(first.id);
            while let Some(last) = self.last_in(component) {
                if let Some(exit) = self.connection(1, last) {
                    return Ok(ConnectedEnds { first: entry, last: exit, nodes: [first.id, last] });
                }
                self.roadmap.near[1].retain(|hit| hit.id != last);
            }
        }
    }

    /// The node of a component that is nearest to the goal, of those left to try.
    fn last_in(&mut self, component: NodeId) -> Option<NodeId> {
        let IndexedRoadmap { map, near, .. } = &mut *self.roadmap;
        near[1].iter().map(|hit| hit.id).find(|&id| map.component(id) == component)
    }

    /// Why the ends cannot be joined.
    fn reason(&mut self, reached: [bool; 2]) -> Unanswered {
        for end in 0..2 {
            let near = self.roadmap.near[end].clone();
            if !reached[end] && !near.iter().any(|hit| self.connection(end, hit.id).is_some()) {
                return Unanswered::Unreached(ENDPOINTS[end]);
            }
        }
        Unanswered::Apart
    }

    /// A verified motion from the start to a node (`end` 0), or from a node to the goal (`end` 1).
    fn connection(&mut self, end: usize, node: NodeId) -> Option<Connection<C::State, L::Edge>> {
        let node = self.roadmap.map.state(node).clone();
        let (from, to) = if end == 1 { (&node, self.ends[1]) } else { (self.ends[0], &node) };
        Some((from.clone(), self.verified(from, to)?))
    }

    /// A motion that the local planner has and the verifier passes.
    fn verified(&mut self, from: &C::State, to: &C::State) -> Option<Motion<C::State, L::Edge>> {
        let motion = self.checker.reach(from, to, Direction::Forward)?;
        self.checker.passes(from, &motion.edge, to, Direction::Forward).then_some(motion)
    }

    /// A shortest path between two nodes, all of whose edges have motions.
    fn shortest(&mut self, [from, to]: [NodeId; 2]) -> Option<GraphPath> {
        let IndexedRoadmap { map, star, forest, .. } = &mut *self.roadmap;
        if !forest.holds(map) {
            return star.search(map, self.checker, &[(from, 0.0)], &[(to, 0.0)]);
        }
        let path = forest.path(map, from, to)?;
        check(map, self.checker, &path).then_some(path)
    }

    /// The shortest paths between two nodes, all of whose edges are verified; `None` when an edge had to be
    /// blocked.
    fn shortest_paths(&mut self, [from, to]: [NodeId; 2], k: usize) -> Option<Vec<GraphPath>> {
        let arcs = self.arcs(from);
        let found = shortest_paths(&arcs, from, to, k, self.checker.interrupt());
        found.into_iter().map(|(length, nodes)| self.checked(length, nodes)).collect()
    }

    /// The arcs that leave each node of the component of a node.
    fn arcs(&mut self, from: NodeId) -> Vec<Vec<(u32, f64)>> {
        let map = &mut self.roadmap.map;
        let component = map.component(from);
        let mut arcs: Vec<Vec<(u32, f64)>> = vec![Vec::new(); map.len()];
        for node in 0..map.len() as NodeId {
            if map.component(node) == component {
                let out = &mut arcs[node as usize];
                out.extend(map.links(node).map(|(_, end, link)| (end, link.length)));
                out.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
                out.dedup_by_key(|arc| arc.0);
            }
        }
        arcs
    }

    /// The path through these nodes, if all of its edges are verified; `None` when one had to be blocked.
    fn checked(&mut self, length: f64, nodes: Vec<u32>) -> Option<GraphPath> {
        let map = &mut self.roadmap.map;
        let edges =
            nodes.windows(2).map(|pair| shortest_edge(map, pair[0], pair[1])).collect::<Option<_>>()?;
        let path = GraphPath { nodes, edges, length };
        let free = check(map, self.checker, &path) && verify(map, self.checker, &path);
        free.then_some(path)
    }

    /// Paths between two nodes that are far apart, all of whose edges are verified; `None` when an edge had
    /// to be blocked.
    fn far_apart(&mut self, [from, to]: [NodeId; 2], k: usize, apart: f64) -> Option<Vec<GraphPath>> {
        let arcs = self.arcs(from);
        let mut open: Vec<NodeId> =
            (0..arcs.len() as NodeId).filter(|&id| !arcs[id as usize].is_empty()).collect();
        let mut paths = Vec::new();
        while paths.len() < k {
            let via = open.iter().copied();
            let interrupt = self.checker.interrupt();
            let Some((length, nodes)) = shortest_via(&arcs, [from, to], apart, via, interrupt) else { break };
            let path = self.checked(length, nodes)?;
            let (map, space) = (&self.roadmap.map, self.checker.space());
            let on = path.nodes.windows(2).flat_map(|pair| {
                let [a, b] = [pair[0], pair[1]].map(|id| map.state(id));
                // A quarter of the distance asked for.
                let pieces = (4.0 * space.distance(a, b) / apart).ceil().clamp(1.0, 1e3) as u32;
                (0..=pieces).map(move |i| space.interpolate(a, b, f64::from(i) / f64::from(pieces)))
            });
            let on: Vec<C::State> = on.collect();
            open.retain(|&id| on.iter().all(|q| space.distance(q, map.state(id)) > apart));
            paths.push(path);
        }
        Some(paths)
    }
}

fn shortest_edge<S, E>(map: &Roadmap<S, E>, from: NodeId, to: NodeId) -> Option<EdgeId> {
    let between = map.links(from).filter(|(_, end, _)| *end == to);
    let shortest = between.min_by(|a, b| a.2.length.total_cmp(&b.2.length).then(a.0.cmp(&b.0)));
    shortest.map(|(edge, ..)| edge)
}

/// A path through the roadmap, with the motions from the start and to the goal.
fn with_ends<S: Clone, E: Clone>(ends: &ConnectedEnds<S, E>, path: Path<S, E>) -> Path<S, E> {
    let (mut states, mut edges) = (vec![ends.first.0.clone()], vec![ends.first.1.edge.clone()]);
    states.extend(path.states);
    edges.extend(path.edges);
    states.push(ends.last.1.end.clone());
    edges.push(ends.last.1.edge.clone());
    Path { states, edges }
}
