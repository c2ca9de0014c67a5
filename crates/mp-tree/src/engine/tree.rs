//! The tree every planner of the family grows.

use mp_cspace::{Direction, Motion, NodeId, Path};

/// A forest of states and the motions between them.
///
/// Edges are stored in forward time in either direction of growth: in a [`Direction::Forward`] tree an edge
/// leads from the parent to the child, in a [`Direction::Backward`] tree from the child to the parent. Ids
/// are indices in order of insertion.
///
/// ```
/// use mp_cspace::{Direction, Motion};
/// use mp_tree::Tree;
/// let mut tree = Tree::new(Direction::Backward);
/// let goal = tree.add_root(9.0);
/// let a = tree.push(goal, Motion { end: 5.0, edge: "5 to 9", cost: 4.0 });
/// let b = tree.push(a, Motion { end: 3.0, edge: "3 to 5", cost: 2.0 });
/// assert_eq!(tree.cost(b), 6.0);
/// assert_eq!(tree.path(b).states, [3.0, 5.0, 9.0]);
/// assert_eq!(tree.path(b).edges, ["3 to 5", "5 to 9"]);
/// ```
///
/// With the feature `serde` trees are serialized and deserialized; a deserialized edge does not count as
/// verified.
#[derive(Clone, Debug)]
pub struct Tree<S, E> {
    direction: Direction,
    states: Vec<S>,
    nodes: Vec<Node<E>>,
}

/// What a node has beside its state.
#[derive(Clone, Debug)]
struct Node<E> {
    cost: f64,
    link: Option<Link<E>>,
    /// The child added last, or [`NONE`].
    child: NodeId,
    /// The child of the same parent added before, or [`NONE`].
    sibling: NodeId,
}

/// In place of an index, where there is no such node.
const NONE: NodeId = NodeId::MAX;

/// The connection of a node to its parent.
#[derive(Clone, Debug)]
struct Link<E> {
    parent: NodeId,
    edge: E,
    cost: f64,
    verified: bool,
}

impl<S, E> Tree<S, E> {
    /// An empty tree that grows in `direction`.
    #[must_use]
    pub fn new(direction: Direction) -> Self {
        Self { direction, states: Vec::new(), nodes: Vec::new() }
    }

    /// The direction in which the tree grows.
    #[must_use]
    pub fn direction(&self) -> Direction {
        self.direction
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether there is no node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// All states, by id.
    #[must_use]
    pub fn states(&self) -> &[S] {
        &self.states
    }

    /// The state of a node.
    ///
    /// # Panics
    /// This and the other accessors panic when there is no node `id`.
    #[must_use]
    pub fn state(&self, id: NodeId) -> &S {
        &self.states[id as usize]
    }

    /// The parent of a node, `None` for a root.
    #[must_use]
    pub fn parent(&self, id: NodeId) -> Option<NodeId> {
        self.link(id).map(|link| link.parent)
    }

    /// The edge between a node and its parent, in forward time; `None` for a root.
    #[must_use]
    pub fn edge(&self, id: NodeId) -> Option<&E> {
        self.link(id).map(|link| &link.edge)
    }

    /// The cost of the edge between a node and its parent; `None` for a root.
    #[must_use]
    pub fn edge_cost(&self, id: NodeId) -> Option<f64> {
        self.link(id).map(|link| link.cost)
    }

    /// The cost of the path between a node and its root.
    #[must_use]
    pub fn cost(&self, id: NodeId) -> f64 {
        self.nodes[id as usize].cost
    }

    /// Whether the edge of a node has passed verification; true for roots, which have no edge.
    #[must_use]
    pub fn is_verified(&self, id: NodeId) -> bool {
        self.link(id).is_none_or(|link| link.verified)
    }

    /// Records that the edge of a node has passed verification.
    pub fn set_verified(&mut self, id: NodeId) {
        if let Some(link) = &mut self.nodes[id as usize].link {
            link.verified = true;
        }
    }

    /// Adds a node without a parent, at cost zero.
    pub fn add_root(&mut self, state: S) -> NodeId {
        self.insert(state, Node { cost: 0.0, link: None, child: NONE, sibling: NONE })
    }

    /// Adds the end of `motion` under `parent`.
    #[inline]
    pub fn push(&mut self, parent: NodeId, motion: Motion<S, E>) -> NodeId {
        let cost = self.cost(parent) + motion.cost;
        let link = Link { parent, edge: motion.edge, cost: motion.cost, verified: false };
        let sibling = std::mem::replace(&mut self.nodes[parent as usize].child, self.states.len() as NodeId);
        self.insert(motion.end, Node { cost, link: Some(link), child: NONE, sibling })
    }

    /// Gives node `id` another parent, by an edge (in forward time) of the given cost, and updates the costs
    /// in the subtree of `id`. The new edge is not verified yet; edges below keep their state. Returns
    /// `false` and changes nothing where that would make a cycle: `parent` is in the subtree of `id`.
    ///
    /// Linear in the depth of `parent`, the children of the former parent and the size of the subtree of
    /// `id`.
    pub fn reparent(&mut self, id: NodeId, parent: NodeId, edge: E, cost: f64) -> bool {
        if self.lineage(parent).any(|node| node == id) {
            return false;
        }
        if let Some(former) = self.parent(id) {
            self.unlink(id, former);
        }
        let sibling = std::mem::replace(&mut self.nodes[parent as usize].child, id);
        let node = &mut self.nodes[id as usize];
        (node.sibling, node.link) = (sibling, Some(Link { parent, edge, cost, verified: false }));
        let mut stack = vec![id];
        while let Some(at) = stack.pop() {
            let Node { link: Some(link), .. } = &self.nodes[at as usize] else { continue };
            self.nodes[at as usize].cost = self.cost(link.parent) + link.cost;
            stack.extend(self.children(at));
        }
        true
    }

    /// The children of a node, the latest first.
    pub fn children(&self, id: NodeId) -> impl Iterator<Item = NodeId> {
        let next = |at: NodeId| (at != NONE).then_some(at);
        std::iter::successors(next(self.nodes[id as usize].child), move |&at| {
            next(self.nodes[at as usize].sibling)
        })
    }

    /// The tree of these states, each with its parent, edge and cost, or `None` for roots; in linear time.
    /// Every parent must be one of the nodes.
    ///
    /// # Errors
    /// A node that is its own ancestor.
    #[cfg(feature = "serde")]
    pub(super) fn from_links(
        direction: Direction,
        states: Vec<S>,
        links: Vec<Option<(NodeId, E, f64)>>,
    ) -> Result<Self, NodeId> {
        let link = |(parent, edge, cost)| Link { parent, edge, cost, verified: false };
        let node = |l: Option<_>| Node { cost: 0.0, link: l.map(link), child: NONE, sibling: NONE };
        let mut tree = Self { direction, states, nodes: links.into_iter().map(node).collect() };
        for id in 0..tree.len() as NodeId {
            if let Some(parent) = tree.parent(id) {
                tree.nodes[id as usize].sibling =
                    std::mem::replace(&mut tree.nodes[parent as usize].child, id);
            }
        }
        let mut reached = vec![false; tree.len()];
        let mut stack: Vec<NodeId> =
            (0..tree.len() as NodeId).filter(|&id| tree.link(id).is_none()).collect();
        while let Some(at) = stack.pop() {
            reached[at as usize] = true;
            if let Some(link) = tree.link(at) {
                tree.nodes[at as usize].cost = tree.cost(link.parent) + link.cost;
            }
            stack.extend(tree.children(at));
        }
        match reached.iter().position(|reached| !reached) {
            Some(id) => Err(id as NodeId),
            None => Ok(tree),
        }
    }

    /// Removes `id` from the list of children of `parent`.
    fn unlink(&mut self, id: NodeId, parent: NodeId) {
        let after = self.nodes[id as usize].sibling;
        match self.children(parent).take_while(|&child| child != id).last() {
            Some(before) => self.nodes[before as usize].sibling = after,
            None => self.nodes[parent as usize].child = after,
        }
    }

    #[inline]
    fn insert(&mut self, state: S, node: Node<E>) -> NodeId {
        let id = self.states.len() as NodeId;
        self.states.push(state);
        self.nodes.push(node);
        id
    }

    fn link(&self, id: NodeId) -> Option<&Link<E>> {
        self.nodes[id as usize].link.as_ref()
    }

    /// The nodes from `id` up to its root, both included.
    pub fn lineage(&self, id: NodeId) -> impl Iterator<Item = NodeId> {
        std::iter::successors(Some(id), |&node| self.parent(node))
    }

    /// The nodes from `id` up to its root whose edges are not verified.
    pub(super) fn doubtful(&self, id: NodeId) -> Vec<NodeId> {
        self.lineage(id).filter(|&node| !self.is_verified(node)).collect()
    }

    /// The path between a node and its root, in forward time: from the root in a forward tree, to the root in
    /// a backward tree.
    #[must_use]
    pub fn path(&self, id: NodeId) -> Path<S, E>
    where
        S: Clone,
        E: Clone,
    {
        let mut states: Vec<S> = self.lineage(id).map(|node| self.state(node).clone()).collect();
        let mut edges: Vec<E> = self.lineage(id).filter_map(|node| self.edge(node).cloned()).collect();
        if self.direction == Direction::Forward {
            states.reverse();
            edges.reverse();
        }
        Path { states, edges }
    }

    /// Removes a node with its subtree. The other nodes keep their order and are renumbered without gaps.
    /// Returns their former ids: what is now node `i` was node `answer[i]`.
    ///
    /// Linear in the size of the tree.
    pub fn prune(&mut self, id: NodeId) -> Vec<NodeId> {
        if let Some(parent) = self.parent(id) {
            self.unlink(id, parent);
        }
        let removed = self.below(id);
        let mut renamed = vec![0; self.len()];
        let mut survivors = Vec::new();
        for old in 0..self.len() {
            if !removed[old] {
                renamed[old] = survivors.len() as NodeId;
                survivors.push(old as NodeId);
            }
        }
        keep(&mut self.states, &removed);
        keep(&mut self.nodes, &removed);
        let rename = |at: &mut NodeId| *at = if *at == NONE { NONE } else { renamed[*at as usize] };
        for node in &mut self.nodes {
            node.link.iter_mut().for_each(|link| rename(&mut link.parent));
            rename(&mut node.child);
            rename(&mut node.sibling);
        }
        survivors
    }

    /// For each node whether it is in the subtree of `id`. Works for any order of parents and children:
    /// rewiring may put a parent after its child.
    fn below(&self, id: NodeId) -> Vec<bool> {
        let mut known: Vec<Option<bool>> = vec![None; self.len()];
        known[id as usize] = Some(true);
        let mut climbed = Vec::new();
        for node in 0..self.len() as NodeId {
            let mut at = node;
            let answer = loop {
                if let Some(answer) = known[at as usize] {
                    break answer;
                }
                climbed.push(at);
                match self.parent(at) {
                    Some(parent) => at = parent,
                    None => break false,
                }
            };
            for node in climbed.drain(..) {
                known[node as usize] = Some(answer);
            }
        }
        known.into_iter().map(|below| below == Some(true)).collect()
    }
}

fn keep<T>(items: &mut Vec<T>, removed: &[bool]) {
    let mut at = 0;
    items.retain(|_| {
        at += 1;
        !removed[at - 1]
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(end: i32) -> Motion<i32, i32> {
        Motion { end, edge: end * 10, cost: 1.0 }
    }

    ///  0 ─ 1 ─ 3 ─ 5
    ///   \─ 2 ─ 4
    fn sample(direction: Direction) -> Tree<i32, i32> {
        let mut tree = Tree::new(direction);
        let root = tree.add_root(0);
        let one = tree.push(root, motion(1));
        let two = tree.push(root, motion(2));
        let three = tree.push(one, motion(3));
        tree.push(two, motion(4));
        tree.push(three, motion(5));
        tree
    }

    #[test]
    fn paths_run_in_forward_time() {
        let forward = sample(Direction::Forward);
        assert_eq!(forward.path(5), Path { states: vec![0, 1, 3, 5], edges: vec![10, 30, 50] });
        let backward = sample(Direction::Backward);
        assert_eq!(backward.path(5), Path { states: vec![5, 3, 1, 0], edges: vec![50, 30, 10] });
        assert_eq!(backward.path(0), Path { states: vec![0], edges: vec![] });
        assert_eq!(forward.cost(5), 3.0);
    }

    #[test]
    fn pruning_removes_the_subtree_and_renumbers() {
        let mut tree = sample(Direction::Forward);
        tree.set_verified(4);
        assert_eq!(tree.prune(1), [0, 2, 4]);
        assert_eq!(tree.states(), [0, 2, 4]);
        assert_eq!((tree.parent(0), tree.parent(1), tree.parent(2)), (None, Some(0), Some(1)));
        assert_eq!(tree.path(2), Path { states: vec![0, 2, 4], edges: vec![20, 40] });
        assert!(tree.is_verified(2) && !tree.is_verified(1));
        let next = tree.push(2, motion(6));
        assert_eq!(tree.path(next).states, [0, 2, 4, 6]);
    }

    #[test]
    fn pruning_a_leaf_or_a_root() {
        let mut tree = sample(Direction::Forward);
        assert_eq!(tree.prune(5), [0, 1, 2, 3, 4]);
        let other = tree.add_root(7);
        tree.push(other, motion(8));
        assert_eq!(tree.prune(0), [5, 6]);
        assert_eq!(tree.path(1).states, [7, 8]);
    }

    #[test]
    fn a_new_parent_changes_the_costs_of_all_below() {
        for direction in [Direction::Forward, Direction::Backward] {
            let mut tree = sample(direction);
            (1..6).for_each(|id| tree.set_verified(id));
            assert!(tree.reparent(3, 4, 34, 0.25));
            assert_eq!((tree.parent(3), tree.edge(3)), (Some(4), Some(&34)));
            assert_eq!((tree.cost(3), tree.cost(5), tree.cost(1)), (2.25, 3.25, 1.0));
            let verified: Vec<bool> = (0..6).map(|id| tree.is_verified(id)).collect();
            assert_eq!(verified, [true, true, true, false, true, true]);
            let mut path = Path { states: vec![0, 2, 4, 3, 5], edges: vec![20, 40, 34, 50] };
            if direction == Direction::Backward {
                path.states.reverse();
                path.edges.reverse();
            }
            assert_eq!(tree.path(5), path);
        }
    }

    #[test]
    fn a_root_may_be_hung_on_another_tree() {
        let mut tree = sample(Direction::Forward);
        let root = tree.add_root(9);
        let below = tree.push(root, motion(10));
        assert!(tree.reparent(root, 5, 0, 0.5));
        assert_eq!((tree.cost(root), tree.cost(below)), (3.5, 4.5));
    }

    #[test]
    fn no_ring_is_made() {
        let mut tree = sample(Direction::Forward);
        for (id, parent) in [(1, 5), (1, 1), (0, 4)] {
            let before = format!("{tree:?}");
            assert!(!tree.reparent(id, parent, 0, 0.0));
            assert_eq!(format!("{tree:?}"), before);
        }
    }

    /// After any sequence of changes, children are those whose parent it is, and costs add up.
    #[test]
    fn children_and_costs_agree_with_parents() {
        let mut tree = Tree::new(Direction::Forward);
        tree.add_root(0);
        let mut seed = 1_u32;
        let mut pick = |n: usize| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) % n as u32
        };
        for round in 0..3000 {
            let (a, b) = (pick(tree.len()), pick(tree.len()));
            match pick(20) {
                0 if a > 0 && tree.len() > 30 => drop(tree.prune(a)),
                0..9 => drop(tree.reparent(a, b, round, f64::from(pick(8)) / 4.0)),
                _ => drop(tree.push(a, Motion { end: round, edge: round, cost: f64::from(pick(8)) / 4.0 })),
            }
            let mut found = 0;
            for id in 0..tree.len() as NodeId {
                for child in tree.children(id) {
                    assert_eq!(tree.parent(child), Some(id));
                    found += 1;
                }
                let cost: f64 = tree.lineage(id).filter_map(|at| tree.link(at)).map(|link| link.cost).sum();
                assert_eq!(tree.cost(id), cost);
            }
            let hanging = (0..tree.len() as NodeId).filter(|&id| tree.parent(id).is_some()).count();
            assert_eq!(found, hanging);
        }
        assert!(tree.len() > 10);
    }
}
