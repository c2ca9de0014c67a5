//! The graph: configurations, and the motions between them.

use mp_cspace::{BuildError, Motion, NearestNeighbors, NodeId, Path, Reversible, Space};
use petgraph::graph::{EdgeIndex, NodeIndex, UnGraph};
use petgraph::unionfind::UnionFind;
use petgraph::visit::EdgeRef;

/// The kind of a node: how or why it was added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum MilestoneKind {
    /// A sample without further meaning.
    #[default]
    Plain,
    /// The start or a goal of a path.
    End,
    /// Added where connecting is difficult.
    Expanded,
    /// A guard: no other guard sees it.
    Guard,
    /// A connection: it sees guards of several components.
    Connection,
    /// In contact with an obstacle, up to a tolerance.
    Contact,
    /// Close to an obstacle.
    Near,
    /// Away from all obstacles: free in every rotation.
    Far,
    /// Was in collision, and was moved until it was free.
    Salvaged,
}

impl MilestoneKind {
    /// All kinds, each at the index that stands for it in files.
    pub const ALL: [Self; 9] = [
        Self::Plain,
        Self::End,
        Self::Expanded,
        Self::Guard,
        Self::Connection,
        Self::Contact,
        Self::Near,
        Self::Far,
        Self::Salvaged,
    ];

    /// The word for it in files, events and pictures.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::End => "end",
            Self::Expanded => "expanded",
            Self::Guard => "guard",
            Self::Connection => "connection",
            Self::Contact => "contact",
            Self::Near => "near",
            Self::Far => "far",
            Self::Salvaged => "salvaged",
        }
    }
}

/// What a node has beside its state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tag {
    /// What it is in the roadmap: planners of guards tell them from connections.
    pub kind: MilestoneKind,
    /// The obstacle it belongs to, or of a [roadmap by regions](crate::algo::regional_prm) the region, if
    /// any.
    pub obstacle: Option<u32>,
    /// How often a connection to another node was tried.
    pub tried: u32,
    /// How often that failed.
    pub failed: u32,
}

/// Whether an edge was checked, and the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinkState {
    /// Not checked by the local planner yet.
    Unchecked,
    /// The local planner has a motion.
    Free,
    /// The local planner has no motion, or the verifier rejected it: searches ignore the edge.
    Blocked,
}

/// The number of an edge: edges are numbered from 0 in the order in which they were added, and never
/// renumbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EdgeId(pub u32);

impl EdgeId {
    fn inner(self) -> EdgeIndex {
        EdgeIndex::new(self.0 as usize)
    }

    fn of(edge: EdgeIndex) -> Self {
        Self(edge.index() as u32)
    }
}

/// An edge of a roadmap, with what is known of its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Link<E> {
    /// The motion from the source of the edge to its target; `None` while it is not checked.
    pub edge: Option<E>,
    /// Its length, not negative.
    pub length: f64,
    /// Whether it was checked.
    pub state: LinkState,
    /// Whether the verifier has passed it, from source to target and from target to source.
    pub verified: [bool; 2],
}

/// A roadmap: configurations as nodes and motions as edges, which can be run in both directions.
///
/// Nodes are numbered in the order in which they were added, and never renumbered; edges are blocked rather
/// than removed. Components are kept up to date; after an edge was blocked, the next query of components
/// visits all edges.
#[derive(Clone, Debug)]
pub struct Roadmap<S, E = ()> {
    states: Vec<S>,
    graph: UnGraph<Tag, Link<E>>,
    sets: UnionFind<u32>,
    components: usize,
    /// In the order in which they were blocked.
    blocked: Vec<EdgeId>,
    stale: bool,
    /// What undoes the changes since a mark, if one is set.
    mark: Option<Mark>,
}

/// A roadmap at some moment: how many nodes, edges and blocked edges it had, and what else changed since, in
/// order.
#[derive(Clone, Debug)]
struct Mark {
    nodes: usize,
    edges: usize,
    blocked: usize,
    changes: Vec<Change>,
}

/// A change of a node or an edge, with what it was before.
#[derive(Clone, Copy, Debug)]
enum Change {
    Tag(NodeId, Tag),
    /// An edge was blocked.
    Blocked(EdgeId, LinkState),
    /// An edge without a motion, of this length, got one.
    Motion(EdgeId, f64),
    /// An edge passed the verifier in this direction.
    Passed(EdgeId, usize),
}

impl<S, E> Default for Roadmap<S, E> {
    fn default() -> Self {
        let (graph, sets) = (UnGraph::default(), UnionFind::new_empty());
        Self { states: Vec::new(), graph, sets, components: 0, blocked: Vec::new(), stale: false, mark: None }
    }
}

impl<S, E> Roadmap<S, E> {
    /// A roadmap without nodes.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// How many nodes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether there is no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// The states of all nodes, in order.
    #[must_use]
    pub fn states(&self) -> &[S] {
        &self.states
    }

    /// The state of a node.
    ///
    /// # Panics
    /// When there is no such node, as in all that takes an id.
    #[must_use]
    pub fn state(&self, id: NodeId) -> &S {
        &self.states[id as usize]
    }

    /// What a node has beside its state.
    #[must_use]
    pub fn tag(&self, id: NodeId) -> &Tag {
        &self.graph[NodeIndex::from(id)]
    }

    /// What the nodes have beside their states, in order.
    pub fn tags(&self) -> impl ExactSizeIterator<Item = &Tag> {
        self.graph.raw_nodes().iter().map(|node| &node.weight)
    }

    /// An edge.
    ///
    /// # Panics
    /// When there is no such edge, as in all that takes an id.
    #[must_use]
    pub fn edge(&self, id: EdgeId) -> &Link<E> {
        &self.graph[id.inner()]
    }

    /// All edges in order, including blocked ones, each with its two ends, source first.
    pub fn all_edges(&self) -> impl ExactSizeIterator<Item = (EdgeId, [NodeId; 2], &Link<E>)> {
        let edges = self.graph.raw_edges().iter().enumerate();
        edges.map(|(i, edge)| {
            let ends = [edge.source(), edge.target()].map(|end| end.index() as NodeId);
            (EdgeId(i as u32), ends, &edge.weight)
        })
    }

    /// How many edges there are that are not blocked.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.graph.edge_count() - self.blocked.len()
    }

    /// How many edges are blocked.
    #[must_use]
    pub fn blocked(&self) -> usize {
        self.blocked.len()
    }

    /// The edges that were blocked after the first `others`.
    pub(crate) fn blocked_after(&self, others: usize) -> &[EdgeId] {
        self.blocked.get(others..).unwrap_or_default()
    }

    /// The edges of a node that are not blocked, each with its other end.
    pub fn links(&self, id: NodeId) -> impl Iterator<Item = (EdgeId, NodeId, &Link<E>)> {
        self.links_and_blocked(id).filter(|(_, _, link)| link.state != LinkState::Blocked)
    }

    /// All edges of a node, also blocked ones.
    pub(crate) fn links_and_blocked(&self, id: NodeId) -> impl Iterator<Item = (EdgeId, NodeId, &Link<E>)> {
        let edges = self.graph.edges(NodeIndex::from(id));
        edges.map(|edge| (EdgeId::of(edge.id()), edge.target().index() as NodeId, edge.weight()))
    }

    /// Adds a node, which is a component of its own.
    pub fn add(&mut self, state: S, tag: Tag) -> NodeId {
        self.states.push(state);
        self.graph.add_node(tag);
        self.sets.new_set();
        self.components += 1;
        (self.states.len() - 1) as NodeId
    }

    /// Adds the edge of a motion between two nodes.
    pub fn link(&mut self, from: NodeId, to: NodeId, edge: E, length: f64) -> EdgeId {
        self.insert(from, to, Link { edge: Some(edge), length, state: LinkState::Free, verified: [false; 2] })
    }

    /// Adds an edge that is not checked yet, with the length it will have.
    pub fn guess(&mut self, from: NodeId, to: NodeId, length: f64) -> EdgeId {
        self.insert(from, to, Link { edge: None, length, state: LinkState::Unchecked, verified: [false; 2] })
    }

    pub(crate) fn insert(&mut self, from: NodeId, to: NodeId, link: Link<E>) -> EdgeId {
        let joins = link.state != LinkState::Blocked;
        let edge = self.graph.add_edge(NodeIndex::from(from), NodeIndex::from(to), link);
        let edge = EdgeId::of(edge);
        if !joins {
            self.blocked.push(edge);
        } else if !self.stale && self.sets.union(from, to) {
            self.components -= 1;
        }
        edge
    }

    /// Whether there is an edge between two nodes, blocked or not.
    #[must_use]
    pub fn has_link(&self, a: NodeId, b: NodeId) -> bool {
        self.graph.contains_edge(NodeIndex::from(a), NodeIndex::from(b))
    }

    /// The two ends of an edge, source first.
    #[must_use]
    pub fn ends(&self, edge: EdgeId) -> [NodeId; 2] {
        let (a, b) = self.graph.edge_endpoints(edge.inner()).unwrap_or_default();
        [a.index() as NodeId, b.index() as NodeId]
    }

    /// Marks an edge as blocked.
    pub fn block(&mut self, edge: EdgeId) {
        let link = &mut self.graph[edge.inner()];
        if link.state != LinkState::Blocked {
            let before = std::mem::replace(&mut link.state, LinkState::Blocked);
            self.stale = true;
            self.blocked.push(edge);
            self.note(Change::Blocked(edge, before));
        }
    }

    /// Sets the motion of an edge that was not checked before.
    pub fn set_motion(&mut self, edge: EdgeId, motion: E, length: f64) {
        let link = &mut self.graph[edge.inner()];
        if link.state == LinkState::Unchecked {
            let before = link.length;
            (link.edge, link.length, link.state) = (Some(motion), length, LinkState::Free);
            self.note(Change::Motion(edge, before));
        }
    }

    pub(crate) fn passed(&mut self, edge: EdgeId, backward: bool) {
        let way = usize::from(backward);
        if !std::mem::replace(&mut self.graph[edge.inner()].verified[way], true) {
            self.note(Change::Passed(edge, way));
        }
    }

    /// Counts an attempt to connect two nodes, or one node to something not in the roadmap.
    pub(crate) fn tried(&mut self, id: NodeId, failed: bool) {
        self.tried_often(id, 1, u32::from(failed));
    }

    /// Counts `tried` attempts, of which `failed` failed.
    pub(crate) fn tried_often(&mut self, id: NodeId, tried: u32, failed: u32) {
        let tag = &mut self.graph[NodeIndex::from(id)];
        let before = *tag;
        tag.tried = tag.tried.saturating_add(tried);
        tag.failed = tag.failed.saturating_add(failed);
        self.note(Change::Tag(id, before));
    }

    fn note(&mut self, change: Change) {
        if let Some(mark) = &mut self.mark {
            mark.changes.push(change);
        }
    }

    /// Sets a mark, to which [`roll_back`](Self::roll_back) returns, in place of one set before.
    pub(crate) fn mark(&mut self) {
        let mut changes = self.mark.take().map(|mark| mark.changes).unwrap_or_default();
        changes.clear();
        let (nodes, edges, blocked) = (self.states.len(), self.graph.edge_count(), self.blocked.len());
        self.mark = Some(Mark { nodes, edges, blocked, changes });
    }

    /// Undoes all changes since the mark.
    pub(crate) fn roll_back(&mut self) {
        let Some(Mark { nodes, edges, blocked, changes }) = self.mark.take() else { return };
        for change in changes.into_iter().rev() {
            match change {
                Change::Tag(id, tag) => self.graph[NodeIndex::from(id)] = tag,
                Change::Blocked(edge, state) => self.graph[edge.inner()].state = state,
                Change::Motion(edge, length) => {
                    let link = &mut self.graph[edge.inner()];
                    (link.edge, link.length, link.state) = (None, length, LinkState::Unchecked);
                }
                Change::Passed(edge, way) => self.graph[edge.inner()].verified[way] = false,
            }
        }
        // The last edge or node can be removed without another being renumbered.
        for edge in (edges..self.graph.edge_count()).rev() {
            self.graph.remove_edge(EdgeIndex::new(edge));
        }
        for node in (nodes..self.states.len()).rev() {
            self.graph.remove_node(NodeIndex::new(node));
        }
        self.states.truncate(nodes);
        self.blocked.truncate(blocked);
        self.stale = true;
    }

    /// Recomputes the components, if an edge was blocked.
    pub(crate) fn refresh(&mut self) {
        if !self.stale {
            return;
        }
        self.sets = UnionFind::new(self.states.len());
        self.components = self.states.len();
        for edge in self.graph.raw_edges() {
            let ends = [edge.source(), edge.target()].map(|end| end.index() as u32);
            if edge.weight.state != LinkState::Blocked && self.sets.union(ends[0], ends[1]) {
                self.components -= 1;
            }
        }
        self.stale = false;
    }

    /// The component of a node, named by one of its nodes.
    pub fn component(&mut self, id: NodeId) -> NodeId {
        self.refresh();
        self.sets.find_mut(id)
    }

    /// The component of a node, in a roadmap that is [refreshed](Self::refresh).
    pub(crate) fn component_now(&self, id: NodeId) -> NodeId {
        self.sets.find(id)
    }

    /// Whether two nodes are in the same component.
    pub fn connected(&mut self, a: NodeId, b: NodeId) -> bool {
        self.component(a) == self.component(b)
    }

    /// How many components there are.
    pub fn components(&mut self) -> usize {
        self.refresh();
        self.components
    }

    /// How many nodes each component has, the largest first.
    pub fn component_sizes(&mut self) -> Vec<usize> {
        self.refresh();
        let mut count = vec![0; self.states.len()];
        for id in 0..self.states.len() as NodeId {
            count[self.sets.find_mut(id) as usize] += 1;
        }
        count.retain(|&size| size > 0);
        count.sort_unstable_by(|a, b| b.cmp(a));
        count
    }
}

impl<S, E> Roadmap<S, E> {
    /// # Errors
    /// When a node is outside the space.
    pub(crate) fn check_within<C: Space<State = S>>(&self, space: &C) -> Result<(), BuildError>
    where
        S: std::fmt::Debug,
    {
        match self.states.iter().find(|q| !space.contains(q)) {
            None => Ok(()),
            Some(q) => {
                let reason = format!("a node of the roadmap is outside the space: {q:?}");
                Err(BuildError::Unmade { reason })
            }
        }
    }

    /// Clears an index and fills it with all nodes.
    ///
    /// # Errors
    /// When a node is outside the space.
    pub(crate) fn fill<C: Space<State = S>>(
        &self,
        space: &C,
        index: &mut impl NearestNeighbors<C>,
    ) -> Result<(), BuildError>
    where
        S: std::fmt::Debug,
    {
        self.check_within(space)?;
        index.clear();
        (0..self.states.len() as NodeId).for_each(|id| index.inserted(space, &self.states, id));
        Ok(())
    }

    /// Adds all nodes and edges of another roadmap; nothing of it counts as verified.
    pub(crate) fn append(&mut self, other: &Self)
    where
        S: Clone,
        E: Clone,
    {
        let before = self.states.len() as NodeId;
        for (state, tag) in other.states.iter().zip(other.tags()) {
            self.add(state.clone(), *tag);
        }
        for (_, [a, b], link) in other.all_edges() {
            self.insert(a + before, b + before, Link { verified: [false; 2], ..link.clone() });
        }
    }
}

/// A path in the graph: the nodes it visits and the edges between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GraphPath {
    /// The nodes, one more than edges.
    pub nodes: Vec<NodeId>,
    /// The edges from the first node to the last.
    pub edges: Vec<EdgeId>,
    /// The sum of the lengths of its edges, in the metric of the space.
    pub length: f64,
}

impl<S: Clone, E: Clone + Reversible> Roadmap<S, E> {
    /// The motion along an edge that leaves `from`, if the edge has one.
    #[must_use]
    pub fn motion(&self, edge: EdgeId, from: NodeId) -> Option<Motion<S, E>> {
        let link = &self.graph[edge.inner()];
        let [a, b] = self.ends(edge);
        let run = link.edge.as_ref()?;
        let (end, edge) = if from == a { (b, run.clone()) } else { (a, run.reversed()) };
        Some(Motion { end: self.state(end).clone(), edge, cost: link.length })
    }

    /// The path of states along a path in the graph; `None` when one of its edges has no motion.
    #[must_use]
    pub fn path(&self, path: &GraphPath) -> Option<Path<S, E>> {
        let mut states = vec![self.state(*path.nodes.first()?).clone()];
        let mut edges = Vec::with_capacity(path.edges.len());
        for (&edge, &from) in path.edges.iter().zip(&path.nodes) {
            let motion = self.motion(edge, from)?;
            states.push(motion.end);
            edges.push(motion.edge);
        }
        Some(Path { states, edges })
    }
}
