//! The buckets of the trees: `f32` numbers of up to 32 states, structure of arrays.

use super::NodeId;
use std::collections::BTreeMap;

/// States in a leaf.
pub(super) const CAP: usize = 32;

/// States per leaf of a new subtree, leaving room to grow.
pub(super) const FILL: usize = CAP * 3 / 4;

/// Lanes the compiler gets to vectorise at a time.
pub(super) const WIDE: usize = 16;

/// More states of a leaf that could not be split.
#[derive(Clone, Debug)]
pub(super) struct Extra {
    /// In ascending order.
    pub(super) ids: Vec<NodeId>,
    /// Their states are that of lane 0.
    pub(super) same: bool,
}

impl Extra {
    /// The states of `ids`, which `first` may be among, beside `first` in lane 0.
    pub(super) fn beside(first: NodeId, mut ids: Vec<NodeId>, same: bool) -> Option<Self> {
        ids.retain(|&id| id != first);
        ids.sort_unstable();
        (!ids.is_empty()).then_some(Self { ids, same })
    }

    /// Adds the state `id`; returns the smallest id, which belongs into lane 0.
    pub(super) fn join(&mut self, first: NodeId, id: NodeId) -> NodeId {
        let at = self.ids.partition_point(|&other| other < first.max(id));
        self.ids.insert(at, first.max(id));
        first.min(id)
    }
}

/// The range of no numbers.
const NOTHING: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

/// All leaves of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaves {
    /// How many states each leaf has, and whether lane 0 has company in `extras`.
    heads: Vec<Head>,
    ids: Vec<[NodeId; CAP]>,
    /// `rows` rows of [`CAP`] lanes for each leaf; not a number where there is no state.
    lanes: Vec<f32>,
    /// The least and the greatest number in each row of each leaf.
    ranges: Vec<[f32; 2]>,
    extras: BTreeMap<usize, Extra>,
    free: Vec<usize>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Head {
    pub(super) len: u32,
    pub(super) has_extra: bool,
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
        self.ranges.resize(self.heads.len() * rows, NOTHING);
        self.heads.len() - 1
    }

    /// Empties leaf `i`.
    pub(super) fn clear(&mut self, i: usize, rows: usize) {
        self.take_extra(i);
        self.heads[i].len = 0;
        self.lanes[i * rows * CAP..][..rows * CAP].fill(f32::NAN);
        self.ranges[i * rows..][..rows].fill(NOTHING);
    }

    /// Takes leaf `i` back.
    pub(super) fn free(&mut self, i: usize) {
        self.take_extra(i);
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

    /// The company of lane 0.
    pub(super) fn extra(&self, i: usize) -> Option<&Extra> {
        if self.heads[i].has_extra { self.extras.get(&i) } else { None }
    }

    pub(super) fn take_extra(&mut self, i: usize) -> Option<Extra> {
        std::mem::take(&mut self.heads[i].has_extra).then(|| self.extras.remove(&i)).flatten()
    }

    pub(super) fn set_extra(&mut self, i: usize, extra: Option<Extra>) {
        self.heads[i].has_extra = extra.is_some();
        if let Some(extra) = extra {
            self.extras.insert(i, extra);
        }
    }

    /// Adds a state to the company of lane 0, which has some.
    pub(super) fn join(&mut self, i: usize, id: NodeId, same: bool) {
        if let Some(extra) = self.extras.get_mut(&i) {
            extra.same &= same;
            self.ids[i][0] = extra.join(self.ids[i][0], id);
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
