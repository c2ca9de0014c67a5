//! The gradient of the clearance of a rigid body.

use crate::{Placement, RigidBody};
use mp_cspace::obstacles::ClearanceGradient;
use nalgebra::{Isometry3, Point3, Vector3};

/// From the nearest points of robot and obstacles.
///
/// Where the robot is free: the exact distance (m) and its derivative. In collision the value is rough, because meshes
/// have no depth. It comes from the first pair of triangles found to intersect: how far the robot's triangle reaches
/// through the plane of the obstacle's triangle, and the direction along the normal of that plane, outward if it bounds a
/// solid, else to the side on which the robot's middle is. Where one is inside of the other, which is solid, they are those of the nearest points of the surfaces: for a
/// point, exact.
///
/// Costs one distance query if something is within `reach`, else one bound; in collision one more intersection query.
impl<P: Placement> ClearanceGradient<P::State> for RigidBody<P> {
    fn clearance_gradient(&mut self, q: &P::State, reach: f64, gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        self.count_clearance();
        let pose = P::pose(q);
        let shared = std::sync::Arc::clone(&self.shared);
        let inside = self.point_inside(&pose);
        // For a point deep inside, the surface may be farther away than the reach.
        let kept = self.kept();
        let enough = if inside { f64::INFINITY } else { reach + kept };
        let (clearance, nearest) =
            shared.obstacles.scene.clearance(&mut self.query, &shared.robot, &pose, enough);
        let Some(body) = nearest.and_then(|id| shared.obstacles.scene.body(id)) else {
            return clearance - kept;
        };
        let (robot, other) = (&shared.robot, (body.mesh(), body.pose()));
        let nested = clearance <= 0.0 && self.query.nested(robot, &pose, other.0, other.1);
        let apart = (clearance > 0.0 || nested).then(|| self.query.distance(robot, &pose, other.0, other.1));
        let (value, at, direction) = match apart.filter(|apart| apart.distance > 0.0) {
            Some(apart) => {
                let sign = if inside || nested { -1.0 } else { 1.0 };
                (sign * apart.distance, apart.point_a, (apart.point_a - apart.point_b) * sign)
            }
            None => match self.first_contact(&pose) {
                Some(found) => found,
                None => return 0.0 - kept,
            },
        };
        if let Some(direction) = direction.try_normalize(0.0) {
            write_gradient::<P>(&pose, &at, &direction, gradient);
        }
        value - kept
    }
}

impl<P: Placement> RigidBody<P> {
    /// The first contact found: minus its depth (m), the deepest point, and the unit direction out of the obstacle.
    fn first_contact(&mut self, pose: &Isometry3<f64>) -> Option<(f64, Point3<f64>, Vector3<f64>)> {
        let shared = &*self.shared;
        let ([a, b, c], touching, solid) = shared.obstacles.placed.iter().find_map(|(id, mesh)| {
            let body = shared.obstacles.scene.body(*id)?;
            let (own, other) =
                self.query.intersecting_triangles(&shared.robot, pose, body.mesh(), body.pose())?;
            let solid = mesh.solids().iter().any(|solid| solid.contains(&(other as u32)));
            Some((mesh.triangle(other), shared.robot_mesh.triangle(own).map(|p| pose * p), solid))
        })?;
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
        let normal = match P::MOVES.contains(&2) {
            true => normal,
            false => Vector3::new(normal.x, normal.y, 0.0).try_normalize(1e-9)?,
        };
        let corners = &shared.radii.corners;
        let middle = pose * Point3::from(corners.iter().map(|p| p.coords).sum::<Vector3<f64>>() / 8.0);
        let normal = if !solid && (middle - a).dot(&normal) < 0.0 { -normal } else { normal };
        let height = |p: &Point3<f64>| (p - a).dot(&normal);
        let deepest = touching.into_iter().min_by(|p, q| height(p).total_cmp(&height(q)))?;
        Some((height(&deepest).min(0.0), deepest, normal))
    }
}

/// Writes the derivative, by the configuration, of how far the point `at` of the body has moved along the unit vector
/// `direction` (both in the world).
fn write_gradient<P: Placement>(
    pose: &Isometry3<f64>,
    at: &Point3<f64>,
    direction: &Vector3<f64>,
    gradient: &mut [f64],
) {
    let turning = (at.coords - pose.translation.vector).cross(direction);
    let moves = P::MOVES.iter().map(|&axis| direction[axis]);
    let numbers = moves.chain(P::TURNS.iter().map(|&axis| turning[axis]));
    gradient.iter_mut().zip(numbers).for_each(|(slot, number)| *slot = number);
}
