//! Queries between two meshes: intersection, distance, tolerance, batches of poses, intervals of motions.

#![allow(clippy::needless_range_loop)] // Coordinates and axes are indices here, several arrays at a time.

mod batch;
mod branch_and_bound;
mod clouds;
pub(crate) mod descend;
mod distance;
mod intersect;
pub(crate) mod interval;
pub(crate) mod schedule;
mod sweep;
mod winding;
mod within;

use nalgebra::Isometry3;

use crate::bvh::Tree;
use crate::bvh::frames::Frames;
use crate::counters::Counters;
use crate::kernels::triangle_pair::TriangleFilter;
use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use crate::query::branch_and_bound::Scratch;
use crate::query::descend::Descend;
use crate::query::intersect::Intersect;
use crate::query::schedule::MotionParts;
use crate::query::sweep::SweptPair;
use crate::triangle::intersect;
use mp_simd::{Isa, run};

/// Runs queries: scratch memory and counters of one thread. Make one per thread and keep it.
///
/// All queries are between mesh `a` at `pose_wa` and mesh `b` at `pose_wb` (poses in the world); answers
/// depend on nothing else, and nothing is allocated once the scratch has grown. The contract, with what
/// happens to bad input, is in the [crate documentation](crate).
#[derive(Clone, Debug)]
pub struct Query {
    /// The work done so far; set to `Counters::default()` to start over.
    pub counters: Counters,
    pub(crate) stack: Vec<(u32, u32)>,
    pub(crate) filter: TriangleFilter,
    pub(crate) scratch: Scratch,
    pub(crate) swept_pairs: Vec<SweptPair>,
    pub(crate) parts: MotionParts,
    pub(crate) isa: Isa,
}

impl Default for Query {
    fn default() -> Self {
        Self::with_isa(Isa::detect())
    }
}

impl Query {
    /// A query on a given instruction set ([`Isa::Scalar`] where this CPU lacks it). Answers are the
    /// same on all; for tests and benchmarks.
    #[must_use]
    pub fn with_isa(isa: Isa) -> Self {
        Self {
            counters: Counters::default(),
            stack: Vec::new(),
            filter: TriangleFilter::NONE,
            scratch: Scratch::default(),
            swept_pairs: Vec::new(),
            parts: MotionParts::default(),
            isa,
        }
    }

    /// Whether the meshes have a point in common. Touching counts.
    pub fn intersects(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> bool {
        self.counters.queries += 1;
        if a.cloud.is_some() || b.cloud.is_some() {
            return clouds::within(self, (a, pose_wa), (b, pose_wb), 0.0);
        }
        match Relative::of((a, pose_wa), (b, pose_wb)) {
            Some(relative) => self.collide(a.tree(), b.tree(), relative, true).is_some(),
            None => true,
        }
    }

    /// The indices of two triangles, of `a` and of `b`, that intersect: the first pair found, always the
    /// same one. `None` when the meshes are apart; triangles (0, 0) for a pose that is not finite.
    pub fn intersecting_triangles(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Option<(usize, usize)> {
        self.counters.queries += 1;
        if a.cloud.is_some() || b.cloud.is_some() {
            return clouds::intersecting(self, (a, pose_wa), (b, pose_wb));
        }
        match Relative::of((a, pose_wa), (b, pose_wb)) {
            Some(relative) => self
                .colliding_pair(a.tree(), b.tree(), &relative)
                .map(|(i, j)| (a.tree().ids[i] as usize, b.tree().ids[j] as usize)),
            None => Some((0, 0)),
        }
    }

    /// Two intersecting triangles, as positions in the trees: always the same.
    pub(crate) fn colliding_pair(
        &mut self,
        a: &Tree,
        b: &Tree,
        relative: &Relative,
    ) -> Option<(usize, usize)> {
        self.collide(a, b, *relative, false)
    }

    /// Two intersecting triangles, as positions in the trees; any, or always the same.
    #[inline(always)]
    fn collide(&mut self, a: &Tree, b: &Tree, relative: Relative, any: bool) -> Option<(usize, usize)> {
        let frames = Frames::new(a, b, &relative);
        if frames.apart > (a.radius_center + b.radius_center) * (1.0 + 1e-12) + relative.slack {
            return None;
        }
        if !frames.fits_f32(a, b) {
            return any_of_all(a, b, &frames);
        }
        let leaves = Intersect { any, filter: &mut self.filter, counters: &mut self.counters };
        let (margin, stack) = (frames.pad, &mut self.stack);
        run(self.isa, Descend { a, b, frames: &frames, margin, stack, leaves })
    }
}

/// The first two triangles that meet, of all pairs: for sizes that do not fit the lanes.
fn any_of_all(a: &Tree, b: &Tree, frames: &Frames) -> Option<(usize, usize)> {
    b.triangles.iter().enumerate().find_map(|(l, triangle)| {
        let single = frames.exact.triangle(triangle);
        a.triangles.iter().position(|other| intersect(other, &single)).map(|k| (k, l))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_geom::primitives;
    use nalgebra::{UnitQuaternion, Vector3};

    fn poses(count: usize, reach: f64) -> impl Iterator<Item = Isometry3<f64>> {
        let mut state = 7u64;
        let mut next = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        (0..count).map(move |_| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::new(next(), next(), next()) * 3.0);
            Isometry3::from_parts(Vector3::new(next() * reach, next() * reach, next() * reach).into(), turn)
        })
    }

    #[test]
    fn every_instruction_set_gives_the_same_answers() {
        let a = CollisionMesh::new(&primitives::torus(1.0, 0.3, 40, 20).unwrap());
        let b = CollisionMesh::new(&primitives::sphere(0.4, 2).unwrap());
        let here = Isometry3::identity();
        let mut scalar = Query::with_isa(Isa::Scalar);
        for isa in Isa::available() {
            let mut query = Query::with_isa(isa);
            for pose in poses(400, 1.5) {
                let hit = scalar.intersects(&a, &here, &b, &pose);
                assert_eq!(query.intersects(&a, &here, &b, &pose), hit, "{isa:?} {pose}");
                let (got, expected) =
                    (query.distance(&a, &here, &b, &pose), scalar.distance(&a, &here, &b, &pose));
                assert_eq!(got.distance.to_bits(), expected.distance.to_bits(), "{isa:?} {pose}");
                assert_eq!(expected.distance == 0.0, hit);
            }
        }
    }

    #[test]
    fn sizes_that_do_not_fit_the_lanes_are_decided_all_the_same() {
        for scale in [1e-30, 1e-12, 1e12, 1e30] {
            let ball = |r: f64| CollisionMesh::new(&primitives::sphere(r * scale, 1).unwrap());
            let (a, b) = (ball(1.0), ball(0.5));
            let at = |x: f64| Isometry3::translation(x * scale, 0.0, 0.0);
            let mut query = Query::default();
            assert!(query.intersects(&a, &at(0.0), &b, &at(1.2)));
            assert!(!query.intersects(&a, &at(0.0), &b, &at(1.7)));
            let distance = query.distance(&a, &at(0.0), &b, &at(2.5)).distance;
            assert!((distance / scale - 1.0).abs() < 0.1, "{distance}");
        }
    }
}
