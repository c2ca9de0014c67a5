//! Whether two trees meet while one of them moves.
//!
//! Pairs of boxes are compared over a part of the motion at a time. Two boxes stay apart when, along one of
//! the separating axes in the middle of the part, the gap exceeds how far the points of the moving box move
//! along that axis. Where this is not shown, the largest of three is divided: one box, the other box, or
//! the part of the motion; so motions are cut into short parts only where and when bodies are near.

use crate::bvh::frames::{FrameTransform, Placed};
use crate::bvh::{LEAF, Tree};
use crate::counters::Counters;
use crate::kernels::leaf_pair::{Corners, LeafFrame, corners};
use crate::kernels::separating_axes::{cross, dot, sub, touching, touching_moving};
use crate::kernels::swept_interval::SweptInterval;
use crate::kernels::swept_triangles::{LeafCheck, triangles};
use crate::kernels::triangle_pair::TriangleFilter;
use crate::query::Query;
use crate::query::descend::{LeafPair, for_children, opens_first};
use crate::query::intersect::Intersect;
use crate::query::schedule::{MotionParts, Schedule};
use mp_simd::{Kernel, Lanes, Mask, run};

/// A pair of nodes during a part of the motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweptPair {
    a: u32,
    b: u32,
    part: u32,
}

/// A part of the motion is halved, rather than a box opened, when points move farther than this many times
/// the larger box's half diagonal. Measured: half as much or twice as much is slower.
const LONG: f32 = 0.1;

impl Query {
    /// The first part of the motion, of all of `range`, in which the trees were not shown to stay apart: a single pose
    /// in which they meet, a smallest part, or one in whose middle they are nearer than the distance to keep. `None`
    /// when they stay apart.
    pub(crate) fn sweep(
        &mut self,
        a: &Tree,
        b: &Tree,
        schedule: &impl Schedule,
        range: [u32; 2],
    ) -> Option<SweepEnd> {
        let (stack, parts, filter, counters) =
            (&mut self.swept_pairs, &mut self.parts, &mut self.filter, &mut self.counters);
        parts.start(range, schedule);
        stack.clear();
        stack.push(SweptPair { a: a.root, b: b.root, part: 0 });
        run(self.isa, Sweep { a, b, schedule, parts, stack, filter, counters })
    }
}

/// The part of the motion where a sweep ended, and why.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweepEnd {
    pub(crate) range: [u32; 2],
    /// `Unproven` for a single pose.
    pub(crate) check: LeafCheck,
}

/// Depth-first; the earlier part of the motion first.
struct Sweep<'q, S> {
    a: &'q Tree,
    b: &'q Tree,
    schedule: &'q S,
    parts: &'q mut MotionParts,
    /// What to compare, the first last.
    stack: &'q mut Vec<SweptPair>,
    filter: &'q mut TriangleFilter,
    counters: &'q mut Counters,
}

impl<S: Schedule> Kernel for Sweep<'_, S> {
    /// See `Query::sweep`.
    type Output = Option<SweepEnd>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, schedule, parts, stack, filter, counters } = self;
        let mut tests = 0;
        let mut end = None;
        let mut limit = u32::MAX;
        let (large_a, large_b) = (a.is_large(), b.is_large());
        while let Some(SweptPair { a: x, b: y, part: index }) = stack.pop() {
            let part = *parts.part(index);
            let [start, _] = part.range;
            if start >= limit {
                continue;
            }
            let (most, leaves) = (part.most, x & y & LEAF != 0);
            let (own_a, own_b) = (a.own(x), b.own(y));
            if most * most > LONG * LONG * own_a.size.max(own_b.size)
                && let Some(half) = parts.halve(index, schedule)
            {
                stack.push(SweptPair { a: x, b: y, part: half + 1 });
                stack.push(SweptPair { a: x, b: y, part: half });
                continue;
            }
            let still = most == 0.0;
            let keep = schedule.keep(part.range);
            let Some(interval) = parts.interval(index, schedule) else { continue };
            let frames = &interval.frames;
            if leaves {
                tests += 2;
                if still {
                    let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
                    let into_a = FrameTransform::<L>::new(&frames.into_a);
                    let mut leaves = Intersect { any: true, filter, counters };
                    if leaves.compare((a, i), (b, j), frames, &into_a).is_none() {
                        continue;
                    }
                } else {
                    let (mask_a, mask_b) = near_leaves::<L>(a, x, b, y, interval);
                    if mask_b == 0 {
                        continue;
                    }
                    if let Some(keep) = keep {
                        let pair = ((a, x, mask_a), (b, y, mask_b));
                        match triangles::<L>(pair, interval, (most, keep), counters) {
                            LeafCheck::Free => continue,
                            LeafCheck::Unproven => {}
                            check => {
                                end = Some(SweepEnd { range: part.range, check });
                                break;
                            }
                        }
                    }
                    if let Some(half) = parts.halve(index, schedule) {
                        stack.push(SweptPair { a: x, b: y, part: half + 1 });
                        stack.push(SweptPair { a: x, b: y, part: half });
                        continue;
                    }
                }
                end = Some(SweepEnd { range: part.range, check: LeafCheck::Unproven });
                if !S::ORDERED {
                    break;
                }
                limit = start;
                continue;
            }
            tests += 1;
            if opens_first((a, x), (b, y)) {
                let node = &a.nodes[x as usize];
                let q = FrameTransform::<L>::new(&frames.into_a).place(own_b);
                let mask = if still {
                    touching::<L>(node, &q, frames.pad)
                } else {
                    let center: [L; 3] = three!(d => L::load(&node.center[d]));
                    let extent =
                        L::load(&node.half[0]).add(L::load(&node.half[1])).add(L::load(&node.half[2]));
                    let slop = extent.mul_add(L::splat(interval.rate), L::splat(interval.rest));
                    let pad = slop.add(L::splat(interval.margin));
                    touching_moving(node, &q, pad, &interval.in_a.at(&center))
                };
                for_children((a, large_a), node, mask, |child| {
                    stack.push(SweptPair { a: child, b: y, part: index });
                });
            } else {
                let node = &b.nodes[y as usize];
                let q = FrameTransform::<L>::new(&frames.into_b).place(own_a);
                let mask = if still {
                    touching::<L>(node, &q, frames.pad)
                } else {
                    let pad = L::splat(interval.slop(own_a)).add(L::splat(interval.margin));
                    touching_moving(node, &q, pad, &interval.in_b.at(&q.center()))
                };
                for_children((b, large_b), node, mask, |child| {
                    stack.push(SweptPair { a: x, b: child, part: index });
                });
            }
        }
        counters.box_tests += tests;
        end
    }
}

/// The triangles of each of two leaves that may come within the margin of the box around the other; none of
/// the second when none of the first does.
#[inline(always)]
fn near_leaves<L: Lanes>(a: &Tree, x: u32, b: &Tree, y: u32, interval: &SweptInterval) -> (u32, u32) {
    let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
    let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
    let (own_a, own_b) = (&a.leaf_boxes[i], &b.leaf_boxes[j]);
    let frames = &interval.frames;
    let near = LeafFrame::new(leaf_a, leaf_b, frames);
    let center: [L; 3] = three!(d => L::splat(own_a.frame[d][0]));
    let drift = interval.in_a.at(&center);
    let margin = interval.slop(own_a) + interval.margin;
    let box_b = FrameTransform::<L>::new(&frames.into_a).place(own_b).centred_at(near.shift);
    let mask_a = near_box(&corners::<L>(leaf_a), leaf_a.edge, &box_b, &near, &drift, margin) & leaf_a.all();
    if mask_a == 0 {
        return (0, 0);
    }
    let corners_b = near.carry(&corners::<L>(leaf_b), frames);
    let box_a = Placed::at_origin(own_a);
    (mask_a, near_box(&corners_b, leaf_b.edge, &box_a, &near, &drift, margin) & leaf_b.all())
}

/// The triangles (with edges up to `edge` long) that may come within `margin` of box `q` while one of the two
/// moves by `drift`: see `leaf_pair::near_box`.
#[inline(always)]
fn near_box<L: Lanes>(
    v: &Corners<L>,
    edge: f32,
    q: &Placed<'_>,
    near: &LeafFrame,
    drift: &[L; 3],
    margin: f32,
) -> u32 {
    let c = q.center::<L>();
    let d = [sub(&v[0], &c), sub(&v[1], &c), sub(&v[2], &c)];
    let margin = margin + 2.0 * near.wrong;
    let zero = L::splat(0.0);
    let [x, y, z] = three!(k => {
        let u = q.axis::<L>(k);
        let (x, y, z) = (dot(&u, &d[0]), dot(&u, &d[1]), dot(&u, &d[2]));
        let reach = dot(&u, drift).abs().add(L::splat(q.half[k] + margin));
        x.min(y).min(z).le(reach) & zero.sub(reach).le(x.max(y).max(z))
    });
    let mask = x & y & z;
    if mask.bits() == 0 {
        return 0;
    }
    let n = cross(&sub(&v[1], &v[0]), &sub(&v[2], &v[0]));
    let height = dot(&n, &d[0]);
    // The errors are those of `leaf_pair::near_box`; the normal is no longer than the sum of its coordinates.
    let length = n[0].abs().add(n[1].abs()).add(n[2].abs());
    let all = drift[0].abs().add(drift[1].abs()).add(drift[2].abs());
    let size = all.add(L::splat(2.0 * edge + q.half[0] + q.half[1] + q.half[2] + margin));
    let wrong = edge * (16.0 * near.wrong + 1e-6 * edge);
    let mut reach = length.mul_add(L::splat(margin * (1.0 + 1e-5)), dot(&n, drift).abs());
    reach = reach.add(size.mul_add(L::splat(wrong), L::splat(1e-34)));
    for k in 0..3 {
        let u = q.axis::<L>(k);
        reach = dot(&n, &u).abs().mul_add(L::splat(q.half[k] * (1.0 + 1e-6)), reach);
    }
    (mask & height.abs().le(reach)).bits()
}
