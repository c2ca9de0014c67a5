//! The only path between two nodes of a roadmap without cycles.

use super::{EdgeId, GraphPath, Roadmap};
use mp_cspace::NodeId;

/// The parents of the nodes in the trees of a roadmap without cycles, by which the path between two nodes is
/// found in time linear in their depth. A* would visit much of the tree, as distances say little about the
/// only path.
#[derive(Clone, Debug, Default)]
pub(crate) struct Forest {
    /// How many nodes, edges and blocked edges the roadmap had when this was computed.
    of: Option<[usize; 3]>,
    cycles: bool,
    /// The edge to the parent, and the parent.
    up: Vec<Option<(EdgeId, NodeId)>>,
    depth: Vec<u32>,
}

impl Forest {
    /// Updates this where the roadmap has changed. Returns whether the roadmap is a forest.
    pub(crate) fn holds<S, E>(&mut self, map: &mut Roadmap<S, E>) -> bool {
        let now = [map.len(), map.edges(), map.blocked()];
        if self.of != Some(now) {
            self.of = Some(now);
            self.cycles = map.edges() + map.components() != map.len();
            if !self.cycles {
                self.root_trees(map);
            }
        }
        !self.cycles
    }

    /// Makes the first node of each tree its root.
    fn root_trees<S, E>(&mut self, map: &Roadmap<S, E>) {
        self.up = vec![None; map.len()];
        self.depth = vec![u32::MAX; map.len()];
        let mut next = Vec::new();
        for root in 0..map.len() as NodeId {
            if self.depth[root as usize] != u32::MAX {
                continue;
            }
            self.depth[root as usize] = 0;
            next.push(root);
            while let Some(node) = next.pop() {
                for (edge, other, _) in map.links(node) {
                    if self.depth[other as usize] == u32::MAX {
                        self.depth[other as usize] = self.depth[node as usize] + 1;
                        self.up[other as usize] = Some((edge, node));
                        next.push(other);
                    }
                }
            }
        }
    }

    /// The path from one node to another of a roadmap that this [holds](Self::holds); `None` when they are in
    /// different trees. Linear in the depth of the nodes.
    pub(crate) fn path<S, E>(&self, map: &Roadmap<S, E>, from: NodeId, to: NodeId) -> Option<GraphPath> {
        let (mut a, mut b) = (from, to);
        let (mut head, mut tail) = (Vec::new(), Vec::new());
        while a != b {
            let (at, steps) = match self.depth[a as usize] >= self.depth[b as usize] {
                true => (&mut a, &mut head),
                false => (&mut b, &mut tail),
            };
            let (edge, parent) = self.up[*at as usize]?;
            steps.push((*at, edge));
            *at = parent;
        }
        let nodes = head.iter().map(|step| step.0).chain([a]).chain(tail.iter().rev().map(|step| step.0));
        let edges: Vec<EdgeId> = head.iter().chain(tail.iter().rev()).map(|step| step.1).collect();
        let length = edges.iter().map(|&edge| map.edge(edge).length).sum();
        Some(GraphPath { nodes: nodes.collect(), edges, length })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{AStar, Tag};
    use mp_cspace::{Rn, Rng, Space};
    use rand::RngExt;

    /// The same paths as A* finds, before and after an edge is blocked; none where there are cycles.
    #[test]
    fn ways_are_those_of_a_star() {
        let space = Rn::<2>::new([0.0; 2], [1.0; 2]).unwrap();
        let mut rng = Rng::seed(1);
        for _ in 0..50 {
            let (mut map, mut forest) = (Roadmap::new(), Forest::default());
            let n = 60;
            for id in 0..n {
                map.add(space.sample_uniform(&mut rng), Tag::default());
                if id > 0 && rng.random_bool(0.9) {
                    let other = rng.random_range(0..id);
                    let length = space.distance(map.state(id), map.state(other));
                    map.link(id, other, (), length);
                }
            }
            let mut agree = |map: &mut Roadmap<_>, rng: &mut Rng| {
                assert!(forest.holds(map));
                for _ in 0..20 {
                    let (a, b) = (rng.random_range(0..n), rng.random_range(0..n));
                    let star = AStar::new().shortest(map, &space, &[(a, 0.0)], &[(b, 0.0)]);
                    let path = forest.path(map, a, b);
                    let parts = |path: &GraphPath| (path.nodes.clone(), path.edges.clone());
                    assert_eq!(path.as_ref().map(parts), star.as_ref().map(parts));
                    let lengths = path.zip(star).map(|(w, s)| (w.length - s.length).abs());
                    assert!(lengths.is_none_or(|off| off < 1e-12));
                }
            };
            agree(&mut map, &mut rng);
            let edge = EdgeId(7);
            map.block(edge);
            agree(&mut map, &mut rng);
            let ends = map.ends(EdgeId(0));
            map.link(ends[0], ends[1], (), 0.1);
            assert!(!forest.holds(&mut map));
        }
    }
}
