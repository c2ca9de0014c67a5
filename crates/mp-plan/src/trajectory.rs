//! Trajectories from files, and as the content of files.

use crate::{Error, Scene};
use mp_io::{Column, TrajectoryFile, TrajectoryKind};
use mp_time::{Interpolation, Knots, Trajectory};
use std::path::Path;

impl Scene {
    /// Whether the robot has trajectories: an arm does whose base stands still or moves in the plane.
    #[must_use]
    pub fn has_trajectories(&self) -> bool {
        self.robot_rates().is_some()
    }

    /// Reads a trajectory of the robot from a file: `.csv`, `.json` or `.yaml`. The curve between its points is `curve`, or what
    /// `joint_trajectory_controller` of ROS runs. `None` if the file has no times: then it is a path, or something else.
    ///
    /// # Errors
    /// When the file cannot be read, its columns are not those of the robot, or it is no trajectory: with file, line and column.
    pub fn read_trajectory(
        &self,
        file: impl AsRef<Path>,
        curve: Option<Interpolation>,
    ) -> Result<Option<Trajectory>, Error> {
        let Some(kind) = TrajectoryKind::of(file.as_ref()) else { return Ok(None) };
        let (name, bytes) = mp_io::read_text(file.as_ref())?;
        self.parse_trajectory(&name, &bytes, kind, curve)
    }

    /// As [`read_trajectory`](Self::read_trajectory), from the content of a file that errors call `name`.
    ///
    /// # Errors
    /// As there.
    pub fn parse_trajectory(
        &self,
        name: &str,
        bytes: &[u8],
        kind: TrajectoryKind,
        curve: Option<Interpolation>,
    ) -> Result<Option<Trajectory>, Error> {
        if !self.has_trajectories() {
            return Ok(None);
        }
        let Some(read) = TrajectoryFile::parse(name, bytes, kind, &self.columns())? else { return Ok(None) };
        let TrajectoryFile { joints, times, positions, velocities, accelerations } = read;
        let joints = joints.iter().map(|joint| (joint.name.as_str(), joint.unit.as_str()));
        let knots = Knots { times, positions, velocities, accelerations };
        let made = match curve {
            Some(curve) => Trajectory::new(joints, knots, curve),
            None => Trajectory::of_controller(joints, knots),
        };
        made.map(Some).map_err(|e| Error::from(e).context(name.to_owned()))
    }
}

/// The content of a file of this kind with a trajectory: as it reads back, its curve is the same to the last bit if its times are [whole
/// nanoseconds](Trajectory::in_nanoseconds).
#[must_use]
pub fn trajectory_text(trajectory: &Trajectory, kind: TrajectoryKind) -> String {
    let Knots { times, positions, velocities, accelerations } = trajectory.knots().clone();
    let joints = trajectory.joints().map(|(name, unit)| Column::new(name, unit)).collect();
    TrajectoryFile { joints, times, positions, velocities, accelerations }.to_text(kind)
}
