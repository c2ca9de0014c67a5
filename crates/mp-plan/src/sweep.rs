//! Poses of a robot along a path, for pictures.

use crate::path::states;
use crate::{Error, PathRows, RobotKind};
use mp_cspace::{MotionClearance, Space};
use mp_geom::evenly;
use nalgebra::{Isometry3, Point3};

/// The poses of the moving bodies along a path, as pictures need them.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Poses of the robot's bodies at the start of the path, or of the scene.
    pub start: Vec<Isometry3<f64>>,
    /// Poses of the robot's bodies at the end of the path, or at the first goal.
    pub goal: Vec<Isometry3<f64>>,
    /// Poses between, spread evenly by how far the robot moves.
    pub between: Vec<Vec<Isometry3<f64>>>,
    /// The curve of one point of the robot.
    pub trace: Vec<Point3<f64>>,
}

/// Poses along a path.
pub(crate) fn sweep<K: RobotKind>(kind: &K, path: Option<&PathRows>) -> Result<Sweep, Error> {
    let states = path.map(|path| states(kind, path)).transpose()?.unwrap_or_default();
    let robot = kind.checker();
    let lengths: Vec<f64> = states.windows(2).map(|w| robot.motion_bound(&w[0], &w[1])).collect();
    let at = |edge: usize, t: f64| kind.space().interpolate(&states[edge], &states[edge + 1], t);
    let places = evenly(&lengths, kind.picture_spacing());
    let fine = |edge: usize| (0..=16).map(move |k| (edge, f64::from(k) / 16.0));
    let trace = (0..lengths.len()).flat_map(fine);
    let (start, goal) = (states.first().unwrap_or(kind.start()), states.last().unwrap_or(&kind.goals()[0]));
    Ok(Sweep {
        start: kind.poses(start),
        goal: kind.poses(goal),
        between: places.into_iter().map(|(edge, t)| kind.poses(&at(edge, t))).collect(),
        trace: trace.map(|(edge, t)| kind.traced(&at(edge, t))).collect(),
    })
}
