//! Shortest paths in a roadmap.

use super::{EdgeChecker, EdgeId, GraphPath, LinkState, Roadmap};
use mp_cspace::{Direction, Interrupt, LocalPlanner, NodeId, Reversible, Space};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A node where a path may begin or end, and the length of the motion between it and the start or goal.
pub type Entry = (NodeId, f64);

/// Slot: how a path in the roadmap is searched for.
pub trait Query<C: Space, L: LocalPlanner<C::State>> {
    /// A shortest path from one of `from` to one of `to`, all of whose edges have motions of the local
    /// planner. May block edges that turn out to have none.
    fn search(
        &mut self,
        map: &mut Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        from: &[Entry],
        to: &[Entry],
    ) -> Option<GraphPath>;
}

/// An entry of the queue: the least estimate first, ties by node.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Open {
    estimate: f64,
    length: f64,
    node: NodeId,
}

impl Eq for Open {}
impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.estimate.total_cmp(&self.estimate).then(other.node.cmp(&self.node))
    }
}
impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The state of a node in the search numbered `search`.
#[derive(Clone, Copy, Debug)]
struct Mark {
    search: u32,
    length: f64,
    rest: f64,
    via: Option<EdgeId>,
}

const UNSEEN: Mark = Mark { search: 0, length: f64::INFINITY, rest: 0.0, via: None };

/// A* (Hart, Nilsson and Raphael 1968, *A formal basis for the heuristic determination of minimum cost
/// paths*), with the distance to the ends as heuristic. Memory is reused from search to search, so that the
/// cost of a search depends only on the nodes it visits.
///
/// Paths are shortest where no edge is shorter than the distance between its ends. Under a distance that
/// violates the triangle inequality, nodes are visited again when a shorter path to them is found.
#[derive(Clone, Debug, Default)]
pub struct AStar {
    marks: Vec<Mark>,
    open: BinaryHeap<Open>,
    search: u32,
    interrupt: Interrupt,
}

/// With more ends than this the heuristic costs more than it saves.
const FEW: usize = 8;

impl AStar {
    /// A search without memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A shortest path from one of `from` to one of `to`, each with the length that is added there; `None`
    /// when there is none. Ties by node.
    pub fn shortest<C: Space, E>(
        &mut self,
        map: &Roadmap<C::State, E>,
        space: &C,
        from: &[Entry],
        to: &[Entry],
    ) -> Option<GraphPath> {
        self.marks.resize(self.marks.len().max(map.len()), UNSEEN);
        self.search = self.search.wrapping_add(1);
        if self.search == 0 {
            self.marks.fill(UNSEEN);
            self.search = 1;
        }
        self.open.clear();
        let estimate = |node: NodeId| {
            if to.len() > FEW {
                return 0.0;
            }
            let over = |&(end, more): &Entry| space.distance(map.state(node), map.state(end)) + more;
            to.iter().map(over).fold(f64::INFINITY, f64::min)
        };
        for &(node, length) in from {
            self.push(node, length, None, estimate);
        }
        let mut best: Option<(f64, NodeId)> = None;
        while let Some(Open { estimate: total, length, node }) = self.open.pop() {
            if best.is_some_and(|(least, _)| total >= least) {
                break;
            }
            if self.interrupt.ask() {
                return None;
            }
            if length > self.marks[node as usize].length {
                continue;
            }
            for &(end, more) in to.iter().filter(|(end, _)| *end == node) {
                if best.is_none_or(|(least, _)| length + more < least) {
                    best = Some((length + more, end));
                }
            }
            for (edge, next, link) in map.links(node) {
                self.push(next, length + link.length, Some(edge), estimate);
            }
        }
        let (length, end) = best?;
        let mut path = GraphPath { nodes: vec![end], edges: Vec::new(), length };
        let mut at = end;
        while let Some(edge) = self.marks[at as usize].via {
            let [a, b] = map.ends(edge);
            at = if at == a { b } else { a };
            path.nodes.push(at);
            path.edges.push(edge);
        }
        path.nodes.reverse();
        path.edges.reverse();
        Some(path)
    }

    #[inline]
    fn push(&mut self, node: NodeId, length: f64, via: Option<EdgeId>, estimate: impl Fn(NodeId) -> f64) {
        let mark = &mut self.marks[node as usize];
        if mark.search == self.search {
            if length >= mark.length {
                return;
            }
            (mark.length, mark.via) = (length, via);
        } else {
            *mark = Mark { search: self.search, length, rest: estimate(node), via };
        }
        self.open.push(Open { estimate: length + mark.rest, length, node });
    }
}

impl<C, L> Query<C, L> for AStar
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    /// Checks the unchecked edges of the path found, and searches again when some are blocked.
    fn search(
        &mut self,
        map: &mut Roadmap<C::State, L::Edge>,
        checker: &mut EdgeChecker<'_, C, L>,
        from: &[Entry],
        to: &[Entry],
    ) -> Option<GraphPath> {
        self.interrupt = checker.interrupt().clone();
        loop {
            let path = self.shortest(map, checker.space(), from, to)?;
            if check(map, checker, &path) {
                return Some(path);
            }
            if checker.is_interrupted() {
                return None;
            }
        }
    }
}

/// The numbers below `n`, alternately from both ends to the middle.
fn inward(n: usize) -> impl Iterator<Item = usize> {
    (0..n).map(move |i| if i % 2 == 0 { i / 2 } else { n - 1 - i / 2 })
}

/// Checks the unchecked edges of a path. Blocks those that fail, unless the checker was interrupted. Returns
/// whether none did.
pub(crate) fn check<C, L>(
    map: &mut Roadmap<C::State, L::Edge>,
    checker: &mut EdgeChecker<'_, C, L>,
    path: &GraphPath,
) -> bool
where
    C: Space,
    L: LocalPlanner<C::State, Edge: Reversible>,
{
    let mut all = true;
    for edge in inward(path.edges.len()).map(|i| path.edges[i]) {
        if map.edge(edge).state != LinkState::Unchecked {
            continue;
        }
        let [a, b] = map.ends(edge);
        let motion = checker.reach(map.state(a), map.state(b), Direction::Forward);
        let failed = motion.is_none();
        if failed && checker.interrupt().raised().is_some() {
            return false;
        }
        map.tried(a, failed);
        map.tried(b, failed);
        match motion {
            Some(motion) => map.set_motion(edge, motion.edge, motion.cost),
            None => {
                map.block(edge);
                all = false;
            }
        }
    }
    all
}
