//! The gradient of the clearance of an arm.

use super::Arm;
use super::check::Nearest;
use super::robot::SharedArm;
use mp_cspace::{Coordinates, obstacles::ClearanceGradient};
use nalgebra::{Isometry3, Point3, Vector3};

/// From the two points that are nearest to each other: how fast each joint, and a base that floats, takes them apart.
///
/// Where the robot is free: the distance (m), beyond what is [kept](Arm::keeping) from obstacles, and its derivative. Zero in collision,
/// because the depth of an arm is not known. Costs one clearance query, and one distance query of two bodies if something is within `reach`.
impl<Q: Coordinates> ClearanceGradient<Q> for Arm {
    fn clearance_gradient(&mut self, q: &Q, reach: f64, gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        let (here, nearest) = self.least_clearance(q, reach, true);
        if here <= 0.0 || here >= reach {
            return here;
        }
        let Self { robot, obstacles, query, scratch, .. } = self;
        let frames = &scratch.frames;
        let placed = |i: usize| (&robot.bodies[i].tree, &frames[robot.bodies[i].frame]);
        let moves = |i: usize, steps: usize| Moves { robot, frames, body: i, steps };
        match nearest {
            Some(Nearest::Obstacle(i, id)) => {
                let Some(other) = obstacles.scene.body(id) else { return here };
                let (tree, pose) = placed(i);
                let found = query.distance(tree, pose, other.mesh(), other.pose());
                let Some(away) = (found.point_a - found.point_b).try_normalize(0.0) else { return here };
                moves(i, robot.bodies[i].chain.steps.len()).add(&found.point_a, &away, gradient);
                if robot.kinematics.floats() {
                    let turning = (found.point_a.coords - frames[0].translation.vector).cross(&away);
                    gradient.iter_mut().zip(away.iter().chain(&turning)).for_each(|(slot, v)| *slot = *v);
                }
            }
            Some(Nearest::Pair(p)) => {
                let pair = &robot.pairs[p];
                let [(tree_a, pose_a), (tree_b, pose_b)] = pair.bodies.map(placed);
                let found = query.distance(tree_a, pose_a, tree_b, pose_b);
                let Some(away) = (found.point_a - found.point_b).try_normalize(0.0) else { return here };
                // Joints below both, and the base, move the two alike.
                moves(pair.bodies[0], pair.steps[0]).add(&found.point_a, &away, gradient);
                moves(pair.bodies[1], pair.steps[1]).add(&found.point_b, &-away, gradient);
            }
            // What is nearest never moves.
            None => {}
        }
        here
    }
}

/// How the first `steps` joints of its chain move a body.
struct Moves<'a> {
    robot: &'a SharedArm,
    frames: &'a [Isometry3<f64>],
    body: usize,
    steps: usize,
}

impl Moves<'_> {
    /// Adds how fast (m for a unit of each coordinate) `point` of the body moves along `direction`, both in the world.
    fn add(&self, point: &Point3<f64>, direction: &Vector3<f64>, gradient: &mut [f64]) {
        let kinematics = &self.robot.kinematics;
        let joints = &mut gradient[if kinematics.floats() { 6 } else { 0 }..];
        for step in &self.robot.bodies[self.body].chain.steps[..self.steps] {
            let (joint, frame) = (&kinematics.frames[step.frame - 1], &self.frames[step.frame]);
            let axis = frame.rotation * joint.axis.into_inner();
            let velocity = match joint.slides {
                true => axis,
                false => axis.cross(&(point.coords - frame.translation.vector)),
            };
            joints[joint.coordinate] += joint.scale * velocity.dot(direction);
        }
    }
}
