//! Builds a subtree from its states.

use super::super::NodeId;
use super::super::leaf::{CAP, Coincident, FILL};
use super::super::node::{Ref, Weight};
use super::{Inner, MetricTree, ROWS, capped};
use crate::nn::states::States;

/// The states to build a subtree from.
#[derive(Debug, Default)]
pub(super) struct Items {
    ids: Vec<NodeId>,
    coincident: Vec<Option<Coincident>>,
    /// Distances to the nearest ancestors, the one at depth `d` in row `d % ROWS`.
    rows: Vec<[f32; ROWS]>,
}

impl Items {
    pub(super) fn push(&mut self, id: NodeId, coincident: Option<Coincident>, row: impl FnMut(usize) -> f32) {
        self.ids.push(id);
        self.coincident.push(coincident);
        self.rows.push(std::array::from_fn(row));
    }
}

impl MetricTree {
    /// The distance of state `id` from the ancestor that has row `row` at depth `depth` of the
    /// path.
    pub(super) fn ancestor_distance(&self, states: &dyn States, depth: usize, row: usize, id: NodeId) -> f32 {
        match (depth.saturating_sub(ROWS)..depth).find(|d| d % ROWS == row) {
            Some(d) => {
                let vantage = self.inner[self.path[d].node].vantage;
                capped(states.distance(vantage, id)) as f32
            }
            None => 0.0,
        }
    }

    /// Moves the states below `r`, at depth `depth`, into `items` and frees its nodes. The
    /// distances are those to the ancestors of a node at depth `top`.
    pub(super) fn gather(
        &mut self,
        states: &dyn States,
        top: usize,
        depth: usize,
        r: Ref,
        items: &mut Items,
    ) {
        match r.get() {
            Ok(i) => {
                let node = &mut self.inner[i];
                let (vantage, coincident, children) = (node.vantage, node.coincident.take(), node.children);
                items.push(vantage, coincident, |row| self.ancestor_distance(states, top, row, vantage));
                for child in children {
                    self.gather(states, top, depth + 1, child, items);
                }
                self.free_inner.push(i);
            }
            Err(leaf) => {
                let mut coincident = self.leaves.take_coincident(leaf);
                let lanes = self.leaves.lanes(leaf, ROWS);
                // Ancestors between `top` and the leaf have overwritten the rows of the highest ones.
                let kept = depth.saturating_sub(ROWS);
                for (lane, &id) in self.leaves.ids(leaf).iter().enumerate() {
                    items.push(id, coincident.take(), |row| {
                        match (top.saturating_sub(ROWS)..top).find(|d| d % ROWS == row) {
                            Some(d) if d >= kept => lanes[row * CAP + lane],
                            _ => self.ancestor_distance(states, top, row, id),
                        }
                    });
                }
                self.leaves.free(leaf);
            }
        }
    }

    /// A subtree of `items` at depth `depth`.
    pub(super) fn build(&mut self, states: &dyn States, depth: usize, items: &mut Items) -> Ref {
        let mut order: Vec<u32> = (0..items.ids.len() as u32).collect();
        self.build_part(states, depth, items, &mut order)
    }

    fn build_part(&mut self, states: &dyn States, depth: usize, items: &mut Items, order: &mut [u32]) -> Ref {
        // Only lane 0 of a leaf may stand for more than one state.
        let shared = order.iter().filter(|&&i| items.coincident[i as usize].is_some()).count();
        if order.len() <= FILL && shared <= 1 {
            order.sort_by_key(|&i| items.coincident[i as usize].is_none());
            return self.build_leaf(items, order);
        }
        let id = |i: u32| items.ids[i as usize];
        if order.iter().all(|&i| states.same(id(i), id(order[0]))) {
            return self.build_coincident_leaf(items, order);
        }
        // A state far from the parent's vantage point, hence near the rim, cuts the rest into
        // shells of little curvature.
        if depth > 0 {
            let far = |i: u32| items.rows[i as usize][(depth - 1) % ROWS];
            let farthest = (0..order.len()).max_by(|&a, &b| far(order[a]).total_cmp(&far(order[b])));
            order.swap(0, farthest.unwrap_or(0));
        }
        let (vantage, rest) = (order[0] as usize, &mut order[1..]);
        let id = items.ids[vantage];
        let mut distances: Vec<(f64, u32)> =
            rest.iter().map(|&i| (capped(states.distance(id, items.ids[i as usize])), i)).collect();
        let half = distances.len() / 2;
        distances.select_nth_unstable_by(half, |a, b| a.0.total_cmp(&b.0));
        for (slot, &(distance, i)) in rest.iter_mut().zip(&distances) {
            *slot = i;
            items.rows[i as usize][depth % ROWS] = distance as f32;
        }
        let range = |part: &[(f64, u32)]| {
            part.iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &(d, _)| (low.min(d), high.max(d)))
        };
        let ranges = [range(&distances[..half]), range(&distances[half..])];
        drop(distances);
        let coincident = items.coincident[vantage].take();
        let (first, second) = rest.split_at_mut(half);
        let children = [first, second].map(|part| self.build_part(states, depth + 1, items, part));
        let leaves = children.iter().map(|&c| self.leaves_below(c)).sum();
        let node = Inner {
            vantage: id,
            coincident,
            split: ranges[0].1,
            ranges,
            children,
            weight: Weight::new(leaves),
        };
        if let Some(i) = self.free_inner.pop() {
            self.inner[i] = node;
            return Ref::inner(i);
        }
        self.inner.push(node);
        Ref::inner(self.inner.len() - 1)
    }

    fn build_leaf(&mut self, items: &mut Items, order: &[u32]) -> Ref {
        let leaf = self.leaves.alloc(ROWS);
        for &i in order {
            let rows = items.rows[i as usize];
            self.leaves.push(leaf, ROWS, items.ids[i as usize], |row| rows[row]);
        }
        self.leaves.set_coincident(leaf, order.first().and_then(|&i| items.coincident[i as usize].take()));
        Ref::leaf(leaf)
    }

    /// A leaf for any number of equal states.
    fn build_coincident_leaf(&mut self, items: &mut Items, order: &mut [u32]) -> Ref {
        let ids = &items.ids;
        order.sort_by_key(|&i| ids[i as usize]);
        let mut all: Vec<NodeId> = order.iter().map(|&i| ids[i as usize]).collect();
        for &i in order.iter() {
            all.extend(items.coincident[i as usize].take().into_iter().flat_map(|coincident| coincident.ids));
        }
        // Coincident states have larger ids than the state they share with.
        let first = order[0] as usize;
        items.coincident[first] = Coincident::sharing_with(items.ids[first], all, true);
        self.build_leaf(items, &order[..1])
    }
}
