//! The distance of one triangle from eight, in lanes, with an error margin.
//!
//! Nine pairs of edges (Ericson 2005, *Real-Time Collision Detection*, §5.1.9) and six corners against
//! faces. For triangles that may intersect no distance is bounded; they are only reported.

use nalgebra::{Point3, Vector3};

use crate::bvh::{Lane, Leaf};
use crate::kernels::corner_drift::CornerDrift;
use crate::kernels::leaf_pair::corners;
use crate::kernels::separating_axes::{cross, dot, sub};
use crate::kernels::swept_interval::Drift;
use crate::triangle::Triangle;
use mp_simd::{Lanes, Mask};

/// Keeps quotients finite where an edge or a triangle has no extent.
const TINY: f32 = 1e-37;

/// A normal is used only when its direction is wrong by at most 1e-4. From corners wrong by u·`g` (u = 2⁻²⁴)
/// and edges up to `e` it is wrong by 6u·e·(g + e); squared, with what is lost to underflow on top:
/// |n|² is to be at least `SOUND` · e² (g² + e²) + `SOUND_AT_LEAST`.
const SOUND: f32 = 2.6e-5;
const SOUND_AT_LEAST: f32 = 1e-30;

/// A normal wrong by the angle δ makes the height of a point over the triangle wrong by δ·e; δ² is `TILT` times the bound
/// of `SOUND`, divided by |n|².
const TILT: f32 = 1e-8;

/// Below this size (metres) products of four lengths are lost to underflow.
const SMALL: f32 = 1e-7;

/// Added to the margin of a height, so that products that underflow decide nothing.
const TINY_HEIGHT: f32 = 1e-34;

/// Squared distances: `near` ≤ distance² ≤ `far` where the triangles do not intersect.
#[derive(Default)]
pub(crate) struct DistanceBounds {
    pub(crate) near: Lane,
    pub(crate) far: Lane,
    /// In a motion: the way from the single triangle between the nearest points of edges.
    pub(crate) join: [Lane; 3],
}

/// A direction along which triangles may be apart, a little shorter than a unit vector; or zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SeparatingDirection(pub(crate) [f32; 3]);

impl SeparatingDirection {
    /// The direction of `join`, if it has a length.
    pub(crate) fn across(join: &Vector3<f64>) -> Self {
        let scale = (1.0 - 1e-6) / join.norm();
        if scale.is_finite() {
            Self(std::array::from_fn(|d| (join[d] * scale) as f32))
        } else {
            Self::default()
        }
    }
}

/// Masks of the triangles that are close.
#[derive(Default)]
pub(crate) struct Close {
    /// Those for which `DistanceBounds::near` is at most the limit; the bounds hold for these.
    pub(crate) near: u32,
    /// Those that may intersect the single triangle.
    pub(crate) crossing: u32,
}

/// The triangles of a leaf, ready to be compared with one after another.
pub(crate) struct DistanceKernel<L> {
    v: [[L; 3]; 3],
    f: [[L; 3]; 3],
    /// Squared lengths of the edges, and their inverses.
    ff: [L; 3],
    inverse: [L; 3],
    n: [L; 3],
    nn: L,
    /// Infinite for triangles whose normal is lost to rounding, 0 for the others.
    unsound: L,
    /// How wrong a height may be through the error of the normal's direction.
    tilt: L,
    /// Vectors in the plane, at right angles to each edge, inward.
    inward: [[L; 3]; 3],
    lo: [L; 3],
    hi: [L; 3],
    /// How far the triangles reach along `direction`.
    top: L,
    direction: [f32; 3],
    center: [f64; 3],
    magnitude: f32,
    edge: f32,
}

impl<L: Lanes> DistanceKernel<L> {
    #[inline(always)]
    pub(crate) fn new(leaf: &Leaf, direction: &SeparatingDirection) -> Self {
        let v = corners::<L>(leaf);
        let f = [sub(&v[1], &v[0]), sub(&v[2], &v[1]), sub(&v[0], &v[2])];
        let n = cross(&f[0], &f[1]);
        let tiny = L::splat(TINY);
        let ff = [dot(&f[0], &f[0]), dot(&f[1], &f[1]), dot(&f[2], &f[2])];
        let one = L::splat(1.0);
        let nn = dot(&n, &n);
        let longest = ff[0].max(ff[1]).max(ff[2]);
        let square = L::splat(leaf.magnitude * leaf.magnitude).add(longest);
        let least = L::splat(SOUND).mul(longest).mul_add(square, L::splat(SOUND_AT_LEAST));
        let huge = L::splat(1e38);
        let along = direction.0.map(L::splat);
        Self {
            unsound: least.sub(nn).max(L::splat(0.0)).mul(huge).mul(huge),
            tilt: L::splat(TILT).mul(longest).mul(least.div(nn.max(L::splat(SOUND_AT_LEAST)))).sqrt(),
            ff,
            inverse: [one.div(ff[0].max(tiny)), one.div(ff[1].max(tiny)), one.div(ff[2].max(tiny))],
            nn,
            inward: [cross(&n, &f[0]), cross(&n, &f[1]), cross(&n, &f[2])],
            lo: three!(d => v[0][d].min(v[1][d]).min(v[2][d])),
            hi: three!(d => v[0][d].max(v[1][d]).max(v[2][d])),
            top: dot(&along, &v[0]).max(dot(&along, &v[1])).max(dot(&along, &v[2])),
            direction: direction.0,
            center: leaf.center,
            magnitude: leaf.magnitude,
            edge: leaf.edge,
            v,
            f,
            n,
        }
    }

    /// How the triangles move by `drift`, whose origin is `origin`. They may leave it by `beside` (m), which has the distance in it that they
    /// keep.
    #[inline(always)]
    pub(crate) fn moving(&self, drift: &Drift, origin: &Point3<f64>, beside: f64) -> CornerDrift<L> {
        let center = std::array::from_fn(|d| (self.center[d] - origin[d]) as f32);
        CornerDrift::new(drift, (&self.v, center), &self.n, beside)
    }

    /// The lanes, of those in `mask`, whose squared distance from `triangle` (in the frame of the mesh) may be
    /// at most `best`; without those that keep apart in a motion, as the plane of either triangle shows, or the line through the nearest points
    /// of their edges.
    #[inline(always)]
    pub(crate) fn between(
        &self,
        triangle: &Triangle,
        mask: u32,
        best: f32,
        motion: Option<&CornerDrift<L>>,
        bounds: &mut DistanceBounds,
    ) -> Close {
        let c = &self.center;
        let p: [[f32; 3]; 3] = three!(k => {
            [(triangle[k].x - c[0]) as f32, (triangle[k].y - c[1]) as f32, (triangle[k].z - c[2]) as f32]
        });
        let mut g = self.magnitude;
        for corner in &p {
            g = g.max(corner[0].abs()).max(corner[1].abs()).max(corner[2].abs());
        }
        let zero = L::splat(0.0);
        // A coordinate is wrong by u·g.
        let wrong = 3e-7 * g;
        let mut gap = zero;
        for d in 0..3 {
            let lo = p[0][d].min(p[1][d]).min(p[2][d]) - wrong;
            let hi = p[0][d].max(p[1][d]).max(p[2][d]) + wrong;
            let apart = self.lo[d].sub(L::splat(hi)).max(L::splat(lo).sub(self.hi[d])).max(zero);
            gap = apart.mul_add(apart, gap);
        }
        // The gap along the direction: each of its two sides is wrong by up to 7u·g.
        let along = three!(k => self.direction[0] * p[k][0] + self.direction[1] * p[k][1] + self.direction[2] * p[k][2]);
        let bottom = along[0].min(along[1]).min(along[2]) - 4.0 * wrong;
        let apart = L::splat(bottom).sub(self.top).max(zero);
        let gap = apart.square().max(gap);
        // Finite: nothing is farther away, and 0 · ∞ would lose triangles without area.
        let limit = L::splat((best * (1.0 + 1e-4)).min(1e30));
        let mut mask = mask & gap.le(limit).bits();
        if mask == 0 {
            return Close::default();
        }
        let s: [[L; 3]; 3] = three!(k => [L::splat(p[k][0]), L::splat(p[k][1]), L::splat(p[k][2])]);
        // Where all of the single triangle is on one side of the plane of a lane, height² / |n|² is a bound. Corners are wrong by
        // u·g and no farther apart than 2√3·g, so a normal is wrong by 7u·g·e + 3u·e² and a height, with the
        // corners' own error and the rounding of the products, by 24u·g²·e + 28u·g·e².
        let edge = self.edge;
        let wrong = edge * (1.5e-6 * g + 2e-6 * edge);
        let error = L::splat(g * wrong);
        let h: [L; 3] = three!(k => dot(&self.n, &sub(&s[k], &self.v[0])));
        let apart = one_sided(&h).sub(error);
        if let Some(motion) = motion {
            mask &= !motion.keeps_from_own_planes(apart, wrong);
        }
        mask &= apart.max(zero).square().le(self.nn.mul(limit).add(error.square())).bits();
        let mut crossing = apart.le(L::splat(TINY_HEIGHT)).bits();
        if mask == 0 {
            return Close::default();
        }
        // Edges from the unrounded corners: for a small triangle far away those of `p` would be mostly noise.
        let e: [[f32; 3]; 3] = three!(k => {
            let d = triangle[(k + 1) % 3] - triangle[k];
            [d.x as f32, d.y as f32, d.z as f32]
        });
        let ee = e.map(|e| e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
        let own = ee[0].max(ee[1]).max(ee[2]).sqrt();
        let m = cross_scalar(&e[0], &e[1]);
        let mm = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
        let longest = own * own;
        let sound = mm >= SOUND * longest * longest + SOUND_AT_LEAST && own.max(edge) >= SMALL;
        let unsound = L::splat(if sound { 0.0 } else { f32::INFINITY });
        let n = [L::splat(m[0]), L::splat(m[1]), L::splat(m[2])];
        let wrong = own * (1.5e-6 * g + 2e-6 * own);
        let error = L::splat(g * wrong);
        let w: [L; 3] = three!(k => dot(&n, &sub(&self.v[k], &s[0])));
        if let Some(motion) = motion {
            mask &= !motion.keeps_from_plane((&n, mm.sqrt()), (&w, error), wrong);
        }
        let apart = one_sided(&w).sub(error);
        mask &= apart.max(zero).square().le(L::splat(mm).mul(limit).add(error.square())).bits();
        crossing &= apart.le(L::splat(TINY_HEIGHT)).bits();
        if mask == 0 {
            return Close::default();
        }
        let mut edges = L::splat(f32::INFINITY);
        // From the single triangle, along the line through the nearest points of edges.
        let mut join = [zero; 3];
        for i in 0..3 {
            let ei = [L::splat(e[i][0]), L::splat(e[i][1]), L::splat(e[i][2])];
            let inverse = L::splat(1.0 / ee[i].max(TINY));
            for j in 0..3 {
                let between = self.edges(&s[i], &ei, L::splat(ee[i]), inverse, j);
                let square = dot(&between, &between);
                if motion.is_some() {
                    let nearer = square.lt(edges);
                    join = three!(d => L::select(nearer, between[d], join[d]));
                }
                edges = square.min(edges);
            }
        }
        if let Some(motion) = motion {
            mask &= !motion.keeps_along(&join, &s, &self.v, g);
            mask &= !motion.keeps_along(&motion.across(&join), &s, &self.v, g);
            if mask == 0 {
                return Close::default();
            }
        }
        // A corner whose foot is inside the face: height² / |n|². A penalty rules out feet outside, and normals that
        // are not sound.
        let penalty = L::splat(-1e30);
        let mut faces = L::splat(f32::INFINITY);
        let inverse = L::splat(1.0).div(self.nn.max(L::splat(TINY)));
        for k in 0..3 {
            let inside = three!(j => dot(&self.inward[j], &sub(&s[k], &self.v[j])));
            let outside = inside[0].min(inside[1]).min(inside[2]).min(zero).mul(penalty);
            faces = h[k].mul(inverse).mul_add(h[k], outside.add(self.unsound)).min(faces);
        }
        let inverse = L::splat(1.0 / mm.max(TINY));
        let across = three!(k => { let u = cross_scalar(&m, &e[k]); [L::splat(u[0]), L::splat(u[1]), L::splat(u[2])] });
        let mut face = L::splat(f32::INFINITY);
        for k in 0..3 {
            let inside = three!(j => dot(&across[j], &sub(&self.v[k], &s[j])));
            let outside = inside[0].min(inside[1]).min(inside[2]).min(zero).mul(penalty);
            face = w[k].mul(inverse).mul_add(w[k], outside.add(unsound)).min(face);
        }
        // Points of edges are points of the triangles, so only their rounding, 16u·g, can make the result too small.
        // The result is too large where the nearest points of two edges are misplaced: along an edge e by at most
        // δ = (14u·r/e + 8u)/sin², which costs (e·δ·sin)² and never more than (e·sin)²: 4e-6·g·e and 1e-6·e² where the
        // two are the same. A height is wrong by the tilt of the normal either way, and by as much rounding;
        // a foot is on the wrong side of an edge by 1e-4 of the height, which is 1e-8 of its square. Where a face
        // was left out, the gap of the boxes is all that is known from below.
        let size = own.max(edge);
        let squared = faces.min(face).min(edges);
        let tilt =
            (TILT * longest * (SOUND * longest * longest + SOUND_AT_LEAST) / mm.max(SOUND_AT_LEAST)).sqrt();
        let error = self.tilt.max(L::splat(tilt)).add(L::splat(2e-6 * g));
        let parallel = L::splat(size * (4e-6 * g + 1e-5 * size));
        let below = squared.sub(parallel).max(zero).sqrt().sub(error).max(zero).square();
        let below = below.mul(L::splat(1.0 - 2e-6)).sub(self.unsound.add(unsound));
        let low = below.max(gap.mul(L::splat(1.0 - 1e-5)));
        low.store(&mut bounds.near);
        if motion.is_some() {
            (0..3).for_each(|d| join[d].store(&mut bounds.join[d]));
        }
        squared.sqrt().add(error).square().mul(L::splat(1.0 + 2e-6)).store(&mut bounds.far);
        Close { near: mask & low.le(L::splat(best)).bits(), crossing: mask & crossing }
    }

    /// The way between the nearest points of an edge (from `p` along `d`, of squared length `dd`) and edges `j` of the eight.
    #[inline(always)]
    fn edges(&self, p: &[L; 3], d: &[L; 3], dd: L, inverse: L, j: usize) -> [L; 3] {
        let (q, f, ff) = (&self.v[j], &self.f[j], self.ff[j]);
        let r = sub(p, q);
        let (c, b, y) = (dot(d, &r), dot(d, f), dot(f, &r));
        let product = dd.mul(ff);
        let determinant = product.sub(b.square()).max(product.mul(L::splat(1e-7))).max(L::splat(TINY));
        let s = unit(b.mul_sub(y, c.mul(ff)).div(determinant));
        let t = unit(b.mul_add(s, y).mul(self.inverse[j]));
        let s = unit(b.mul_sub(t, c).mul(inverse));
        three!(k => f[k].mul(t).sub(d[k].mul_add(s, r[k])))
    }
}

#[inline(always)]
fn unit<L: Lanes>(x: L) -> L {
    x.max(L::splat(0.0)).min(L::splat(1.0))
}

/// The least distance of three heights from zero when all have one sign; at most 0 otherwise.
#[inline(always)]
fn one_sided<L: Lanes>(h: &[L; 3]) -> L {
    let (lo, hi) = (h[0].min(h[1]).min(h[2]), h[0].max(h[1]).max(h[2]));
    lo.max(L::splat(0.0).sub(hi))
}

#[inline(always)]
fn cross_scalar(a: &[f32; 3], b: &[f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{NodeBox, build::leaf};
    use crate::triangle::closest_within;
    use mp_simd::{Isa, Kernel, run};
    use nalgebra::UnitQuaternion;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    struct Between<'t>(&'t Leaf, &'t Triangle);

    impl Kernel for Between<'_> {
        type Output = (DistanceBounds, Close);
        #[inline(always)]
        fn run<L: Lanes>(self) -> Self::Output {
            let mut bounds = DistanceBounds::default();
            let kernel = DistanceKernel::<L>::new(self.0, &SeparatingDirection::default());
            let close = kernel.between(self.1, self.0.all(), f32::INFINITY, None, &mut bounds);
            (bounds, close)
        }
    }

    /// Squared distances lie between the bounds, whatever the shapes, from almost touching to far away, parallel
    /// edges and faces among them; and where shapes are sound the bounds are tight.
    #[test]
    fn distances_lie_between_the_bounds() {
        let mut rng = Pcg64::seed_from_u64(8);
        let mut power = |low: f64, high: f64| mp_math::powf(10.0, rng.random_range(low..high));
        let mut other = Pcg64::seed_from_u64(9);
        let mut any = || Vector3::from_fn(|_, _| other.random_range(-1.0..1.0));
        let obb = NodeBox::new([[0.0; 4]; 3], [0.0; 3]);
        let (mut tight, mut far) = (0, 0);
        for round in 0..20_000 {
            let size = power(-6.0, 4.0);
            let sliver = if round % 3 == 0 { power(-6.0, 0.0) } else { 1.0 };
            let mut triangles: Vec<Triangle> = (0..8)
                .map(|_| {
                    let (p, e) = (Point3::from(any() * size), any() * size);
                    [p, p + e, p + e * (any().x + 1.0) + any() * (size * sliver)]
                })
                .collect();
            // One of them again, turned a little or not at all, and carried away.
            let turn = UnitQuaternion::from_scaled_axis(any() * power(-8.0, 1.0));
            let away = any() * (size * power(-5.0, 5.0));
            if round % 5 == 0 {
                triangles[3] = triangles[3].map(|p| p + any() * (size * 1e-3));
            }
            let single = triangles[3].map(|p| turn * p + away);
            let leaf = leaf(triangles.iter().copied(), 0, &Point3::origin(), &obb);
            for isa in Isa::available() {
                let (bounds, close) = run(isa, Between(&leaf, &single));
                assert_eq!(close.near, 0xff);
                for (lane, triangle) in triangles.iter().enumerate() {
                    let squared = closest_within(triangle, &single, f64::INFINITY).unwrap().squared;
                    let (near, beyond) = (f64::from(bounds.near[lane]), f64::from(bounds.far[lane]));
                    if squared == 0.0 {
                        assert!(close.crossing >> lane & 1 != 0, "{isa:?} {triangle:?} {single:?}");
                        continue;
                    }
                    assert!(near <= squared, "{isa:?}: {near} > {squared}: {triangle:?} {single:?}");
                    assert!(beyond >= squared, "{isa:?}: {beyond} < {squared}: {triangle:?} {single:?}");
                    if sliver == 1.0 && squared > size * size {
                        far += 1;
                        tight += usize::from(near > squared * 0.9999 && beyond < squared * 1.0001);
                    }
                }
            }
        }
        assert!(far > 100_000 && tight * 10 > far * 9, "{tight} of {far}");
    }
}
