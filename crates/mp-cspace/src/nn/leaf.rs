//! The buckets of the trees: `f32` numbers of up to 32 states, structure of arrays.

use super::NodeId;

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
    pub(super) fn beside(first: NodeId, mut ids: Vec<NodeId>, same: bool) -> Option<Box<Self>> {
        ids.retain(|&id| id != first);
        ids.sort_unstable();
        (!ids.is_empty()).then(|| Box::new(Self { ids, same }))
    }

    /// Adds the state `id`; returns the smallest id, which belongs into lane 0.
    pub(super) fn join(&mut self, first: NodeId, id: NodeId) -> NodeId {
        let at = self.ids.partition_point(|&other| other < first.max(id));
        self.ids.insert(at, first.max(id));
        first.min(id)
    }
}

/// What a leaf holds beside its coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaf {
    pub(super) len: usize,
    pub(super) ids: [NodeId; CAP],
    pub(super) extra: Option<Box<Extra>>,
}

/// All leaves of a tree.
#[derive(Clone, Debug, Default)]
pub(super) struct Leaves {
    all: Vec<Leaf>,
    /// `rows` rows of [`CAP`] lanes for each leaf.
    lanes: Vec<f32>,
    free: Vec<usize>,
}

impl Leaves {
    /// A new empty leaf.
    pub(super) fn alloc(&mut self, rows: usize) -> usize {
        let leaf = Leaf::default();
        if let Some(i) = self.free.pop() {
            self.all[i] = leaf;
            return i;
        }
        self.all.push(leaf);
        self.lanes.resize(self.all.len() * rows * CAP, 0.0);
        self.all.len() - 1
    }

    /// Takes leaf `i` back.
    pub(super) fn free(&mut self, i: usize) {
        self.all[i].extra = None;
        self.free.push(i);
    }

    #[inline]
    pub(super) fn get(&self, i: usize) -> &Leaf {
        &self.all[i]
    }

    pub(super) fn get_mut(&mut self, i: usize) -> &mut Leaf {
        &mut self.all[i]
    }

    /// The numbers of leaf `i`: lane `l` of row `d` is at `d * CAP + l`.
    #[inline]
    pub(super) fn lanes(&self, i: usize, rows: usize) -> &[f32] {
        &self.lanes[i * rows * CAP..][..rows * CAP]
    }

    /// Puts a state into a lane.
    #[inline]
    pub(super) fn set(&mut self, i: usize, rows: usize, lane: usize, id: NodeId, x: impl Fn(usize) -> f32) {
        self.all[i].ids[lane] = id;
        let lanes = &mut self.lanes[i * rows * CAP..][..rows * CAP];
        for d in 0..rows {
            lanes[d * CAP + lane] = x(d);
        }
    }

    /// Adds a state to a leaf that is not full.
    #[inline]
    pub(super) fn push(&mut self, i: usize, rows: usize, id: NodeId, x: impl Fn(usize) -> f32) {
        let lane = self.all[i].len;
        self.set(i, rows, lane, id, x);
        self.all[i].len += 1;
    }
}
