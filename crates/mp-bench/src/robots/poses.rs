//! Inverse kinematics of robots as other people described them: poses of the link that the most joints move,
//! made from configurations at random.

use crate::error::{IntoError, Result};
use mp_cspace::{Configuration, Halton, Rng, Sampler};
use mp_geom::primitives::tetrahedron;
use mp_plan::Clock;
use mp_robot::{ArmModel, IK_PRECISION, InverseKinematics, Kinematics, PoseGoal};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// From how many starts a pose is looked for.
const STARTS: u32 = 100;

/// What became of the poses of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Poses {
    /// The link, and how many joints move it.
    pub(super) link: String,
    pub(super) joints: usize,
    /// How many poses were asked for, and for how many a configuration was found that is there by forward
    /// kinematics.
    pub(super) asked: u32,
    pub(super) reached: u32,
    /// Milliseconds to the first solution: the median, and the longest.
    pub(super) median: f64,
    pub(super) longest: f64,
}

/// The poses of the robot in a file; `None` when it is no robot with joints.
///
/// # Errors
/// When the file cannot be read.
pub(super) fn reached(file: &Path, count: u32) -> Result<Option<Poses>> {
    let text = mp_io::read_robot_text(&mp_io::Disk, file)?;
    // Only the joints matter.
    let shape = tetrahedron(0.01).into_error()?;
    let Ok(model) = ArmModel::from_urdf(&text, |_| Ok(shape.clone())) else { return Ok(None) };
    let Ok(kinematics) = Kinematics::new(&model) else { return Ok(None) };
    let moves = |frame: usize| {
        let (mut joints, mut at) = (0, frame);
        while at > 0 {
            (joints, at) = (joints + 1, kinematics.joint_frames()[at - 1].parent);
        }
        joints
    };
    let links = kinematics.attached().iter().enumerate();
    let Some((i, joints)) =
        links.map(|(i, link)| (i, moves(link.frame))).max_by_key(|(i, joints)| (*joints, usize::MAX - i))
    else {
        return Ok(None);
    };
    let link = kinematics.attached()[i].name.clone();
    let Ok(space) = kinematics.space::<Configuration>() else { return Ok(None) };
    let (mut halton, mut rng, clock) = (Halton::new(&space), Rng::seed(1), Clock::default());
    let neutral = Configuration::from(kinematics.neutral());
    let (mut found, mut times) = (0, Vec::new());
    for _ in 0..count {
        let q = halton.sample(&mut rng);
        let Some(poses) = kinematics.link_poses(q.as_slice()) else { continue };
        let goal = PoseGoal::new(&link, poses[i]);
        let Some(solver) = InverseKinematics::new(&kinematics, goal.clone()) else { return Ok(None) };
        let (mut solver, began) = (solver.beginning_at(&neutral), clock.now());
        let solution = (0..STARTS).find_map(|_| solver.next_solution());
        times.push(1e3 * (clock.now() - began).as_secs_f64());
        let there = solution.and_then(|q| {
            let (place, turn) = goal.error(&kinematics.link_poses(q.as_slice())?[i]);
            Some(place.norm().max(turn.norm()) < 10.0 * IK_PRECISION)
        });
        found += u32::from(there == Some(true));
    }
    times.sort_by(f64::total_cmp);
    let [median, longest] =
        [times.len() / 2, times.len().saturating_sub(1)].map(|k| times.get(k).copied().unwrap_or(0.0));
    Ok(Some(Poses { link, joints, asked: count, reached: found, median, longest }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_of_the_last_link_are_reached() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("two.urdf");
        let joint = |name: &str, parent: &str, child: &str| {
            format!(
                "<joint name='{name}' type='revolute'><parent link='{parent}'/><child link='{child}'/><origin xyz='1 0 0'/>\
                 <axis xyz='0 0 1'/><limit lower='-1' upper='2' effort='1' velocity='1'/></joint>"
            )
        };
        let links = ["base", "upper", "lower"].map(|name| format!("<link name='{name}'/>")).concat();
        let robot = format!(
            "<robot name='two'>{links}{}{}</robot>",
            joint("a", "base", "upper"),
            joint("b", "upper", "lower")
        );
        std::fs::write(&file, robot).unwrap();
        let poses = reached(&file, 40).unwrap().unwrap();
        assert_eq!((poses.link.as_str(), poses.joints, poses.asked, poses.reached), ("lower", 2, 40, 40));
        std::fs::write(&file, "<robot name='none'><link name='base'/></robot>").unwrap();
        assert_eq!(reached(&file, 40).unwrap(), None);
    }
}
