//! The nearest points of two trees, by branch and bound.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::bvh::frames::{FrameTransform, Frames};
use crate::bvh::{LEAF, Tree, WIDTH};
use crate::counters::Counters;
use crate::kernels::leaf_pair::near_each_other;
use crate::kernels::separating_axes::distances;
use crate::kernels::triangle_distance::{DistanceBounds, DistanceKernel, SeparatingDirection};
use crate::query::descend::{opens_first, prefetch_node};
use crate::triangle::{Closest, closest_within, is_farther, is_nearest};
use mp_simd::{Kernel, Lanes, Mask};

/// Two nodes whose boxes are at least the square root of `bound` apart; ordered so that the nearest is the greatest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodePair {
    bound: f32,
    a: u32,
    b: u32,
}

impl Ord for NodePair {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then((other.a, other.b).cmp(&(self.a, self.b)))
    }
}

impl PartialOrd for NodePair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for NodePair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for NodePair {}

/// Two triangles (positions in the trees) at least the square root of `bound` apart that may be the nearest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    bound: f32,
    a: u32,
    b: u32,
}

/// Memory of a search for nearest points, kept between queries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    pairs: BinaryHeap<NodePair>,
    candidates: Vec<Candidate>,
}

/// Branch and bound over pairs of nodes, the nearest first, in `f32`; the candidates left are compared
/// in `f64`.
pub(crate) struct BranchAndBound<'q> {
    pub(crate) a: &'q Tree,
    pub(crate) b: &'q Tree,
    pub(crate) frames: &'q Frames,
    /// Only points nearer than this are of interest.
    pub(crate) enough: f64,
    pub(crate) scratch: &'q mut Scratch,
    pub(crate) counters: &'q mut Counters,
}

impl Kernel for BranchAndBound<'_> {
    /// The nearest points in the frame of `a`, and the triangles they are on, if near enough.
    type Output = Option<(Closest, usize, usize)>;

    #[inline(always)]
    fn run<L: Lanes>(mut self) -> Self::Output {
        let (a, b, frames, enough) = (self.a, self.b, self.frames, self.enough);
        let (into_a, into_b) =
            (FrameTransform::<L>::new(&frames.into_a), FrameTransform::<L>::new(&frames.into_b));
        self.scratch.pairs.clear();
        self.scratch.candidates.clear();
        let mut best = Best {
            squared: up(enough * enough),
            closest: Closest::NONE,
            direction: SeparatingDirection::default(),
        };
        let far = a.is_large() || b.is_large();
        let mut next = Some(NodePair { bound: 0.0, a: a.root, b: b.root });
        while let Some(pair) = next.take().or_else(|| self.scratch.pairs.pop()) {
            if pair.bound > best.squared {
                break;
            }
            self.counters.box_tests += 1;
            let (x, y) = (pair.a, pair.b);
            if far && let Some(then) = self.scratch.pairs.peek() {
                prefetch_node(a, then.a);
                prefetch_node(b, then.b);
            }
            if x & y & LEAF != 0 {
                let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
                self.leaf_pair::<L>(i, j, &into_a, &mut best);
                continue;
            }
            let open_a = opens_first((a, x), (b, y));
            let (node, place) = if open_a {
                (&a.nodes[x as usize], into_a.place(b.own(y)))
            } else {
                (&b.nodes[y as usize], into_b.place(a.own(x)))
            };
            let bounds = distances::<L>(node, &place, frames.pad);
            let mut mask =
                (bounds.le(L::splat(best.squared)) & L::splat(0.0).le(L::load(&node.half[0]))).bits();
            let mut bound = [0.0; WIDTH];
            bounds.store(&mut bound);
            let pairs = &mut self.scratch.pairs;
            // The nearest child is next, unless a pair in the queue is nearer; before the first leaves, the search goes
            // straight down.
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                let (a, b) = if open_a { (node.child[lane], y) } else { (x, node.child[lane]) };
                let pair = NodePair { bound: bound[lane], a, b };
                match &mut next {
                    Some(first) if pair > *first => pairs.push(std::mem::replace(first, pair)),
                    Some(_) => pairs.push(pair),
                    None => next = Some(pair),
                }
            }
            if best.squared < f32::INFINITY
                && let (Some(first), Some(top)) = (next, pairs.peek())
                && *top > first
            {
                pairs.push(first);
                next = None;
            }
        }
        refine(a, b, frames, enough, &best, &mut self.scratch.candidates)
    }
}

/// The nearest points so far.
struct Best {
    /// An upper bound on their squared distance.
    squared: f32,
    /// The nearest found.
    closest: Closest,
    /// Along the segment between the nearest found, in the frame of `a`.
    direction: SeparatingDirection,
}

impl BranchAndBound<'_> {
    /// Compares the triangles of two leaves.
    #[inline(always)]
    fn leaf_pair<L: Lanes>(&mut self, i: usize, j: usize, into_a: &FrameTransform<L>, best: &mut Best) {
        let (a, b, frames) = (self.a, self.b, self.frames);
        let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
        let (mut lanes, mut singles) = (leaf_a.all(), leaf_b.all());
        if best.squared < 1e30 {
            let margin = best.squared.sqrt() * (1.0 + 1e-6) + frames.pad;
            let boxes = (&a.leaf_boxes[i], &b.leaf_boxes[j]);
            (lanes, singles) = near_each_other((leaf_a, leaf_b), boxes, frames, into_a, margin);
            if lanes == 0 || singles == 0 {
                return;
            }
        }
        let kernel = DistanceKernel::<L>::new(leaf_a, &best.direction);
        let mut nearest = None;
        while singles != 0 {
            let position = leaf_b.first + singles.trailing_zeros();
            singles &= singles - 1;
            let single = frames.exact.triangle(&b.triangles[position as usize]);
            let mut bounds = DistanceBounds::default();
            let mut near = kernel.between(&single, lanes, best.squared, None, &mut bounds).near;
            self.counters.triangle_tests += 1;
            while near != 0 {
                let lane = near.trailing_zeros() as usize & 7;
                near &= near - 1;
                let k = leaf_a.first + lane as u32;
                self.scratch.candidates.push(Candidate { bound: bounds.near[lane], a: k, b: position });
                if bounds.far[lane] < best.squared {
                    best.squared = bounds.far[lane];
                    nearest = Some((k, single));
                }
            }
        }
        if let Some((k, single)) = nearest
            && let Some(closest) = closest_within(&a.triangles[k as usize], &single, f64::INFINITY)
        {
            // The bound of the lanes is a little too large; the larger the meshes, the more pairs lie below such a bound.
            best.squared = best.squared.min(up(closest.squared));
            if closest.squared < best.closest.squared {
                best.closest = closest;
            }
            let join = closest.on_b - closest.on_a;
            best.direction = SeparatingDirection::across(&join);
        }
    }
}

/// The nearest of the candidates, in an order that does not depend on the lanes.
fn refine(
    a: &Tree,
    b: &Tree,
    frames: &Frames,
    enough: f64,
    best: &Best,
    candidates: &mut Vec<Candidate>,
) -> Option<(Closest, usize, usize)> {
    let Closest { squared: known, on_a, on_b } = best.closest;
    candidates.retain(|c| {
        let (i, j) = (c.a as usize, c.b as usize);
        let farther = || is_farther(&a.triangles[i], &frames.exact.triangle(&b.triangles[j]), on_a, on_b);
        c.bound <= best.squared && !(known.is_finite() && farther())
    });
    candidates.sort_unstable_by_key(|c| (c.a, c.b));
    let mut squared = enough * enough;
    let mut witness: Option<(Closest, usize, usize)> = None;
    for c in candidates.iter() {
        let (i, j) = (c.a as usize, c.b as usize);
        let single = frames.exact.triangle(&b.triangles[j]);
        // Most candidates are neighbours that share the points found.
        if let Some((closest, ..)) = &witness
            && is_nearest(&a.triangles[i], &single, closest.on_a, closest.on_b)
        {
            continue;
        }
        if let Some(closest) = closest_within(&a.triangles[i], &single, squared) {
            squared = closest.squared;
            witness = Some((closest, i, j));
        }
    }
    witness
}

/// Rounded up to `f32`.
fn up(x: f64) -> f32 {
    ((x * (1.0 + 1e-6)) as f32).next_up()
}
