//! Times for a path.

use crate::blend::Part;
use crate::jerk::{averaged, window};
use crate::toppra::{Grid, fastest, seconds};
use crate::{BlendedPath, Interpolation, Knots, TimeError, Trajectory};

/// The limits of each joint, the same in both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    jerk: Vec<f64>,
}

impl Limits {
    /// Limits of velocity (rad/s or m/s; infinite where there is none) and acceleration (rad/s² or m/s²) of each joint. Jerk has none.
    ///
    /// # Errors
    /// When their numbers differ, one is not above zero, or an acceleration is not finite.
    pub fn new(velocity: Vec<f64>, acceleration: Vec<f64>) -> Result<Self, TimeError> {
        let jerk = vec![f64::INFINITY; velocity.len()];
        Self { velocity, acceleration, jerk }.valid()
    }

    /// The same with limits of jerk (rad/s³ or m/s³; infinite where there is none).
    ///
    /// # Errors
    /// When there is not one for each joint, or one is not above zero.
    pub fn with_jerk(self, jerk: Vec<f64>) -> Result<Self, TimeError> {
        Self { jerk, ..self }.valid()
    }

    fn valid(self) -> Result<Self, TimeError> {
        let infinite = f64::INFINITY;
        let all = [
            (["velocity", "limits of velocity"], &self.velocity, infinite),
            (["acceleration", "limits of acceleration"], &self.acceleration, f64::MAX),
            (["jerk", "limits of jerk"], &self.jerk, infinite),
        ];
        let expected = self.velocity.len();
        for ([what, several], limits, most) in all {
            if limits.len() != expected {
                return Err(TimeError::Count { what: several, expected, found: limits.len() });
            }
            if let Some(joint) = limits.iter().position(|limit| !(*limit > 0.0 && *limit <= most)) {
                return Err(TimeError::Limit { what, joint, limit: limits[joint] });
            }
        }
        Ok(self)
    }

    /// The limits times `velocity`, `acceleration` and `jerk`, such as half of them for a robot that is to move gently.
    ///
    /// # Errors
    /// When a limit is not above zero then.
    pub fn scaled(&self, velocity: f64, acceleration: f64, jerk: f64) -> Result<Self, TimeError> {
        let times = |limits: &[f64], factor| limits.iter().map(|limit| limit * factor).collect();
        Self {
            velocity: times(&self.velocity, velocity),
            acceleration: times(&self.acceleration, acceleration),
            jerk: times(&self.jerk, jerk),
        }
        .valid()
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

    /// Those of jerk.
    #[must_use]
    pub fn jerk(&self) -> &[f64] {
        &self.jerk
    }

    /// Those of velocity, acceleration and jerk of each joint.
    pub fn joints(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        (0..self.velocity.len())
            .map(|joint| [&self.velocity, &self.acceleration, &self.jerk].map(|of| of[joint]))
    }
}

/// A path with times.
#[derive(Clone, Debug)]
pub struct Timing {
    /// The trajectory: cubic, with positions and velocities at its points; with limits of jerk quintic, with accelerations too.
    pub trajectory: Trajectory,
    /// The time (s) at which it is nearest to each corner of the path.
    pub corners: Vec<f64>,
    /// How far it is from each corner (the Euclidean norm of all joints).
    pub deviations: Vec<f64>,
}

/// About how many intervals a section between two stops is cut into. What lines have of them is by their lengths.
const INTERVALS: f64 = 100.0;
/// The least number of intervals of a line, and the number of each parabola.
const OF_A_LINE: f64 = 4.0;
const OF_A_BLEND: usize = 8;

/// Goes along a path as fast as the limits allow, from standing still to standing still. Limits hold all along the trajectory, which is that of a
/// controller that joins points by polynomials: on lines it is the path, near corners within little of it.
///
/// Where jerk is limited, each part between two stops is averaged over a window of time, after accelerations that make the whole
/// of it shortest. Corners are then rounded less by the parabola, so that both together cut them by no more than the path allows.
///
/// # Errors
/// When the path has other joints than `joints` and `limits`, or cannot be timed.
pub fn timed<'n>(
    path: &BlendedPath,
    limits: &Limits,
    joints: impl IntoIterator<Item = (&'n str, &'n str)>,
) -> Result<Timing, TimeError> {
    let joints: Vec<_> = joints.into_iter().collect();
    let (mut path, mut tried) = (path.clone(), vec![0; path.corners()]);
    let allowed = path.allowed();
    loop {
        let timing = timed_once(&path, limits, &joints)?;
        let is_cut =
            |corner: &usize| path.blend(*corner).is_some() && timing.deviations[*corner] > allowed * ROUNDED;
        let cut: Vec<_> = (0..path.corners()).filter(is_cut).collect();
        if cut.is_empty() {
            return Ok(timing);
        }
        for corner in cut {
            tried[corner] += 1;
            let less = (0.98 * allowed / timing.deviations[corner]).clamp(0.25, 0.95);
            path.tighten(corner, if tried[corner] > TRIES { 0.0 } else { less });
        }
    }
}

/// By this factor rounding may increase how far a corner is cut.
const ROUNDED: f64 = 1.0 + 1e-9;
/// How often the parabola of a corner is made shorter, before the robot stops at the corner.
const TRIES: u32 = 12;

/// Times the sections of a path between which the robot stops, one after another.
fn timed_once(path: &BlendedPath, limits: &Limits, joints: &[(&str, &str)]) -> Result<Timing, TimeError> {
    let parts = path.parts();
    let (expected, found) = (limits.velocity.len(), parts[0].from.len());
    if expected != found {
        return Err(TimeError::Count { what: "numbers of a point", expected, found });
    }
    let (mut knots, mut interpolation) = (Knots::default(), Interpolation::Cubic);
    let mut corners = vec![0.0; path.corners()];
    let mut deviations: Vec<_> = (0..path.corners()).map(|corner| path.deviation(corner)).collect();
    let mut begins = 0.0;
    for parts in parts.split_inclusive(|part| part.stops) {
        let made = Section(parts).smooth(limits, joints)?;
        interpolation = made.trajectory.interpolation();
        for (corner, time) in made.corners {
            let (near, off) = made.trajectory.nearest(path.corner(corner), time, made.window);
            corners[corner] = begins + near;
            deviations[corner] = if made.window > 0.0 { off } else { deviations[corner] };
        }
        let duration = made.trajectory.duration();
        knots.follow(made.trajectory.into_knots(), begins);
        begins += duration;
    }
    Ok(Timing {
        trajectory: Trajectory::new(joints.iter().copied(), knots, interpolation)?,
        corners,
        deviations,
    })
}

/// The parts of a path between two stops.
struct Section<'p>(&'p [Part]);

/// A section with times, which count from its beginning.
struct TimedSection {
    trajectory: Trajectory,
    /// The corners of the path in it, and about when it is nearest to each.
    corners: Vec<(usize, f64)>,
    /// The window (s) over which it is averaged.
    window: f64,
}

impl Section<'_> {
    /// Within limits of jerk too.
    fn smooth(&self, limits: &Limits, joints: &[(&str, &str)]) -> Result<TimedSection, TimeError> {
        /// Lower accelerations need shorter windows, so the smoothed motion may take less time. The accelerations are multiplied by
        /// this factor at most `TIMES` times, as long as that can help.
        const LESS: f64 = 0.84;
        const TIMES: usize = 60;
        /// Rounding of positions counts in jerk over the third power of the time between two points: these are no nearer to each other.
        const ROUNDING: f64 = 4e-10;
        /// Jerk may be a little above its limit where points were left out for that; then it all gets slower.
        const MORE: f64 = 1.0 + 1e-4;
        /// No window (s) is shorter: controllers do not see what happens within a millisecond.
        const SHORTEST: f64 = 1e-3;
        let mut best = self.fast(limits, joints)?;
        let least = limits.jerk.iter().copied().fold(f64::INFINITY, f64::min);
        if least.is_infinite() {
            return Ok(best);
        }
        let apart = mp_math::cbrt(ROUNDING / least);
        let window =
            |section: &TimedSection| window(&section.trajectory, &limits.jerk).max(SHORTEST).max(4.0 * apart);
        best.window = window(&best);
        let mut scale = 1.0;
        for _ in 0..TIMES {
            scale *= LESS;
            let mut next = self.fast(&limits.scaled(1.0, scale, 1.0)?, joints)?;
            if next.trajectory.duration() >= best.duration() {
                break;
            }
            next.window = window(&next);
            if next.duration() < best.duration() {
                best = next;
            }
        }
        let mut made = averaged(&best.trajectory, best.window, apart)?;
        let mut slower = 1.0;
        // Once slower, a millisecond is a shorter part of the motion, in which there may be more jerk.
        for _ in 0..TIMES {
            let beyond = (0..joints.len()).map(|joint| {
                let jerk = made.jerkiest(joint).amount / limits.jerk[joint];
                let acceleration = made.hardest(joint).amount / limits.acceleration[joint];
                (mp_math::cbrt(jerk / MORE)).max((acceleration / MORE).sqrt())
            });
            let by = beyond.fold(1.0, f64::max);
            if by < 1.0 + 1e-6 {
                break;
            }
            slower *= by;
            made = made.slower(by);
        }
        let corners =
            best.corners.iter().map(|(corner, t)| (*corner, slower * (t + 0.5 * best.window))).collect();
        Ok(TimedSection { trajectory: made, corners, window: slower * best.window })
    }

    /// As fast as limits of velocity and acceleration allow.
    fn fast(&self, limits: &Limits, joints: &[(&str, &str)]) -> Result<TimedSection, TimeError> {
        let Self(parts) = self;
        let total: f64 = parts.iter().map(|part| part.length).sum();
        let intervals = |part: &Part| match part.rounds {
            true => OF_A_BLEND,
            false => (INTERVALS * part.length / total).ceil().max(OF_A_LINE) as usize,
        };
        let mut grid = Grid::new(&limits.acceleration);
        for part in *parts {
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
                grid.cap(at + 1, slowest);
            }
        }
        let x = fastest(&grid).ok_or(TimeError::NoSpeed)?;
        let pace = |i: usize| (x[i + 1] - x[i]) / (2.0 * grid.steps()[i]);
        let (mut time, mut at) = (0.0, 0);
        let (mut knots, mut corners) = (Knots::default(), Vec::new());
        for part in *parts {
            let first = at;
            let middle = if part.rounds { OF_A_BLEND / 2 } else { usize::MAX };
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
                    && i < middle
                {
                    corners.retain(|(before, _)| *before != corner);
                    corners.push((corner, time));
                }
            }
        }
        let last = &parts[parts.len() - 1];
        knots.push(time, last, last.length, 0.0);
        let trajectory = Trajectory::new(joints.iter().copied(), knots, Interpolation::Cubic)?;
        // Cubic polynomials go a little beyond along parabolas.
        let beyond = (0..joints.len()).map(|joint| {
            let velocity = trajectory.fastest(joint).amount / limits.velocity[joint];
            let acceleration = trajectory.hardest(joint).amount / limits.acceleration[joint];
            velocity.max(acceleration.sqrt())
        });
        let slower = beyond.fold(1.0, f64::max);
        corners.iter_mut().for_each(|(_, t)| *t *= slower);
        Ok(TimedSection { trajectory: trajectory.slower(slower), corners, window: 0.0 })
    }
}

impl TimedSection {
    fn duration(&self) -> f64 {
        self.trajectory.duration() + self.window
    }
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

    /// Adds the points of what begins at a time (s) where this one ends.
    fn follow(&mut self, next: Self, begins: f64) {
        let again = usize::from(!self.times.is_empty());
        self.times.extend(next.times.iter().skip(again).map(|t| begins + t));
        self.positions.extend(next.positions.into_iter().skip(again));
        self.velocities.extend(next.velocities.into_iter().skip(again));
        self.accelerations.extend(next.accelerations.into_iter().skip(again));
    }
}

impl Trajectory {
    /// About when, and how far away, the trajectory is nearest to a place, within half a window (s) of a time.
    fn nearest(&self, place: &[f64], time: f64, window: f64) -> (f64, f64) {
        const LOOKS: u32 = 64;
        let looks = (0..=LOOKS).map(|i| time + window * (f64::from(i) / f64::from(LOOKS) - 0.5));
        let far = looks.map(|t| {
            let off = self.at(t).position.iter().zip(place).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            (t, off.sqrt())
        });
        far.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((time, f64::INFINITY))
    }
}
