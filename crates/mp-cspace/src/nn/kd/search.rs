//! The search.

use super::super::collect::Collector;
use super::super::leaf::{CAP, Extra, WIDE};
use super::super::{Hit, NodeId};
use super::{Inner, KdTree, MAX_DIM, Ref};
use crate::Embed;

/// One search under way.
struct Search<'a, C: Embed, L, const K: usize> {
    tree: &'a KdTree<K>,
    space: &'a C,
    points: &'a [C::State],
    query: &'a C::State,
    collector: &'a mut L,
    /// Coordinates of the image of the query being searched for.
    q: [f64; MAX_DIM],
    q32: [f32; MAX_DIM],
    /// Which of the shape's antipodes are negated in it, bit by bit.
    negated: u32,
    period32: [f32; MAX_DIM],
    /// The current cell, along coordinates with a period.
    cell: [(f64, f64); MAX_DIM],
    /// Squared distance of the image from the current cell: by coordinate, and summed by group.
    off: [f64; MAX_DIM],
    sums: [f64; MAX_DIM],
    /// Cells farther than this (squared if there is one group) hold nothing of interest.
    reach: f64,
    /// The same for lanes, with the rounding of their coordinates.
    lane_reach: f32,
    /// Bounds on the rounding of cells and of lanes.
    pads: [f64; 2],
}

impl<const K: usize> KdTree<K> {
    /// Offers `collector` every state that may interest it.
    pub(super) fn search<C: Embed>(
        &self,
        space: &C,
        points: &[C::State],
        query: &C::State,
        collector: &mut impl Collector,
    ) {
        let Some(root) = self.root else { return };
        let mut search = Search {
            tree: self,
            space,
            points,
            query,
            collector,
            q: self.shape.embed(space, query),
            q32: [0.0; MAX_DIM],
            negated: 0,
            period32: self.shape.period.map(|p| p as f32),
            cell: [(0.0, 0.0); MAX_DIM],
            off: [0.0; MAX_DIM],
            sums: [0.0; MAX_DIM],
            reach: 0.0,
            lane_reach: 0.0,
            pads: [0.0; 2],
        };
        let mut largest = 0.0f64;
        for d in 0..self.dim() {
            let (low, high) = (self.bounds[0][d], self.bounds[1][d]);
            search.cell[d] = (low, high);
            largest = largest.max(search.q[d].abs()).max(low.abs()).max(high.abs());
        }
        largest *= self.dim() as f64;
        search.pads = [largest * 1e-14, largest * 5e-7];
        search.limit();
        search.images(root, 0);
    }
}

impl<C: Embed, L: Collector, const K: usize> Search<'_, C, L, K> {
    #[inline(always)]
    fn one_group(&self) -> bool {
        self.tree.shape.ends.len() <= 1
    }

    /// Reads the limit of the collector.
    #[inline]
    fn limit(&mut self) {
        // 1e-7 is what a layout admits.
        let limit = (self.collector.limit() + self.tree.shape.slack) * (1.0 + 1e-7);
        self.reach = limit + self.pads[0];
        // `f32` arithmetic is off by some 2^-24 per operation, of which there are some 20.
        let lane = (limit + self.pads[1]) * (1.0 + 5e-6);
        self.lane_reach = lane as f32;
        if self.one_group() {
            self.reach *= self.reach;
            self.lane_reach = (lane * lane) as f32 + f32::MIN_POSITIVE;
        }
        if limit < 0.0 {
            (self.reach, self.lane_reach) = (-1.0, -1.0);
        }
    }

    /// Searches for every image of the query, antipodes from number `a` on undecided.
    fn images(&mut self, root: Ref, a: usize) {
        let Some(&(start, end)) = self.tree.shape.antipodes.get(a) else { return self.begin(root) };
        self.images(root, a + 1);
        let saved = self.q;
        self.q[start..end].iter_mut().for_each(|x| *x = -*x);
        self.negated ^= 1 << a;
        self.images(root, a + 1);
        self.negated ^= 1 << a;
        self.q = saved;
    }

    /// Searches for the image `q`.
    fn begin(&mut self, root: Ref) {
        self.sums = [0.0; MAX_DIM];
        for d in 0..self.tree.dim() {
            self.q32[d] = self.q[d] as f32;
            let off = self.distance_along(d, self.cell[d]);
            self.off[d] = off * off;
            self.sums[usize::from(self.tree.shape.group[d]) & (MAX_DIM - 1)] += off * off;
        }
        let total = if self.one_group() {
            self.sums[0]
        } else {
            self.sums[..self.tree.shape.ends.len()].iter().map(|x| x.sqrt()).sum()
        };
        if total <= self.reach {
            self.visit(root, total);
        }
    }

    /// How far coordinate `d` of the image is from an interval, the short way round its period.
    #[inline]
    fn distance_along(&self, d: usize, (low, high): (f64, f64)) -> f64 {
        let (q, period) = (self.q[d], self.tree.shape.period[d]);
        let (below, above) = (low - q, q - high);
        if below <= 0.0 && above <= 0.0 {
            0.0
        } else {
            // One of the two is positive: the gap on this side. The other side of the interval is
            // reached by going on round.
            let gap = below.max(above);
            gap.min(period + below.min(above)).max(0.0)
        }
    }

    /// Searches the cell of `r`, at distance `total` (squared if there is one group).
    fn visit(&mut self, r: Ref, total: f64) {
        let i = match r.get() {
            Err(leaf) => return self.scan(leaf),
            Ok(i) => i,
        };
        let node = &self.tree.inner[i];
        let d = node.dim as usize & (MAX_DIM - 1);
        if self.tree.shape.period[d] != f64::INFINITY {
            return self.visit_round(node, d, total);
        }
        let diff = self.q[d] - node.split;
        let near = usize::from(diff > 0.0);
        self.visit(node.children[near], total);
        self.visit_at(node.children[1 - near], d, diff * diff, total);
    }

    /// Searches a cell like the current one, but for the squared distance along `d`.
    #[inline(always)]
    fn visit_at(&mut self, r: Ref, d: usize, off: f64, total: f64) {
        let old = self.off[d];
        if self.one_group() {
            let total = total - old + off;
            if total <= self.reach {
                self.off[d] = off;
                self.visit(r, total);
                self.off[d] = old;
            }
        } else {
            let g = usize::from(self.tree.shape.group[d]) & (MAX_DIM - 1);
            let sum = self.sums[g];
            let grown = (sum - old + off).max(0.0);
            let total = total - sum.sqrt() + grown.sqrt();
            if total <= self.reach {
                (self.off[d], self.sums[g]) = (off, grown);
                self.visit(r, total);
                (self.off[d], self.sums[g]) = (old, sum);
            }
        }
    }

    /// Searches the children of a node that splits a coordinate with a period.
    fn visit_round(&mut self, node: &Inner, d: usize, total: f64) {
        let whole = self.cell[d];
        let cells = [(whole.0, node.split), (node.split, whole.1)];
        let offs = cells.map(|cell| self.distance_along(d, cell));
        let near = usize::from(offs[1] < offs[0]);
        for side in [near, 1 - near] {
            self.cell[d] = cells[side];
            self.visit_at(node.children[side], d, offs[side] * offs[side], total);
        }
        self.cell[d] = whole;
    }

    fn scan(&mut self, leaf: usize) {
        let dim = self.tree.dim();
        let lanes = self.tree.leaves.lanes(leaf, dim);
        let head = self.tree.leaves.get(leaf);
        let ends = &self.tree.shape.ends[..];
        let mut bound = match *ends {
            [] | [_] => squares(lanes, &self.q32, &self.period32, (0, dim), head.len),
            _ => {
                let mut start = 0;
                let mut bound = [0.0; CAP];
                for &end in ends {
                    let s = squares(lanes, &self.q32, &self.period32, (start, end), head.len);
                    for (b, s) in bound.iter_mut().zip(&s) {
                        *b += s.sqrt();
                    }
                    start = end;
                }
                bound
            }
        };
        let len = head.len.min(CAP);
        bound[len..].fill(f32::INFINITY);
        if bound.iter().all(|&b| b > self.lane_reach) {
            return;
        }
        let mut start = 0;
        if let Some(extra) = &head.extra {
            self.offer_all(head.ids[0], extra);
            start = 1;
        }
        // The nearest first: it spares most of the others.
        let bound = &mut bound[..len];
        let mut first = start;
        for lane in start + 1..len {
            if bound[lane] < bound[first] {
                first = lane;
            }
        }
        if first < len {
            self.offer(head.ids[first]);
            bound[first] = f32::INFINITY;
        }
        for (&bound, &id) in bound.iter().zip(&head.ids).skip(start) {
            if bound <= self.lane_reach && bound < f32::INFINITY {
                self.offer(id);
            }
        }
    }

    /// Offers all states that lane 0 stands for.
    fn offer_all(&mut self, first: NodeId, extra: &Extra) {
        if !extra.same {
            return [first].iter().chain(&extra.ids).for_each(|&id| self.offer(id));
        }
        if self.is_repeated(first) {
            return;
        }
        let distance = self.space.distance(&self.points[first as usize], self.query);
        // Equal distances in the order of ids: one that is refused speaks for the rest.
        let all = [first].into_iter().chain(extra.ids.iter().copied());
        let _ = all.map(|id| self.collector.offer(Hit { id, distance })).take_while(|taken| *taken).count();
        self.limit();
    }

    #[inline]
    fn offer(&mut self, id: NodeId) {
        let distance = self.space.distance(&self.points[id as usize], self.query);
        if !self.is_repeated(id) && self.collector.offer(Hit { id, distance }) {
            self.limit();
        }
    }

    /// Whether another image of the query is the one to find state `id` by.
    #[inline]
    fn is_repeated(&self, id: NodeId) -> bool {
        if L::MAY_REPEAT || self.tree.shape.antipodes.is_empty() {
            return false;
        }
        let x = self.tree.shape.embed(self.space, &self.points[id as usize]);
        // The nearer of an image and its antipode; of two equally near the original.
        (0..).zip(&self.tree.shape.antipodes).any(|(a, &(start, end))| {
            let dot: f64 = (start..end).map(|d| x[d] * self.q[d]).sum();
            dot < 0.0 || (dot == 0.0 && self.negated >> a & 1 == 1)
        })
    }
}

/// The squared distance of every lane from `q` over the coordinates `start..end`, each the short
/// way round its period.
#[inline(always)]
fn squares(
    lanes: &[f32],
    q: &[f32; MAX_DIM],
    period: &[f32; MAX_DIM],
    (start, end): (usize, usize),
    len: usize,
) -> [f32; CAP] {
    let mut out = [0.0; CAP];
    for (w, out) in out.chunks_exact_mut(WIDE).enumerate() {
        if w * WIDE >= len {
            break;
        }
        let mut sum = [0.0f32; WIDE];
        for d in start..end.min(MAX_DIM) {
            let Some(row) = lanes[d * CAP + w * WIDE..].first_chunk::<WIDE>() else { break };
            if period[d] == f32::INFINITY {
                for (s, x) in sum.iter_mut().zip(row) {
                    let t = x - q[d];
                    *s += t * t;
                }
            } else {
                for (s, x) in sum.iter_mut().zip(row) {
                    let t = (x - q[d]).abs();
                    let t = t.min(period[d] - t);
                    *s += t * t;
                }
            }
        }
        out.copy_from_slice(&sum);
    }
    out
}
