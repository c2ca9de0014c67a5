//! The tree every planner of the family grows.

use mp_cspace::{Direction, Motion, NodeId, Path};

/// A forest of states and the motions between them.
///
/// Edges are kept in forward time whichever way the tree grows: in a [`Direction::Forward`] tree
/// an edge leads from the parent to the child, in a [`Direction::Backward`] tree from the child
/// to the parent. Ids are indices in order of insertion.
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
#[derive(Clone, Debug)]
pub struct Tree<S, E> {
    direction: Direction,
    states: Vec<S>,
    nodes: Vec<Node<E>>,
}

/// What there is to a node beside its state.
#[derive(Clone, Debug)]
struct Node<E> {
    cost: f64,
    link: Option<Link<E>>,
}

/// How a node hangs on its parent.
#[derive(Clone, Debug)]
struct Link<E> {
    parent: NodeId,
    edge: E,
    verified: bool,
}

impl<S, E> Tree<S, E> {
    /// An empty tree that grows in `direction`.
    #[must_use]
    pub fn new(direction: Direction) -> Self {
        Self { direction, states: Vec::new(), nodes: Vec::new() }
    }

    /// Which way the tree grows.
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

    /// The cost of the path between a node and its root.
    #[must_use]
    pub fn cost(&self, id: NodeId) -> f64 {
        self.nodes[id as usize].cost
    }

    /// Whether the edge of a node has passed verification. Roots have none to fail.
    #[must_use]
    pub fn is_verified(&self, id: NodeId) -> bool {
        self.link(id).is_none_or(|link| link.verified)
    }

    /// Notes that the edge of a node has passed verification.
    pub fn set_verified(&mut self, id: NodeId) {
        if let Some(link) = &mut self.nodes[id as usize].link {
            link.verified = true;
        }
    }

    /// Adds a root.
    pub fn add_root(&mut self, state: S) -> NodeId {
        self.insert(state, Node { cost: 0.0, link: None })
    }

    /// Adds the end of `motion` under `parent`.
    #[inline]
    pub fn push(&mut self, parent: NodeId, motion: Motion<S, E>) -> NodeId {
        let cost = self.cost(parent) + motion.cost;
        let link = Link { parent, edge: motion.edge, verified: false };
        self.insert(motion.end, Node { cost, link: Some(link) })
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

    /// The path between a node and its root, in forward time: from the root in a forward tree,
    /// to the root in a backward tree.
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

    /// Removes a node and everything that hangs on it. The others keep their order and are
    /// renumbered without gaps; the answer gives their former ids, so node `i` was `answer[i]`.
    ///
    /// Linear in the size of the tree.
    pub fn prune(&mut self, id: NodeId) -> Vec<NodeId> {
        let doomed = self.below(id);
        let mut renamed = vec![0; self.len()];
        let mut survivors = Vec::new();
        for old in 0..self.len() {
            if !doomed[old] {
                renamed[old] = survivors.len() as NodeId;
                survivors.push(old as NodeId);
            }
        }
        keep(&mut self.states, &doomed);
        keep(&mut self.nodes, &doomed);
        for link in self.nodes.iter_mut().filter_map(|node| node.link.as_mut()) {
            link.parent = renamed[link.parent as usize];
        }
        survivors
    }

    /// For each node whether it is `id` or hangs on it. Asks nothing of the order of parents and
    /// children: rewiring may put a parent after its child.
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

fn keep<T>(items: &mut Vec<T>, doomed: &[bool]) {
    let mut at = 0;
    items.retain(|_| {
        at += 1;
        !doomed[at - 1]
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
}
