//! The search of the k-d tree.

use super::super::collect::Collector;
use super::{Inner, KdTree, Ref};
use crate::nn::states::EmbeddedStates;

/// One search under way. Distances to cells and lanes are squared.
pub(super) struct Search<'a, L, const K: usize> {
    pub(super) tree: &'a KdTree<K>,
    pub(super) states: &'a dyn EmbeddedStates,
    pub(super) collector: &'a mut L,
    /// Coordinates of the image of the query being searched for.
    pub(super) q: [f64; K],
    pub(super) q32: [f32; K],
    /// Which of the layout's antipodes are negated in it, bit by bit.
    pub(super) negated: u32,
    /// The current cell; kept only for coordinates with a period.
    cell: [(f64, f64); K],
    /// Squared distance of the image from the current cell: by coordinate, and summed by group.
    off: [f64; K],
    sums: [f64; K],
    groups: usize,
    /// Squared distances beyond which cells, and lanes, hold no wanted state.
    reach: f64,
    pub(super) lane_reach: f32,
    /// Bounds on the rounding of cells and of lanes.
    pads: [f64; 2],
    /// A squared reach within which no state is found by two images of the query.
    pub(super) single: f32,
}

impl<const K: usize> KdTree<K> {
    /// Offers `collector` every state that it may want. Returns the squared distance beyond which it wants no
    /// state.
    pub(super) fn search(&self, states: &dyn EmbeddedStates, collector: &mut impl Collector) -> f32 {
        let Some(root) = self.root else { return f32::INFINITY };
        let q = self.layout.embed(|out| states.embed_query(out));
        let pads = self.pads(q.iter().fold(self.largest, |largest, x| largest.max(x.abs())));
        let [low, high] = &self.bounds;
        let mut search = Search {
            tree: self,
            states,
            collector,
            q,
            q32: [0.0; K],
            negated: 0,
            cell: std::array::from_fn(|d| (low[d], high[d])),
            off: [0.0; K],
            sums: [0.0; K],
            groups: self.layout.ends.len(),
            reach: 0.0,
            lane_reach: 0.0,
            pads,
            // ‖x − q‖² + ‖x + q‖² = 2 (‖x‖² + ‖q‖²).
            single: 0.9 * (self.least_antipode + self.layout.least_antipode(&q)) as f32,
        };
        search.limit();
        search.search_images(root, 0);
        search.lane_reach
    }

    /// Bounds on the rounding of cells and of lanes, where no coordinate is greater than `largest`.
    pub(super) fn pads(&self, largest: f64) -> [f64; 2] {
        [1e-14, 5e-7].map(|error| largest * self.dim() as f64 * error)
    }
}

impl<L: Collector, const K: usize> Search<'_, L, K> {
    /// Reads the limit of the collector.
    #[inline]
    pub(super) fn limit(&mut self) {
        // A layout allows 1e-7; `f32` arithmetic is off by some 2^-24 per operation, in some 30
        // operations.
        let limit = self.collector.limit() * (1.0 + 1e-7);
        if limit < 0.0 {
            (self.reach, self.lane_reach) = (-1.0, -1.0);
            return;
        }
        let (cell, lane) = (limit + self.pads[0], (limit + self.pads[1]) * (1.0 + 5e-6));
        self.reach = cell * cell;
        self.lane_reach = (lane * lane) as f32 + f32::MIN_POSITIVE;
    }

    /// Searches for every image of the query, the signs of the antipodes before number `a` being chosen.
    fn search_images(&mut self, root: Ref, a: usize) {
        let Some(&(start, end)) = self.tree.layout.antipodes.get(a) else { return self.search_image(root) };
        self.search_images(root, a + 1);
        let saved = self.q;
        self.q[start..end].iter_mut().for_each(|x| *x = -*x);
        self.negated ^= 1 << a;
        self.search_images(root, a + 1);
        self.negated ^= 1 << a;
        self.q = saved;
    }

    /// Searches for the image `q`.
    fn search_image(&mut self, root: Ref) {
        self.sums = [0.0; K];
        for d in 0..self.tree.dim() {
            self.q32[d] = self.q[d] as f32;
            let off = self.distance_along(d, self.cell[d]);
            self.off[d] = off * off;
            self.sums[self.tree.layout.group[d] as usize] += off * off;
        }
        if self.is_in_reach() {
            self.visit(root);
        }
    }

    /// Whether the current cell may hold a wanted state.
    #[inline(always)]
    fn is_in_reach(&self) -> bool {
        match (self.groups, self.sums.as_slice()) {
            (1, [a, ..]) => *a <= self.reach,
            (2, [a, b, ..]) => {
                // √a + √b ≤ √r, without a root.
                let rest = self.reach - (a + b);
                4.0 * a * b <= rest * rest.abs()
            }
            (n, sums) => {
                let total: f64 = sums[..n].iter().map(|x| x.max(0.0).sqrt()).sum();
                total * total <= self.reach
            }
        }
    }

    /// How far coordinate `d` of the image is from an interval, the shorter way round its period.
    #[inline]
    fn distance_along(&self, d: usize, (low, high): (f64, f64)) -> f64 {
        let (q, period) = (self.q[d], self.tree.layout.period[d]);
        let (below, above) = (low - q, q - high);
        if below <= 0.0 && above <= 0.0 {
            0.0
        } else {
            // One of the two is positive: the gap to the near side of the interval. The far side is
            // reached around the period.
            let gap = below.max(above);
            gap.min(period + below.min(above)).max(0.0)
        }
    }

    /// Searches the current cell, that of node `r`.
    fn visit(&mut self, r: Ref) {
        let i = match r.get() {
            Err(leaf) => return self.scan(leaf),
            Ok(i) => i,
        };
        let node = &self.tree.inner[i];
        let d = node.dim as usize;
        if self.tree.layout.period[d] != f64::INFINITY {
            return self.visit_periodic(node, d);
        }
        let diff = self.q[d] - node.split;
        let near = usize::from(diff > 0.0);
        self.visit(node.children[near]);
        self.visit_at(node.children[1 - near], d, diff * diff);
    }

    /// Searches a cell that differs from the current one by the squared distance `off` along `d`.
    #[inline(always)]
    fn visit_at(&mut self, r: Ref, d: usize, off: f64) {
        let g = self.tree.layout.group[d] as usize;
        let (old, sum) = (self.off[d], self.sums[g]);
        self.sums[g] = sum - old + off;
        if self.is_in_reach() {
            self.off[d] = off;
            self.visit(r);
            self.off[d] = old;
        }
        self.sums[g] = sum;
    }

    /// Searches the children of a node that splits a coordinate with a period.
    fn visit_periodic(&mut self, node: &Inner, d: usize) {
        let whole = self.cell[d];
        let cells = [(whole.0, node.split), (node.split, whole.1)];
        let offs = cells.map(|cell| self.distance_along(d, cell));
        let near = usize::from(offs[1] < offs[0]);
        for side in [near, 1 - near] {
            self.cell[d] = cells[side];
            self.visit_at(node.children[side], d, offs[side] * offs[side]);
        }
        self.cell[d] = whole;
    }
}
