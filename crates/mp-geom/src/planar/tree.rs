//! A tree of axis-aligned boxes over edges.

use super::edge::Edge;
use mp_stop::Interrupt;
use nalgebra::{Point2, Vector2};
use std::cmp::Ordering;

/// Edges in a leaf.
const LEAF: usize = 4;

#[derive(Clone, Copy, Debug)]
struct Node {
    low: Point2<f64>,
    high: Point2<f64>,
    /// Of a leaf the position of its first edge; otherwise the index of the second child (the first child
    /// comes next).
    from: u32,
    /// Zero for inner nodes.
    count: u32,
}

impl Node {
    fn squared(&self, p: &Point2<f64>) -> f64 {
        (self.low - p).sup(&(p - self.high)).sup(&Vector2::zeros()).norm_squared()
    }
}

/// As many items are sorted without a question in between.
const AT_ONCE: usize = 1 << 14;

/// Sorts, unless `interrupt` says to end: then the items are in any order.
fn sort(items: &mut [u32], order: impl Fn(&u32, &u32) -> Ordering + Copy, interrupt: &mut Interrupt) {
    if items.len() <= AT_ONCE {
        return items.sort_by(order);
    }
    let (low, high) = items.split_at_mut(items.len() / 2);
    sort(low, order, interrupt);
    sort(high, order, interrupt);
    if interrupt.ask() {
        return;
    }
    let (mut left, mut right) = (low.iter().peekable(), high.iter().peekable());
    let mut merged = Vec::with_capacity(left.len() + right.len());
    loop {
        if merged.len().is_multiple_of(AT_ONCE) && interrupt.ask() {
            return;
        }
        let next = match (left.peek(), right.peek()) {
            (Some(i), Some(j)) if order(i, j).is_gt() => right.next(),
            (Some(_), _) => left.next(),
            (None, _) => right.next(),
        };
        let Some(next) = next else { break };
        merged.push(*next);
    }
    items.copy_from_slice(&merged);
}

/// A tree over edges, which are named by their index in the slice it was made of.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeTree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl EdgeTree {
    /// Halves the longer side of each box at the median: O(n log² n). Not to be used when `interrupt` has
    /// said to end.
    pub(super) fn new(edges: &[Edge], interrupt: &mut Interrupt) -> Self {
        let mut tree = Self { nodes: Vec::new(), order: (0..edges.len() as u32).collect() };
        if !edges.is_empty() {
            tree.split(edges, 0, edges.len(), interrupt);
        }
        tree
    }

    fn split(&mut self, edges: &[Edge], from: usize, to: usize, interrupt: &mut Interrupt) {
        let (mut low, mut high) = (Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2]));
        for i in &self.order[from..to] {
            let [l, h] = edges[*i as usize].bounds();
            (low, high) = (low.inf(&l), high.sup(&h));
        }
        let here = self.nodes.len();
        self.nodes.push(Node { low, high, from: from as u32, count: (to - from) as u32 });
        if to - from <= LEAF || interrupt.ask() {
            return;
        }
        let axis = usize::from(high.y - low.y > high.x - low.x);
        let middle = |i: &u32| {
            let edge = &edges[*i as usize];
            edge.a[axis] + edge.b[axis]
        };
        let half = (from + to) / 2;
        let before = |i: &u32, j: &u32| middle(i).total_cmp(&middle(j)).then(i.cmp(j));
        sort(&mut self.order[from..to], before, interrupt);
        self.split(edges, from, half, interrupt);
        self.nodes[here].from = self.nodes.len() as u32;
        self.nodes[here].count = 0;
        self.split(edges, half, to, interrupt);
    }

    /// Calls `visit` with edges that may be less than the square root of `within` from `p`, nearer boxes
    /// first; it returns the new `within`, at most the old.
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
