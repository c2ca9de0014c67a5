//! The broad phase: a balanced dynamic tree of axis-aligned boxes.
//!
//! Insertion descends where the surface grows least and rotates on the way back up, as in E. Catto,
//! *Dynamic Bounding Volume Hierarchies*, GDC 2019.

use nalgebra::Point3;

/// IntervalClearance for a traversal: the tree is balanced, 2³² boxes are less than 50 levels.
const STACK: usize = 96;

/// An axis-aligned box in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) min: Point3<f64>,
    pub(crate) max: Point3<f64>,
}

impl Bounds {
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        (0..3).all(|k| self.min[k] <= other.max[k] && other.min[k] <= self.max[k])
    }

    /// The distance of two boxes, 0 when they overlap.
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        let gap = |k: usize| (other.min[k] - self.max[k]).max(self.min[k] - other.max[k]).max(0.0);
        (0..3).map(|k| gap(k) * gap(k)).sum::<f64>().sqrt()
    }

    fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    fn surface(&self) -> f64 {
        let d = self.max - self.min;
        d.x * d.y + d.y * d.z + d.z * d.x
    }
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Bounds,
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

/// A set of boxes, each with a number, that tells which may overlap a given box.
#[derive(Clone, Debug, Default)]
pub(crate) struct BroadPhase {
    nodes: Vec<Node>,
    free: Vec<usize>,
    root: Option<usize>,
}

impl BroadPhase {
    /// Whether there is no box.
    pub(crate) fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// Adds a box; returns the handle to remove it by.
    pub(crate) fn insert(&mut self, item: u32, bounds: Bounds) -> usize {
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

    /// Removes what [`BroadPhase::insert`] returned `leaf` for.
    pub(crate) fn remove(&mut self, leaf: usize) {
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
        mut enter: impl FnMut(&Bounds) -> bool,
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
    /// it returns the new limit. Returns a lower bound on the distance of all boxes passed over.
    pub(crate) fn nearest(&self, own: &Bounds, mut limit: f64, mut visit: impl FnMut(u32) -> f64) -> f64 {
        let mut passed_over = f64::INFINITY;
        let mut stack = [(0.0, 0); STACK];
        let mut top = 0;
        if let Some(root) = self.root {
            stack[0] = (own.distance(&self.nodes[root].bounds), root);
            top = 1;
        }
        while top > 0 {
            top -= 1;
            let (distance, node) = stack[top];
            // Boxes that overlap are looked at even at limit 0.
            if distance > 0.0 && distance >= limit {
                passed_over = passed_over.min(distance);
                continue;
            }
            match self.nodes[node].content {
                Content::Leaf(item) => limit = visit(item),
                Content::Inner(children) => {
                    let [x, y] = children.map(|child| (own.distance(&self.nodes[child].bounds), child));
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

    /// Where a new box costs the least surface.
    fn best_sibling(&self, root: usize, bounds: &Bounds) -> usize {
        let mut at = root;
        while let Content::Inner(children) = self.nodes[at].content {
            let here = self.nodes[at].bounds;
            let joined = here.union(bounds).surface();
            let growth = joined - here.surface();
            let cost = |child: usize| {
                let node = &self.nodes[child];
                let joined = node.bounds.union(bounds).surface();
                growth + if node.height == 0 { joined } else { joined - node.bounds.surface() }
            };
            let (x, y) = (cost(children[0]), cost(children[1]));
            if joined < x.min(y) {
                break;
            }
            at = if x <= y { children[0] } else { children[1] };
        }
        at
    }

    /// Sets box and height of `start` and all above it right, rotating where the heights differ by two.
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

    /// Lifts the higher child of `node` when it is higher by two or more; returns who is on top now.
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
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn random_bounds(rng: &mut rand_pcg::Pcg64) -> Bounds {
        let min = Point3::from([0; 3].map(|_| rng.random_range(-10.0..10.0)));
        let max = min + nalgebra::Vector3::from([0; 3].map(|_| rng.random_range(0.0..3.0)));
        Bounds { min, max }
    }

    #[test]
    fn finds_what_a_scan_finds_through_inserts_and_removals() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
        let mut broad = BroadPhase::default();
        let mut all: Vec<(u32, usize, Bounds)> = Vec::new();
        for step in 0..3000_u32 {
            if all.len() > 150 || (!all.is_empty() && rng.random_bool(0.4)) {
                let (_, handle, _) = all.swap_remove(rng.random_range(0..all.len()));
                broad.remove(handle);
            } else {
                let bounds = random_bounds(&mut rng);
                all.push((step, broad.insert(step, bounds), bounds));
            }
            let probe = random_bounds(&mut rng);
            let mut found = Vec::new();
            let stopped: Option<()> = broad.find(
                |b| b.overlaps(&probe),
                |item| {
                    found.push(item);
                    None
                },
            );
            assert_eq!(stopped, None);
            found.sort_unstable();
            let mut expected: Vec<u32> =
                all.iter().filter(|(_, _, b)| b.overlaps(&probe)).map(|(item, ..)| *item).collect();
            expected.sort_unstable();
            assert_eq!(found, expected, "step {step}");
        }
    }

    #[test]
    fn stays_balanced_when_boxes_come_in_order_or_coincide() {
        for spacing in [0.0, 1.0, 100.0] {
            let mut broad = BroadPhase::default();
            for i in 0..4096_u32 {
                let x = f64::from(i) * spacing;
                broad
                    .insert(i, Bounds { min: Point3::new(x, 0.0, 0.0), max: Point3::new(x + 1.0, 1.0, 1.0) });
            }
            let height = broad.nodes[broad.root.unwrap()].height;
            assert!(height <= 40, "height {height} at spacing {spacing}");
        }
    }
}
