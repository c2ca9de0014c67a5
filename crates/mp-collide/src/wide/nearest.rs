//! How far are two trees apart?

use super::boxes::distances;
use super::frames::{Carrier, Frames};
use super::gaps::Gaps;
use super::{LEAF, Node, Obb, Tree, WIDTH};
use crate::query::Counters;
use crate::simd::{Kernel, Lanes};
use crate::triangle::{Closest, closest_within};

/// Two nodes whose boxes are at least the root of `bound` apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    bound: f32,
    a: u32,
    b: u32,
}

/// Two triangles (positions in the trees) at least the root of `bound` apart that may be the nearest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    bound: f32,
    a: u32,
    b: u32,
}

/// What a search for nearest points needs between queries.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    pairs: Vec<Pair>,
    candidates: Vec<Candidate>,
}

/// Branch and bound over pairs of nodes, the nearest first, in `f32`; the candidates left are compared
/// in `f64`.
pub(crate) struct Nearest<'q> {
    pub(crate) a: &'q Tree,
    pub(crate) b: &'q Tree,
    pub(crate) frames: &'q Frames,
    /// Only points nearer than this are of interest.
    pub(crate) enough: f64,
    /// Any points at most this far apart will do.
    pub(crate) accept: f64,
    pub(crate) scratch: &'q mut Scratch,
    pub(crate) counters: &'q mut Counters,
}

impl Kernel for Nearest<'_> {
    /// Nearest points in the frame of `a`, and the triangles they are on, if near enough.
    type Output = Option<(Closest, usize, usize)>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, frames, enough, accept, scratch, counters } = self;
        let Scratch { pairs, candidates } = scratch;
        let (into_a, into_b) = (Carrier::<L>::new(&frames.into_a), Carrier::<L>::new(&frames.into_b));
        // Squares in `f32`: up for what must not be missed, down for what must be sure.
        let mut best = up(enough * enough);
        let sure = (accept * accept * (1.0 - 1e-6)) as f32;
        pairs.clear();
        candidates.clear();
        pairs.push(Pair { bound: 0.0, a: a.root, b: b.root });
        'search: while let Some(pair) = pairs.pop() {
            if pair.bound > best {
                continue;
            }
            counters.box_tests += 1;
            let (x, y) = (pair.a, pair.b);
            if x & y & LEAF != 0 {
                let leaf_a = &a.leaves[(x & !LEAF) as usize];
                let leaf_b = &b.leaves[(y & !LEAF) as usize];
                let gaps = Gaps::<L>::new(leaf_a);
                for l in 0..leaf_b.count {
                    let position = leaf_b.first + l;
                    let single = frames.exact.triangle(&b.triangles[position as usize]);
                    let mut near = [0.0; WIDTH];
                    let mut far = [0.0; WIDTH];
                    let mut mask = gaps.between(&single, best, &mut near, &mut far);
                    counters.triangle_tests += 1;
                    while mask != 0 {
                        let k = mask.trailing_zeros() as usize & 7;
                        mask &= mask - 1;
                        candidates.push(Candidate {
                            bound: near[k],
                            a: leaf_a.first + k as u32,
                            b: position,
                        });
                        if far[k] < best {
                            best = far[k];
                            if best <= sure {
                                break 'search;
                            }
                        }
                    }
                }
                continue;
            }
            let open_a = x & LEAF == 0 && (y & LEAF != 0 || a.own(x).size >= b.own(y).size);
            let from = pairs.len();
            if open_a {
                let node = &a.nodes[x as usize];
                push::<L>(node, &into_a, b.own(y), frames.pad, best, |bound, child| {
                    pairs.push(Pair { bound, a: child, b: y });
                });
            } else {
                let node = &b.nodes[y as usize];
                push::<L>(node, &into_b, a.own(x), frames.pad, best, |bound, child| {
                    pairs.push(Pair { bound, a: x, b: child });
                });
            }
            nearest_last(&mut pairs[from..]);
        }
        // The likely nearest first: most of the others need no second look then.
        candidates.retain(|c| c.bound <= best);
        candidates.sort_unstable_by(|c, d| c.bound.total_cmp(&d.bound).then((c.a, c.b).cmp(&(d.a, d.b))));
        let mut squared = enough * enough;
        let mut witness = None;
        for c in candidates.iter() {
            if f64::from(c.bound) > squared {
                break;
            }
            let (i, j) = (c.a as usize, c.b as usize);
            let single = frames.exact.triangle(&b.triangles[j]);
            if let Some(closest) = closest_within(&a.triangles[i], &single, squared) {
                squared = closest.squared;
                witness = Some((closest, i, j));
                if squared <= accept * accept {
                    break;
                }
            }
        }
        witness
    }
}

/// Rounded up to `f32`.
fn up(x: f64) -> f32 {
    ((x * (1.0 + 1e-6)) as f32).next_up()
}

/// Calls `push` for every child of `node` that may be nearer to `other` than the root of `best`.
#[inline(always)]
fn push<L: Lanes>(
    node: &Node,
    frame: &Carrier<L>,
    other: &Obb,
    pad: f32,
    best: f32,
    mut push: impl FnMut(f32, u32),
) {
    let bounds = distances::<L>(node, &frame.place(other), pad);
    let mut mask = bounds.le(L::splat(best)) & L::splat(0.0).le(L::load(&node.half[0]));
    let mut bound = [0.0; WIDTH];
    bounds.store(&mut bound);
    while mask != 0 {
        let lane = mask.trailing_zeros() as usize & 7;
        mask &= mask - 1;
        push(bound[lane], node.child[lane]);
    }
}

/// Sorts by falling bound, so that the nearest is popped first; equal bounds keep their order.
#[inline(always)]
fn nearest_last(pairs: &mut [Pair]) {
    for i in 1..pairs.len() {
        let pair = pairs[i];
        let mut at = i;
        while at > 0 && pairs[at - 1].bound < pair.bound {
            pairs[at] = pairs[at - 1];
            at -= 1;
        }
        pairs[at] = pair;
    }
}
