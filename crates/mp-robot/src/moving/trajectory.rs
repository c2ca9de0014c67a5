//! Trajectories: the pose of a body at each time.

use mp_cspace::angle::{rotation_angle, slerp};
use nalgebra::Isometry3;
use thiserror::Error;

/// Why a list of timed poses is not a trajectory.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// There is no pose.
    #[error("a trajectory needs at least one timed pose")]
    Empty,
    /// A time or a pose is not finite, or a rotation is not of unit length.
    #[error("timed pose {index} must be finite, and its rotation of unit length")]
    NotAPose {
        /// The index of the timed pose.
        index: usize,
    },
    /// A time is not later than the one before.
    #[error("timed pose {index} is at {time} s, which must be after the one before")]
    NotAfter {
        /// The index of the timed pose.
        index: usize,
        /// The time (s) that it is given.
        time: f64,
    },
}

/// Timed poses of a body in the world, with straight motions between them: the origin of its frame moves on a line,
/// and the body turns about a fixed axis by the shorter way, both at constant speed. The body stands still before the
/// first pose and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    times: Vec<f64>,
    poses: Vec<Isometry3<f64>>,
}

impl Trajectory {
    /// The trajectory through `poses` at their times (s).
    ///
    /// # Errors
    /// When there is no pose, one is not valid, or the times do not increase.
    pub fn new(poses: impl IntoIterator<Item = (f64, Isometry3<f64>)>) -> Result<Self, TrajectoryError> {
        let (times, poses): (Vec<f64>, Vec<Isometry3<f64>>) = poses.into_iter().unzip();
        if times.is_empty() {
            return Err(TrajectoryError::Empty);
        }
        for (index, (&time, pose)) in times.iter().zip(&poses).enumerate() {
            let finite = time.is_finite() && pose.translation.vector.iter().all(|x| x.is_finite());
            let unit = (pose.rotation.as_ref().coords.norm_squared() - 1.0).abs() < 1e-9;
            if !(finite && unit) {
                return Err(TrajectoryError::NotAPose { index });
            }
            if index > 0 && time <= times[index - 1] {
                return Err(TrajectoryError::NotAfter { index, time });
            }
        }
        Ok(Self { times, poses })
    }

    /// The poses that it was made of, with their times (s).
    pub fn timed_poses(&self) -> impl Iterator<Item = (f64, &Isometry3<f64>)> {
        self.times.iter().copied().zip(&self.poses)
    }

    /// The pose in the world at `time` (s): not a pose where that is not a number, so that nothing is free then.
    #[must_use]
    pub fn pose(&self, time: f64) -> Isometry3<f64> {
        if time.is_nan() {
            return Isometry3::translation(time, time, time);
        }
        let next = self.times.partition_point(|t| *t <= time);
        let last = self.times.len() - 1;
        if next == 0 || next > last {
            return self.poses[next.min(last)];
        }
        let (a, b) = (&self.poses[next - 1], &self.poses[next]);
        let share = (time - self.times[next - 1]) / (self.times[next] - self.times[next - 1]);
        let translation = a.translation.vector.lerp(&b.translation.vector, share);
        Isometry3::from_parts(translation.into(), slerp(&a.rotation, &b.rotation, share))
    }

    /// An upper bound (m/s) on the speed of any point within `radius` of the origin of the body's frame
    /// from `begin` to `end`.
    #[must_use]
    pub fn speed(&self, radius: f64, begin: f64, end: f64) -> f64 {
        let (begin, end) = (begin.min(end), begin.max(end));
        let speed = |i: usize| {
            let (a, b) = (&self.poses[i - 1], &self.poses[i]);
            let shift = (b.translation.vector - a.translation.vector).norm();
            (shift + radius * rotation_angle(&a.rotation, &b.rotation)) / (self.times[i] - self.times[i - 1])
        };
        let touched = |i: &usize| self.times[*i] >= begin && self.times[*i - 1] <= end;
        (1..self.times.len()).filter(touched).map(speed).fold(0.0, f64::max)
    }
}
