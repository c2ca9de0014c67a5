//! Points of clouds that are on the robot itself, which a camera sees too.

use crate::Error;
use mp_collide::{CollisionMesh, Query};
use mp_geom::TriMesh;
use mp_io::{RobotFilePart, RobotProblem};
use mp_robot::Arm;
use nalgebra::Isometry3;

/// How the sentences end.
pub(super) const LEFT_OUT: &str = "are on the robot at the start, and left out";

/// Leaves out the points that are as near to the arm at `start` as their obstacles say. Returns how many, in sentences.
///
/// # Errors
/// When nothing of a cloud is left.
pub(super) fn filter(arm: &Arm, problem: &mut RobotProblem, start: &[f64]) -> Result<Vec<String>, Error> {
    let wanted = problem.file.obstacles.iter().any(|obstacle| obstacle.self_filter.is_some());
    let links = if wanted { arm.meshes_at(start) } else { Vec::new() };
    let links: Vec<_> = links.iter().map(|(_, mesh)| CollisionMesh::new(mesh)).collect();
    let (mut query, mut said) = (Query::default(), Vec::new());
    for (i, (entry, body)) in problem.file.obstacles.iter().zip(&mut problem.obstacles).enumerate() {
        let Some((near, radius)) = entry.self_filter.as_ref().zip(body.mesh.rounding()) else { continue };
        let cloud = CollisionMesh::new(&body.mesh);
        let mut of_robot = vec![false; cloud.triangle_count()];
        for link in &links {
            let found = query.balls_near(link, &Isometry3::identity(), &cloud, &body.pose, *near.get_ref());
            found.into_iter().for_each(|id| of_robot[id] = true);
        }
        let points = body.mesh.vertices().iter().zip(&of_robot);
        let kept: Vec<_> = points.filter(|(_, left_out)| !**left_out).map(|(p, _)| *p).collect();
        let (all, left_out) = (of_robot.len(), of_robot.len() - kept.len());
        if left_out == 0 {
            continue;
        }
        body.mesh = TriMesh::of_balls(kept, radius).map_err(|_| {
            let message = format!("all {all} points of {} are on the robot at the start", entry.name);
            let help = "correct the pose of the obstacle, or give a smaller self_filter";
            Error::from(problem.file.fault(RobotFilePart::SelfFilter(i), &message, help))
        })?;
        said.push(format!("{left_out} of {all} points of {} {LEFT_OUT}", entry.name));
    }
    Ok(said)
}
