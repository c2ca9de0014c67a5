//! Distance, clearance and tolerance queries: nearest boxes first.

use nalgebra::{Isometry3, Point3};

use crate::bvh::Tree;
use crate::bvh::frames::Frames;
use crate::mesh::{CollisionMesh, PosedMesh};
use crate::pose::{Relative, to_world};
use crate::query::Query;
use crate::query::branch_and_bound::BranchAndBound;
use crate::query::clouds;
use crate::query::descend::Descend;
use crate::query::within::Within;
use crate::separation::Separation;
use crate::triangle::{Closest, closest_within, crossing};
use mp_simd::run;

impl Query {
    /// The distance of the meshes with nearest points, in the world.
    ///
    /// For input that counts as in collision with everything (see the crate docs) the points are the
    /// origin.
    pub fn distance(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Separation {
        self.counters.queries += 1;
        if a.cloud.is_some() || b.cloud.is_some() {
            return clouds::distance(self, (a, pose_wa), (b, pose_wb));
        }
        let Some(relative) = Relative::of((a, pose_wa), (b, pose_wb)) else {
            return Separation { distance: 0.0, point_a: Point3::origin(), point_b: Point3::origin() };
        };
        if let Some((i, j)) = self.colliding_pair(a.tree(), b.tree(), &relative) {
            let triangle_b = relative.triangle(&b.tree().triangles[j]);
            let point = to_world(pose_wa, &crossing(&a.tree().triangles[i], &triangle_b));
            return Separation { distance: 0.0, point_a: point, point_b: point };
        }
        let nearest = self.nearest(a.tree(), b.tree(), &relative, f64::INFINITY);
        let closest = nearest.map_or(Closest::NONE, |(closest, ..)| closest);
        Separation {
            distance: positive(closest.squared.sqrt()),
            point_a: to_world(pose_wa, &closest.on_a),
            point_b: to_world(pose_wa, &closest.on_b),
        }
    }

    /// A lower bound on the distance of the meshes that is exact when below `enough` (metres) and some
    /// value of at least `enough` otherwise; 0 exactly when they intersect.
    ///
    /// The smaller `enough`, the sooner the search ends. A value beyond `enough` is the best
    /// bound known without further search. NaN counts as infinity.
    pub fn clearance(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
        enough: f64,
    ) -> f64 {
        self.clearance_of((a, pose_wa), (b, pose_wb), enough).0
    }

    /// Whether the distance of the meshes is at most `tolerance` (metres), to rounding.
    ///
    /// A negative tolerance counts as 0, and then this is [`Query::intersects`]; NaN as infinity, for
    /// which the answer is `true`.
    pub fn within(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
        tolerance: f64,
    ) -> bool {
        self.counters.queries += 1;
        if a.cloud.is_some() || b.cloud.is_some() {
            return clouds::within(self, (a, pose_wa), (b, pose_wb), tolerance);
        }
        let Some(relative) = Relative::of((a, pose_wa), (b, pose_wb)) else { return true };
        let tolerance = if tolerance.is_nan() { f64::INFINITY } else { tolerance.max(0.0) };
        if tolerance == f64::INFINITY {
            return true;
        }
        let (a, b) = (a.tree(), b.tree());
        if tolerance == 0.0 {
            return self.colliding_pair(a, b, &relative).is_some();
        }
        let frames = Frames::new(a, b, &relative);
        if frames.apart > (a.radius_center + b.radius_center + tolerance) * (1.0 + 1e-12) + relative.slack {
            return false;
        }
        if !frames.fits_f32(a, b) || !(1e-9..=1e9).contains(&tolerance) {
            return self.colliding_pair(a, b, &relative).is_some()
                || self.nearest(a, b, &relative, tolerance.next_up()).is_some();
        }
        let leaves = Within::new(tolerance, &frames, &mut self.counters);
        let (margin, stack) = (leaves.margin, &mut self.stack);
        run(self.isa, Descend { a, b, frames: &frames, margin, stack, leaves }).is_some()
    }

    /// [`Query::clearance`], and the number of the nearest triangle or ball of `b`, if any were compared.
    pub(crate) fn clearance_of(
        &mut self,
        a: PosedMesh<'_>,
        b: PosedMesh<'_>,
        enough: f64,
    ) -> (f64, Option<usize>) {
        self.counters.queries += 1;
        if a.0.cloud.is_some() || b.0.cloud.is_some() {
            return clouds::clearance(self, a, b, enough);
        }
        let Some(relative) = Relative::of(a, b) else { return (0.0, Some(0)) };
        let (clearance, position) = self.clearance_with(a.0.tree(), b.0.tree(), &relative, enough);
        (clearance, position.map(|position| b.0.tree().ids[position] as usize))
    }

    /// [`Query::clearance`], and the position in the tree of the nearest triangle of `b`, if triangles were
    /// compared.
    pub(crate) fn clearance_with(
        &mut self,
        a: &Tree,
        b: &Tree,
        relative: &Relative,
        enough: f64,
    ) -> (f64, Option<usize>) {
        let enough = if enough.is_nan() { f64::INFINITY } else { enough };
        let bound = self.bound(a, b, relative);
        if bound > 0.0 && bound >= enough {
            return (bound, None);
        }
        if let Some((_, j)) = self.colliding_pair(a, b, relative) {
            return (0.0, Some(j));
        }
        let nearest = self.nearest(a, b, relative, enough);
        match nearest {
            Some((closest, _, j)) => (positive(closest.squared.sqrt()), Some(j)),
            None => (positive(bound.max(enough)), None),
        }
    }

    /// A lower bound on the distance from the boxes at the roots.
    fn bound(&mut self, a: &Tree, b: &Tree, relative: &Relative) -> f64 {
        self.counters.box_tests += 1;
        a.bounding.distance_bound(&relative.obb(&b.bounding), relative.slack)
    }

    /// The nearest points of meshes that do not intersect (in the frame of `a`) and their triangles
    /// (positions in the trees), when nearer than `enough`.
    fn nearest(
        &mut self,
        a: &Tree,
        b: &Tree,
        relative: &Relative,
        enough: f64,
    ) -> Option<(Closest, usize, usize)> {
        let frames = Frames::new(a, b, relative);
        let enough = enough.max(0.0);
        if !frames.fits_f32(a, b) {
            return nearest_of_all(a, b, &frames, enough);
        }
        let (scratch, counters) = (&mut self.scratch, &mut self.counters);
        run(self.isa, BranchAndBound { a, b, frames: &frames, enough, scratch, counters })
    }
}

/// The nearest of all pairs of triangles, for sizes that do not fit the lanes.
fn nearest_of_all(a: &Tree, b: &Tree, frames: &Frames, enough: f64) -> Option<(Closest, usize, usize)> {
    let mut squared = enough * enough;
    let mut witness = None;
    for (j, triangle) in b.triangles.iter().enumerate() {
        let single = frames.exact.triangle(triangle);
        for (i, other) in a.triangles.iter().enumerate() {
            if let Some(closest) = closest_within(other, &single, squared) {
                squared = closest.squared;
                witness = Some((closest, i, j));
            }
        }
    }
    witness
}

/// Meshes that do not intersect are never at distance 0, whatever rounding says.
fn positive(distance: f64) -> f64 {
    distance.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Isa;
    use mp_geom::primitives;

    #[test]
    fn nearest_points_do_not_depend_on_the_instruction_set() {
        // Many pairs of triangles share the nearest corner, edge or face.
        let meshes = [
            primitives::cuboid(1.0, 2.0, 0.5),
            primitives::cylinder(0.5, 2.0, 24),
            primitives::torus(1.0, 0.3, 24, 12),
        ]
        .map(|mesh| CollisionMesh::new(&mesh.unwrap()));
        let mut queries: Vec<Query> = Isa::available().into_iter().map(Query::with_isa).collect();
        for (i, a) in meshes.iter().enumerate() {
            for b in &meshes[i..] {
                for k in 0..60 {
                    let turn = if k % 3 == 0 { 0.0 } else { 0.1 * f64::from(k) };
                    let at = nalgebra::Vector3::new(1.7, 0.03 * f64::from(k), -0.9);
                    let pose = Isometry3::new(at, nalgebra::Vector3::new(turn, 0.3 * turn, -turn));
                    let here = Isometry3::identity();
                    let all: Vec<(Separation, [bool; 2], f64)> = queries
                        .iter_mut()
                        .map(|q| {
                            let found = q.distance(a, &here, b, &pose);
                            let d = found.distance;
                            let near = [d, 0.999 * d].map(|t| q.within(a, &here, b, &pose, t));
                            (found, near, q.clearance(a, &here, b, &pose, 2.0 * d))
                        })
                        .collect();
                    let (found, near, clearance) = all[0];
                    assert!(near[0] && near[1] == (found.distance == 0.0), "{near:?} {}", found.distance);
                    assert_eq!(clearance, found.distance);
                    assert!(all.iter().all(|other| *other == all[0]), "{all:?}");
                }
            }
        }
    }
}
