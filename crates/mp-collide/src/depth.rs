//! The penetration depth of two meshes, for messages and for finding a free pose nearby.

use nalgebra::{Isometry3, Vector3};

use crate::bvh::Tree;
use crate::mesh::CollisionMesh;
use crate::pose::Relative;
use crate::query::Query;

/// The first step of the search along a direction is this part of the way that surely separates.
const FIRST_STEP: f64 = 1.0 / 4096.0;
/// Every further step is longer by this factor.
const GROWTH: f64 = 1.5;
/// How often the interval between the last colliding and the first free step is halved.
const HALVINGS: usize = 12;

impl Query {
    /// An estimate of the penetration depth (metres): the length of [`Query::escape`]; 0 when the meshes
    /// are apart, infinity when nothing separates them (see there).
    ///
    /// It is an upper bound on the true depth (the shortest translation that separates), as a rule within
    /// some tens of percent; a few hundred intersection queries. Meant for messages, not for planning.
    pub fn depth(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> f64 {
        self.escape(a, pose_wa, b, pose_wb).map_or(f64::INFINITY, |way| way.norm())
    }

    /// A short translation of `a` in the world after which the meshes are apart: the shortest found by
    /// walking along 39 directions (both ways along the axes of the boxes at both roots and along the axes and
    /// diagonals of the world, and the join of the centres); zero when they are apart already.
    ///
    /// `None` when no translation separates them, as the input counts as in collision with everything (see
    /// the crate docs).
    pub fn escape(
        &mut self,
        a: &CollisionMesh,
        pose_wa: &Isometry3<f64>,
        b: &CollisionMesh,
        pose_wb: &Isometry3<f64>,
    ) -> Option<Vector3<f64>> {
        let relative = Relative::of((a, pose_wa), (b, pose_wb))?;
        if !self.meets(a, pose_wa, b, pose_wb) {
            return Some(Vector3::zeros());
        }
        let moved = |way: Vector3<f64>| {
            let mut pose = *pose_wa;
            pose.translation.vector += way;
            pose
        };
        let mut shortest: Option<(f64, Vector3<f64>)> = None;
        for direction in directions(a.tree(), pose_wa, b.tree(), pose_wb) {
            // After this step along the direction the boxes at the roots are apart.
            let overlap = reach(b.tree(), pose_wb, direction) + reach(a.tree(), pose_wa, -direction);
            let overlap = overlap + a.rounding() + b.rounding();
            let sure = 1.001 * overlap.max(0.0) + 10.0 * relative.slack + f64::EPSILON;
            let limit = shortest.map_or(sure, |(length, _)| length.min(sure));
            let (mut blocked, mut step) = (0.0, sure * FIRST_STEP);
            let free = loop {
                if step >= limit {
                    break None;
                }
                if !self.meets(a, &moved(direction * step), b, pose_wb) {
                    break Some(step);
                }
                blocked = step;
                step *= GROWTH;
            };
            // No step below the limit is free: the direction is no better than the best, or it is the first to succeed.
            let mut free = match free {
                Some(free) => free,
                None if shortest.is_none() && !self.meets(a, &moved(direction * sure), b, pose_wb) => sure,
                None => continue,
            };
            for _ in 0..HALVINGS {
                let middle = 0.5 * (blocked + free);
                if self.meets(a, &moved(direction * middle), b, pose_wb) {
                    blocked = middle;
                } else {
                    free = middle;
                }
            }
            shortest = Some((free, direction * free));
        }
        shortest.map(|(_, way)| way)
    }
}

/// How far the box at the root of a placed mesh reaches along `direction`, from the origin of the world.
fn reach(tree: &Tree, pose: &Isometry3<f64>, direction: Vector3<f64>) -> f64 {
    let obb = &tree.bounding;
    let direction_local = pose.rotation.inverse_transform_vector(&direction);
    let half: f64 =
        obb.axes.iter().zip(obb.half.iter()).map(|(axis, h)| (axis.dot(&direction_local) * h).abs()).sum();
    (pose * obb.center).coords.dot(&direction) + half
}

fn directions(
    a: &Tree,
    pose_wa: &Isometry3<f64>,
    b: &Tree,
    pose_wb: &Isometry3<f64>,
) -> impl Iterator<Item = Vector3<f64>> {
    let join = pose_wa * a.bounding.center - pose_wb * b.bounding.center;
    let axes = [(b, pose_wb), (a, pose_wa)].map(|(tree, pose)| tree.bounding.axes.map(|axis| pose * axis));
    let both_ways = axes.into_iter().flatten().flat_map(|axis| [axis, -axis]);
    let world = (0..27).map(|i| Vector3::new(i / 9, i / 3 % 3, i % 3).map(|c| f64::from(c) - 1.0));
    let world = world.filter_map(|way| way.try_normalize(0.0));
    join.try_normalize(0.0).into_iter().chain(both_ways).chain(world)
}
