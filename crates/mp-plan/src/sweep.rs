//! Poses of a robot along a path, for pictures and animations.

use crate::path::states;
use crate::{Error, ErrorKind, PathRows, Robot};
use mp_cspace::{Clearance, Configuration, MotionClearance, Space};
use mp_geom::evenly;
use mp_kinds::motion::AnyChecker;
use mp_kinds::turns::continued;
use mp_kinds::turns::turning;
use mp_time::Trajectory;
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

/// A path of more configurations is thinned for pictures and films.
const MOST_SHOWN: usize = 10_000;
/// The most parts that it has once thinned.
const PARTS: f64 = 5_000.0;

/// The configurations of a path that are shown.
struct Shown {
    states: Vec<Configuration>,
    /// How far (m) the robot moves at most from each to the next.
    lengths: Vec<f64>,
    /// The same, or how long (s) that takes where states say so.
    ways: Vec<f64>,
}

impl Shown {
    /// All of at most 10⁴. Of more of them, each at which no point of the robot has moved by 1/5000 of the whole way since the last one
    /// shown is left out: what is drawn is nowhere farther from the path than that.
    fn of(kind: &dyn Robot, path: &PathRows) -> Result<Self, Error> {
        let states = states(kind, path)?;
        let robot = kind.any_checker();
        let edges = states.windows(2).map(|w| {
            let length = robot.motion_bound(&w[0], &w[1]);
            (length, kind.seconds(&w[0], &w[1]).unwrap_or(length))
        });
        let (lengths, ways): (Vec<f64>, Vec<f64>) = edges.unzip();
        if states.len() <= MOST_SHOWN {
            return Ok(Self { states, lengths, ways });
        }
        let least = lengths.iter().sum::<f64>() / PARTS;
        let mut shown = Self { states: vec![states[0].clone()], lengths: Vec::new(), ways: Vec::new() };
        let (mut length, mut way) = (0.0, 0.0);
        for (edge, state) in states.iter().skip(1).enumerate() {
            (length, way) = (length + lengths[edge], way + ways[edge]);
            if length >= least || edge + 2 == states.len() {
                shown.states.push(state.clone());
                shown.lengths.push(std::mem::take(&mut length));
                shown.ways.push(std::mem::take(&mut way));
            }
        }
        Ok(shown)
    }
}

/// Poses along a path.
pub(crate) fn sweep(kind: &dyn Robot, path: Option<&PathRows>) -> Result<Sweep, Error> {
    let shown = path.map(|path| Shown::of(kind, path)).transpose()?;
    let (states, lengths) = shown.map(|shown| (shown.states, shown.lengths)).unwrap_or_default();
    let at = |edge: usize, t: f64| kind.any_space().interpolate(&states[edge], &states[edge + 1], t);
    let places = evenly(&lengths, kind.picture_spacing());
    // Many edges are short.
    let parts = if lengths.len() > 2_000 { 2 } else { 16 };
    let fine = |edge: usize| (0..=parts).map(move |k| (edge, f64::from(k) / f64::from(parts)));
    let trace = (0..lengths.len()).flat_map(fine);
    let (start, goal) = (states.first().unwrap_or(kind.start()), states.last().unwrap_or(&kind.goals()[0]));
    Ok(Sweep {
        start: kind.poses(start),
        goal: kind.poses(goal),
        between: places.into_iter().map(|(edge, t)| kind.poses(&at(edge, t))).collect(),
        trace: trace.map(|(edge, t)| kind.traced(&at(edge, t))).collect(),
    })
}

/// Configurations at equal distances along a path, as rows.
pub(crate) fn resample(kind: &dyn Robot, path: &PathRows, count: usize) -> Result<Vec<Vec<f64>>, Error> {
    let most = 10_000_000 / kind.columns().len().max(1);
    if !(2..=most).contains(&count) {
        return Err(Error::new(format!("a path cannot be {} configurations", count))
            .help(format!("give 2 to {most}"))
            .of_kind(ErrorKind::Request));
    }
    let (space, states) = (kind.any_space(), states(kind, path)?);
    let lengths: Vec<f64> = states.windows(2).map(|w| space.distance(&w[0], &w[1])).collect();
    let spacing = lengths.iter().sum::<f64>() / (count - 1) as f64;
    let (mut edge, mut passed, mut along) = (0, 0.0, vec![states[0].clone()]);
    for i in 1..count - 1 {
        let s = i as f64 * spacing;
        while edge + 1 < lengths.len() && passed + lengths[edge] < s {
            passed += lengths[edge];
            edge += 1;
        }
        along.push(match lengths.get(edge) {
            Some(length) if *length > 0.0 => {
                let part = ((s - passed) / length).clamp(0.0, 1.0);
                space.interpolate(&states[edge], &states[edge + 1], part)
            }
            _ => states[edge].clone(),
        });
    }
    along.extend(states.last().cloned());
    let rows = along.iter().map(|q| kind.row(q)).collect();
    Ok(continued(&turning(kind), &path.rows[0], rows))
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
    /// Which of them are the path's own.
    pub corners: Vec<usize>,
}

impl Track {
    fn add(&mut self, kind: &dyn Robot, checker: &mut AnyChecker, q: &Configuration, travel: f64) {
        self.rows.push(kind.row(q));
        self.poses.push(kind.poses(q));
        self.trace.push(kind.traced(q));
        self.clearance.push(checker.clearance(q, f64::INFINITY).max(0.0));
        self.travel.push(travel);
    }

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
pub(crate) fn track(kind: &dyn Robot, path: &PathRows) -> Result<Track, Error> {
    let Shown { states, lengths, ways } = Shown::of(kind, path)?;
    let mut checker = kind.any_measure();
    let total: f64 = lengths.iter().sum();
    let spacing = (0.1 * kind.picture_spacing()).max(total / MAX_BETWEEN);
    let mut track = Track::default();
    let mut add = |q: &Configuration, travel: f64| track.add(kind, &mut checker, q, travel);
    let (mut way, mut corners) = (0.0, vec![0]);
    for (edge, length) in lengths.iter().enumerate() {
        let parts = (length / spacing).ceil().clamp(1.0, MAX_BETWEEN) as u32;
        corners.push(corners[edge] + parts as usize);
        let length = ways[edge];
        for k in 0..parts {
            let t = f64::from(k) / f64::from(parts);
            add(&kind.any_space().interpolate(&states[edge], &states[edge + 1], t), way + length * t);
        }
        way += length;
    }
    if let Some(last) = states.last() {
        add(last, way);
        track.corners = corners;
    }
    Ok(track)
}

/// Configurations of a trajectory at equal times, `rate` in a second, or as many as a path may have between two of its own.
pub(crate) fn track_in_time(kind: &dyn Robot, trajectory: &Trajectory, rate: f64) -> Track {
    let (first, duration) = (trajectory.span()[0], trajectory.duration());
    let parts = (duration * rate).ceil().clamp(0.0, MAX_BETWEEN) as u32;
    let (mut checker, mut track) = (kind.any_measure(), Track::default());
    for k in 0..=parts {
        let time = duration * f64::from(k) / f64::from(parts.max(1));
        let q = kind.state(&trajectory.at(first + time).position);
        track.add(kind, &mut checker, &q, time);
    }
    track
}
