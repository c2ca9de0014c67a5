//! Points of clouds that are on the robot itself, which a camera sees too.

use crate::{Error, Interrupt};
use mp_collide::{CollisionMesh, Query};
use mp_cspace::Configuration;
use mp_geom::TriMesh;
use mp_io::{RobotFilePart, RobotProblem};
use mp_robot::Arm;
use nalgebra::Isometry3;

/// How the sentences end.
const LEFT_OUT: &str = "are on the robot at the start, and left out";

/// The arm among the points that are not as near to it at `start` as their obstacles say, and what is `said` of it: how many are left out, too.
///
/// # Errors
/// When nothing of a cloud is left, or the work was interrupted.
pub(super) fn filtered(
    arm: Arm,
    problem: &mut RobotProblem,
    start: &Configuration,
    mut said: Vec<String>,
    interrupt: &Interrupt,
) -> Result<(Arm, Vec<String>), Error> {
    // Of the scene before.
    said.retain(|line| !line.ends_with(LEFT_OUT));
    let left_out = filter(&arm, problem, start)?;
    if left_out.is_empty() {
        return Ok((arm, said));
    }
    said.extend(left_out);
    let bodies = problem.obstacles.iter().map(|o| (o.name.clone(), o.mesh.clone(), o.pose));
    Ok((arm.among_until(bodies, interrupt)?, said))
}

/// Leaves out the points that are as near to the arm at `start` as their obstacles say. Returns how many, in sentences.
///
/// # Errors
/// When nothing of a cloud is left.
fn filter(arm: &Arm, problem: &mut RobotProblem, start: &[f64]) -> Result<Vec<String>, Error> {
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
