//! The distance of a mesh from a solid of revolution: a cylinder or a cone.

use nalgebra::{Point3, Vector3};

use crate::bvh::frames::{FrameTransform, Frames};
use crate::bvh::{LEAF, Tree, WIDTH};
use crate::counters::Counters;
use crate::kernels::separating_axes::distances;
use crate::pose::Relative;
use crate::simd::{Kernel, Lanes, Mask};
use crate::triangle::Triangle;

/// A solid about Z between two discs: of radius `low` at z = −`half` and `high` at z = `half` (metres), not both 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) half: f64,
}

/// A point of a point, segment or triangle, and the nearest point of a solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestPoints {
    /// Metres; 0 when they meet.
    pub(crate) distance: f64,
    pub(crate) other: Point3<f64>,
    pub(crate) solid: Point3<f64>,
}

/// Halvings of an edge in search of its nearest point, which is then exact to rounding.
const HALVINGS: usize = 54;

impl Frustum {
    /// The point of the solid that is nearest to `p`; `p` itself, if it is inside.
    fn nearest(&self, p: &Point3<f64>) -> Point3<f64> {
        let rho = (p.x * p.x + p.y * p.y).sqrt();
        let (r, z) = self.nearest_in_profile(rho, p.z);
        let [x, y] = if rho > 0.0 { [p.x / rho, p.y / rho] } else { [1.0, 0.0] };
        if r == rho { Point3::new(p.x, p.y, z) } else { Point3::new(x * r, y * r, z) }
    }

    /// [`Frustum::nearest`] in the half-plane of distances from the axis and heights, where the solid is a trapezium.
    fn nearest_in_profile(&self, rho: f64, z: f64) -> (f64, f64) {
        let &Self { low, high, half } = self;
        let (across, up) = (high - low, 2.0 * half);
        let (out, above) = (rho - low, z + half);
        if z.abs() <= half && out * up <= above * across {
            return (rho, z);
        }
        let along = ((out * across + above * up) / (across * across + up * up)).clamp(0.0, 1.0);
        let side = (low + along * across, along * up - half);
        let mut best = (f64::INFINITY, side);
        for at in [side, (rho.min(low), -half), (rho.min(high), half)] {
            let square = mp_math::powi(rho - at.0, 2) + mp_math::powi(z - at.1, 2);
            if square < best.0 {
                best = (square, at);
            }
        }
        best.1
    }

    /// The point that is farthest along `n`; of several, one in their middle.
    fn farthest(&self, n: &Vector3<f64>) -> Point3<f64> {
        let level = (n.x * n.x + n.y * n.y).sqrt();
        let top = self.high * level + self.half * n.z > self.low * level - self.half * n.z;
        let (r, z) = if top { (self.high, self.half) } else { (self.low, -self.half) };
        if level > 0.0 { Point3::new(r * n.x / level, r * n.y / level, z) } else { Point3::new(0.0, 0.0, z) }
    }

    fn near_point(&self, p: &Point3<f64>) -> NearestPoints {
        let solid = self.nearest(p);
        let distance = (p - solid).norm();
        // NaN counts as collision.
        NearestPoints { distance: if distance.is_nan() { 0.0 } else { distance }, other: *p, solid }
    }

    /// By bisection: as the solid is convex, the distance grows along a line to both sides of its minimum.
    fn near_segment(&self, p: &Point3<f64>, q: &Point3<f64>) -> NearestPoints {
        let along = q - p;
        let at = |t: f64| p + along * t;
        let slope = |x: &Point3<f64>| (x - self.nearest(x)).dot(&along);
        let (mut lo, mut hi) = (0.0, 1.0);
        if slope(p) >= 0.0 {
            return self.near_point(p);
        }
        if slope(q) <= 0.0 {
            return self.near_point(q);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (lo + hi);
            let slope = slope(&at(middle));
            if slope == 0.0 {
                return self.near_point(&at(middle));
            }
            if slope < 0.0 {
                lo = middle;
            } else {
                hi = middle;
            }
        }
        self.near_point(&at(hi))
    }

    /// The nearest points of a triangle and the solid: on an edge, or within the face, below the point of the solid
    /// that is nearest to its plane.
    pub(crate) fn near_triangle(&self, t: &Triangle) -> NearestPoints {
        let mut best = self.near_segment(&t[0], &t[1]);
        for k in 1..3 {
            let other = self.near_segment(&t[k], &t[(k + 1) % 3]);
            if other.distance < best.distance {
                best = other;
            }
        }
        let normal = (t[1] - t[0]).cross(&(t[2] - t[0]));
        let n = normal / normal.norm();
        if best.distance == 0.0 || !n.iter().all(|x| x.is_finite()) {
            return best;
        }
        let ends = [self.farthest(&-n), self.farthest(&n)];
        let heights = ends.map(|end| (end - t[0]).dot(&n));
        let foot = if heights[0] > 0.0 {
            NearestPoints { distance: heights[0], other: ends[0] - n * heights[0], solid: ends[0] }
        } else if heights[1] < 0.0 {
            NearestPoints { distance: -heights[1], other: ends[1] - n * heights[1], solid: ends[1] }
        } else {
            // The plane cuts the solid, and no edge meets it: either all of the cut is within the triangle, or none.
            let share = -heights[0] / (heights[1] - heights[0]);
            let cut = ends[0] + (ends[1] - ends[0]) * if share.is_finite() { share } else { 0.5 };
            NearestPoints { distance: 0.0, other: cut, solid: cut }
        };
        let within = (0..3).all(|k| {
            let (p, q) = (t[k], t[(k + 1) % 3]);
            (q - p).cross(&(foot.other - p)).dot(&n) >= 0.0
        });
        if within && foot.distance < best.distance { foot } else { best }
    }

    /// [`Frustum::near_triangle`] for a triangle of `a`, in the frame of `a`.
    pub(crate) fn near_triangle_of_a(&self, t: &Triangle, pose_ab: &Relative) -> NearestPoints {
        let Relative { rotation, translation, .. } = pose_ab;
        let local = t.map(|p| Point3::from(rotation.tr_mul(&(p.coords - translation))));
        let apart = self.near_triangle(&local);
        NearestPoints { other: pose_ab.point(&apart.other), solid: pose_ab.point(&apart.solid), ..apart }
    }
}

/// Branch and bound over the nodes of a mesh, the nearest first, by their distances from the box around the solid.
pub(crate) struct Revolved<'q> {
    pub(crate) a: &'q Tree,
    /// The box around the solid.
    pub(crate) b: &'q Tree,
    pub(crate) solid: &'q Frustum,
    pub(crate) frames: &'q Frames,
    /// Only points no farther apart than this (metres) are of interest.
    pub(crate) enough: f64,
    /// Whether any of these will do, not only the nearest.
    pub(crate) any: bool,
    pub(crate) stack: &'q mut Vec<(u32, u32)>,
    pub(crate) counters: &'q mut Counters,
}

impl Kernel for Revolved<'_> {
    /// In the frame of `a`.
    type Output = Option<NearestPoints>;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Self::Output {
        let Self { a, b, solid, frames, enough, any, stack, counters } = self;
        let place = FrameTransform::<L>::new(&frames.into_a).place(b.own(b.root));
        let mut best: Option<NearestPoints> = None;
        // The square, rounded up.
        let up = |x: f64| ((x * x * (1.0 + 1e-6)) as f32).next_up();
        let mut limit = up(enough);
        stack.clear();
        stack.push((a.root, 0.0_f32.to_bits()));
        while let Some((x, bound)) = stack.pop() {
            if f32::from_bits(bound) > limit {
                continue;
            }
            counters.box_tests += 1;
            if x & LEAF != 0 {
                let leaf = &a.leaves[(x & !LEAF) as usize];
                let first = leaf.first as usize;
                for triangle in &a.triangles[first..first + leaf.count as usize] {
                    counters.triangle_tests += 1;
                    let apart = solid.near_triangle_of_a(triangle, &frames.exact);
                    if apart.distance <= enough && best.is_none_or(|b| apart.distance < b.distance) {
                        limit = up(apart.distance);
                        best = Some(apart);
                        if any || apart.distance == 0.0 {
                            return best;
                        }
                    }
                }
                continue;
            }
            let node = &a.nodes[x as usize];
            let bounds = distances::<L>(node, &place, frames.pad);
            let mut mask = (bounds.le(L::splat(limit)) & L::splat(0.0).le(L::load(&node.half[0]))).bits();
            let mut bound = [0.0_f32; WIDTH];
            bounds.store(&mut bound);
            let from = stack.len();
            while mask != 0 {
                let lane = mask.trailing_zeros() as usize & 7;
                mask &= mask - 1;
                stack.push((node.child[lane], bound[lane].to_bits()));
            }
            // The bits of non-negative numbers are in the order of the numbers.
            stack[from..].sort_unstable_by_key(|&(x, bound)| std::cmp::Reverse((bound, x)));
        }
        best
    }
}
