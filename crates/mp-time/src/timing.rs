//! Times for a path.

use crate::blend::Part;
use crate::toppra::{Grid, fastest, seconds};
use crate::{BlendedPath, Interpolation, Knots, TimeError, Trajectory};

/// The limits of each joint, the same in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
}

impl Limits {
    /// Limits of velocity (rad/s or m/s; infinite where there is none) and acceleration (rad/s² or m/s²) of each joint.
    ///
    /// # Errors
    /// When their numbers differ, one is not above zero, or an acceleration is not finite.
    pub fn new(velocity: Vec<f64>, acceleration: Vec<f64>) -> Result<Self, TimeError> {
        if velocity.len() != acceleration.len() {
            let (expected, found) = (velocity.len(), acceleration.len());
            return Err(TimeError::Count { what: "limits of acceleration", expected, found });
        }
        let wrong = |what, limits: &[f64], most: f64| {
            let joint = limits.iter().position(|limit| !(*limit > 0.0 && *limit <= most))?;
            Some(TimeError::Limit { what, joint, limit: limits[joint] })
        };
        let faults =
            [wrong("velocity", &velocity, f64::INFINITY), wrong("acceleration", &acceleration, f64::MAX)];
        faults.into_iter().flatten().next().map_or(Ok(Self { velocity, acceleration }), Err)
    }

    /// The limits times `velocity` and `acceleration`, such as half of them for a robot that is to move gently.
    ///
    /// # Errors
    /// When a limit is not above zero then.
    pub fn scaled(&self, velocity: f64, acceleration: f64) -> Result<Self, TimeError> {
        let times = |limits: &[f64], factor| limits.iter().map(|limit| limit * factor).collect();
        Self::new(times(&self.velocity, velocity), times(&self.acceleration, acceleration))
    }

    /// Those of velocity.
    #[must_use]
    pub fn velocity(&self) -> &[f64] {
        &self.velocity
    }

    /// Those of acceleration.
    #[must_use]
    pub fn acceleration(&self) -> &[f64] {
        &self.acceleration
    }
}

/// A path with times.
#[derive(Clone, Debug)]
pub struct Timing {
    /// The trajectory: cubic, with positions and velocities at its points.
    pub trajectory: Trajectory,
    /// The time (s) at which it is nearest to each corner of the path.
    pub corners: Vec<f64>,
}

/// About how many intervals a path is cut into. What lines have of them is by their lengths.
const INTERVALS: f64 = 100.0;
/// The least number of intervals of a line, and the number of each parabola.
const OF_A_LINE: f64 = 4.0;
const OF_A_BLEND: usize = 8;

/// Goes along a path as fast as the limits allow, from standing still to standing still. Limits hold all along the trajectory, which is that of a
/// controller that joins points by cubic polynomials: on lines it is the path, near corners within little of it.
///
/// # Errors
/// When the path has other joints than `joints` and `limits`, or cannot be timed.
pub fn timed<'n>(
    path: &BlendedPath,
    limits: &Limits,
    joints: impl IntoIterator<Item = (&'n str, &'n str)>,
) -> Result<Timing, TimeError> {
    let parts = path.parts();
    let (expected, found) = (limits.velocity.len(), parts[0].from.len());
    if expected != found {
        return Err(TimeError::Count { what: "numbers of a point", expected, found });
    }
    let total: f64 = parts.iter().map(|part| part.length).sum();
    let intervals = |part: &Part| match part.rounds {
        true => OF_A_BLEND,
        false => (INTERVALS * part.length / total).ceil().max(OF_A_LINE) as usize,
    };
    let mut grid = Grid::new(&limits.acceleration);
    for part in &parts {
        let count = intervals(part);
        let step = part.length / count as f64;
        for i in 0..count {
            let [start, end] = [i, i + 1].map(|k| part.derivative(k as f64 * step));
            // Velocities hold all along the interval: the larger derivative of both ends counts at both.
            let slowest = start.iter().zip(&end).zip(&limits.velocity).map(|((a, b), limit)| {
                let speed = limit / a.abs().max(b.abs());
                speed * speed
            });
            let slowest = slowest.fold(f64::INFINITY, f64::min);
            let at = grid.steps().len();
            grid.push(step, [[&start, &part.second], [&end, &part.second]]);
            grid.cap(at, slowest);
            grid.cap(at + 1, if part.stops && i + 1 == count { 0.0 } else { slowest });
        }
    }
    let x = fastest(&grid).ok_or(TimeError::NoSpeed)?;
    let pace = |i: usize| (x[i + 1] - x[i]) / (2.0 * grid.steps()[i]);
    let (mut time, mut at) = (0.0, 0);
    let (mut knots, mut corners) = (Knots::default(), vec![0.0; path.corners()]);
    for part in &parts {
        let first = at;
        for i in 0..intervals(part) {
            // On a line an even acceleration is a cubic polynomial, however long it lasts.
            let goes_on = i > 0 && !part.rounds && {
                let (before, after) = (pace(at - 1), pace(at));
                (before - after).abs() <= 1e-9 * (before.abs() + after.abs())
            };
            if !goes_on {
                knots.push(time, part, (at - first) as f64 * grid.steps()[at], x[at].sqrt());
            }
            time += seconds(grid.steps()[at], x[at], x[at + 1]);
            at += 1;
            if let Some(corner) = part.corner
                && (!part.rounds || i < OF_A_BLEND / 2)
            {
                corners[corner] = time;
            }
        }
    }
    let last = &parts[parts.len() - 1];
    knots.push(time, last, last.length, 0.0);
    let trajectory = Trajectory::new(joints, knots, Interpolation::Cubic)?;
    // Cubic polynomials go a little beyond along parabolas.
    let beyond = (0..expected).map(|joint| {
        let velocity = trajectory.fastest(joint).amount / limits.velocity[joint];
        let acceleration = trajectory.hardest(joint).amount / limits.acceleration[joint];
        velocity.max(acceleration.sqrt())
    });
    let slower = beyond.fold(1.0, f64::max);
    corners.iter_mut().for_each(|t| *t *= slower);
    Ok(Timing { trajectory: trajectory.slower(slower), corners })
}

impl Part {
    /// The derivative of the path at a distance from the beginning of the part.
    fn derivative(&self, s: f64) -> Vec<f64> {
        self.first[0].iter().zip(&self.second).map(|(first, second)| first + s * second).collect()
    }
}

impl Knots {
    /// Adds the point of the path at a distance from the beginning of a part, where the speed along the path is `speed`.
    fn push(&mut self, time: f64, part: &Part, s: f64, speed: f64) {
        let place = part.from.iter().zip(&part.first[0]).zip(&part.second);
        self.times.push(time);
        self.positions.push(place.map(|((q, first), second)| q + s * (first + 0.5 * s * second)).collect());
        self.velocities.push(part.derivative(s).into_iter().map(|d| d * speed).collect());
    }
}
