//! Building: a binary tree by the surface-area heuristic with bins, collapsed to eight children where
//! dynamic programming finds it cheapest.

use std::ops::Range;

use nalgebra::{Point3, Vector3};

use super::fit::{centred, fit};
use super::{LEAF, Leaf, Node, Obb, Tree, WIDTH};
use crate::triangle::Triangle;

const BINS: usize = 128;
/// Up to so many triangles every division is tried, not only those between bins.
const SWEEP: usize = 64;
/// The cost of a leaf in units of a node's.
const LEAF_COST: f64 = 1.0;

struct Binary {
    /// Children, which are neighbours; 0 in a leaf.
    children: usize,
    range: Range<usize>,
    obb: Obb,
    surface: f64,
}

/// The cheapest forest under a binary node with at most k + 1 roots, for k in 0..8: what it costs, and how
/// many roots go left (0: the node itself is the root).
struct Choice {
    cost: [f64; WIDTH],
    left: [u8; WIDTH],
    /// How many of the eight children of a node made here go left.
    node_left: u8,
}

/// What a tree knows of all its corners.
pub(crate) struct Size {
    pub(crate) center: Point3<f64>,
    pub(crate) radius_center: f64,
    pub(crate) radius: f64,
}

impl Size {
    pub(crate) fn of<'a>(corners: impl Iterator<Item = &'a Point3<f64>> + Clone) -> Self {
        let (mut lo, mut hi) = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        for p in corners.clone() {
            lo = lo.inf(&p.coords);
            hi = hi.sup(&p.coords);
        }
        let center = Point3::from(lo * 0.5 + hi * 0.5);
        let up = 1.0 + 1e-15;
        // A mesh moved by a pose that is not finite has corners that are none: infinitely far away.
        let farthest = |far: f64, r: f64| if r.is_nan() { f64::INFINITY } else { far.max(r) };
        let radius = corners.clone().map(|p| p.coords.norm()).fold(0.0, farthest) * up;
        let radius_center = corners.map(|p| (p - center).norm()).fold(0.0, farthest) * up;
        Self { center, radius_center, radius }
    }
}

impl Tree {
    /// `triangles` is neither empty nor longer than `u32` can count: `TriMesh` has seen to it.
    pub(crate) fn build(triangles: &[Triangle]) -> Self {
        let Size { center, radius_center, radius } = Size::of(triangles.iter().flatten());
        let mut items: Vec<Item> = triangles
            .iter()
            .enumerate()
            .map(|(i, t)| {
                let corners = centred(t, &center);
                Item { corners, id: i as u32 }
            })
            .collect();
        let binary = split_all(&mut items);
        let choices = choose(&binary);
        let mut tree = Self {
            nodes: Vec::new(),
            leaves: Vec::new(),
            node_boxes: Vec::new(),
            leaf_boxes: Vec::new(),
            root: 0,
            bounding: crate::obb::Obb::fit(triangles.iter()),
            triangles: items.iter().map(|i| triangles[i.id as usize]).collect(),
            ids: items.iter().map(|i| i.id).collect(),
            center,
            radius_center,
            radius,
        };
        tree.root = tree.emit(&binary, &choices, 0);
        tree.nodes.shrink_to_fit();
        tree.leaves.shrink_to_fit();
        tree
    }

    /// Adds binary node `n` and all below; returns the reference to it.
    fn emit(&mut self, binary: &[Binary], choices: &[Choice], n: usize) -> u32 {
        let b = &binary[n];
        if b.children == 0 {
            self.leaves.push(leaf(&self.triangles, &self.center, &b.range, &b.obb));
            self.leaf_boxes.push(b.obb);
            return LEAF | (self.leaves.len() - 1) as u32;
        }
        let mut roots = Vec::with_capacity(WIDTH);
        let left = usize::from(choices[n].node_left);
        forest(binary, choices, b.children, left, &mut roots);
        forest(binary, choices, b.children + 1, WIDTH - left, &mut roots);
        let me = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        self.node_boxes.push(b.obb);
        for (lane, &root) in roots.iter().enumerate() {
            let child = self.emit(binary, choices, root);
            self.nodes[me].set(lane, child, &binary[root].obb);
        }
        me as u32
    }
}

/// The leaf of `triangles[range]`, neither none nor more than eight, with the box around them.
pub(crate) fn leaf(triangles: &[Triangle], center: &Point3<f64>, range: &Range<usize>, obb: &Obb) -> Leaf {
    let (first, count) = (range.start, range.len());
    let middle: [f64; 3] = std::array::from_fn(|d| center[d] + f64::from(obb.frame[d][0]));
    let mut leaf = Leaf {
        corner: [[[0.0; WIDTH]; 3]; 3],
        center: middle,
        magnitude: 0.0,
        edge: 0.0,
        first: first as u32,
        count: count as u32,
    };
    for lane in 0..WIDTH {
        let t = &triangles[first + lane.min(count - 1)];
        for k in 0..3 {
            for d in 0..3 {
                let x = (t[k][d] - middle[d]) as f32;
                leaf.corner[k][d][lane] = x;
                leaf.magnitude = leaf.magnitude.max(x.abs());
            }
            let edge = ((t[(k + 1) % 3] - t[k]).norm() * (1.0 + 1e-6)) as f32;
            leaf.edge = leaf.edge.max(edge);
        }
    }
    leaf
}

/// A triangle on its way through the build.
#[derive(Clone, Copy)]
struct Item {
    corners: [[f64; 3]; 3],
    id: u32,
}

/// The binary tree, parents before children.
fn split_all(items: &mut [Item]) -> Vec<Binary> {
    let mut scratch = Vec::new();
    let mut binary = vec![boxed(items, 0..items.len(), &mut scratch)];
    let mut n = 0;
    while n < binary.len() {
        let range = binary[n].range.clone();
        if range.len() > WIDTH {
            let middle = range.start + split(&mut items[range.clone()], &binary[n].obb);
            binary[n].children = binary.len();
            let low = boxed(items, range.start..middle, &mut scratch);
            let high = boxed(items, middle..range.end, &mut scratch);
            binary.push(low);
            binary.push(high);
        }
        n += 1;
    }
    binary
}

fn boxed(items: &[Item], range: Range<usize>, scratch: &mut Vec<[[f64; 3]; 3]>) -> Binary {
    scratch.clear();
    scratch.extend(items[range.clone()].iter().map(|i| i.corners));
    let obb = fit(scratch);
    let h = obb.half.map(f64::from);
    Binary { children: 0, range, obb, surface: h[0] * h[1] + h[1] * h[2] + h[2] * h[0] }
}

/// Extent along up to six axes.
#[derive(Clone, Copy)]
struct Bounds {
    lo: [f64; AXES],
    hi: [f64; AXES],
    count: usize,
}

/// The axes of the mesh, then those of the box.
const AXES: usize = 6;

impl Bounds {
    const EMPTY: Self = Self { lo: [f64::INFINITY; AXES], hi: [f64::NEG_INFINITY; AXES], count: 0 };

    #[inline(always)]
    fn join(&mut self, other: &Self) {
        for d in 0..AXES {
            self.lo[d] = if other.lo[d] < self.lo[d] { other.lo[d] } else { self.lo[d] };
            self.hi[d] = if other.hi[d] > self.hi[d] { other.hi[d] } else { self.hi[d] };
        }
        self.count += other.count;
    }

    /// Surface (in the tighter of the two frames) times the number of lanes it takes.
    fn cost(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let s: [f64; AXES] = std::array::from_fn(|d| self.hi[d] - self.lo[d]);
        let surface = |s: &[f64]| s[0] * s[1] + s[1] * s[2] + s[2] * s[0];
        let n = if self.count > 4 * WIDTH { self.count } else { self.count.div_ceil(WIDTH) * WIDTH };
        surface(&s[..3]).min(surface(&s[3..])) * n as f64
    }
}

/// Reorders `items` in two parts, neither empty; returns the length of the first.
fn split(items: &mut [Item], obb: &Obb) -> usize {
    let mut axes = [[0.0; 3]; AXES];
    (axes[0][0], axes[1][1], axes[2][2]) = (1.0, 1.0, 1.0);
    for k in 0..3 {
        axes[3 + k] = std::array::from_fn(|d| f64::from(obb.frame[d][k + 1]));
    }
    let own: Vec<Bounds> = items
        .iter()
        .map(|item| {
            let mut own = Bounds { count: 1, ..Bounds::EMPTY };
            for k in 0..AXES {
                let along = |p: &[f64; 3]| axes[k][0] * p[0] + axes[k][1] * p[1] + axes[k][2] * p[2];
                let [a, b, c] = [along(&item.corners[0]), along(&item.corners[1]), along(&item.corners[2])];
                own.lo[k] = a.min(b).min(c);
                own.hi[k] = a.max(b).max(c);
            }
            own
        })
        .collect();
    if items.len() <= SWEEP { sweep(items, &own) } else { bin(items, &own) }
}

/// Every division in the order of the middles along each axis.
fn sweep(items: &mut [Item], own: &[Bounds]) -> usize {
    let n = items.len();
    let mut best = (f64::INFINITY, 0, n / 2);
    let mut above = vec![0.0; n];
    let mut orders: Vec<Vec<u32>> = Vec::with_capacity(AXES);
    for k in 0..AXES {
        let middle = |i: u32| own[i as usize].lo[k] + own[i as usize].hi[k];
        let mut order: Vec<u32> = (0..n as u32).collect();
        order.sort_unstable_by(|&i, &j| middle(i).total_cmp(&middle(j)).then(i.cmp(&j)));
        let mut right = Bounds::EMPTY;
        for i in (1..n).rev() {
            right.join(&own[order[i] as usize]);
            above[i] = right.cost();
        }
        let mut left = Bounds::EMPTY;
        for i in 1..n {
            left.join(&own[order[i - 1] as usize]);
            let cost = left.cost() + above[i];
            if cost < best.0 {
                best = (cost, k, i);
            }
        }
        orders.push(order);
    }
    let sorted: Vec<Item> = orders[best.1].iter().map(|&i| items[i as usize]).collect();
    items.copy_from_slice(&sorted);
    best.2
}

/// Divisions between bins along each axis.
fn bin(items: &mut [Item], own: &[Bounds]) -> usize {
    let (mut lo, mut hi) = ([f64::INFINITY; AXES], [f64::NEG_INFINITY; AXES]);
    for o in own {
        for k in 0..AXES {
            let x = o.lo[k] + o.hi[k];
            lo[k] = lo[k].min(x);
            hi[k] = hi[k].max(x);
        }
    }
    let scale: [f64; AXES] = std::array::from_fn(|k| BINS as f64 / (hi[k] - lo[k]));
    let of = |o: &Bounds, k: usize| (((o.lo[k] + o.hi[k] - lo[k]) * scale[k]) as usize).min(BINS - 1);
    let mut best: Option<(f64, usize, usize)> = None;
    for k in (0..AXES).filter(|&k| scale[k].is_finite()) {
        let mut bins = [Bounds::EMPTY; BINS];
        for o in own {
            bins[of(o, k)].join(o);
        }
        let mut above = [0.0; BINS];
        let mut right = Bounds::EMPTY;
        for i in (1..BINS).rev() {
            right.join(&bins[i]);
            above[i] = right.cost();
        }
        let mut left = Bounds::EMPTY;
        for i in 1..BINS {
            left.join(&bins[i - 1]);
            let cost = left.cost() + above[i];
            if left.count > 0 && left.count < items.len() && best.is_none_or(|(c, ..)| cost < c) {
                best = Some((cost, k, i));
            }
        }
    }
    let Some((_, k, i)) = best else {
        return items.len() / 2; // All in one place.
    };
    // A stable partition: the order depends on the mesh alone.
    let low: Vec<Item> = items.iter().zip(own).filter(|(_, o)| of(o, k) < i).map(|(item, _)| *item).collect();
    let high: Vec<Item> =
        items.iter().zip(own).filter(|(_, o)| of(o, k) >= i).map(|(item, _)| *item).collect();
    items[..low.len()].copy_from_slice(&low);
    items[low.len()..].copy_from_slice(&high);
    low.len()
}

/// Dynamic programming from the leaves up: where to make nodes of eight so that the boxes a query is
/// likely to test are fewest (the chance that a box is reached is proportional to its surface).
fn choose(binary: &[Binary]) -> Vec<Choice> {
    let mut choices: Vec<Choice> = Vec::with_capacity(binary.len());
    choices.resize_with(binary.len(), || Choice { cost: [0.0; WIDTH], left: [0; WIDTH], node_left: 1 });
    for n in (0..binary.len()).rev() {
        let b = &binary[n];
        if b.children == 0 {
            choices[n].cost = [b.surface * LEAF_COST; WIDTH];
            continue;
        }
        let (l, r) = (b.children, b.children + 1);
        // Cheapest division of k + 1 roots, k ≥ 1, between the children: some division too where all costs
        // have overflowed.
        let mut divided = [(f64::INFINITY, 1u8); WIDTH + 1];
        for (k, best) in divided.iter_mut().enumerate().skip(1).take(WIDTH - 1) {
            for left in 0..k {
                let cost = choices[l].cost[left] + choices[r].cost[k - 1 - left];
                if cost < best.0 {
                    *best = (cost, left as u8 + 1);
                }
            }
        }
        let c = &mut choices[n];
        c.node_left = divided[WIDTH - 1].1;
        c.cost[0] = b.surface + divided[WIDTH - 1].0;
        for k in 1..WIDTH {
            (c.cost[k], c.left[k]) =
                if divided[k].0 < c.cost[k - 1] { divided[k] } else { (c.cost[k - 1], c.left[k - 1]) };
        }
    }
    choices
}

/// The roots of the cheapest forest under `n` with at most `k` roots.
fn forest(binary: &[Binary], choices: &[Choice], n: usize, k: usize, roots: &mut Vec<usize>) {
    // The least number of roots that reaches this cost.
    let c = &choices[n];
    let mut k = k;
    while k > 1 && c.cost[k - 2] <= c.cost[k - 1] {
        k -= 1;
    }
    let left = usize::from(c.left[k - 1]);
    if binary[n].children == 0 || k == 1 || left == 0 {
        roots.push(n);
        return;
    }
    forest(binary, choices, binary[n].children, left, roots);
    forest(binary, choices, binary[n].children + 1, k - left, roots);
}
