//! A tree of axis-aligned boxes over edges.

use super::edge::Edge;
use nalgebra::{Point2, Vector2};

/// Edges in a leaf.
const LEAF: usize = 4;

#[derive(Clone, Copy, Debug)]
struct Node {
    low: Point2<f64>,
    high: Point2<f64>,
    /// Of a leaf the position of its first edge; otherwise the index of the second child (the first child comes next).
    from: u32,
    /// Zero for inner nodes.
    count: u32,
}

impl Node {
    fn squared(&self, p: &Point2<f64>) -> f64 {
        (self.low - p).sup(&(p - self.high)).sup(&Vector2::zeros()).norm_squared()
    }
}

/// A tree over edges, which are named by their index in the slice it was made of.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeTree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl EdgeTree {
    /// Halves the longer side of each box at the median: O(n log² n).
    pub(super) fn new(edges: &[Edge]) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..edges.len() as u32).collect() };
        if !edges.is_empty() {
            tree.split(edges, 0, edges.len());
        }
        tree
    }

    fn split(&mut self, edges: &[Edge], from: usize, to: usize) {
        let (mut low, mut high) = (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2]));
        for i in &self.order[from..to] {
            let [l, h] = edges[*i as usize].bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        let here = self.nodes.len();
        self.nodes.push(Node { low, high, from: from as u32, count: (to - from) as u32 });
        if to - from <= LEAF {
            return;
        }
        let axis = usize::from(high.y - low.y > high.x - low.x);
        let middle = |i: &u32| {
            let edge = &edges[*i as usize];
            edge.a[axis] + edge.b[axis]
        };
        let half = (from + to) / 2;
        self.order[from..to].sort_by(|i, j| middle(i).total_cmp(&middle(j)).then(i.cmp(j)));
        self.split(edges, from, half);
        self.nodes[here].from = self.nodes.len() as u32;
        self.nodes[here].count = 0;
        self.split(edges, half, to);
    }

    /// Calls `visit` with edges that may be less than the square root of `within` from `p`, nearer boxes first;
    /// it returns the new `within`, at most the old.
    pub(super) fn near(&self, p: &Point2<f64>, mut within: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        // Split at medians, the tree is no deeper than log₂ of the number of edges.
        let mut open = [(0_u32, 0.0_f64); 64];
        let mut count = usize::from(!self.nodes.is_empty());
        while count > 0 {
            count -= 1;
            let (at, squared) = open[count];
            if squared > within {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                for i in &self.order[node.from as usize..(node.from + node.count) as usize] {
                    within = visit(*i, within);
                }
                continue;
            }
            let children = [at + 1, node.from].map(|i| (i, self.nodes[i as usize].squared(p)));
            let nearer = usize::from(children[1].1 < children[0].1);
            open[count] = children[1 - nearer];
            open[count + 1] = children[nearer];
            count += 2;
        }
    }
}
