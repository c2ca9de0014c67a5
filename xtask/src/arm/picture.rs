//! Pictures of arms.

use super::task::{State, Task};
use mp::cspace::{MotionBound, Space};
use mp::geom::TriMesh;
use mp::render::{Body, Scene, evenly};
use nalgebra::{Isometry3, Point3};

/// Between two copies of the arm no point moves farther than this share of its reach.
const SPACING: f64 = 0.12;

/// What is drawn of `task` with the path `states` in it; without one when that is empty.
pub(crate) fn scene(task: &Task, states: &[State], subtitle: String) -> Scene {
    let lengths: Vec<f64> = states.windows(2).map(|w| task.arm.motion_bound(&w[0], &w[1])).collect();
    let at = |edge: usize, t: f64| task.space.interpolate(&states[edge], &states[edge + 1], t);
    let copies = evenly(&lengths, SPACING * task.arm.reach()).into_iter();
    let tip = |q: &State| {
        let poses = task.arm.kinematics().link_poses(q.as_slice()).unwrap_or_default();
        // Of links the last is the farthest down the tree, in most files.
        poses.last().map_or(Point3::origin(), |pose| Point3::from(pose.translation.vector))
    };
    let fine = |edge: usize| (0..=16).map(move |k| (edge, f64::from(k) / 16.0));
    let trace = (0..lengths.len()).flat_map(fine).map(|(edge, t)| tip(&at(edge, t)));
    let goal = states.last().unwrap_or(&task.goals[0]);
    Scene {
        title: task.name().to_owned(),
        subtitle,
        planar: false,
        obstacles: task.problem.obstacles.iter().map(|o| Body::new(&o.mesh, o.pose)).collect(),
        start: Some(body(task, &task.start)),
        goal: Some(body(task, goal)),
        copies: copies.map(|(edge, t)| body(task, &at(edge, t))).collect(),
        trace: trace.collect(),
        bounds: None,
    }
}

/// The arm at `q`.
fn body(task: &Task, q: &State) -> Body {
    let meshes = task.arm.meshes_at(q.as_slice());
    let pose = Isometry3::identity();
    TriMesh::merged(meshes.iter().map(|(_, mesh)| mesh))
        .map_or(Body::point(pose), |mesh| Body::new(&mesh, pose))
}
