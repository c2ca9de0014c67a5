//! Poses of a robot along a path, for pictures and animations.

use crate::path::states;
use crate::{Error, PathRows, RobotKind};
use mp_cspace::{Clearance, MotionClearance, Space};
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

/// A path sampled for an animation: its own configurations, and as many between them as a smooth film needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// The configurations.
    pub rows: Vec<Vec<f64>>,
    /// The poses of the robot's bodies at each.
    pub poses: Vec<Vec<Isometry3<f64>>>,
    /// The drawn point of the robot at each.
    pub trace: Vec<Point3<f64>>,
    /// A lower bound (m) on the clearance at each; zero in collision.
    pub clearance: Vec<f64>,
    /// How far (m) the robot has moved from the start to each: an upper bound for its points. For robots whose states say when
    /// they are there, how long (s) that took.
    pub travel: Vec<f64>,
}

impl Track {
    /// The poses of the robot's bodies and the drawn point at a fraction of the way, 0 to 1, at even speed, or of the time for
    /// robots whose states say when they are there. `None` without
    /// configurations.
    #[must_use]
    pub fn at(&self, fraction: f64) -> Option<(Vec<Isometry3<f64>>, Point3<f64>)> {
        let way = fraction.clamp(0.0, 1.0) * self.travel.last()?;
        let next = self.travel.partition_point(|s| *s < way).min(self.travel.len() - 1);
        let before = next.saturating_sub(1);
        let part = self.travel[next] - self.travel[before];
        let t = if part > 0.0 { ((way - self.travel[before]) / part).clamp(0.0, 1.0) } else { 1.0 };
        let pose = |(a, b): (&Isometry3<f64>, &Isometry3<f64>)| {
            a.try_lerp_slerp(b, t, 1e-12).unwrap_or(if t < 0.5 { *a } else { *b })
        };
        let poses = self.poses[before].iter().zip(&self.poses[next]).map(pose).collect();
        Some((poses, self.trace[before] + (self.trace[next] - self.trace[before]) * t))
    }
}

/// No more configurations than this are put between those of a path.
const MAX_BETWEEN: f64 = 2000.0;

/// Configurations along a path, neighbours so near that poses between them may be interpolated linearly.
pub(crate) fn track<K: RobotKind>(kind: &K, path: &PathRows) -> Result<Track, Error> {
    let states = states(kind, path)?;
    let mut checker = kind.checker().clone();
    let lengths: Vec<f64> = states.windows(2).map(|w| checker.motion_bound(&w[0], &w[1])).collect();
    let total: f64 = lengths.iter().sum();
    let spacing = (0.1 * kind.picture_spacing()).max(total / MAX_BETWEEN);
    let mut track = Track::default();
    let mut add = |q: &K::State, travel: f64| {
        track.rows.push(kind.row(q));
        track.poses.push(kind.poses(q));
        track.trace.push(kind.traced(q));
        track.clearance.push(checker.clearance(q, f64::INFINITY).max(0.0));
        track.travel.push(travel);
    };
    let mut way = 0.0;
    for (edge, length) in lengths.iter().enumerate() {
        let parts = (length / spacing).ceil().clamp(1.0, MAX_BETWEEN) as u32;
        let length = kind.seconds(&states[edge], &states[edge + 1]).unwrap_or(*length);
        for k in 0..parts {
            let t = f64::from(k) / f64::from(parts);
            add(&kind.space().interpolate(&states[edge], &states[edge + 1], t), way + length * t);
        }
        way += length;
    }
    if let Some(last) = states.last() {
        add(last, way);
    }
    Ok(track)
}
