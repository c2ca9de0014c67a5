//! Leaves: eight triangles, moved into another frame, and compared with a box, by a filter that keeps every triangle
//! that meets the box.

use crate::bvh::frames::{FrameTransform, Frames, Placed};
use crate::bvh::{Leaf, NodeBox};
use crate::kernels::separating_axes::{cross, dot, sub};
use mp_simd::{Lanes, Mask};

/// Added to every margin, so that products that underflow decide nothing.
pub(crate) const TINY: f32 = 1e-34;

/// Corners of eight triangles: `[k][d]` is coordinate `d` of corner `k`.
pub(crate) type Corners<L> = [[L; 3]; 3];

#[inline(always)]
pub(crate) fn corners<L: Lanes>(leaf: &Leaf) -> Corners<L> {
    let c = &leaf.corner;
    [
        [L::load(&c[0][0]), L::load(&c[0][1]), L::load(&c[0][2])],
        [L::load(&c[1][0]), L::load(&c[1][1]), L::load(&c[1][2])],
        [L::load(&c[2][0]), L::load(&c[2][1]), L::load(&c[2][2])],
    ]
}

/// u: the relative rounding of `f32`.
pub(crate) const U: f32 = 6e-8;

/// The frame in which two leaves are compared, that of the first with its origin moved to the leaf's centre, and the
/// rounding error of `f32` there.
///
/// Corners of the first, within `m` of its centre, are rounded once: u·m. Those of the second, within `n`
/// of its centre, which is at `t`, are wrong by u·√3·n each for the rounding of the corner, of the rotation and of
/// three products, by u·(√3·n + t) for each of three sums and by u·t for that of the shift, and by what `f64`
/// loses in the triangles that the contract speaks of. All in each coordinate.
pub(crate) struct LeafFrame {
    /// Centre of the second leaf.
    pub(crate) shift: [f32; 3],
    /// Its largest coordinate in magnitude.
    pub(crate) t: f32,
    /// A bound on the error of a coordinate of the first leaf plus that of one of the second.
    pub(crate) wrong: f32,
}

impl LeafFrame {
    #[inline(always)]
    pub(crate) fn new(a: &Leaf, b: &Leaf, frames: &Frames) -> Self {
        let center = frames.exact.point(&b.center.into());
        let shift = three!(d => (center[d] - a.center[d]) as f32);
        let t = shift[0].abs().max(shift[1].abs()).max(shift[2].abs());
        let wrong = U * (a.magnitude + 10.5 * b.magnitude + 4.0 * t) + frames.slack;
        Self { shift, t, wrong }
    }

    /// Moves the triangles of the second leaf into this frame.
    #[inline(always)]
    pub(crate) fn carry<L: Lanes>(&self, v: &Corners<L>, frames: &Frames) -> Corners<L> {
        let r = &frames.into_a.r;
        three!(k => three!(d => {
            let x = v[k][2].mul_add(L::splat(r[d][2]), L::splat(self.shift[d]));
            v[k][0].mul_add(L::splat(r[d][0]), v[k][1].mul_add(L::splat(r[d][1]), x))
        }))
    }
}

/// The triangles (with edges up to `edge` long) that may come within `margin` of box `q`, all in the frame of
/// `near`: axes of the box, then the normals of the triangles.
#[inline(always)]
pub(crate) fn near_box<L: Lanes>(
    v: &Corners<L>,
    edge: f32,
    q: &Placed<'_>,
    near: &LeafFrame,
    margin: f32,
) -> u32 {
    let c = q.center::<L>();
    let d = [sub(&v[0], &c), sub(&v[1], &c), sub(&v[2], &c)];
    let margin = margin + 2.0 * near.wrong;
    let [x, y, z] = three!(k => {
        let u = q.axis::<L>(k);
        let (x, y, z) = (dot(&u, &d[0]), dot(&u, &d[1]), dot(&u, &d[2]));
        let reach = q.half[k] + margin;
        x.min(y).min(z).le(L::splat(reach)) & L::splat(-reach).le(x.max(y).max(z))
    });
    let mask = x & y & z;
    if mask.bits() == 0 {
        return 0;
    }
    let n = cross(&sub(&v[1], &v[0]), &sub(&v[2], &v[0]));
    let height = dot(&n, &d[0]);
    // The normal is no longer than edge², and wrong by some (7·wrong + 5u·edge)·edge; corners not ruled out
    // are no farther from the centre of the box than `size`.
    let size = 2.0 * edge + q.half[0] + q.half[1] + q.half[2] + margin;
    let mut reach = L::splat(edge * (edge * margin + (16.0 * near.wrong + 1e-6 * edge) * size) + TINY);
    for k in 0..3 {
        let u = q.axis::<L>(k);
        reach = dot(&n, &u).abs().mul_add(L::splat(q.half[k] * (1.0 + 1e-6)), reach);
    }
    (mask & height.abs().le(reach)).bits()
}

/// The triangles of each of two leaves that may come within `margin` of the box around the other; none of the
/// second when none of the first does.
#[inline(always)]
pub(crate) fn near_each_other<L: Lanes>(
    (a, b): (&Leaf, &Leaf),
    (box_a, box_b): (&NodeBox, &NodeBox),
    frames: &Frames,
    into_a: &FrameTransform<L>,
    margin: f32,
) -> (u32, u32) {
    let near = LeafFrame::new(a, b, frames);
    let box_b = into_a.place(box_b).centred_at(near.shift);
    let mask_a = near_box(&corners::<L>(a), a.edge, &box_b, &near, margin) & a.all();
    if mask_a == 0 {
        return (0, 0);
    }
    let corners_b = near.carry(&corners::<L>(b), frames);
    (mask_a, near_box(&corners_b, b.edge, &Placed::at_origin(box_a), &near, margin) & b.all())
}
