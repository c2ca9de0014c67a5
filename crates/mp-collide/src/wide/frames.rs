//! How two trees lie to each other: exactly in `f64` for triangles, in `f32` with a margin for boxes.

use nalgebra::{Matrix3, Vector3};

use super::{Obb, Tree};
use crate::pose::Relative;
use crate::simd::Lanes;

/// A rigid motion in `f32`, between centred frames.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) r: [[f32; 3]; 3],
    t: [f32; 3],
}

/// A box carried into the frame of another tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// As [`Obb::frame`].
    pub(crate) frame: [[f32; 4]; 3],
    pub(crate) half: [f32; 3],
}

impl Placed {
    /// A box in the frame of its own tree, moved there so that its centre is the origin.
    #[inline(always)]
    pub(crate) fn at_origin(b: &Obb) -> Self {
        let mut frame = b.frame;
        for row in &mut frame {
            row[0] = 0.0;
        }
        Self { frame, half: b.half }
    }

    /// Axis `k` in every lane.
    #[inline(always)]
    pub(crate) fn axis<L: Lanes>(&self, k: usize) -> [L; 3] {
        [L::splat(self.frame[0][k + 1]), L::splat(self.frame[1][k + 1]), L::splat(self.frame[2][k + 1])]
    }
}

impl Frame {
    /// As [`Frame::place`], with the centre of the box at a place already known.
    #[inline(always)]
    pub(crate) fn place_at(&self, b: &Obb, center: [f32; 3]) -> Placed {
        let mut placed = self.place(b);
        for i in 0..3 {
            placed.frame[i][0] = center[i];
        }
        placed
    }

    fn new(r: &Matrix3<f64>, t: &Vector3<f64>) -> Self {
        Self {
            r: std::array::from_fn(|i| std::array::from_fn(|j| r[(i, j)] as f32)),
            t: std::array::from_fn(|i| t[i] as f32),
        }
    }

    #[inline(always)]
    pub(crate) fn place(&self, b: &Obb) -> Placed {
        let [x, y, z] = &b.frame;
        let mut frame = [[0.0; 4]; 3];
        for i in 0..3 {
            let r = &self.r[i];
            // The centre and the three axes at once; only the centre is moved.
            let t = [self.t[i], 0.0, 0.0, 0.0];
            for l in 0..4 {
                frame[i][l] = r[0] * x[l] + r[1] * y[l] + r[2] * z[l] + t[l];
            }
        }
        Placed { frame, half: b.half }
    }
}

/// Everything about the relative pose of tree `a` and tree `b`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frames {
    /// From the frame of `b` into that of `a`: the motion the contract speaks of.
    pub(crate) exact: Relative,
    /// From centred `b` to centred `a`, and back.
    pub(crate) into_a: Frame,
    pub(crate) into_b: Frame,
    /// Boxes are apart only when the gap exceeds this (metres): [`PAD`], and the rounding of the triangles
    /// themselves in `f64`, which outweighs it far from the origin of a mesh.
    pub(crate) pad: f32,
    /// That rounding alone (metres).
    pub(crate) slack: f32,
    /// Distance of the two centres.
    pub(crate) apart: f64,
}

/// Rounding in `f32` of carrying a box into the other frame and testing it, in parts of the size of the
/// problem `s = radius a + radius b + distance of the centres`.
///
/// A coordinate of a placed centre is a sum of four products, wrong by at most 6u·s (u = 2⁻²⁴); its
/// projection on an axis adds 5u·s; extents along an axis are sums of six products, wrong by 10u·s; axes
/// themselves are wrong by 4u, which moves a projection by 8u·s. 32u·s covers it: 2e-6.
const PAD: f64 = 2e-6;

impl Frames {
    pub(crate) fn new(a: &Tree, b: &Tree, exact: &Relative) -> Self {
        let r = exact.rotation;
        let shift = exact.point(&b.center) - a.center;
        let shift_back = r.tr_mul(&shift) * -1.0;
        let apart = shift.norm();
        let pad = PAD * (a.radius_center + b.radius_center + apart) + exact.slack;
        Self {
            exact: *exact,
            into_a: Frame::new(&r, &shift),
            into_b: Frame::new(&r.transpose(), &shift_back),
            pad: (pad * (1.0 + 1e-6)) as f32,
            slack: (exact.slack * (1.0 + 1e-6)) as f32,
            apart,
        }
    }

    /// Whether lanes may be used: products of four lengths must neither overflow nor vanish in `f32`.
    pub(crate) fn fits_f32(&self, a: &Tree, b: &Tree) -> bool {
        let fits = |length: f64| length == 0.0 || (1e-9..=1e9).contains(&length);
        fits(a.radius_center) && fits(b.radius_center) && self.apart <= 1e9
    }
}
