//! Insertion into the k-d tree.

use super::super::NodeId;
use super::super::leaf::CAP;
use super::build::Items;
use super::layout::TreeLayout;
use super::{Inner, KdTree, Ref, Weight};
use crate::nn::states::EmbeddedStates;

impl<const K: usize> KdTree<K> {
    /// Adds the state `id`, which is the query.
    pub(super) fn insert(&mut self, states: &dyn EmbeddedStates, id: NodeId) {
        if self.root.is_none() {
            self.layout = TreeLayout::new(states);
        }
        let dim = self.dim();
        let x = self.layout.embed(|out| states.embed_query(out));
        let [low, high] = &mut self.bounds;
        low.iter_mut().zip(&x).for_each(|(low, x)| *low = low.min(*x));
        high.iter_mut().zip(&x).for_each(|(high, x)| *high = high.max(*x));
        self.largest = x.iter().fold(self.largest, |largest, x| largest.max(x.abs()));
        self.least_antipode = self.layout.least_antipode(&x).min(self.least_antipode);
        let root = match self.root {
            Some(root) => root,
            None => *self.root.insert(Ref::leaf(self.leaves.alloc(dim))),
        };
        let leaf = self.descend(root, &x);
        let joined = self.leaves.head(leaf).has_coincident && self.join(states, leaf, id, &x);
        if joined {
            return;
        }
        if self.leaves.ids(leaf).len() < CAP {
            self.leaves.push(leaf, dim, id, |d| x[d] as f32);
        } else {
            self.split(states, leaf, id, &x);
            self.rebalance(states);
        }
    }

    /// The leaf of `x`; sets `path` to the inner nodes above it.
    fn descend(&mut self, root: Ref, x: &[f64; K]) -> usize {
        self.path.clear();
        let mut r = root;
        loop {
            match r.get() {
                Err(leaf) => return leaf,
                Ok(i) => {
                    let node = &self.inner[i];
                    let side = usize::from(x[node.dim as usize] > node.split);
                    self.path.push((i, side));
                    r = node.children[side];
                }
            }
        }
    }

    /// Adds a state whose coordinates are those of a leaf's lane 0 to the states coincident with it;
    /// `false` when the coordinates differ.
    fn join(&mut self, states: &dyn EmbeddedStates, leaf: usize, id: NodeId, x: &[f64; K]) -> bool {
        let Some(&first) = self.leaves.ids(leaf).first() else { return false };
        if self.layout.embed(|out| states.embed(first, out)) != *x {
            return false;
        }
        self.leaves.join(leaf, id, states.same(first, id));
        true
    }

    /// Splits a full leaf and adds a state to one of the halves.
    fn split(&mut self, states: &dyn EmbeddedStates, leaf: usize, id: NodeId, x: &[f64; K]) {
        let r = match self.halve(leaf, id, x) {
            Some(r) => r,
            None => {
                let mut items = Items::new(self.dim());
                self.gather(states, Ref::leaf(leaf), &mut items);
                items.push(x, id, None);
                self.build(states, &mut items)
            }
        };
        self.replace_at(self.path.len(), r);
        let added = self.leaves_below(r) as i64 - 1;
        self.count(self.path.len(), added);
    }

    /// The fast way to split: at the median of the widest coordinate, all in `f32`.
    fn halve(&mut self, leaf: usize, id: NodeId, x: &[f64; K]) -> Option<Ref> {
        let dim = self.dim();
        let lanes = self.leaves.lanes(leaf, dim);
        let (mut widest, mut width) = (0, 0.0);
        for d in 0..dim {
            let row = &lanes[d * CAP..][..CAP];
            let low = row.iter().fold(f32::INFINITY, |a, &b| a.min(b));
            let high = row.iter().fold(f32::NEG_INFINITY, |a, &b| a.max(b));
            if high - low > width {
                (widest, width) = (d, high - low);
            }
        }
        let row: &[f32; CAP] = lanes[widest * CAP..].first_chunk()?;
        let mut sorted = *row;
        sorted.sort_unstable_by(f32::total_cmp);
        let (a, b) = (sorted[CAP / 2 - 1], sorted[CAP / 2]);
        if a >= b {
            return None;
        }
        // States go to the side of their `f64` coordinate: above `split` means `b` or more in `f32`.
        let middle = 0.5 * (f64::from(a) + f64::from(b));
        let split = if middle as f32 >= b { middle.next_down() } else { middle };
        let (row, lanes, ids) = (*row, lanes.to_vec(), self.leaves.ids(leaf).to_vec());
        let coincident = self.leaves.take_coincident(leaf);
        let right = self.leaves.alloc(dim);
        self.leaves.clear(leaf, dim);
        for (lane, &id) in ids.iter().enumerate() {
            let to = if row[lane] >= b { right } else { leaf };
            self.leaves.push(to, dim, id, |d| lanes[d * CAP + lane]);
        }
        // Lane 0 is still lane 0 of its leaf.
        self.leaves.set_coincident(if row[0] >= b { right } else { leaf }, coincident);
        let to = if x[widest] > split { right } else { leaf };
        self.leaves.push(to, dim, id, |d| x[d] as f32);
        Some(self.new_inner(Inner {
            split,
            children: [Ref::leaf(leaf), Ref::leaf(right)],
            dim: widest as u32,
            weight: Weight::new(2),
        }))
    }

    pub(super) fn new_inner(&mut self, node: Inner) -> Ref {
        if let Some(i) = self.free_inner.pop() {
            self.inner[i] = node;
            return Ref::inner(i);
        }
        self.inner.push(node);
        Ref::inner(self.inner.len() - 1)
    }

    pub(super) fn leaves_below(&self, r: Ref) -> u32 {
        r.get().map_or(1, |i| self.inner[i].weight.leaves)
    }

    /// Makes `r` the node at depth `depth` of the path.
    fn replace_at(&mut self, depth: usize, r: Ref) {
        match depth.checked_sub(1).map(|parent| self.path[parent]) {
            Some((parent, side)) => self.inner[parent].children[side] = r,
            None => self.root = Some(r),
        }
    }

    /// Adds `change` to the number of leaves below the first `depth` nodes of the path.
    fn count(&mut self, depth: usize, change: i64) {
        for &(i, _) in &self.path[..depth] {
            self.inner[i].weight.change(change);
        }
    }

    /// Rebuilds the highest node of the path that is out of balance and has grown enough since it was
    /// built to pay for it.
    fn rebalance(&mut self, states: &dyn EmbeddedStates) {
        let unbalanced = |&(i, _): &(usize, usize)| {
            let node = &self.inner[i];
            let [a, b] = node.children.map(|child| self.leaves_below(child));
            node.weight.is_unbalanced(a.max(b))
        };
        let Some(depth) = self.path.iter().position(unbalanced) else { return };
        let (i, _) = self.path[depth];
        let before = i64::from(self.inner[i].weight.leaves);
        let mut items = Items::new(self.dim());
        self.gather(states, Ref::inner(i), &mut items);
        let r = self.build(states, &mut items);
        self.replace_at(depth, r);
        let after = i64::from(self.leaves_below(r));
        self.count(depth, after - before);
    }
}
