//! How far the corners of eight triangles move over a part of a motion, and whether a plane of a triangle or another direction shows that they keep apart
//! meanwhile.

use crate::kernels::leaf_pair::{Corners, TINY};
use crate::kernels::separating_axes::dot;
use crate::kernels::swept_interval::Drift;
use mp_simd::{Lanes, Mask};

/// The drift of the corners of eight triangles, which lie as in a leaf.
pub(crate) struct CornerDrift<L> {
    drift: Corners<L>,
    /// A bound on the sum of its coordinates.
    sum: L,
    /// How far corners may leave their drift, in any direction, plus the distance to keep (metres).
    beside: f32,
    /// How far corners move along the normal of their triangle, times its length.
    along_own: L,
    /// The lengths of the normals, times `beside`.
    beside_own: L,
}

impl<L: Lanes> CornerDrift<L> {
    /// Of corners `v`, `center` from the origin of `drift`, of triangles with the normals `n`.
    #[inline(always)]
    pub(crate) fn new(drift: &Drift, (v, center): (&Corners<L>, [f32; 3]), n: &[L; 3], beside: f64) -> Self {
        let drift = three!(k => drift.at(&three!(d => v[k][d].add(L::splat(center[d])))));
        let beside = (beside * (1.0 + 1e-6)) as f32;
        let sum = |k: usize| drift[k][0].abs().add(drift[k][1].abs()).add(drift[k][2].abs());
        Self {
            sum: sum(0).max(sum(1)).max(sum(2)),
            along_own: dot(n, &drift[0]).abs().max(dot(n, &drift[1]).abs()).max(dot(n, &drift[2]).abs()),
            beside_own: dot(n, n).sqrt().mul(L::splat(beside * (1.0 + 1e-5))),
            drift,
            beside,
        }
    }

    /// The lanes of which a single triangle stays on one side of the plane. `heights` are the least ones of its corners over each plane, times the
    /// length of the normal, with their errors taken off; a normal is wrong by at most `wrong`.
    #[inline(always)]
    pub(crate) fn keeps_from_own_planes(&self, heights: L, wrong: f32) -> u32 {
        self.is_less(self.along_own.add(self.beside_own), wrong, heights)
    }

    /// The lanes that stay on one side of the plane of a single triangle, whose normal is `n` of length `length`, wrong by at most `wrong`. Corners have
    /// the heights `w` over it, times that length, wrong by up to `error`.
    #[inline(always)]
    pub(crate) fn keeps_from_plane(
        &self,
        (n, length): (&[L; 3], f32),
        (w, error): (&[L; 3], L),
        wrong: f32,
    ) -> u32 {
        let d: [L; 3] = three!(k => dot(n, &self.drift[k]).abs());
        let low = w[0].sub(d[0]).min(w[1].sub(d[1])).min(w[2].sub(d[2]));
        let high = w[0].add(d[0]).max(w[1].add(d[1])).max(w[2].add(d[2]));
        let heights = low.max(L::splat(0.0).sub(high)).sub(error);
        self.is_less(L::splat(length * self.beside * (1.0 + 1e-5)), wrong, heights)
    }

    /// The lanes whose corners `v` stay farther along `way`, of any length, than the corners `s` of a single triangle. Coordinates are at most `g`, and
    /// wrong by u·`g` (u = 2⁻²⁴): with the rounding of their products each side is wrong by up to 7u·`g`.
    #[inline(always)]
    pub(crate) fn keeps_along(&self, way: &[L; 3], s: &Corners<L>, v: &Corners<L>, g: f32) -> u32 {
        let low: [L; 3] = three!(k => dot(way, &v[k]).sub(dot(way, &self.drift[k]).abs()));
        let high: [L; 3] = three!(k => dot(way, &s[k]));
        // What is added outweighs what is lost to underflow.
        let length = dot(way, way).add(L::splat(1e-36)).sqrt();
        let apart = L::splat(self.beside * (1.0 + 1e-5) + 1.2e-6 * g);
        let high = high[0].max(high[1]).max(high[2]).add(L::splat(TINY));
        length.mul_add(apart, high).lt(low[0].min(low[1]).min(low[2])).bits()
    }

    /// A way without its part along the motion: what moves past something is separated from it along that.
    #[inline(always)]
    pub(crate) fn across(&self, way: &[L; 3]) -> [L; 3] {
        let d = &self.drift[0];
        let along = dot(way, d).div(dot(d, d).max(L::splat(TINY)));
        three!(k => way[k].sub(d[k].mul(along)))
    }

    /// Where `reach` is less than heights, whatever the error of the normal, which has the rounding of projections in it. Written so that NaN is not.
    #[inline(always)]
    fn is_less(&self, reach: L, wrong: f32, heights: L) -> u32 {
        let error = self.sum.add(L::splat(self.beside)).mul_add(L::splat(wrong), L::splat(TINY));
        reach.add(error).lt(heights).bits()
    }
}
