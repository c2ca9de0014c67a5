//! The relative pose of two trees: in `f64` for triangles, in `f32` with a margin for boxes.

use nalgebra::{Matrix3, Vector3};

use crate::bvh::{NodeBox, Tree};
use crate::pose::Relative;
use mp_simd::Lanes;

/// A rigid motion in `f32`, between centred frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidTransform {
    pub(crate) r: [[f32; 3]; 3],
    t: [f32; 3],
}

impl RigidTransform {
    #[inline(always)]
    fn new(r: &Matrix3<f64>, t: &Vector3<f64>) -> Self {
        Self {
            r: [
                [r.m11 as f32, r.m12 as f32, r.m13 as f32],
                [r.m21 as f32, r.m22 as f32, r.m23 as f32],
                [r.m31 as f32, r.m32 as f32, r.m33 as f32],
            ],
            t: [t.x as f32, t.y as f32, t.z as f32],
        }
    }
}

/// A [`RigidTransform`] of boxes, in lanes: rows 0 and 1 side by side, then row 2.
#[derive(Clone, Copy)]
pub(crate) struct FrameTransform<L> {
    r: [[L; 3]; 2],
    /// Moves the centre of a box, not its axes.
    t: [L; 2],
}

impl<L: Lanes> FrameTransform<L> {
    #[inline(always)]
    pub(crate) fn new(frame: &RigidTransform) -> Self {
        let (r, t) = (&frame.r, &frame.t);
        Self {
            r: [three!(k => L::halves(r[0][k], r[1][k])), three!(k => L::splat(r[2][k]))],
            t: [
                L::load(&[t[0], 0.0, 0.0, 0.0, t[1], 0.0, 0.0, 0.0]),
                L::load(&[t[2], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            ],
        }
    }

    #[inline(always)]
    pub(crate) fn place<'b>(&self, b: &'b NodeBox) -> Placed<'b> {
        let v: [L; 3] = three!(d => L::twice(&b.frame[d]));
        let mut rows = [[0.0; 8]; 2];
        for i in 0..2 {
            let r = &self.r[i];
            let sum = v[0].mul_add(r[0], v[1].mul_add(r[1], v[2].mul_add(r[2], self.t[i])));
            sum.store(&mut rows[i]);
        }
        Placed { rows, half: &b.half }
    }
}

/// A box moved into the frame of another tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'b> {
    /// As [`NodeBox::frame`], the first two rows side by side.
    rows: [[f32; 8]; 2],
    pub(crate) half: &'b [f32; 3],
}

impl<'b> Placed<'b> {
    /// A box in the frame of its own tree, moved so that its centre is the origin.
    #[inline(always)]
    pub(crate) fn at_origin(b: &'b NodeBox) -> Self {
        let [x, y, z] = &b.frame;
        Self {
            rows: [
                [0.0, x[1], x[2], x[3], 0.0, y[1], y[2], y[3]],
                [0.0, z[1], z[2], z[3], 0.0, 0.0, 0.0, 0.0],
            ],
            half: &b.half,
        }
    }

    /// The same box with its centre elsewhere.
    #[inline(always)]
    pub(crate) fn centred_at(mut self, center: [f32; 3]) -> Self {
        self.rows[0][0] = center[0];
        self.rows[0][4] = center[1];
        self.rows[1][0] = center[2];
        self
    }

    #[inline(always)]
    fn column<L: Lanes>(&self, k: usize) -> [L; 3] {
        [L::splat(self.rows[0][k]), L::splat(self.rows[0][k + 4]), L::splat(self.rows[1][k])]
    }

    /// The centre in every lane.
    #[inline(always)]
    pub(crate) fn center<L: Lanes>(&self) -> [L; 3] {
        self.column(0)
    }

    #[inline(always)]
    pub(crate) fn axis<L: Lanes>(&self, k: usize) -> [L; 3] {
        self.column(k + 1)
    }
}

/// The relative pose of tree `a` and tree `b`, in all the forms that queries use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frames {
    /// From the frame of `b` into that of `a`: the transform of the contract in the crate docs.
    pub(crate) exact: Relative,
    /// From centred `b` to centred `a`, and back.
    pub(crate) into_a: RigidTransform,
    pub(crate) into_b: RigidTransform,
    /// Boxes are apart only when the gap exceeds this (metres): [`PAD`], and the rounding of the triangles
    /// themselves in `f64`, which outweighs it far from the origin of a mesh.
    pub(crate) pad: f32,
    /// That rounding alone (metres).
    pub(crate) slack: f32,
    /// Distance of the two centres.
    pub(crate) apart: f64,
}

/// Rounding in `f32` of moving a box into the other frame and testing it, relative to the size of the
/// problem `s = radius a + radius b + distance of the centres`.
///
/// A coordinate of a placed centre is a sum of four products, wrong by at most 6u·s (u = 2⁻²⁴); its
/// projection on an axis adds 5u·s; extents along an axis are sums of six products, wrong by 10u·s; axes
/// themselves are wrong by 4u, which moves a projection by 8u·s. 32u·s covers it: 2e-6.
const PAD: f64 = 2e-6;

impl Frames {
    #[inline(always)]
    pub(crate) fn new(a: &Tree, b: &Tree, exact: &Relative) -> Self {
        let r = exact.rotation;
        let shift = exact.point(&b.center) - a.center;
        let shift_back = r.tr_mul(&shift) * -1.0;
        let apart = shift.norm();
        let pad = PAD * (a.radius_center + b.radius_center + apart) + exact.slack;
        Self {
            exact: *exact,
            into_a: RigidTransform::new(&r, &shift),
            into_b: RigidTransform::new(&r.transpose(), &shift_back),
            pad: (pad * (1.0 + 1e-6)) as f32,
            slack: (exact.slack * (1.0 + 1e-6)) as f32,
            apart,
        }
    }

    /// Whether lanes may be used: products of four lengths must neither overflow nor underflow in `f32`.
    pub(crate) fn fits_f32(&self, a: &Tree, b: &Tree) -> bool {
        fits(a.radius_center) && fits(b.radius_center) && self.apart <= 1e9
    }
}

/// Whether lanes, and so the boxes of nodes and leaves, may be used for a tree of this `Tree::radius_center`.
pub(crate) fn fits(radius_center: f64) -> bool {
    radius_center == 0.0 || (1e-9..=1e9).contains(&radius_center)
}
