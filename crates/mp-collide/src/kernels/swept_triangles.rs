//! Whether triangles of two leaves stay apart while those of one leaf move.

use nalgebra::{Point3, Vector3};

use crate::bvh::{LEAF, NodeBox, Tree};
use crate::counters::Counters;
use crate::kernels::swept_interval::{Drift, SweptInterval};
use crate::kernels::triangle_distance::{DistanceBounds, DistanceKernel, SeparatingDirection};
use crate::triangle::{Triangle, are_apart, closest_within, intersect};
use mp_simd::Lanes;

/// Whether triangles keep a distance over a part of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeafCheck {
    /// They keep it all along.
    Free,
    /// They were not shown to keep it.
    Unproven,
    /// They are nearer in the middle.
    TooClose,
    /// They meet in the middle.
    Collision,
}

/// Whether the triangles of `mask_a` keep the distance `keep` (metres) from those of `mask_b` over a part in which no point
/// moves farther than `most` (metres) from the middle.
///
/// Pairs whose distance does not decide are separated along a direction: only motion along that direction counts.
#[inline(always)]
pub(crate) fn triangles<L: Lanes>(
    ((a, x, mask_a), (b, y, mask_b)): ((&Tree, u32, u32), (&Tree, u32, u32)),
    interval: &SweptInterval,
    (most, keep): (f32, f64),
    counters: &mut Counters,
) -> LeafCheck {
    let (i, j) = ((x & !LEAF) as usize, (y & !LEAF) as usize);
    let (leaf_a, leaf_b, frames) = (&a.leaves[i], &b.leaves[j], &interval.frames);
    let swept = LeafMotion::new(a, &a.leaf_boxes[i], interval, most, keep);
    let kernel = DistanceKernel::<L>::new(leaf_a, &SeparatingDirection::default());
    let motion = kernel.moving(swept.drift, swept.origin, swept.beside);
    let mut singles = mask_b;
    while singles != 0 {
        let l = leaf_b.first as usize + singles.trailing_zeros() as usize;
        singles &= singles - 1;
        let single = frames.exact.triangle(&b.triangles[l]);
        counters.triangle_tests += 1;
        let mut bounds = DistanceBounds::default();
        let close = kernel.between(&single, mask_a, swept.maybe, Some(&motion), &mut bounds);
        let mut lanes = close.near | close.crossing;
        while lanes != 0 {
            let lane = lanes.trailing_zeros();
            lanes &= lanes - 1;
            let other = &a.triangles[leaf_a.first as usize + lane as usize];
            if close.crossing >> lane & 1 != 0 && intersect(other, &single) {
                return LeafCheck::Collision;
            }
            if close.near >> lane & 1 != 0 {
                let first = Vector3::from(bounds.join.map(|lanes| f64::from(lanes[lane as usize])));
                let gap = swept.gap(other, &single, first);
                if gap != LeafCheck::Free {
                    return gap;
                }
            }
        }
    }
    LeafCheck::Free
}

/// The motion of the triangles of a leaf of `a` over a part.
struct LeafMotion<'s> {
    drift: &'s Drift,
    /// The origin of the drift, in the frame of `a`.
    origin: &'s Point3<f64>,
    /// The distance to keep (metres).
    keep: f64,
    /// How far points may leave their drift, in any direction, plus the distance to keep (metres).
    beside: f64,
    /// Squared, rounded up: triangles farther apart than this keep the distance in whatever direction they move.
    maybe: f32,
}

impl<'s> LeafMotion<'s> {
    #[inline(always)]
    fn new(a: &'s Tree, own: &NodeBox, interval: &'s SweptInterval, most: f32, keep: f64) -> Self {
        let center = three!(d => f64::from(own.frame[d][0]));
        let far = interval.in_a.at_point(&center.into()).norm() + f64::from(interval.slop(own));
        // The rounding of the transform is added to the distance to keep.
        let rounded = keep + f64::from(interval.frames.slack);
        let squared = mp_math::powi(far.min(f64::from(most)) + rounded, 2);
        let maybe = ((squared * (1.0 + 1e-6)) as f32).next_up();
        let beside = f64::from(interval.rest) + rounded;
        Self { drift: &interval.in_a, origin: &a.center, keep, beside, maybe }
    }

    /// Whether two triangles that do not intersect in the middle keep the distance. All directions count, not only those that lanes try: these
    /// round as the processor does, and the answer must not depend on it. The search begins with `first`, a direction from `b` to `a`.
    fn gap(&self, a: &Triangle, b: &Triangle, first: Vector3<f64>) -> LeafCheck {
        let mut ends = [Vector3::zeros(); 6];
        for (k, corner) in a.iter().enumerate() {
            let (at, drift) = (corner - b[0], self.drift.at_point(&(corner - self.origin)));
            (ends[k], ends[k + 3]) = (at + drift, at - drift);
        }
        let still = [Vector3::zeros(), b[1] - b[0], b[2] - b[0]];
        if are_apart(&ends, &still, self.beside, first) {
            return LeafCheck::Free;
        }
        match closest_within(a, b, self.keep * self.keep) {
            None => LeafCheck::Unproven,
            Some(_) => LeafCheck::TooClose,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Leaf, NodeBox, build::leaf};
    use crate::triangle::closest;
    use mp_simd::{Isa, Kernel, run};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Triangles found free keep the distance when they are moved along their drift: slivers, triangles without area and
    /// far from the origin among them.
    #[test]
    fn what_is_kept_apart_stays_apart() {
        let mut state = 3u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        let (mut past, mut tight, mut short) = (0, 0, 0);
        for round in 0..20_000 {
            let mut vector = |size: f64| Vector3::new(next(), next(), next()) * size;
            let origin = Point3::from(vector(if round % 5 == 0 { 1e3 } else { 1.0 }));
            let mut corners = |flat: f64| {
                let (at, u) = (origin + vector(1.0), vector(1.0));
                [at, at + u, at + u * 0.5 + vector(flat)]
            };
            let (a, b) = (corners(1.0), corners([1.0, 1e-6, 0.0][round % 3]));
            let size = [1e-3, 0.1, 1.0][round / 3 % 3];
            let drift = Drift::new(&vector(size), &vector(size), &origin.coords);
            let keep = 0.1 * vector(1.0).x.abs();
            let drifts = a.map(|corner| drift.at_point(&(corner - origin)));
            let far = drifts.iter().map(|d| d.norm()).fold(0.0, f64::max);
            let squared = mp_math::powi(far + keep, 2);
            let swept =
                LeafMotion { drift: &drift, origin: &origin, keep, beside: keep, maybe: squared as f32 };
            if intersect(&a, &b) {
                continue;
            }
            let distance = closest(&a, &b).distance;
            let first = Vector3::from(drifts[round % 3]);
            match swept.gap(&a, &b, first) {
                LeafCheck::Free => {
                    past += u32::from(distance < far + keep);
                    for i in -8..=8 {
                        let at = |k: usize| a[k] + drifts[k] * (f64::from(i) / 8.0);
                        let moved = [at(0), at(1), at(2)];
                        let least = closest(&moved, &b).distance;
                        assert!(least >= keep - 1e-12, "{round}: {least} {keep} {moved:?} {b:?}");
                    }
                }
                LeafCheck::TooClose => {
                    assert!(distance < keep + 1e-12);
                    tight += 1;
                }
                LeafCheck::Unproven => {
                    assert!(distance < far + keep + 1e-12);
                    short += 1;
                }
                LeafCheck::Collision => panic!("these do not intersect"),
            }
        }
        assert!(past > 1000 && tight > 200 && short > 1000, "{past} {tight} {short}");
    }

    struct Between<'t>(&'t Leaf, &'t Triangle, &'t Drift, f64);

    impl Kernel for Between<'_> {
        type Output = [u32; 2];
        #[inline(always)]
        fn run<L: Lanes>(self) -> [u32; 2] {
            let Self(leaf, single, drift, beside) = self;
            let kernel = DistanceKernel::<L>::new(leaf, &SeparatingDirection::default());
            let motion = kernel.moving(drift, &Point3::origin(), beside);
            [None, Some(&motion)].map(|motion| {
                let bounds = &mut DistanceBounds::default();
                let close = kernel.between(single, leaf.all(), f32::INFINITY, motion, bounds);
                close.near | close.crossing
            })
        }
    }

    /// Of eight triangles those that lanes show to keep apart do so: slivers, triangles without area, tiny ones and large ones
    /// far from the origin among them.
    #[test]
    fn what_lanes_keep_apart_stays_apart() {
        let mut rng = Pcg64::seed_from_u64(4);
        let mut other = Pcg64::seed_from_u64(5);
        let mut power = |low: f64, high: f64| mp_math::powf(10.0, other.random_range(low..high));
        let obb = NodeBox::new([[0.0; 4]; 3], [0.0; 3]);
        let (mut dropped, mut tight) = (0, 0);
        for round in 0..6_000 {
            let size = power(-6.0, 4.0);
            let mut any = |size: f64| Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0) * size);
            let origin = Point3::from(any(size * [0.0, 1e3][usize::from(round % 5 == 0)]));
            let flat = [1.0, 1e-5, 0.0][round % 3];
            let mut triangle = |flat: f64| {
                let (at, u) = (origin + any(size), any(size));
                [at, at + u, at + u * 0.5 + any(size * flat)]
            };
            let triangles: Vec<Triangle> = (0..8).map(|_| triangle(flat)).collect();
            let single = triangle([1.0, 1e-5][round % 2]);
            let far = size * power(-3.0, 0.0);
            let drift = Drift::new(&any(far / size), &any(far), &any(size));
            let drifts = |t: &Triangle| t.map(|corner| drift.at_point(&corner.coords));
            let keep = size * power(-2.0, 0.0);
            // As an interval has it: with the rounding of what moves far from the origin.
            let most = triangles.iter().flat_map(drifts).map(|d| d.norm()).fold(0.0, f64::max);
            let rounding = 1e-5 * (most + far / size * 2.0 * origin.coords.norm());
            let leaf = leaf(triangles.iter().copied(), 0, &Point3::origin(), &obb);
            for isa in Isa::available() {
                let [all, kept] = run(isa, Between(&leaf, &single, &drift, keep + rounding));
                assert_eq!(kept & !all, 0);
                for (lane, a) in
                    triangles.iter().enumerate().filter(|(lane, _)| (all & !kept) >> lane & 1 != 0)
                {
                    let moved = |t: f64| {
                        let d = drifts(a);
                        closest(&[0, 1, 2].map(|k| a[k] + d[k] * t), &single).distance
                    };
                    let least = (-4..=4).map(|i| moved(f64::from(i) / 4.0)).fold(f64::INFINITY, f64::min);
                    assert!(
                        least >= keep,
                        "{isa:?} {round} {lane}: {least} {keep} {a:?} {single:?} {drift:?}"
                    );
                    dropped += 1;
                    tight += u32::from(least < 1.5 * (keep + rounding));
                }
            }
        }
        assert!(dropped > 10_000 && tight > 300, "{dropped} {tight}");
    }
}
