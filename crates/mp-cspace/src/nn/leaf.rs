//! The leaves of the trees: buckets of `f32` numbers of up to 32 states, structure of arrays.

use super::NodeId;
use std::collections::BTreeMap;

/// The most lanes of a leaf, each for one state (lane 0 may stand for more).
pub(super) const CAP: usize = 32;

/// States per leaf of a new subtree, leaving room to grow.
pub(super) const FILL: usize = CAP * 3 / 4;

/// Lanes in one vectorised step.
pub(super) const WIDE: usize = 16;

/// States that share a lane or a vantage point with another state, from which they cannot be split.
#[derive(Clone, Debug)]
pub(super) struct Coincident {
    /// In ascending order.
    pub(super) ids: Vec<NodeId>,
    /// They all equal the state they share with.
    pub(super) same: bool,
}

impl Coincident {
    /// The states `ids` without `first`, with which they share; `None` when no other is left.
    pub(super) fn sharing_with(first: NodeId, mut ids: Vec<NodeId>, same: bool) -> Option<Self> {
        ids.retain(|&id| id != first);
        ids.sort_unstable();
        (!ids.is_empty()).then_some(Self { ids, same })
    }

    /// Adds the state `id` to those that share with `first`; returns the smaller of both ids, which takes
    /// the place of `first`.
    pub(super) fn join(&mut self, first: NodeId, id: NodeId) -> NodeId {
        let at = self.ids.partition_point(|&other| other < first.max(id));
        self.ids.insert(at, first.max(id));
        first.min(id)
    }
}

/// The range of no numbers.
const EMPTY_RANGE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// All leaves of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaves {
    heads: Vec<Head>,
    ids: Vec<[NodeId; CAP]>,
    /// `rows` rows of [`CAP`] lanes for each leaf; NaN where there is no state.
    lanes: Vec<f32>,
    /// The least and the greatest number in each row of each leaf.
    ranges: Vec<[f32; 2]>,
    /// The states that share lane 0, by leaf.
    coincident: BTreeMap<usize, Coincident>,
    free: Vec<usize>,
}

/// How many lanes of a leaf are filled, and whether states share lane 0.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Head {
    pub(super) len: u32,
    pub(super) has_coincident: bool,
}

impl Leaves {
    /// A new empty leaf.
    pub(super) fn alloc(&mut self, rows: usize) -> usize {
        if let Some(i) = self.free.pop() {
            self.clear(i, rows);
            return i;
        }
        self.heads.push(Head::default());
        self.ids.push([0; CAP]);
        self.lanes.resize(self.heads.len() * rows * CAP, f32::NAN);
        self.ranges.resize(self.heads.len() * rows, EMPTY_RANGE);
        self.heads.len() - 1
    }

    /// Empties leaf `i`.
    pub(super) fn clear(&mut self, i: usize, rows: usize) {
        self.take_coincident(i);
        self.heads[i].len = 0;
        self.lanes[i * rows * CAP..][..rows * CAP].fill(f32::NAN);
        self.ranges[i * rows..][..rows].fill(EMPTY_RANGE);
    }

    /// Makes leaf `i` available to [`alloc`](Self::alloc).
    pub(super) fn free(&mut self, i: usize) {
        self.take_coincident(i);
        self.free.push(i);
    }

    #[inline]
    pub(super) fn head(&self, i: usize) -> Head {
        self.heads[i]
    }

    /// The states of leaf `i`, lane by lane.
    #[inline]
    pub(super) fn ids(&self, i: usize) -> &[NodeId] {
        &self.ids[i][..self.heads[i].len as usize]
    }

    /// The states that share lane 0.
    pub(super) fn coincident(&self, i: usize) -> Option<&Coincident> {
        if self.heads[i].has_coincident { self.coincident.get(&i) } else { None }
    }

    pub(super) fn take_coincident(&mut self, i: usize) -> Option<Coincident> {
        std::mem::take(&mut self.heads[i].has_coincident).then(|| self.coincident.remove(&i)).flatten()
    }

    pub(super) fn set_coincident(&mut self, i: usize, coincident: Option<Coincident>) {
        self.heads[i].has_coincident = coincident.is_some();
        if let Some(coincident) = coincident {
            self.coincident.insert(i, coincident);
        }
    }

    /// Adds a state to those that share lane 0, of which there are some.
    pub(super) fn join(&mut self, i: usize, id: NodeId, same: bool) {
        if let Some(coincident) = self.coincident.get_mut(&i) {
            coincident.same &= same;
            self.ids[i][0] = coincident.join(self.ids[i][0], id);
        }
    }

    /// The numbers of leaf `i`: lane `l` of row `d` is at `d * CAP + l`.
    #[inline]
    pub(super) fn lanes(&self, i: usize, rows: usize) -> &[f32] {
        &self.lanes[i * rows * CAP..][..rows * CAP]
    }

    /// The least and the greatest number in each row of leaf `i`.
    #[inline]
    pub(super) fn ranges(&self, i: usize, rows: usize) -> &[[f32; 2]] {
        &self.ranges[i * rows..][..rows]
    }

    /// Adds a state to a leaf that is not full.
    #[inline]
    pub(super) fn push(&mut self, i: usize, rows: usize, id: NodeId, x: impl Fn(usize) -> f32) {
        let lane = self.heads[i].len as usize;
        self.heads[i].len += 1;
        self.ids[i][lane] = id;
        let lanes = &mut self.lanes[i * rows * CAP..][..rows * CAP];
        for (d, [low, high]) in self.ranges[i * rows..][..rows].iter_mut().enumerate() {
            let x = x(d);
            lanes[d * CAP + lane] = x;
            (*low, *high) = (low.min(x), high.max(x));
        }
    }
}
