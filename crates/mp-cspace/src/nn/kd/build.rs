//! Builds a subtree from its states.

use super::super::NodeId;
use super::super::leaf::{CAP, Coincident, FILL};
use super::{Inner, KdTree, Ref, Weight};
use crate::nn::states::EmbeddedStates;

/// The states to build a subtree from.
#[derive(Debug)]
pub(super) struct Items {
    dim: usize,
    /// `dim` coordinates each.
    rows: Vec<f64>,
    ids: Vec<NodeId>,
    coincident: Vec<Option<Coincident>>,
}

impl Items {
    pub(super) fn new(dim: usize) -> Self {
        Self { dim, rows: Vec::new(), ids: Vec::new(), coincident: Vec::new() }
    }

    pub(super) fn push(&mut self, x: &[f64], id: NodeId, coincident: Option<Coincident>) {
        self.rows.extend_from_slice(&x[..self.dim]);
        self.ids.push(id);
        self.coincident.push(coincident);
    }

    #[inline]
    fn at(&self, item: u32, d: usize) -> f64 {
        self.rows[item as usize * self.dim + d]
    }

    /// Splits `order` in two parts, neither empty, as evenly as equal coordinates allow. Returns the
    /// coordinate, the value, and the length of the first part.
    fn split(&self, order: &mut [u32]) -> Option<(usize, f64, usize)> {
        let mut widths = vec![(0.0, 0); self.dim];
        for (d, width) in widths.iter_mut().enumerate() {
            let (low, high) = order.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &i| {
                (low.min(self.at(i, d)), high.max(self.at(i, d)))
            });
            *width = (high - low, d);
        }
        widths.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Option<(usize, f64, usize)> = None;
        for &(_, d) in widths.iter().take_while(|(width, _)| *width > 0.0) {
            let half = order.len() / 2;
            let (_, &mut median, _) =
                order.select_nth_unstable_by(half, |&a, &b| self.at(a, d).total_cmp(&self.at(b, d)));
            let median = self.at(median, d);
            // Equal coordinates stay together: cut below the median's, or above them.
            let (mut below, mut above) = (f64::NEG_INFINITY, f64::INFINITY);
            let (mut less, mut more) = (0, 0);
            for &i in order.iter() {
                let x = self.at(i, d);
                if x < median {
                    (less, below) = (less + 1, below.max(x));
                } else if x > median {
                    (more, above) = (more + 1, above.min(x));
                }
            }
            let (a, b, first) =
                if less >= more { (below, median, less) } else { (median, above, order.len() - more) };
            let middle = 0.5 * a + 0.5 * b;
            let value = if a <= middle && middle < b { middle } else { a };
            let balance = |first: usize| first.min(order.len() - first);
            if best.is_none_or(|(_, _, other)| balance(first) > balance(other)) {
                best = Some((d, value, first));
            }
            if balance(first) >= order.len() / 4 {
                break;
            }
        }
        let (d, value, _) = best?;
        let mut first = 0;
        for i in 0..order.len() {
            if self.at(order[i], d) <= value {
                order.swap(i, first);
                first += 1;
            }
        }
        Some((d, value, first))
    }
}

impl<const K: usize> KdTree<K> {
    /// Moves the states below `r` into `items` and frees its nodes.
    pub(super) fn gather(&mut self, states: &dyn EmbeddedStates, r: Ref, items: &mut Items) {
        match r.get() {
            Ok(i) => {
                for child in self.inner[i].children {
                    self.gather(states, child, items);
                }
                self.free_inner.push(i);
            }
            Err(leaf) => {
                let mut coincident = self.leaves.take_coincident(leaf);
                for &id in self.leaves.ids(leaf) {
                    let x = self.layout.embed(|out| states.embed(id, out));
                    items.push(&x, id, coincident.take());
                }
                self.leaves.free(leaf);
            }
        }
    }

    /// A subtree of `items`; moves their coincident states into it.
    pub(super) fn build(&mut self, states: &dyn EmbeddedStates, items: &mut Items) -> Ref {
        let mut order: Vec<u32> = (0..items.ids.len() as u32).collect();
        self.build_part(states, items, &mut order)
    }

    fn build_part(&mut self, states: &dyn EmbeddedStates, items: &mut Items, order: &mut [u32]) -> Ref {
        // Only lane 0 of a leaf may stand for more than one state.
        let shared = order.iter().filter(|&&i| items.coincident[i as usize].is_some()).count();
        if order.len() > FILL || shared > 1 {
            if let Some((d, split, first)) = items.split(order) {
                let (left, right) = order.split_at_mut(first);
                let children = [self.build_part(states, items, left), self.build_part(states, items, right)];
                let leaves = children.iter().map(|&c| self.leaves_below(c)).sum();
                return self.new_inner(Inner { split, children, dim: d as u32, weight: Weight::new(leaves) });
            }
            if order.len() > CAP || shared > 1 {
                return self.build_coincident_leaf(states, items, order);
            }
        }
        order.sort_by_key(|&i| items.coincident[i as usize].is_none());
        let leaf = self.leaves.alloc(items.dim);
        for &i in order.iter() {
            self.leaves.push(leaf, items.dim, items.ids[i as usize], |d| items.at(i, d) as f32);
        }
        self.leaves.set_coincident(leaf, order.first().and_then(|&i| items.coincident[i as usize].take()));
        Ref::leaf(leaf)
    }

    /// A leaf for any number of states with the same coordinates.
    fn build_coincident_leaf(
        &mut self,
        states: &dyn EmbeddedStates,
        items: &mut Items,
        order: &[u32],
    ) -> Ref {
        let mut ids = Vec::new();
        let mut same = true;
        for &i in order {
            ids.push(items.ids[i as usize]);
            if let Some(coincident) = items.coincident[i as usize].take() {
                ids.extend(coincident.ids);
                same &= coincident.same;
            }
        }
        let first = ids.iter().copied().min().unwrap_or(0);
        same &= order.iter().all(|&i| states.same(items.ids[i as usize], first));
        let leaf = self.leaves.alloc(items.dim);
        if let Some(&i) = order.first() {
            self.leaves.push(leaf, items.dim, first, |d| items.at(i, d) as f32);
        }
        self.leaves.set_coincident(leaf, Coincident::sharing_with(first, ids, same));
        Ref::leaf(leaf)
    }
}
