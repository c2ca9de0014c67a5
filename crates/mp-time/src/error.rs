//! What can be wrong with trajectories, paths and limits.

use crate::Interpolation;

/// What is wrong with a trajectory, or with what one is to be made from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimeError {
    /// There is no point, or a path has less than two different ones.
    #[error("there are not enough points: {found}, and {least} are needed")]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many there must be.
        least: usize,
    },
    /// A list does not have as many numbers as there are joints, or as many rows as there are times.
    #[error("there are {found} {what}, not {expected}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A time, position, velocity or acceleration is NaN or infinite.
    #[error("a number of point {} is not finite", point + 1)]
    NotFinite {
        /// The index of the point.
        point: usize,
    },
    /// Times do not increase.
    #[error("the time of point {} is {time} s, not after that of the point before, {before} s", point + 1)]
    Times {
        /// The index of the point.
        point: usize,
        /// The time of the point (s).
        time: f64,
        /// The time of the point before (s).
        before: f64,
    },
    /// A curve needs numbers that are not there.
    #[error("a {curve} curve needs {what}, which are missing")]
    Missing {
        /// The curve that was asked for.
        curve: Interpolation,
        /// What is missing.
        what: &'static str,
    },
    /// A limit is not above zero.
    #[error("the limit of {what} of joint {} is {limit}, not above zero", joint + 1)]
    Limit {
        /// Velocity or acceleration.
        what: &'static str,
        /// The index of the joint.
        joint: usize,
        /// The limit that was given (rad or m, per s or s²).
        limit: f64,
    },
    /// There are not points at this rate: it is not above zero, or there would be more than ten million.
    #[error("there are no points {rate} times a second: take a rate above 0 Hz and below {most} Hz")]
    Rate {
        /// The rate that was given (Hz).
        rate: f64,
        /// At this rate (Hz) there would be ten million points.
        most: f64,
    },
    /// A path cannot be timed: rounding leaves no speed along it.
    #[error("the path cannot be timed: it is too long, or too short, for its limits")]
    NoSpeed,
}
