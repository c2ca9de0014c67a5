//! The broad phase: a balanced dynamic tree of axis-aligned boxes.
//!
//! Insertion descends where the surface grows least and rotates on the way back up, as in E. Catto,
//! *Dynamic Bounding Volume Hierarchies*, GDC 2019.

use mp_geom::Aabb;
use mp_simd::wide::{Doubles, LANES, Wide, Wide3, load3};

/// Of no more boxes than this a list is kept beside the tree.
const FEW: usize = 64;

/// Room for a traversal: the tree is balanced, so that 2³² boxes are less than 50 levels.
const STACK: usize = 96;

/// The distance of two boxes, 0 when they overlap.
pub(crate) fn distance(a: &Aabb, b: &Aabb) -> f64 {
    let gap = |k: usize| (b.min[k] - a.max[k]).max(a.min[k] - b.max[k]).max(0.0);
    (0..3).map(|k| gap(k) * gap(k)).sum::<f64>().sqrt()
}

/// Half the surface of a box.
fn surface(aabb: &Aabb) -> f64 {
    let d = aabb.max - aabb.min;
    d.x * d.y + d.y * d.z + d.z * d.x
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Aabb,
    parent: Option<usize>,
    content: Content,
    /// 0 for a leaf.
    height: u32,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    Leaf(u32),
    Inner([usize; 2]),
    Free,
}

/// Up to eight boxes.
#[derive(Clone, Debug)]
pub(crate) struct EightBoxes {
    pub(crate) items: [u32; LANES],
    /// Bit i is set where there is a box.
    pub(crate) taken: u32,
    low: Wide3,
    high: Wide3,
    /// The largest absolute coordinates.
    pub(crate) size: Wide,
}

impl EightBoxes {
    const NONE: Self = Self {
        items: [0; LANES],
        taken: 0,
        low: [Wide::splat(f64::INFINITY); 3],
        high: [Wide::splat(f64::NEG_INFINITY); 3],
        size: Wide::splat(0.0),
    };

    fn push(&mut self, item: u32, bounds: &Aabb) {
        let i = self.taken.count_ones() as usize;
        self.taken |= 1 << i;
        self.items[i] = item;
        for k in 0..3 {
            (self.low[k].0[i], self.high[k].0[i]) = (bounds.min[k], bounds.max[k]);
        }
        self.size.0[i] = bounds.min.coords.amax().max(bounds.max.coords.amax());
    }

    /// The squares of the distances of a box, 0 where it overlaps.
    #[inline(always)]
    pub(crate) fn square_distance<D: Doubles>(&self, low: &[f64; 3], high: &[f64; 3]) -> D {
        let (own_low, own_high) = (load3::<D>(&self.low), load3::<D>(&self.high));
        let mut square = D::splat(0.0);
        let mut k = 0;
        while k < 3 {
            let gap = (own_low[k] - high[k]).max(D::splat(low[k]) - own_high[k]).max(D::splat(0.0));
            square = square + gap * gap;
            k += 1;
        }
        square
    }
}

/// A set of numbered boxes that finds those which overlap a box, or are near it.
#[derive(Clone, Debug, Default)]
pub(crate) struct BroadPhase {
    nodes: Vec<Node>,
    free: Vec<usize>,
    root: Option<usize>,
    /// All boxes in the order in which they are found, where they are few.
    list: Vec<EightBoxes>,
}

impl BroadPhase {
    /// Whether there is no box.
    pub(crate) fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// All boxes in the order in which [`find`](Self::find) finds them; `None` where they are many.
    pub(crate) fn few(&self) -> Option<&[EightBoxes]> {
        (self.is_empty() || !self.list.is_empty()).then_some(&self.list)
    }

    /// Makes the list anew, O(n) for n boxes.
    fn relist(&mut self) {
        let Self { nodes, free, root, list } = self;
        list.clear();
        let Some(root) = root.filter(|_| nodes.len() - free.len() < 2 * FEW) else { return };
        let (mut stack, mut top) = ([root; STACK], 1);
        while top > 0 {
            top -= 1;
            match &nodes[stack[top]] {
                Node { content: Content::Leaf(item), bounds, .. } => {
                    if list.last().is_none_or(|last| last.taken.count_ones() as usize == LANES) {
                        list.push(EightBoxes::NONE);
                    }
                    if let Some(last) = list.last_mut() {
                        last.push(*item, bounds);
                    }
                }
                Node { content: Content::Inner([x, y]), .. } => {
                    (stack[top], stack[top + 1]) = (*y, *x);
                    top += 2;
                }
                Node { content: Content::Free, .. } => {}
            }
        }
    }

    /// Adds a box; returns the handle to remove it by.
    pub(crate) fn insert(&mut self, item: u32, bounds: Aabb) -> usize {
        let leaf = self.add(item, bounds);
        self.relist();
        leaf
    }

    fn add(&mut self, item: u32, bounds: Aabb) -> usize {
        let leaf = self.allocate(Node { bounds, parent: None, content: Content::Leaf(item), height: 0 });
        let Some(root) = self.root else {
            self.root = Some(leaf);
            return leaf;
        };
        let sibling = self.best_sibling(root, &bounds);
        let old_parent = self.nodes[sibling].parent;
        let parent = self.allocate(Node {
            bounds,
            parent: old_parent,
            content: Content::Inner([sibling, leaf]),
            height: 1,
        });
        self.nodes[sibling].parent = Some(parent);
        self.nodes[leaf].parent = Some(parent);
        self.replace_child(old_parent, sibling, parent);
        self.refit_from(Some(parent));
        leaf
    }

    /// Removes the box for which [`BroadPhase::insert`] returned `leaf`.
    pub(crate) fn remove(&mut self, leaf: usize) {
        self.take(leaf);
        self.relist();
    }

    fn take(&mut self, leaf: usize) {
        let parent = self.nodes[leaf].parent;
        self.release(leaf);
        let Some(parent) = parent else {
            self.root = None;
            return;
        };
        let grandparent = self.nodes[parent].parent;
        if let Content::Inner([x, y]) = self.nodes[parent].content {
            let sibling = if x == leaf { y } else { x };
            self.nodes[sibling].parent = grandparent;
            self.replace_child(grandparent, parent, sibling);
        }
        self.release(parent);
        self.refit_from(grandparent);
    }

    /// Calls `visit` with the numbers of all boxes that `enter` accepts, and whose ancestors' boxes it
    /// accepts, until `visit` returns something.
    pub(crate) fn find<T>(
        &self,
        mut enter: impl FnMut(&Aabb) -> bool,
        mut visit: impl FnMut(u32) -> Option<T>,
    ) -> Option<T> {
        let mut stack = [0; STACK];
        let mut top = 0;
        if let Some(root) = self.root {
            stack[0] = root;
            top = 1;
        }
        while top > 0 {
            top -= 1;
            let node = &self.nodes[stack[top]];
            if !enter(&node.bounds) {
                continue;
            }
            match node.content {
                Content::Leaf(item) => {
                    if let Some(found) = visit(item) {
                        return Some(found);
                    }
                }
                Content::Inner([x, y]) => {
                    stack[top] = y;
                    stack[top + 1] = x;
                    top += 2;
                }
                Content::Free => {}
            }
        }
        None
    }

    /// Calls `visit` with the numbers of boxes nearer to `own` than `limit`, the nearer ones first as a rule;
    /// it returns the new limit. Returns a lower bound on the distance of all boxes not visited.
    pub(crate) fn nearest(&self, own: &Aabb, mut limit: f64, mut visit: impl FnMut(u32) -> f64) -> f64 {
        let mut passed_over = f64::INFINITY;
        let mut stack = [(0.0, 0); STACK];
        let mut top = 0;
        if let Some(root) = self.root {
            stack[0] = (distance(own, &self.nodes[root].bounds), root);
            top = 1;
        }
        while top > 0 {
            top -= 1;
            let (far, node) = stack[top];
            // Boxes that overlap are visited even at limit 0.
            if far > 0.0 && far >= limit {
                passed_over = passed_over.min(far);
                continue;
            }
            match self.nodes[node].content {
                Content::Leaf(item) => limit = visit(item),
                Content::Inner(children) => {
                    let [x, y] = children.map(|child| (distance(own, &self.nodes[child].bounds), child));
                    (stack[top], stack[top + 1]) = if x.0 <= y.0 { (y, x) } else { (x, y) };
                    top += 2;
                }
                Content::Free => {}
            }
        }
        passed_over
    }

    fn allocate(&mut self, node: Node) -> usize {
        match self.free.pop() {
            Some(slot) => {
                self.nodes[slot] = node;
                slot
            }
            None => {
                self.nodes.push(node);
                self.nodes.len() - 1
            }
        }
    }

    fn release(&mut self, slot: usize) {
        self.nodes[slot].content = Content::Free;
        self.free.push(slot);
    }

    fn replace_child(&mut self, parent: Option<usize>, old: usize, new: usize) {
        match parent {
            None => self.root = Some(new),
            Some(parent) => {
                if let Content::Inner(children) = &mut self.nodes[parent].content {
                    for child in children {
                        if *child == old {
                            *child = new;
                        }
                    }
                }
            }
        }
    }

    /// The node beside which a new box costs the least surface.
    fn best_sibling(&self, root: usize, bounds: &Aabb) -> usize {
        let mut at = root;
        while let Content::Inner(children) = self.nodes[at].content {
            let here = self.nodes[at].bounds;
            let joined = surface(&here.union(bounds));
            let growth = joined - surface(&here);
            let cost = |child: usize| {
                let node = &self.nodes[child];
                let joined = surface(&node.bounds.union(bounds));
                growth + if node.height == 0 { joined } else { joined - surface(&node.bounds) }
            };
            let (x, y) = (cost(children[0]), cost(children[1]));
            if joined < x.min(y) {
                break;
            }
            at = if x <= y { children[0] } else { children[1] };
        }
        at
    }

    /// Updates box and height of `start` and its ancestors, rotating where the heights of children differ by two.
    fn refit_from(&mut self, start: Option<usize>) {
        let mut at = start;
        while let Some(node) = at {
            let node = self.rotate(node);
            self.refit(node);
            at = self.nodes[node].parent;
        }
    }

    fn refit(&mut self, node: usize) {
        if let Content::Inner([x, y]) = self.nodes[node].content {
            self.nodes[node].bounds = self.nodes[x].bounds.union(&self.nodes[y].bounds);
            self.nodes[node].height = 1 + self.nodes[x].height.max(self.nodes[y].height);
        }
    }

    /// Lifts the higher child of `node` when it is higher by two or more; returns the node now on top.
    fn rotate(&mut self, node: usize) -> usize {
        let Content::Inner([x, y]) = self.nodes[node].content else { return node };
        let (high, low) = if self.nodes[x].height >= self.nodes[y].height { (x, y) } else { (y, x) };
        if self.nodes[high].height < self.nodes[low].height + 2 {
            return node;
        }
        let Content::Inner([p, q]) = self.nodes[high].content else { return node };
        let (keep, give) = if self.nodes[p].height >= self.nodes[q].height { (p, q) } else { (q, p) };
        // node(high(keep, give), low) becomes high(node(give, low), keep).
        let parent = self.nodes[node].parent;
        self.nodes[high].parent = parent;
        self.replace_child(parent, node, high);
        self.nodes[node].parent = Some(high);
        self.nodes[give].parent = Some(node);
        self.nodes[high].content = Content::Inner([node, keep]);
        self.nodes[node].content = Content::Inner([give, low]);
        self.refit(node);
        high
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn random_bounds(rng: &mut rand_pcg::Pcg64) -> Aabb {
        let min = Point3::from([0; 3].map(|_| rng.random_range(-10.0..10.0)));
        let max = min + nalgebra::Vector3::from([0; 3].map(|_| rng.random_range(0.0..3.0)));
        Aabb { min, max }
    }

    #[test]
    fn finds_what_a_scan_finds_through_inserts_and_removals() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
        let mut broad = BroadPhase::default();
        let mut all: Vec<(u32, usize, Aabb)> = Vec::new();
        for step in 0..3000_u32 {
            if all.len() > if step < 1000 { 40 } else { 150 } || (!all.is_empty() && rng.random_bool(0.4)) {
                let (_, handle, _) = all.swap_remove(rng.random_range(0..all.len()));
                broad.remove(handle);
            } else {
                let bounds = random_bounds(&mut rng);
                all.push((step, broad.insert(step, bounds), bounds));
            }
            let probe = random_bounds(&mut rng);
            let mut found = Vec::new();
            let stopped: Option<()> = broad.find(
                |b| b.intersects(&probe),
                |item| {
                    found.push(item);
                    None
                },
            );
            assert_eq!(stopped, None);
            let in_order = found.clone();
            found.sort_unstable();
            let mut expected: Vec<u32> =
                all.iter().filter(|(_, _, b)| b.intersects(&probe)).map(|(item, ..)| *item).collect();
            expected.sort_unstable();
            let Some(list) = broad.few() else {
                assert!(all.len() > FEW);
                assert_eq!(found, expected, "step {step}");
                continue;
            };
            assert!(all.len() <= FEW);
            // In the same order, each with its distance.
            let (low, high) = (probe.min.coords.into(), probe.max.coords.into());
            let listed = list.iter().flat_map(|eight| {
                let far = eight.square_distance::<Wide>(&low, &high).sqrt();
                let taken = move |i: &usize| eight.taken >> i & 1 == 1;
                (0..LANES).filter(taken).map(move |i| (eight.items[i], far.0[i]))
            });
            let listed: Vec<(u32, f64)> = listed.collect();
            for (item, far) in &listed {
                let own = all.iter().find(|(own, ..)| own == item).unwrap().2;
                assert_eq!(*far, distance(&probe, &own));
            }
            assert_eq!(listed.len(), all.len());
            let near: Vec<u32> =
                listed.iter().filter(|(_, far)| *far == 0.0).map(|(item, _)| *item).collect();
            assert_eq!(near, in_order, "step {step}");
            assert_eq!(found, expected, "step {step}");
        }
    }

    #[test]
    fn stays_balanced_when_boxes_come_in_order_or_coincide() {
        for spacing in [0.0, 1.0, 100.0] {
            let mut broad = BroadPhase::default();
            for i in 0..4096_u32 {
                let x = f64::from(i) * spacing;
                broad.insert(i, Aabb { min: Point3::new(x, 0.0, 0.0), max: Point3::new(x + 1.0, 1.0, 1.0) });
            }
            let height = broad.nodes[broad.root.unwrap()].height;
            assert!(height <= 40, "height {height} at spacing {spacing}");
        }
    }
}
