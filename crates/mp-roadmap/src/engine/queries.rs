//! Many queries to one roadmap.

use super::forest::Forest;
use super::planner::verify;
use super::{AStar, Builder, EdgeChecker, EdgeId, GraphPath, LinkState, Query, Roadmap};
use mp_cspace::shortest::shortest_paths;
use mp_cspace::{
    BuildError, Direction, Endpoint, Hit, LocalPlanner, Motion, NearestNeighbors, NodeId, Path, Reversible,
    Space,
};

/// Why a query has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unanswered {
    /// An end is outside the space.
    #[error("the {0} is outside the space")]
    Outside(Endpoint),
    /// An end is not free, or too close to something for the local planner.
    #[error("the {0} is not free")]
    NotFree(Endpoint),
    /// No node near an end can be connected to it: the roadmap needs more nodes there.
    #[error("no node of the roadmap near the {0} can be connected to it")]
    Unreached(Endpoint),
    /// Both ends are connected, to different components: the roadmap needs more nodes between.
    #[error("start and goal are connected to different components of the roadmap")]
    Apart,
}

/// A roadmap that answers queries; it does not grow by them.
///
/// To answer, start and goal are connected to one of the nodes nearest to them, in order of distance, such
/// that both are in one component, and a shortest way between is looked for. The path is verified; edges
/// that passed once are not verified again, and one that fails is blocked for good. A direct motion from
/// start to goal is tried first.
#[derive(Debug)]
pub struct RoadmapQueries<'c, C: Space, L: LocalPlanner<C::State>, N> {
    checker: EdgeChecker<'c, C, L>,
    indexed: IndexedRoadmap<C::State, L::Edge, N>,
}

/// A roadmap, an index of its nodes and what searches have learnt: what of [`RoadmapQueries`] outlives a local planner. It
/// answers the same queries to whoever brings one, always for the same space and scene.
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
    /// What was built, to answer queries; each end is connected to one of its `neighbours` nearest nodes.
    #[must_use]
    pub fn into_answers(self, neighbours: usize) -> RoadmapQueries<'c, C, L, N> {
        let Self { checker, map, index, .. } = self;
        RoadmapQueries { checker, indexed: IndexedRoadmap::filled(map, index, neighbours) }
    }
}

/// A motion from one state to another, and the states.
type Hop<S, E> = (S, Motion<S, E>);

/// Paths and their lengths.
pub type Listed<S, E> = Vec<(Path<S, E>, f64)>;

/// How the ends of a path hang on the roadmap.
struct Joined<S, E> {
    first: Hop<S, E>,
    last: Hop<S, E>,
    nodes: [NodeId; 2],
}

impl<'c, C, L, N> RoadmapQueries<'c, C, L, N>
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
    N: NearestNeighbors<C>,
{
    /// Of a roadmap made before, with an empty index. Each end of a query is connected to one of its
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

    /// The roadmap.
    #[must_use]
    pub fn map(&self) -> &Roadmap<C::State, L::Edge> {
        &self.indexed.map
    }

    /// The roadmap alone, with what was learnt about its edges.
    #[must_use]
    pub fn into_map(self) -> Roadmap<C::State, L::Edge> {
        self.indexed.map
    }

    /// Motions asked of the local planner so far.
    #[must_use]
    pub fn motions(&self) -> u64 {
        self.checker.motions()
    }

    /// A verified path from `start` to `goal`.
    ///
    /// # Errors
    /// When there is none in the roadmap, with the reason.
    pub fn answer(
        &mut self,
        start: &C::State,
        goal: &C::State,
    ) -> Result<Path<C::State, L::Edge>, Unanswered> {
        self.indexed.answer(&mut self.checker, start, goal)
    }

    /// As [`IndexedRoadmap::alternatives`].
    ///
    /// # Errors
    /// When there is none in the roadmap, with the reason.
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
    /// Of a roadmap whose nodes the index holds already.
    fn filled(map: Roadmap<S, E>, index: N, neighbours: usize) -> Self {
        let (star, forest) = (AStar::new(), Forest::default());
        Self { map, index, star, forest, neighbours, near: Default::default() }
    }

    /// The roadmap.
    #[must_use]
    pub fn map(&self) -> &Roadmap<S, E> {
        &self.map
    }

    /// The roadmap, to ask for its components.
    pub fn map_mut(&mut self) -> &mut Roadmap<S, E> {
        &mut self.map
    }

    /// The roadmap alone, with what was learnt about its edges.
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
    /// Of a roadmap made before, with an empty index. Each end of a query is connected to one of its `neighbours`
    /// nearest nodes.
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

    /// Verifies all edges now, in both directions, so that no query waits for it; those that fail are blocked. How many
    /// did. Edges that were only guessed are checked first.
    ///
    /// A planner of one path is better off with the verification of that path; of thousands each edge is on
    /// many, and until it has been on one the query pays. Takes time by the number of edges not verified yet.
    pub fn verify<C, L>(&mut self, checker: &mut EdgeChecker<'_, C, L>) -> usize
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
    {
        let before = self.map.blocked();
        let edges: Vec<EdgeId> = self.map.all_edges().map(|(edge, ..)| edge).collect();
        for edge in edges {
            if self.map.edge(edge).state == LinkState::Blocked {
                continue;
            }
            let [a, b] = self.map.ends(edge);
            for nodes in [vec![a, b], vec![b, a]] {
                let way = GraphPath { nodes, edges: vec![edge], length: self.map.edge(edge).length };
                if !self.star.check(&mut self.map, checker, &way) || !verify(&mut self.map, checker, &way) {
                    break;
                }
            }
        }
        self.map.blocked() - before
    }

    /// A verified path from `start` to `goal`.
    ///
    /// # Errors
    /// When there is none in the roadmap, with the reason.
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
        self.prepare(checker, start, goal)?;
        if let Some(motion) = checker.reach(start, goal, Direction::Forward)
            && checker.passes(start, &motion.edge, goal, Direction::Forward)
        {
            return Ok(Path { states: vec![start.clone(), goal.clone()], edges: vec![motion.edge] });
        }
        loop {
            let ends = self.join(checker, start, goal)?;
            let way = self.way(checker, ends.nodes);
            // Without a way a lazy search has blocked what connected the ends.
            if let Some(way) = way
                && verify(&mut self.map, checker, &way)
                && let Some(path) = self.map.path(&way)
            {
                return Ok(whole(&ends, path));
            }
        }
    }

    /// A shortest way between two nodes, all of whose edges have motions.
    fn way<C, L>(&mut self, checker: &mut EdgeChecker<'_, C, L>, [from, to]: [NodeId; 2]) -> Option<GraphPath>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        if !self.forest.holds(&mut self.map) {
            return self.star.search(&mut self.map, checker, &[(from, 0.0)], &[(to, 0.0)]);
        }
        let way = self.forest.way(&self.map, from, to)?;
        self.star.check(&mut self.map, checker, &way).then_some(way)
    }

    /// At most `k` verified paths from `start` to `goal` with their lengths, the shortest first. They begin and
    /// end with the same motions, and visit no node twice (Yen 1971). A roadmap without cycles has only
    /// one.
    ///
    /// Takes time by the size of the roadmap, and a search for each node of each path.
    ///
    /// # Errors
    /// When there is none in the roadmap, with the reason.
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
        self.prepare(checker, start, goal)?;
        loop {
            let ends = self.join(checker, start, goal)?;
            if let Some(ways) = self.ways(checker, ends.nodes, k) {
                let more = ends.first.1.cost + ends.last.1.cost;
                let paths = ways.iter().filter_map(|way| Some((self.map.path(way)?, way.length + more)));
                return Ok(paths.map(|(path, length)| (whole(&ends, path), length)).collect());
            }
        }
    }

    /// The shortest ways between two nodes, all of whose edges are verified; `None` when some edge had to be
    /// blocked on the way.
    fn ways<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        [from, to]: [NodeId; 2],
        k: usize,
    ) -> Option<Vec<GraphPath>>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        let part = self.map.component(from);
        let mut arcs: Vec<Vec<(u32, f64)>> = vec![Vec::new(); self.map.len()];
        for node in 0..self.map.len() as NodeId {
            if self.map.component(node) == part {
                let out = &mut arcs[node as usize];
                out.extend(self.map.links(node).map(|(_, end, link)| (end, link.length)));
                out.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
                out.dedup_by_key(|arc| arc.0);
            }
        }
        let mut ways = Vec::new();
        for (length, nodes) in shortest_paths(&arcs, from, to, k) {
            let edges =
                nodes.windows(2).map(|pair| self.shortest_edge(pair[0], pair[1])).collect::<Option<_>>()?;
            let way = GraphPath { nodes, edges, length };
            if !self.star.check(&mut self.map, checker, &way) {
                return None;
            }
            if !verify(&mut self.map, checker, &way) {
                return None;
            }
            ways.push(way);
        }
        Some(ways)
    }

    fn shortest_edge(&self, from: NodeId, to: NodeId) -> Option<EdgeId> {
        let between = self.map.links(from).filter(|(_, end, _)| *end == to);
        let shortest = between.min_by(|a, b| a.2.length.total_cmp(&b.2.length).then(a.0.cmp(&b.0)));
        shortest.map(|(edge, ..)| edge)
    }

    /// Looks at the ends, and for the nodes nearest to them.
    fn prepare<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        start: &S,
        goal: &S,
    ) -> Result<(), Unanswered>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        for (i, (endpoint, q)) in [(Endpoint::Start, start), (Endpoint::Goal, goal)].into_iter().enumerate() {
            if !checker.space().contains(q) {
                return Err(Unanswered::Outside(endpoint));
            }
            if !checker.admits(q) {
                return Err(Unanswered::NotFree(endpoint));
            }
            let (space, states) = (checker.space(), self.map.states());
            self.index.k_nearest(space, states, q, self.neighbours, &mut self.near[i]);
        }
        Ok(())
    }

    /// Connects both ends to the same component. Neighbours that do not do are dropped for the rest of
    /// the query.
    fn join<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        start: &S,
        goal: &S,
    ) -> Result<Joined<S, E>, Unanswered>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        let mut reached = [false; 2];
        loop {
            let [from, to] = &self.near;
            let shares = |hit: &&Hit, map: &mut Roadmap<_, _>| {
                let part = map.component(hit.id);
                to.iter().any(|other| map.component(other.id) == part)
            };
            let Some(&first) = from.iter().find(|hit| shares(hit, &mut self.map)) else {
                return Err(self.why(checker, start, goal, reached));
            };
            let Some(ahead) = self.hop(checker, start, first.id, false) else {
                self.near[0].retain(|hit| hit.id != first.id);
                continue;
            };
            reached[0] = true;
            let part = self.map.component(first.id);
            while let Some(&last) = self.near[1].iter().find(|hit| self.map.component(hit.id) == part) {
                if let Some(behind) = self.hop(checker, goal, last.id, true) {
                    return Ok(Joined { first: ahead, last: behind, nodes: [first.id, last.id] });
                }
                self.near[1].retain(|hit| hit.id != last.id);
            }
        }
    }

    /// Why the ends cannot be joined.
    fn why<C, L>(
        &mut self,
        checker: &mut EdgeChecker<'_, C, L>,
        start: &S,
        goal: &S,
        reached: [bool; 2],
    ) -> Unanswered
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
        N: NearestNeighbors<C>,
    {
        for (i, (endpoint, q)) in [(Endpoint::Start, start), (Endpoint::Goal, goal)].into_iter().enumerate() {
            let near = self.near[i].clone();
            if !reached[i] && !near.iter().any(|hit| self.hop(checker, q, hit.id, i == 1).is_some()) {
                return Unanswered::Unreached(endpoint);
            }
        }
        Unanswered::Apart
    }

    /// A verified motion from an end to a node, or with `back` from the node to it.
    fn hop<C, L>(
        &self,
        checker: &mut EdgeChecker<'_, C, L>,
        q: &S,
        node: NodeId,
        back: bool,
    ) -> Option<Hop<S, E>>
    where
        C: Space<State = S>,
        L: LocalPlanner<S, Edge = E>,
    {
        let (from, to) = if back { (self.map.state(node), q) } else { (q, self.map.state(node)) };
        let motion = checker.reach(from, to, Direction::Forward)?;
        checker.passes(from, &motion.edge, to, Direction::Forward).then(|| (from.clone(), motion))
    }
}

/// A path with what leads to its beginning and on from its end.
fn whole<S: Clone, E: Clone>(ends: &Joined<S, E>, path: Path<S, E>) -> Path<S, E> {
    let (mut states, mut edges) = (vec![ends.first.0.clone()], vec![ends.first.1.edge.clone()]);
    states.extend(path.states);
    edges.extend(path.edges);
    states.push(ends.last.1.end.clone());
    edges.push(ends.last.1.edge.clone());
    Path { states, edges }
}
