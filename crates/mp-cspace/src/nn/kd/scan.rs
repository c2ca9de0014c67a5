//! The search of one leaf: `f32` lower bounds for 32 states at a time, then the metric itself for
//! those that pass.

use super::super::collect::Collector;
use super::super::leaf::{CAP, Coincident, WIDE};
use super::super::{Hit, NodeId};
use super::bounded::MOST;
use super::search::Search;

impl<L: Collector, const K: usize> Search<'_, L, K> {
    /// Offers the states of a leaf that pass the filter.
    #[inline(never)]
    pub(super) fn scan(&mut self, leaf: usize) {
        let (dim, reach) = (self.tree.dim(), self.lane_reach);
        if self.is_beyond(leaf, dim) {
            return;
        }
        let lanes = self.tree.leaves.lanes(leaf, dim);
        // Lanes without a state are NaN, for which no comparison holds.
        match *self.tree.layout.ends.as_slice() {
            [] | [_] => {
                let squares = self.squares(lanes, 0, dim);
                let least = least(&squares);
                if least <= reach {
                    self.offer_passing(leaf, squares, least);
                }
            }
            [end, _] => {
                let (a, b) = (self.squares(lanes, 0, end), self.squares(lanes, end, dim));
                // √a + √b ≤ √r is 4ab ≤ (r − a − b)² with r − a − b ≥ 0: no root for most.
                let r = reach * (1.0 + 2e-6);
                let excess = pairs(&a, &b, |a, b| {
                    let rest = r - (a + b);
                    4.0 * a * b - rest * rest.abs()
                });
                if least(&excess) <= 0.0 {
                    let bounds = pairs(&a, &b, |a, b| a + b + 2.0 * (a * b).sqrt());
                    self.offer_passing(leaf, bounds, least(&bounds));
                }
            }
            ref ends => {
                let mut start = 0;
                let mut sums = [0.0; CAP];
                for &end in ends {
                    sums = pairs(&sums, &self.squares(lanes, start, end), |sum, x| sum + x.sqrt());
                    start = end;
                }
                let bounds = sums.map(|sum| sum * sum);
                let least = least(&bounds);
                if least <= reach {
                    self.offer_passing(leaf, bounds, least);
                }
            }
        }
    }

    /// Whether the box around all lanes is farther than the reach. Rounds as the lanes do, in the same
    /// order, so that no lane passes where the box does not.
    #[inline(always)]
    fn is_beyond(&self, leaf: usize, dim: usize) -> bool {
        let layout = &self.tree.layout;
        let ranges = self.tree.leaves.ranges(leaf, dim);
        let gap = |d: usize| {
            let ([low, high], q) = (ranges[d], self.q32[d]);
            // Where there is a period, the other way round may be shorter.
            if layout.period[d] == f64::INFINITY { (low - q).max(q - high).max(0.0) } else { 0.0 }
        };
        let squares = |from: usize, to: usize| (from..to).map(gap).fold(0.0, |sum, t| sum + t * t);
        match *layout.ends.as_slice() {
            [] | [_] => squares(0, dim) > self.lane_reach,
            [end, _] => {
                let (a, b) = (squares(0, end), squares(end, dim));
                let rest = self.lane_reach * (1.0 + 4e-6) - (a + b);
                4.0 * a * b > rest * rest.abs()
            }
            _ => false,
        }
    }

    /// The squared distance of every lane from the image over the coordinates `start..end`, each
    /// the shorter way round its period.
    #[inline(always)]
    fn squares(&self, lanes: &[f32], start: usize, end: usize) -> [f32; CAP] {
        let mut out = [0.0; CAP];
        for (w, out) in out.chunks_exact_mut(WIDE).enumerate() {
            let mut sum = [0.0f32; WIDE];
            for d in start..end {
                let Some(row) = lanes[d * CAP + w * WIDE..].first_chunk::<WIDE>() else { break };
                let (q, period) = (self.q32[d], self.tree.layout.period[d]);
                if period == f64::INFINITY {
                    for (s, x) in sum.iter_mut().zip(row) {
                        let t = x - q;
                        *s += t * t;
                    }
                } else {
                    let period = period as f32;
                    for (s, x) in sum.iter_mut().zip(row) {
                        let t = (x - q).abs();
                        let round = period - t;
                        let t = if round < t { round } else { t };
                        *s += t * t;
                    }
                }
            }
            out.copy_from_slice(&sum);
        }
        out
    }

    /// Offers the states of a leaf whose bound is small enough, the one of `least_bound` first: it
    /// excludes most of the others.
    fn offer_passing(&mut self, leaf: usize, mut bounds: [f32; CAP], least_bound: f32) {
        let ids = self.tree.leaves.ids(leaf);
        if let Some(coincident) = self.tree.leaves.coincident(leaf)
            && bounds[0] <= self.lane_reach
        {
            self.offer_all(ids[0], bounds[0], coincident);
            bounds[0] = f32::NAN;
        }
        if L::BY_BOUND {
            for (&bound, &id) in bounds.iter().zip(ids) {
                if bound <= self.lane_reach && !self.is_repeated(id) {
                    self.collector.offer(Hit { id, distance: f64::from(bound) });
                }
            }
            return self.limit();
        }
        if let Some(first) = bounds.iter().position(|&b| b == least_bound) {
            self.offer(ids[first]);
            bounds[first] = f32::NAN;
        }
        if least(&bounds) <= self.lane_reach {
            for (&bound, &id) in bounds.iter().zip(ids) {
                if bound <= self.lane_reach {
                    self.offer(id);
                }
            }
        }
    }

    /// Offers all states that lane 0 stands for.
    fn offer_all(&mut self, first: NodeId, bound: f32, coincident: &Coincident) {
        if !coincident.same && !L::BY_BOUND {
            return [first].iter().chain(&coincident.ids).for_each(|&id| self.offer(id));
        }
        if self.is_repeated(first) {
            return;
        }
        let distance = match L::BY_BOUND {
            true => f64::from(bound),
            false => self.states.to_query(first),
        };
        // Equal distances in the order of ids: after the first one refused all would be.
        let most = if L::BY_BOUND && coincident.same { MOST } else { usize::MAX };
        let mut all = [first].into_iter().chain(coincident.ids.iter().copied()).take(most);
        let _ = all.all(|id| self.collector.offer(Hit { id, distance }));
        self.limit();
    }

    #[inline]
    fn offer(&mut self, id: NodeId) {
        let distance = self.states.to_query(id);
        if !self.is_repeated(id) && self.collector.offer(Hit { id, distance }) {
            self.limit();
        }
    }

    /// Whether state `id` is found by another image of the query instead.
    #[inline]
    fn is_repeated(&self, id: NodeId) -> bool {
        if L::MAY_REPEAT || self.lane_reach <= self.single {
            return false;
        }
        let x = self.tree.layout.embed(|out| self.states.embed(id, out));
        // The nearer of an image and its antipode finds it; of two equally near the one not negated.
        (0..).zip(&self.tree.layout.antipodes).any(|(a, &(start, end))| {
            let dot: f64 = (start..end).map(|d| x[d] * self.q[d]).sum();
            dot < 0.0 || (dot == 0.0 && self.negated >> a & 1 == 1)
        })
    }
}

/// `f` of every pair.
#[inline(always)]
fn pairs(a: &[f32; CAP], b: &[f32; CAP], f: impl Fn(f32, f32) -> f32) -> [f32; CAP] {
    let mut out = [0.0; CAP];
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out = f(a, b);
    }
    out
}

/// The least of all that are numbers.
#[inline(always)]
fn least(all: &[f32; CAP]) -> f32 {
    const LANES: usize = 8;
    let less = |a: f32, b: f32| if a < b { a } else { b };
    let mut columns = [f32::INFINITY; LANES];
    for row in all.chunks_exact(LANES) {
        for (column, &x) in columns.iter_mut().zip(row) {
            *column = less(x, *column);
        }
    }
    columns.into_iter().fold(f32::INFINITY, |least, x| less(x, least))
}
