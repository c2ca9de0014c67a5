//! The search of the metric tree.

use super::super::collect::Collector;
use super::super::leaf::{CAP, Coincident, WIDE};
use super::super::node::Ref;
use super::super::{Hit, NodeId};
use super::{MetricTree, ROWS, capped};
use crate::nn::states::States;

/// One search under way.
struct Search<'a, L> {
    tree: &'a MetricTree,
    states: &'a dyn States,
    collector: &'a mut L,
    /// Distances from the last vantage points above, as in the leaves.
    rows: [f32; ROWS],
    /// The largest distance seen, which bounds rounding.
    largest: f64,
}

impl MetricTree {
    /// Offers `collector` every state that it may want.
    pub(super) fn search(&self, states: &dyn States, collector: &mut impl Collector) {
        for &id in &self.unmeasurable {
            collector.offer(Hit { id, distance: states.to_query(id) });
        }
        if let Some(root) = self.root {
            let rows = [0.0; ROWS];
            Search { tree: self, states, collector, rows, largest: 0.0 }.visit(root, 0);
        }
    }
}

impl<L: Collector> Search<'_, L> {
    fn visit(&mut self, r: Ref, depth: usize) {
        let i = match r.get() {
            Err(leaf) => return self.scan(leaf),
            Ok(i) => i,
        };
        let node = &self.tree.inner[i];
        let distance = capped(self.offer(node.vantage, node.coincident.as_ref()));
        let row = depth % ROWS;
        let saved = std::mem::replace(&mut self.rows[row], distance as f32);
        self.largest = self.largest.max(distance);
        let bounds = node.ranges.map(|(low, high)| (low - distance).max(distance - high));
        let near = if bounds[0].max(0.0) == bounds[1].max(0.0) {
            usize::from(distance > node.split)
        } else {
            usize::from(bounds[1] < bounds[0])
        };
        for side in [near, 1 - near] {
            let limit = self.collector.limit();
            if bounds[side] <= limit + 1e-10 * (self.largest + limit) {
                self.visit(node.children[side], depth + 1);
            }
        }
        self.rows[row] = saved;
    }

    fn scan(&mut self, leaf: usize) {
        let lanes = self.tree.leaves.lanes(leaf, ROWS);
        let ids = self.tree.leaves.ids(leaf);
        let len = ids.len();
        let mut bounds = differences(lanes, &self.rows, len);
        let bounds = &mut bounds[..len];
        let mut reach = self.reach();
        let mut start = 0;
        if let Some(coincident) = self.tree.leaves.coincident(leaf)
            && bounds[0] <= reach
        {
            self.offer(ids[0], Some(coincident));
            start = 1;
        }
        // The most promising first: it may exclude the others.
        let mut first = start;
        for lane in start..len {
            if bounds[lane] < bounds[first] {
                first = lane;
            }
        }
        if first < len && bounds[first] <= reach {
            self.offer(ids[first], None);
            bounds[first] = f32::NAN;
            reach = self.reach();
        }
        for (&bound, &id) in bounds.iter().zip(ids).skip(start) {
            if bound <= reach {
                self.offer(id, None);
                reach = self.reach();
            }
        }
    }

    /// The largest bound of a lane that may be wanted, with the rounding of `f32`.
    #[inline]
    fn reach(&self) -> f32 {
        let limit = self.collector.limit();
        (limit + 5e-7 * (self.largest + limit)) as f32
    }

    /// Offers a state and those equal to it; returns its distance.
    #[inline]
    fn offer(&mut self, id: NodeId, coincident: Option<&Coincident>) -> f64 {
        let distance = self.states.to_query(id);
        if self.collector.offer(Hit { id, distance })
            && let Some(coincident) = coincident
        {
            // In the order of ids: after the first one refused all would be.
            let _ = coincident.ids.iter().all(|&id| self.collector.offer(Hit { id, distance }));
        }
        distance
    }
}

/// For every lane the largest difference between its row and that of the query: by the triangle
/// inequality, a lower bound on the distance.
#[inline]
fn differences(lanes: &[f32], rows: &[f32; ROWS], len: usize) -> [f32; CAP] {
    let mut out = [0.0; CAP];
    for (w, out) in out.chunks_exact_mut(WIDE).enumerate() {
        if w * WIDE >= len {
            break;
        }
        let mut most = [0.0f32; WIDE];
        for (d, q) in rows.iter().enumerate() {
            let Some(row) = lanes[d * CAP + w * WIDE..].first_chunk::<WIDE>() else { break };
            for (m, x) in most.iter_mut().zip(row) {
                let t = (x - q).abs();
                *m = if t > *m { t } else { *m };
            }
        }
        out.copy_from_slice(&most);
    }
    out
}
