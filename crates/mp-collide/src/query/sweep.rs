//! Do two trees meet while one of them moves?
//!
//! Pairs of boxes are compared over a part of the motion at a time. Two boxes stay apart when, along one of
//! the separating axes of the middle of the part, the gap exceeds how far the points of the moving one get
//! along that axis. Where they may not stay apart, the largest of three is divided: one box, the other, or
//! the part of the motion; so motions are cut into short parts only where and when bodies are near.

use crate::bvh::frames::{FrameTransform, Placed};
use crate::bvh::{LEAF, Node, Tree};
use crate::counters::Counters;
use crate::kernels::leaf_pair::{Corners, Near, corners};
use crate::kernels::separating_axes::{cross, dot, sub, touching};
use crate::kernels::swept_interval::{Parts, SweptInterval};
use crate::kernels::swept_triangles::{LeafCheck, triangles};
use crate::kernels::triangle_pair::TriangleFilter;
use crate::query::Query;
use crate::query::intersect::{leaf_pair, prefetch_node};
use crate::simd::{Kernel, Lanes, Mask, run};

/// A pair of nodes during a part of the motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    a: u32,
    b: u32,
    part: u32,
}

impl Item {
    fn new(a: &Tree, b: &Tree, part: u32) -> Self {
        Self { a: a.root, b: b.root, part }
    }
}

/// A motion, in parts that cover ranges of what it is counted in.
pub(crate) trait Schedule {
    /// Whether the earliest part is wanted, or any.
    const ORDERED: bool;
    /// What was made of it.
    fn parts(&self) -> &Parts;
    /// The same, to be added to.
    fn parts_mut(&mut self) -> &mut Parts;
    /// How far any point moves at most (m) from the middle of a range to either end; 0 for a single pose.
    fn most(&self, range: [u32; 2]) -> f64;
    /// What lies where in a range; `None` when the bodies are nowhere near each other.
    fn make(&self, range: [u32; 2]) -> Option<SweptInterval>;
    /// How far apart (m) the bodies are to stay all along a range that is not still, if triangles are to be compared
    /// over it; smallest ranges that are not still need that.
    fn keep(&self, _range: [u32; 2]) -> Option<f64> {
        None
    }

    /// Adds a part.
    fn add(&mut self, range: [u32; 2]) {
        let most = self.most(range);
        self.parts_mut().add(range, most);
    }

    /// What lies where in a part, made when first asked for.
    #[inline]
    fn span(&mut self, index: u32) -> Option<&SweptInterval> {
        if self.parts().span(index).is_none() {
            let span = self.make(self.parts().part(index).range);
            self.parts_mut().set_span(index, span);
        }
        self.parts().span(index).flatten()
    }

    /// The first of the two halves of a part, the earlier; the other comes after. `None` for the smallest parts,
    /// which are not divided.
    fn halve(&mut self, index: u32) -> Option<u32> {
        if let Some(half) = self.parts().half(index) {
            return Some(half);
        }
        let [lo, hi] = self.parts().part(index).range;
        if hi - lo == 1 {
            return None;
        }
        let half = self.parts_mut().set_half(index);
        let middle = u32::midpoint(lo, hi);
        self.add([lo, middle]);
        self.add([middle, hi]);
        Some(half)
    }
}

/// A part of the motion is halved, rather than a box opened, when points move farther than this many times
/// the larger box's half diagonal. Measured: half as much or twice as much is slower.
const LONG: f32 = 0.1;

impl Query {
    /// The first range of the motion in which the trees were not shown to stay apart, of all of `range`: still ones
    /// in which they meet, smallest ones that are not still, and those in whose middle they are nearer than is to be
    /// kept. `None` when they stay apart.
    pub(crate) fn sweep(
        &mut self,
        a: &Tree,
        b: &Tree,
        course: &mut impl Schedule,
        range: [u32; 2],
    ) -> Option<Met> {
        course.parts_mut().clear();
        course.add(range);
        let (stack, meeting, counters) = (&mut self.items, &mut self.meeting, &mut self.counters);
        stack.clear();
        stack.push(Item::new(a, b, 0));
        run(self.isa, Sweep { a, b, course, stack, meeting, counters })
    }
}

/// Where a sweep ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    pub(crate) range: [u32; 2],
    /// `Short` for a single pose.
    pub(crate) gap: LeafCheck,
}

/// Depth-first; the earlier part of the motion first.
struct Sweep<'q, C> {
    a: &'q Tree,
    b: &'q Tree,
    course: &'q mut C,
    /// What to look at, the first last.
    stack: &'q mut Vec<Item>,
    meeting: &'q mut TriangleFilter,
    counters: &'q mut Counters,
}

impl<C: Schedule> Kernel for Sweep<'_, C> {
    /// See `Query::sweep`.
    type Output = Option<Met>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, course, stack, meeting, counters } = self;
        let mut tests = 0;
        let mut met = None;
        let mut limit = u32::MAX;
        let (far_a, far_b) = (a.is_large(), b.is_large());
        while let Some(Item { a: x, b: y, part: index }) = stack.pop() {
            let part = *course.parts().part(index);
            let [start, _] = part.range;
            if start >= limit {
                continue;
            }
            let (most, leaves) = (part.most, x & y & LEAF != 0);
            let (own_a, own_b) = (a.own(x), b.own(y));
            if most * most > LONG * LONG * own_a.size.max(own_b.size)
                && let Some(half) = course.halve(index)
            {
                stack.push(Item { a: x, b: y, part: half + 1 });
                stack.push(Item { a: x, b: y, part: half });
                continue;
            }
            let still = most == 0.0;
            let keep = course.keep(part.range);
            let Some(span) = course.span(index) else { continue };
            let frames = &span.frames;
            if leaves {
                tests += 2;
                if still {
                    let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
                    let into_a = FrameTransform::<L>::new(&frames.into_a);
                    if leaf_pair((a, i), (b, j), frames, &into_a, true, meeting, counters).is_none() {
                        continue;
                    }
                } else {
                    let (mask_a, mask_b) = near_leaves::<L>(a, x, b, y, span);
                    if mask_b == 0 {
                        continue;
                    }
                    if let Some(keep) = keep {
                        let pair = ((a, x, mask_a), (b, y, mask_b));
                        match triangles::<L>(pair, span, (most, keep), counters) {
                            LeafCheck::Free => continue,
                            LeafCheck::Unproven => {}
                            gap => {
                                met = Some(Met { range: part.range, gap });
                                break;
                            }
                        }
                    }
                    if let Some(half) = course.halve(index) {
                        stack.push(Item { a: x, b: y, part: half + 1 });
                        stack.push(Item { a: x, b: y, part: half });
                        continue;
                    }
                }
                met = Some(Met { range: part.range, gap: LeafCheck::Unproven });
                if !C::ORDERED {
                    break;
                }
                limit = start;
                continue;
            }
            tests += 1;
            let open_a = x & LEAF == 0 && (y & LEAF != 0 || own_a.size >= own_b.size);
            if open_a {
                let node = &a.nodes[x as usize];
                let q = FrameTransform::<L>::new(&frames.into_a).place(own_b);
                let mut mask = if still {
                    touching::<L>(node, &q, frames.pad)
                } else {
                    let center: [L; 3] = three!(d => L::load(&node.center[d]));
                    let extent =
                        L::load(&node.half[0]).add(L::load(&node.half[1])).add(L::load(&node.half[2]));
                    let slop = extent.mul_add(L::splat(span.rate), L::splat(span.rest));
                    apart(node, &q, &span.in_a.at(&center), slop, span)
                };
                while mask != 0 {
                    let child = node.child[mask.trailing_zeros() as usize & 7];
                    mask &= mask - 1;
                    if far_a {
                        prefetch_node(a, child);
                    }
                    stack.push(Item { a: child, b: y, part: index });
                }
            } else {
                let node = &b.nodes[y as usize];
                let q = FrameTransform::<L>::new(&frames.into_b).place(own_a);
                let mut mask = if still {
                    touching::<L>(node, &q, frames.pad)
                } else {
                    apart(node, &q, &span.in_b.at(&q.center()), L::splat(span.slop(own_a)), span)
                };
                while mask != 0 {
                    let child = node.child[mask.trailing_zeros() as usize & 7];
                    mask &= mask - 1;
                    if far_b {
                        prefetch_node(b, child);
                    }
                    stack.push(Item { a: x, b: child, part: index });
                }
            }
        }
        counters.box_tests += tests;
        met
    }
}

/// Bit `i` is set unless child `i` of `node` surely stays farther than the margin from `q`, where one of the
/// two moves by `drift` and up to `slop` beside.
///
/// As `boxes::touching`, which see.
#[inline(always)]
fn apart<L: Lanes>(node: &Node, q: &Placed<'_>, drift: &[L; 3], slop: L, span: &SweptInterval) -> u32 {
    let center = q.center::<L>();
    let d: [L; 3] = three!(k => center[k].sub(L::load(&node.center[k])));
    let zero = L::splat(0.0);
    let pad = slop.add(L::splat(span.margin));
    let h: [L; 3] = [L::splat(q.half[0]), L::splat(q.half[1]), L::splat(q.half[2])];
    let mut t = [zero; 3];
    let mut w = [zero; 3];
    let mut m = [[zero; 3]; 3];
    let mut am = [[zero; 3]; 3];
    let mut e = [zero; 3];
    let [x, y, z] = three!(k => {
        let u = [L::load(&node.axes[k][0]), L::load(&node.axes[k][1]), L::load(&node.axes[k][2])];
        t[k] = dot(&u, &d);
        w[k] = dot(&u, drift);
        e[k] = L::load(&node.half[k]);
        let mut reach = e[k].add(pad).add(w[k].abs());
        for j in 0..3 {
            m[k][j] = dot(&u, &q.axis(j));
            am[k][j] = m[k][j].abs();
            reach = am[k][j].mul_add(h[j], reach);
        }
        t[k].abs().le(reach)
    });
    let mut mask = x & y & z;
    if mask.bits() == 0 {
        return 0;
    }
    for j in 0..3 {
        let p = t[0].mul_add(m[0][j], t[1].mul_add(m[1][j], t[2].mul(m[2][j])));
        let v = w[0].mul_add(m[0][j], w[1].mul_add(m[1][j], w[2].mul(m[2][j])));
        let reach = e[0]
            .mul_add(am[0][j], e[1].mul_add(am[1][j], e[2].mul_add(am[2][j], h[j].add(pad).add(v.abs()))));
        mask = mask & p.abs().le(reach);
    }
    if mask.bits() == 0 {
        return 0;
    }
    for (i, i1, i2) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
        for (j, j1, j2) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let p = t[i2].mul_sub(m[i1][j], t[i1].mul(m[i2][j]));
            let v = w[i2].mul_sub(m[i1][j], w[i1].mul(m[i2][j]));
            let travel = v.abs().add(pad);
            let reach = e[i1].mul_add(
                am[i2][j],
                e[i2].mul_add(am[i1][j], am[i][j2].mul_add(h[j1], am[i][j1].mul_add(h[j2], travel))),
            );
            mask = mask & p.abs().le(reach);
        }
    }
    mask.bits()
}

/// The triangles of each of two leaves that may come within the margin of the box around the other; none of
/// the second when none of the first does.
#[inline(always)]
fn near_leaves<L: Lanes>(a: &Tree, x: u32, b: &Tree, y: u32, span: &SweptInterval) -> (u32, u32) {
    let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
    let (leaf_a, leaf_b) = (&a.leaves[i], &b.leaves[j]);
    let (own_a, own_b) = (&a.leaf_boxes[i], &b.leaf_boxes[j]);
    let frames = &span.frames;
    let near = Near::new(leaf_a, leaf_b, frames);
    let center: [L; 3] = three!(d => L::splat(own_a.frame[d][0]));
    let drift = span.in_a.at(&center);
    let margin = span.slop(own_a) + span.margin;
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
/// moves by `drift`. As `leaves::near_box`, which see.
#[inline(always)]
fn near_box<L: Lanes>(
    v: &Corners<L>,
    edge: f32,
    q: &Placed<'_>,
    near: &Near,
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
    // As there; and the normal is no longer than the sum of its coordinates.
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
