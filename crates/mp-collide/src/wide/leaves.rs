//! Eight triangles against a box, and against one triangle: filters that never lose a pair that meets.

use super::boxes::{cross, dot, sub};
use super::frames::Placed;
use super::{Leaf, Tree};
use crate::simd::Lanes;
use crate::triangle::Triangle;

/// Added to every margin: products of lengths so small that they underflow decide nothing.
const TINY: f32 = 1e-34;

/// The inverse of u = 2⁻²⁴, the relative rounding of `f32`.
const INVERSE_U: f32 = 16_777_216.0;

/// The triangles of `leaf` (of `tree`) that may come within `margin` of box `q`: axes of the box, then
/// the normals of the triangles.
#[inline(always)]
pub(crate) fn near_box<L: Lanes>(tree: &Tree, leaf: &Leaf, q: &Placed, margin: f32) -> u32 {
    let c: [f32; 3] = three!(i => q.frame[i][0] - (leaf.center[i] - tree.center[i]) as f32);
    let c = [L::splat(c[0]), L::splat(c[1]), L::splat(c[2])];
    let v = corners::<L>(leaf);
    let d = [sub(&v[0], &c), sub(&v[1], &c), sub(&v[2], &c)];
    let mut mask = !0;
    for k in 0..3 {
        let u = q.axis::<L>(k);
        let (x, y, z) = (dot(&u, &d[0]), dot(&u, &d[1]), dot(&u, &d[2]));
        let reach = q.half[k] + margin;
        mask &= x.min(y).min(z).le(L::splat(reach)) & L::splat(-reach).le(x.max(y).max(z));
    }
    mask &= (1 << leaf.count) - 1;
    if mask == 0 {
        return 0;
    }
    let n = cross(&sub(&v[1], &v[0]), &sub(&v[2], &v[0]));
    let height = dot(&n, &d[0]);
    // The normal is no longer than edge², and wrong by about 4u·(edge + magnitude)·edge.
    let edge = leaf.edge;
    let size = leaf.magnitude + q.half[0] + q.half[1] + q.half[2] + margin;
    let mut reach = L::splat(edge * (edge * margin + 2e-6 * (edge + leaf.magnitude) * size) + TINY);
    for k in 0..3 {
        let u = q.axis::<L>(k);
        reach = dot(&n, &u).abs().mul_add(L::splat(q.half[k]), reach);
    }
    mask & height.abs().le(reach)
}

#[inline(always)]
pub(crate) fn corners<L: Lanes>(leaf: &Leaf) -> [[L; 3]; 3] {
    let c = &leaf.corner;
    [
        [L::load(&c[0][0]), L::load(&c[0][1]), L::load(&c[0][2])],
        [L::load(&c[1][0]), L::load(&c[1][1]), L::load(&c[1][2])],
        [L::load(&c[2][0]), L::load(&c[2][1]), L::load(&c[2][2])],
    ]
}

/// What one triangle after another is tested against: the triangles of a leaf with their normals.
pub(crate) struct Block<L> {
    v: [[L; 3]; 3],
    f: [[L; 3]; 3],
    n: [L; 3],
    center: [f64; 3],
    magnitude: f32,
    edge: f32,
}

impl<L: Lanes> Block<L> {
    #[inline(always)]
    pub(crate) fn new(leaf: &Leaf) -> Self {
        let v = corners::<L>(leaf);
        let f = [sub(&v[1], &v[0]), sub(&v[2], &v[1]), sub(&v[0], &v[2])];
        let n = cross(&f[0], &f[1]);
        Self { v, f, n, center: leaf.center, magnitude: leaf.magnitude, edge: leaf.edge }
    }

    /// The triangles of the block that may meet `triangle`, given in the frame of the block's mesh and wrong
    /// by up to `slack` (metres) there.
    ///
    /// Planes first, then the nine signed volumes of pairs of edges. With corners wrong by u·`g` (`g` the
    /// largest coordinate, u = 2⁻²⁴) and edges no longer than `e` and `f`, a volume
    /// (p − v)·(e × f) is wrong by at most 2u·g·w·(e + f) + 4u·g·e·f for the corners, with
    /// w ≤ 2√3·g the distance of the corners, and 6u·w·e·f for the arithmetic.
    #[inline(always)]
    pub(crate) fn may_meet(&self, triangle: &Triangle, mask: u32, slack: f32) -> u32 {
        let c = &self.center;
        let p: [[f32; 3]; 3] = three!(k => {
            [(triangle[k].x - c[0]) as f32, (triangle[k].y - c[1]) as f32, (triangle[k].z - c[2]) as f32]
        });
        let mut g = self.magnitude;
        for corner in &p {
            g = g.max(corner[0].abs()).max(corner[1].abs()).max(corner[2].abs());
        }
        // A corner wrong by `slack` too is as wrong as one rounded at this size.
        g += slack * INVERSE_U;
        let s: [[L; 3]; 3] = three!(k => [L::splat(p[k][0]), L::splat(p[k][1]), L::splat(p[k][2])]);
        // Corners of the one against the planes of the eight.
        let edge = self.edge;
        let wrong = g * edge * (1.5e-6 * g + 2e-6 * edge) + TINY;
        let h: [L; 3] = three!(k => dot(&self.n, &sub(&s[k], &self.v[0])));
        let mut mask = mask
            & h[0].min(h[1]).min(h[2]).le(L::splat(wrong))
            & L::splat(-wrong).le(h[0].max(h[1]).max(h[2]));
        if mask == 0 {
            return 0;
        }
        // Corners of the eight against the plane of the one.
        let e: [[f32; 3]; 3] = three!(k => {
            let (a, b) = (&p[k], &p[(k + 1) % 3]);
            [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
        });
        let length = |v: &[f32; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        let own = length(&e[0]).max(length(&e[1])).max(length(&e[2]));
        let n = [
            e[0][1] * e[1][2] - e[0][2] * e[1][1],
            e[0][2] * e[1][0] - e[0][0] * e[1][2],
            e[0][0] * e[1][1] - e[0][1] * e[1][0],
        ];
        let n = [L::splat(n[0]), L::splat(n[1]), L::splat(n[2])];
        let wrong = g * own * (1.5e-6 * g + 2e-6 * own) + TINY;
        let h: [L; 3] = three!(k => dot(&n, &sub(&self.v[k], &s[0])));
        mask &= h[0].min(h[1]).min(h[2]).le(L::splat(wrong)) & L::splat(-wrong).le(h[0].max(h[1]).max(h[2]));
        if mask == 0 {
            return 0;
        }
        // Edges against edges: they meet only if for some edge of one all three volumes may agree.
        let wrong = g * (5e-7 * g * (own + edge) + 2e-6 * own * edge) + TINY;
        let (above, below) = (L::splat(-wrong), L::splat(wrong));
        let mut positive = [[0u32; 3]; 3];
        let mut negative = [[0u32; 3]; 3];
        for i in 0..3 {
            let ei = [L::splat(e[i][0]), L::splat(e[i][1]), L::splat(e[i][2])];
            for j in 0..3 {
                let volume = dot(&sub(&s[i], &self.v[j]), &cross(&ei, &self.f[j]));
                positive[i][j] = above.le(volume);
                negative[i][j] = volume.le(below);
            }
        }
        let mut some = 0;
        for i in 0..3 {
            some |= (positive[i][0] & positive[i][1] & positive[i][2])
                | (negative[i][0] & negative[i][1] & negative[i][2])
                | (positive[0][i] & positive[1][i] & positive[2][i])
                | (negative[0][i] & negative[1][i] & negative[2][i]);
        }
        mask & some
    }
}
