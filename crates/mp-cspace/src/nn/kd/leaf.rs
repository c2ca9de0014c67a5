//! The buckets: `f32` coordinates, structure of arrays.

use super::super::NodeId;
use super::MAX_DIM;

/// States in a leaf.
pub(super) const CAP: usize = 32;

/// Lanes the compiler gets to vectorise at a time.
const WIDE: usize = 16;

/// More states of a leaf that could not be split.
#[derive(Clone, Debug)]
pub(super) struct Extra {
    /// In ascending order.
    pub(super) ids: Vec<NodeId>,
    /// They have all the coordinates of lane 0.
    pub(super) same: bool,
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
    /// `dim` rows of [`CAP`] lanes for each leaf.
    lanes: Vec<f32>,
    free: Vec<usize>,
}

impl Leaves {
    /// A new empty leaf.
    pub(super) fn alloc(&mut self, dim: usize) -> usize {
        let leaf = Leaf::default();
        if let Some(i) = self.free.pop() {
            self.all[i] = leaf;
            return i;
        }
        self.all.push(leaf);
        self.lanes.resize(self.all.len() * dim * CAP, 0.0);
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

    /// The coordinates of leaf `i`: lane `l` of coordinate `d` is at `d * CAP + l`.
    #[inline]
    pub(super) fn lanes(&self, i: usize, dim: usize) -> &[f32] {
        &self.lanes[i * dim * CAP..][..dim * CAP]
    }

    /// Puts a state into a lane.
    #[inline]
    pub(super) fn set(&mut self, i: usize, dim: usize, lane: usize, id: NodeId, x: impl Fn(usize) -> f32) {
        self.all[i].ids[lane] = id;
        let lanes = &mut self.lanes[i * dim * CAP..][..dim * CAP];
        for d in 0..dim {
            lanes[d * CAP + lane] = x(d);
        }
    }

    /// Adds a state to a leaf that is not full.
    #[inline]
    pub(super) fn push(&mut self, i: usize, dim: usize, id: NodeId, x: impl Fn(usize) -> f32) {
        let lane = self.all[i].len;
        self.set(i, dim, lane, id, x);
        self.all[i].len += 1;
    }
}

/// The squared distance of every lane from `q` over the coordinates `start..end`, each the short
/// way round its period.
#[inline(always)]
pub(super) fn squares(
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
