//! A binary tree by the surface-area heuristic, along the axes of the mesh and those of each box.
//!
//! All coordinates here are relative to the centre of the mesh, in units of its radius, in `f32`.

use mp_stop::Interrupted;
use std::ops::Range;

use crate::bvh::fit::{self, Axes};
use crate::bvh::{NodeBox, WIDTH};

/// Bins along an axis: a power of two.
const BINS: usize = 32;
/// From this number to its double the numbers of `f32` are whole, and their last bits count from 0.
const UNITS: f32 = (1 << 23) as f32;
/// Up to this many triangles every division is tried, not only those between bins.
const SWEEP: usize = 16;
/// Triangles that fit a leaf are divided nevertheless where their box has this many times the surface of the boxes of two
/// parts: opposite walls of a room are better in two leaves.
const WORTH: f32 = 1.1;
/// A bound on the error of a coordinate along an axis of a box: u = 2⁻²⁴ from rounding the corner, 3u from the
/// sum of three products, all of vectors no longer than 1.
const ROUNDING: f64 = 4.0 / (1 << 24) as f64;

/// Three coordinates in a register of four.
pub(crate) type Vec4 = [f32; 4];

/// Up to this many triangles their extents are kept while they are divided; those of more are computed anew in each pass.
const KEPT: usize = 1 << 20;

/// A triangle during the build. 40 bytes.
#[derive(Clone, Copy)]
pub(crate) struct BuildTriangle {
    pub(crate) corners: [[f32; 3]; 3],
    pub(crate) id: u32,
}

impl BuildTriangle {
    const NONE: Self = Self { corners: [[0.0; 3]; 3], id: 0 };

    #[inline(always)]
    pub(crate) fn corners(&self) -> [Vec4; 3] {
        self.corners.map(|[x, y, z]| [x, y, z, 0.0])
    }
}

/// A node of the binary tree. 76 bytes.
pub(crate) struct BinaryNode {
    /// The index of the first child, which the second follows; 0 in a leaf.
    children: u32,
    range: [u32; 2],
    pub(crate) surface: f32,
    frame: Axes,
    lo: [f32; 3],
    hi: [f32; 3],
}

impl BinaryNode {
    /// There are no more than `u32::MAX` triangles.
    fn new(range: Range<usize>) -> Self {
        let range = [range.start as u32, range.end as u32];
        Self { children: 0, range, surface: 0.0, frame: fit::MESH, lo: [0.0; 3], hi: [0.0; 3] }
    }

    /// The index of the first child, which the second follows; 0 in a leaf.
    #[inline]
    pub(crate) fn children(&self) -> usize {
        self.children as usize
    }

    /// Its part of the triangles.
    #[inline]
    pub(crate) fn range(&self) -> Range<usize> {
        self.range[0] as usize..self.range[1] as usize
    }

    /// The box around the node's part of `items`, rounding included, in metres: `unit` is the radius of the mesh. Relative
    /// to the centre of the mesh.
    pub(crate) fn obb(&self, items: &[BuildTriangle], unit: f64) -> NodeBox {
        let items = &items[self.range()];
        let (f, lo, hi) = match fit::refine(items, &self.frame) {
            Some(frame) => {
                let corners = items.iter().flat_map(BuildTriangle::corners);
                let ([lx, ly, lz, _], [hx, hy, hz, _]) = fit::extent(corners, &fit::columns(&frame));
                (frame, [lx, ly, lz], [hx, hy, hz])
            }
            None => (self.frame, self.lo, self.hi),
        };
        let wide = f.map(|u| u.map(f64::from));
        let lo: [f64; 3] = std::array::from_fn(|k| (f64::from(lo[k]) - ROUNDING) * unit);
        let hi: [f64; 3] = std::array::from_fn(|k| (f64::from(hi[k]) + ROUNDING) * unit);
        // Infinities would give NaN in the box.
        let center: [f32; 3] = std::array::from_fn(|d| {
            let x = (0..3).map(|k| wide[k][d] * 0.5 * (lo[k] + hi[k])).sum::<f64>();
            (x as f32).clamp(f32::MIN, f32::MAX)
        });
        let half: [f32; 3] = std::array::from_fn(|k| {
            // The rounded axes are not quite orthogonal: measured from the rounded centre. Box
            // tests assume orthonormal axes; `Frames::pad` covers the difference.
            let at: f64 = (0..3).map(|d| wide[k][d] * f64::from(center[d])).sum();
            ((hi[k] - at).max(at - lo[k]) * (1.0 + 3e-7)) as f32
        });
        let frame = std::array::from_fn(|d| [center[d], f[0][d], f[1][d], f[2][d]]);
        NodeBox::new(frame, half)
    }
}

/// The binary tree, parents before children, its leaves of at most [`WIDTH`] items.
///
/// # Errors
/// That of `go_on`, which is called for each node.
pub(crate) fn split_all(
    items: &mut [BuildTriangle],
    go_on: &mut dyn FnMut() -> Result<(), Interrupted>,
) -> Result<Vec<BinaryNode>, Interrupted> {
    let mut own = Vec::with_capacity(items.len().min(KEPT));
    let mut aside = Vec::new();
    let mut binary = Vec::with_capacity(items.len() / 2 + 1);
    binary.push(BinaryNode::new(0..items.len()));
    let mut todo = vec![0];
    while let Some(n) = todo.pop() {
        go_on()?;
        let range = binary[n].range();
        let items = &mut items[range.clone()];
        let frame = fit::frame(items);
        let all = bounds(items, &frame, &mut own);
        let b = &mut binary[n];
        let three = |[x, y, z, _]: Vec4| [x, y, z];
        (b.frame, b.lo, b.hi) = (frame, three(all.lo[1]), three(all.hi[1]));
        b.surface = surface(&all.lo[1], &all.hi[1]);
        // Along the axes of the mesh alone where those of the box are the same.
        let frames = if frame == fit::MESH { 1 } else { 2 };
        let first = if items.len() > KEPT {
            let columns = fit::columns(&frame);
            Some(bin(items, |items, i| extents(&items[i], &columns), frames, &mut aside))
        } else {
            split(items, &own, frames, b.surface, &mut aside)
        };
        if let Some(first) = first {
            let children = binary.len();
            binary[n].children = children as u32;
            binary.push(BinaryNode::new(range.start..range.start + first));
            binary.push(BinaryNode::new(range.start + first..range.end));
            todo.extend([children, children + 1]);
        }
    }
    Ok(binary)
}

/// Extents along the axes of the mesh, then along those of a box.
#[derive(Clone, Copy)]
struct Extents {
    lo: [Vec4; 2],
    hi: [Vec4; 2],
}

impl Extents {
    const EMPTY: Self = Self { lo: [[f32::INFINITY; 4]; 2], hi: [[f32::NEG_INFINITY; 4]; 2] };

    #[inline(always)]
    fn join(&mut self, other: &Self) {
        for f in 0..2 {
            self.lo[f] = min(&other.lo[f], &self.lo[f]);
            self.hi[f] = max(&other.hi[f], &self.hi[f]);
        }
    }

    /// The surface in the tighter of the two frames.
    #[inline(always)]
    fn surface(&self) -> f32 {
        surface(&self.lo[0], &self.hi[0]).min(surface(&self.lo[1], &self.hi[1]))
    }

    /// Twice the middle.
    #[inline(always)]
    fn middle(&self, frame: usize) -> Vec4 {
        std::array::from_fn(|k| self.lo[frame][k] + self.hi[frame][k])
    }
}

#[inline(always)]
pub(crate) fn min(a: &Vec4, b: &Vec4) -> Vec4 {
    std::array::from_fn(|k| if a[k] < b[k] { a[k] } else { b[k] })
}

#[inline(always)]
pub(crate) fn max(a: &Vec4, b: &Vec4) -> Vec4 {
    std::array::from_fn(|k| if a[k] > b[k] { a[k] } else { b[k] })
}

/// Half the surface of a box: enough to compare by.
#[inline(always)]
pub(crate) fn surface(lo: &Vec4, hi: &Vec4) -> f32 {
    let [x, y, z] = [hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]];
    x * y + y * z + z * x
}

/// Coordinates of `p` along three axes, which come as columns.
#[inline(always)]
pub(crate) fn along(columns: &[Vec4; 3], p: &Vec4) -> Vec4 {
    std::array::from_fn(|k| columns[0][k] * p[0] + columns[1][k] * p[1] + columns[2][k] * p[2])
}

/// The extents of a triangle, in a frame that comes as columns.
#[inline(always)]
fn extents(item: &BuildTriangle, columns: &[Vec4; 3]) -> Extents {
    let [a, b, c] = &item.corners();
    let [x, y, z] = [along(columns, a), along(columns, b), along(columns, c)];
    Extents {
        lo: [min(&min(a, b), c), min(&min(&x, &y), &z)],
        hi: [max(&max(a, b), c), max(&max(&x, &y), &z)],
    }
}

/// The extents of all triangles, and those of each, in `own`, if they are not too many to be kept.
fn bounds(items: &[BuildTriangle], frame: &Axes, own: &mut Vec<Extents>) -> Extents {
    let columns = fit::columns(frame);
    let (mut all, keep) = (Extents::EMPTY, items.len() <= KEPT);
    own.clear();
    for item in items {
        let one = extents(item, &columns);
        all.join(&one);
        if keep {
            own.push(one);
        }
    }
    all
}

/// Reorders `items` into two parts, neither empty, and returns the length of the first. `None` where one leaf is
/// better.
fn split(
    items: &mut [BuildTriangle],
    own: &[Extents],
    frames: usize,
    whole: f32,
    aside: &mut Vec<BuildTriangle>,
) -> Option<usize> {
    let n = items.len();
    if n > SWEEP {
        return Some(bin(items, |_, i| own[i], frames, aside));
    }
    if n > WIDTH {
        return Some(sweep(items, own, frames, aside, |bounds, count| bounds.surface() * count as f32).0);
    }
    if n == 1 {
        return None;
    }
    // The cost of a leaf does not depend on how many triangles it holds.
    let (first, surface) = sweep(items, own, frames, aside, |bounds, _| bounds.surface());
    (surface * WORTH < whole).then_some(first)
}

/// The best of all divisions in the order of the middles along each axis, and what it costs.
#[inline(always)]
fn sweep(
    items: &mut [BuildTriangle],
    own: &[Extents],
    frames: usize,
    aside: &mut Vec<BuildTriangle>,
    cost: impl Fn(&Extents, usize) -> f32,
) -> (usize, f32) {
    let n = items.len();
    let mut best = (n / 2, f32::INFINITY);
    let mut best_order: [u64; SWEEP] = std::array::from_fn(|i| i as u64);
    for (f, k) in (0..frames).flat_map(|f| [(f, 0), (f, 1), (f, 2)]) {
        let mut order = [0; SWEEP];
        let order = &mut order[..n];
        for (i, (key, o)) in order.iter_mut().zip(own).enumerate() {
            *key = u64::from(ordered(o.lo[f][k] + o.hi[f][k])) << 32 | i as u64;
        }
        order.sort_unstable();
        let at = |i: usize| &own[order[i] as u32 as usize];
        let mut above = [0.0; SWEEP];
        let mut right = Extents::EMPTY;
        for i in (1..n).rev() {
            right.join(at(i));
            above[i] = cost(&right, n - i);
        }
        let mut left = Extents::EMPTY;
        let before = best.1;
        for i in 1..n {
            left.join(at(i - 1));
            let both = cost(&left, i) + above[i];
            if both < best.1 {
                best = (i, both);
            }
        }
        if best.1 < before {
            best_order[..n].copy_from_slice(order);
        }
    }
    aside.clear();
    aside.extend_from_slice(items);
    for (item, i) in items.iter_mut().zip(best_order) {
        *item = aside[i as u32 as usize];
    }
    best
}

/// An integer with the order of `f32::total_cmp`.
#[inline(always)]
fn ordered(x: f32) -> u32 {
    let bits = x.to_bits();
    bits ^ if bits >> 31 == 1 { u32::MAX } else { 1 << 31 }
}

/// The best division between bins along each axis. `own` gives the extents of an item.
#[inline(always)]
fn bin(
    items: &mut [BuildTriangle],
    own: impl Fn(&[BuildTriangle], usize) -> Extents,
    frames: usize,
    aside: &mut Vec<BuildTriangle>,
) -> usize {
    let n = items.len();
    let mut best: Option<(f32, usize, usize, usize)> = None;
    let (mut start, mut scale) = ([[0.0; 4]; 2], [[0.0; 4]; 2]);
    for f in 0..frames {
        let (mut lo, mut hi) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for i in 0..n {
            let middle = own(items, i).middle(f);
            (lo, hi) = (min(&middle, &lo), max(&middle, &hi));
        }
        (start[f], scale[f]) = (lo, std::array::from_fn(|k| (BINS - 1) as f32 / (hi[k] - lo[k])));
        let mut bins = [[(Extents::EMPTY, 0u32); BINS]; 3];
        for i in 0..n {
            let o = own(items, i);
            let at = place(&o, f, &start[f], &scale[f]);
            for k in 0..3 {
                let bin = &mut bins[k][at[k]];
                bin.0.join(&o);
                bin.1 += 1;
            }
        }
        for k in (0..3).filter(|&k| scale[f][k].is_finite()) {
            let mut above = [0.0; BINS];
            let (mut right, mut count) = (Extents::EMPTY, 0);
            // An empty bin changes neither side: a division beside it is the one before.
            for i in (1..BINS).rev() {
                if bins[k][i].1 == 0 {
                    above[i] = above.get(i + 1).copied().unwrap_or_default();
                    continue;
                }
                right.join(&bins[k][i].0);
                count += bins[k][i].1;
                above[i] = right.surface() * count as f32;
            }
            let (mut left, mut count) = (Extents::EMPTY, 0);
            for i in (1..BINS).filter(|&i| bins[k][i - 1].1 > 0) {
                left.join(&bins[k][i - 1].0);
                count += bins[k][i - 1].1;
                let cost = left.surface() * count as f32 + above[i];
                let both = count > 0 && (count as usize) < n;
                if both && best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, f, k, i));
                }
            }
        }
    }
    let Some((_, f, k, i)) = best else {
        return n / 2; // All in one place.
    };
    // A stable partition: the order depends on the mesh alone.
    let (mut low, mut high) = (0, 0);
    for j in 0..n {
        // Room for the next ones, and not for all: most divisions are even.
        if aside.len() <= high {
            aside.resize((high + n / 16 + 64).min(n), BuildTriangle::NONE);
        }
        let item = items[j];
        let first = place(&own(items, j), f, &start[f], &scale[f])[k] < i;
        items[low] = item;
        aside[high] = item;
        low += usize::from(first);
        high += usize::from(!first);
    }
    items[low..].copy_from_slice(&aside[..high]);
    low
}

/// The bins of an item along three axes.
#[inline(always)]
fn place(o: &Extents, frame: usize, start: &Vec4, scale: &Vec4) -> [usize; 3] {
    let middle = o.middle(frame);
    std::array::from_fn(|k| {
        // Rounded to the nearest by the addition, and never out of range.
        ((middle[k] - start[k]) * scale[k] + UNITS).to_bits() as usize % BINS
    })
}
