//! Paths with times, and the proof of the curve that a controller runs.
//!
//! The corners of a path are rounded, the rounded path is timed, and the curve between the points of the trajectory is proved by the verifier. Where
//! that is not free, the nearest corner is rounded half as far from the path, at last not at all: the robot stops there, on the path that was
//! proved before.

use crate::explain::enclosures;
use crate::finish::check::{end_faults, fault_text, what_happens};
use crate::path::states;
use crate::{Error, PathRows, Robot, Verdict, brief, count, plain};
use mp_cspace::erased::AnyCheck;
use mp_cspace::{
    Clearance, Configuration, Curve, Interrupt, MotionCheck, MotionClearance, MotionValidity, Path,
};
use mp_kinds::counted::Counted;
use mp_kinds::proof::verified;
use mp_kinds::turns::turning;
use mp_time::{BlendedPath, Extreme, Interpolation, Knots, Limits, TimeError, Trajectory, timed};
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::PI;
use std::sync::atomic::AtomicU64;

/// How a path is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// The part of the limits of velocity that is used, above 0.
    pub velocity: f64,
    /// The part of the limits of acceleration that is used, above 0.
    pub acceleration: f64,
    /// The part of the limits of jerk that is used, above 0. Without such limits jerk is not limited.
    pub jerk: f64,
    /// How far from a corner of the path the trajectory may pass (rad and m: the Euclidean norm of all joints). Zero: it stops at each corner.
    pub deviation: f64,
}

impl Default for Pace {
    /// All of the limits; corners are cut by 0.1, as `path_tolerance` of MoveIt has it.
    fn default() -> Self {
        Self { velocity: 1.0, acceleration: 1.0, jerk: 1.0, deviation: 0.1 }
    }
}

/// A corner that had to be rounded less than was allowed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TightCorner {
    /// The number of the configuration of the path, counted from 1.
    pub configuration: usize,
    /// When the trajectory is there (s).
    pub time: f64,
    /// How far from it the trajectory passes (rad and m); zero where it stops.
    pub deviation: f64,
}

/// A path with times, whose curve is proved free.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPath {
    /// The points of the path with their times, and the curve between them.
    pub trajectory: Trajectory,
    /// How many corners the path has.
    pub corners: usize,
    /// Those that had to be rounded less, for the curve to be free.
    pub tightened: Vec<TightCorner>,
    /// A bound (m) on the clearance all along, from the proof: often less than what there is.
    pub clearance: f64,
    /// Which limits were taken where none are known, in sentences.
    pub notes: Vec<String>,
    /// Where the path does not lead from the start to a goal, in sentences: it may be a part of one, or of another problem.
    pub ends: Vec<String>,
}

/// What has limits, in the order of [`Robot::rates`].
const RATES: [&str; 3] = ["velocity", "acceleration", "jerk"];

/// The limits that are taken where none is known (rad/s or m/s, and these per s): those of MoveIt.
pub(crate) const UNKNOWN: f64 = 1.0;

/// How often the rounding of a corner is halved, before the corner is not rounded at all.
const HALVINGS: u32 = 6;

/// Times a path, which is proved free first.
///
/// # Errors
/// When the robot's configurations are not joints that move by themselves; when the path is not free, or the proof of its curve is interrupted;
/// and when the pace is not valid.
pub(crate) fn time(
    kind: &dyn Robot,
    path: &PathRows,
    pace: &Pace,
    interrupt: &Interrupt,
) -> Result<TimedPath, Error> {
    let _span = tracing::info_span!("time", scene = kind.name()).entered();
    let (limits, notes) = limits(kind, pace)?;
    let given = Path::straight(states(kind, path)?);
    let ends = end_faults(kind, &given.states);
    if let Some(fault) = verified(kind, &given, interrupt)?.fault {
        return Err(match interrupt.raised() {
            Some(_) => interrupted(),
            None => Error::new(format!("the path is not free: {}", fault_text(kind, &given, fault)))
                .help("only free paths get times"),
        });
    }
    let rows = kind.rows(&given);
    let columns = kind.columns();
    let joints = || columns.iter().map(|column| (column.name.as_str(), column.unit.as_str()));
    let mut verifier: AnyCheck<'_, Configuration> = Box::new(kind.any_verifier()?);
    verifier.interrupt_by(interrupt);
    let deviation = pace.deviation;
    if !(deviation >= 0.0 && deviation.is_finite()) {
        return Err(Error::new(format!("corners cannot be cut by {deviation}"))
            .help("give a finite number of radians (and metres), zero or more"));
    }
    let mut blended = match BlendedPath::new(&rows, deviation) {
        Err(TimeError::TooFew { .. }) => return standing(&rows[0], joints(), &mut verifier, (notes, ends)),
        made => made?,
    };
    let allowed: Vec<f64> = (0..blended.corners()).map(|corner| blended.deviation(corner)).collect();
    let mut halvings = vec![0; blended.corners()];
    let mut tighten = |blended: &mut BlendedPath, corner: usize| {
        halvings[corner] += 1;
        blended.tighten(corner, if halvings[corner] > HALVINGS { 0.0 } else { 0.5 });
    };
    for corner in 0..blended.corners() {
        while let Some(blend) = blended.blend(corner)
            && !check_curve(kind, &mut verifier, &blend)?.is_free()
        {
            if interrupt.raised().is_some() {
                return Err(interrupted());
            }
            tighten(&mut blended, corner);
        }
    }
    loop {
        let timing = timed(&blended, &limits, joints())?;
        // What is written reads back the same.
        let trajectory = timing.trajectory.in_nanoseconds()?;
        let at = match check_curve(kind, &mut verifier, &trajectory)? {
            MotionCheck::Free { clearance } => {
                let tight = |corner: &usize| blended.deviation(*corner) < allowed[*corner] * (1.0 - 1e-9);
                let tightened = (0..blended.corners()).filter(tight).map(|corner| TightCorner {
                    configuration: blended.index(corner) + 1,
                    time: timing.corners[corner],
                    deviation: timing.deviations[corner],
                });
                let (tightened, corners) = (tightened.collect(), blended.corners());
                return Ok(TimedPath { trajectory, corners, tightened, clearance, notes, ends });
            }
            MotionCheck::Collision { at } | MotionCheck::Unproven { at } => at,
        };
        if interrupt.raised().is_some() {
            return Err(interrupted());
        }
        let time = time_of(&trajectory, at);
        let rounded = (0..blended.corners()).filter(|corner| blended.blend(*corner).is_some());
        let off = |corner: &usize| (timing.corners[*corner] - time).abs();
        let Some(nearest) = rounded.min_by(|a, b| off(a).total_cmp(&off(b))) else {
            return Err(Error::new(format!(
                "the curve at {} s is too near to contact to be proved free",
                brief(time)
            ))
            .help("plan with a clearance, such as 0.01 m"));
        };
        tracing::debug!(time, corner = blended.index(nearest) + 1, "the curve is not free");
        tighten(&mut blended, nearest);
    }
}

/// The trajectory of a path of one configuration.
fn standing<'n>(
    row: &[f64],
    joints: impl IntoIterator<Item = (&'n str, &'n str)>,
    verifier: &mut AnyCheck<'_, Configuration>,
    (notes, ends): (Vec<String>, Vec<String>),
) -> Result<TimedPath, Error> {
    let still = row.to_vec().into();
    let clearance = match verifier.check_motion(&still, &still) {
        MotionCheck::Free { clearance } => clearance,
        _ => 0.0,
    };
    let knots = Knots {
        times: vec![0.0],
        positions: vec![row.to_vec()],
        velocities: vec![vec![0.0; row.len()]],
        accelerations: Vec::new(),
    };
    let trajectory = Trajectory::new(joints, knots, Interpolation::Cubic)?;
    Ok(TimedPath { trajectory, corners: 0, tightened: Vec::new(), clearance, notes, ends })
}

fn interrupted() -> Error {
    Error::new("the trajectory was not proved in time").help("give it more time")
}

/// The time (s) of a fraction of the pieces of a trajectory.
pub(crate) fn time_of(trajectory: &Trajectory, at: f64) -> f64 {
    let times = &trajectory.knots().times;
    let x = at * trajectory.pieces() as f64;
    let piece = (x as usize).min(times.len() - 2);
    times[piece] + (x - piece as f64) * (times[piece + 1] - times[piece])
}

/// What the verifier finds along a curve.
pub(crate) fn check_curve(
    kind: &dyn Robot,
    verifier: &mut AnyCheck<'_, Configuration>,
    curve: &dyn Curve,
) -> Result<MotionCheck, Error> {
    verifier.check_curve(curve).ok_or_else(|| no_curves(kind))
}

fn no_curves(kind: &dyn Robot) -> Error {
    Error::new(format!("there are no trajectories for the robot of {}", kind.name()))
        .help("arms have them whose base stands still or moves in the plane, and that do not move by inputs")
}

/// The limits of velocity, acceleration and jerk of each number, where they are known.
pub(crate) fn rates(kind: &dyn Robot) -> Result<Vec<[Option<f64>; 3]>, Error> {
    kind.rates().ok_or_else(|| no_curves(kind))
}

/// The limits at a pace, and which were taken for want of known ones.
fn limits(kind: &dyn Robot, pace: &Pace) -> Result<(Limits, Vec<String>), Error> {
    let (rates, columns) = (rates(kind)?, kind.columns());
    let mut notes = Vec::new();
    let mut limit = |i: usize, what: &str, key: &str, per: &str| {
        let unknown = rates.iter().zip(&columns).filter(|(rate, _)| rate[i].is_none());
        let names: Vec<_> = unknown.map(|(_, column)| column.name.as_str()).collect();
        if !names.is_empty() {
            let of = if names.len() == rates.len() { "any joint".to_owned() } else { names.join(", ") };
            notes.push(format!(
                "no limit of {what} of {of} is known: {UNKNOWN} rad/{per} or m/{per} is taken; `{key} = …` in [robot] sets it"
            ));
        }
        rates.iter().map(|rate| rate[i].unwrap_or(UNKNOWN)).collect()
    };
    let velocity = limit(0, "velocity", "max_velocity", "s");
    let acceleration = limit(1, "acceleration", "max_acceleration", "s²");
    let wrong = |what: &str, part: f64| {
        Error::new(format!("the part of the limits of {what} is {part}"))
            .help("give a number above 0, at most 1; limits of a robot are set in [robot] of its problem: `max_velocity`, `max_acceleration`, `max_jerk`")
    };
    let parts = [pace.velocity, pace.acceleration, pace.jerk];
    for (what, part) in RATES.into_iter().zip(parts) {
        if !(part > 0.0 && part <= 1.0) {
            return Err(wrong(what, part));
        }
    }
    let jerk = rates.iter().map(|rate| rate[2].unwrap_or(f64::INFINITY)).collect();
    let limits = Limits::new(velocity, acceleration)?.with_jerk(jerk)?;
    Ok((limits.scaled(pace.velocity, pace.acceleration, pace.jerk)?, notes))
}

/// The least clearance along a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeastAlong {
    /// A lower bound (m) on the clearance all along.
    pub bound: f64,
    /// The least clearance (m) that was found.
    pub found: f64,
    /// When that is (s).
    pub time: f64,
}

/// A part of a trajectory: from when to when (s), and a bound (m) on the clearance in it. The greatest has the lowest bound.
#[derive(Clone, Copy)]
struct Part {
    bound: f64,
    from: f64,
    to: f64,
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(other.from.total_cmp(&self.from))
    }
}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Part {}

/// Configurations that are looked at, at most.
const STATES: usize = 16_000;

/// The least clearance along a trajectory, to within `accuracy` (m) if that does not take too long: parts of which less than that can be said are
/// halved, those with the lowest bound first. Ranges of joints are those of their polynomials, and no point of the robot travels
/// farther than the checker's bound for a straight motion to the end of the range.
pub(crate) fn least_along(
    kind: &dyn Robot,
    trajectory: &Trajectory,
    accuracy: f64,
    interrupt: &Interrupt,
) -> Option<LeastAlong> {
    let unused = AtomicU64::new(0);
    let mut checker = Counted::new(kind.any_measure(), &unused).with_interrupt(interrupt.clone());
    let [first, last] = trajectory.span();
    let mut least = LeastAlong { bound: f64::INFINITY, found: f64::INFINITY, time: first };
    let mut open = BinaryHeap::from([Part { bound: f64::NEG_INFINITY, from: first, to: last }]);
    for _ in 0..STATES {
        let Part { bound, from, to } = *open.peek()?;
        if bound >= least.found - accuracy {
            break;
        }
        open.pop();
        let middle = 0.5 * (from + to);
        let q = trajectory.at(middle).position;
        let far = (0..q.len()).map(|joint| {
            let [low, high] = trajectory.range(joint, from, to);
            q[joint] + (high - q[joint]).max(q[joint] - low)
        });
        let far: Configuration = far.collect();
        let q: Configuration = q.into();
        // Ranges of half a turn and more would come round the other way.
        let narrow = q.iter().zip(far.iter()).all(|(a, b)| b - a < 3.0);
        let travel = if narrow { checker.motion_bound(&q, &far) } else { f64::INFINITY };
        let enough = least.found.min(1e9) + travel.min(1e9);
        let clearance = checker.clearance(&q, enough);
        if interrupt.raised().is_some() {
            return None;
        }
        if clearance < least.found && clearance < enough {
            (least.found, least.time) = (clearance, middle);
        }
        if clearance <= 0.0 {
            return Some(LeastAlong { bound: 0.0, found: 0.0, time: middle });
        }
        let bound = clearance - travel;
        match bound >= least.found - accuracy || to - from < 1e-9 {
            true => open.push(Part { bound, from, to }),
            false => open.extend([Part { bound, from, to: middle }, Part { bound, from: middle, to }]),
        }
    }
    least.bound = open.peek().map_or(f64::INFINITY, |part| part.bound).min(least.found).max(0.0);
    Some(least)
}

/// What is known of a checked trajectory, beside what is known of any path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrajectoryVerdict {
    /// How long it takes (s).
    pub duration: f64,
    /// The curve between its points: `linear`, `cubic` or `quintic`.
    pub curve: String,
    /// When the clearance is least (s), where it is free.
    pub least_at: Option<f64>,
    /// When it first collides, or comes too near to contact (s).
    pub collides_at: Option<f64>,
    /// The limits that it exceeds.
    pub limits: Vec<LimitFault>,
}

/// A limit that a trajectory exceeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitFault {
    /// The name of the joint.
    pub joint: String,
    /// `position`, `velocity`, `acceleration` or `jerk`: the change of the acceleration in a millisecond.
    pub of: String,
    /// The limit (rad or m, and these per s, s² and s³).
    pub limit: f64,
    /// The farthest that it goes.
    pub reached: f64,
    /// When (s).
    pub time: f64,
}

impl LimitFault {
    fn words(&self, unit: &str) -> String {
        let per = match self.of.as_str() {
            "velocity" => "/s",
            "acceleration" => "/s²",
            "jerk" => "/s³",
            _ => "",
        };
        let [reached, limit, beyond] =
            [self.reached, self.limit, (self.reached - self.limit).abs()].map(brief);
        let Self { joint, of, time, .. } = self;
        format!(
            "the {of} of {joint} reaches {reached} {unit}{per} at {} s: {beyond} beyond its limit {limit}",
            brief(*time)
        )
    }
}

/// A velocity, an acceleration or jerk may be greater than its limit by this part: files have rounded numbers.
const ROUNDED: f64 = 1e-3;
/// A position may be so far beyond its limit (rad or m), as for states of paths.
pub(crate) const HAIR: f64 = 1e-5;
/// A joint that is slower stands still (rad/s or m/s).
const STILL: f64 = 1e-3;

/// Checks that the curve of a trajectory is free, leads from the start to a goal, and keeps the limits that are known, or those at a pace.
pub(crate) fn check(
    kind: &dyn Robot,
    trajectory: &Trajectory,
    pace: Option<&Pace>,
    interrupt: &Interrupt,
) -> Result<Verdict, Error> {
    let _span = tracing::info_span!("check", scene = kind.name()).entered();
    let columns = kind.columns();
    let rates = match pace {
        None => rates(kind)?,
        Some(pace) => limits(kind, pace)?.0.joints().map(|rates| rates.map(Some)).collect(),
    };
    if !trajectory.joints().eq(columns.iter().map(|column| (column.name.as_str(), column.unit.as_str()))) {
        let names: Vec<_> = columns.iter().map(ToString::to_string).collect();
        return Err(Error::new(format!("the joints of the trajectory are not those of {}", kind.name()))
            .help(format!("give in order: {}", names.join(", "))));
    }
    let rows = &trajectory.knots().positions;
    let states: Vec<_> = rows.iter().map(|row| kind.state(row)).collect();
    let mut faults = end_faults(kind, &states);
    faults.extend(turned_start(kind, &rows[0]));
    let limits = limit_faults(kind, trajectory, &rates);
    let unit =
        |fault: &LimitFault| columns.iter().find(|c| c.name == fault.joint).map_or("", |c| c.unit.as_str());
    faults.extend(limits.iter().map(|fault| fault.words(unit(fault))));
    let mut verifier: AnyCheck<'_, Configuration> = Box::new(kind.any_verifier()?);
    verifier.interrupt_by(interrupt);
    let checked = match states.as_slice() {
        [only] => verifier.check_motion(only, only),
        _ => check_curve(kind, &mut verifier, trajectory)?,
    };
    if matches!(checked, MotionCheck::Unproven { .. }) && interrupt.raised().is_some() {
        return Err(interrupted());
    }
    let collides_at = checked.failed_at().map(|at| time_of(trajectory, at));
    if let Some(time) = collides_at {
        let state: Configuration = trajectory.at(time).position.into();
        let at: Vec<_> = state.iter().copied().map(plain).collect();
        let what = what_happens(kind, &state, checked);
        faults.push(format!("{what} at {} s, at [{}]", brief(time), at.join(", ")));
    }
    let (mut clearance, mut least_at) = (0.0, None);
    if let MotionCheck::Free { clearance: proved } = checked
        && faults.is_empty()
    {
        let least = least_along(kind, trajectory, 0.1 * kind.accuracy(), interrupt);
        clearance = least.map_or(proved, |least| least.bound.max(proved));
        least_at = least.map(|least| least.time);
    }
    let warnings = match faults.is_empty() {
        true => enclosures(kind, &states[0]).into_iter().chain(moving_ends(trajectory)).collect(),
        false => Vec::new(),
    };
    Ok(Verdict {
        scene: kind.name().to_owned(),
        path: String::new(),
        free: faults.is_empty(),
        configurations: states.len(),
        path_length: Path::straight(states).length(&kind.any_space()),
        clearance,
        clearance_kept: kind.kept(),
        faults,
        warnings,
        trajectory: Some(TrajectoryVerdict {
            duration: trajectory.duration(),
            curve: trajectory.interpolation().to_string(),
            least_at,
            collides_at,
            limits,
        }),
    })
}

/// Which angle begins a turn away from the start. On a path that is the same place, but a controller that is sent there may turn all the way.
fn turned_start(kind: &dyn Robot, first: &[f64]) -> Option<String> {
    let start = kind.given_start();
    let ends = start.iter().zip(first).zip(turning(kind));
    let joint = ends.into_iter().position(|((start, first), turns)| turns && (first - start).abs() > PI)?;
    let [start, first] = [start[joint], first[joint]].map(brief);
    Some(format!(
        "begins a turn away from the start: {} at {first}, not at {start}",
        kind.columns()[joint].name
    ))
}

/// A warning where a trajectory begins or ends while it moves. Between points on straight lines velocities jump anyway.
fn moving_ends(trajectory: &Trajectory) -> Option<String> {
    let velocities = &trajectory.knots().velocities;
    let moving = |row: Option<&Vec<f64>>| row?.iter().position(|v| v.abs() > STILL);
    let (when, joint) = moving(velocities.first())
        .map(|joint| ("begins", joint))
        .or_else(|| moving(velocities.last()).map(|joint| ("ends", joint)))
        .filter(|_| trajectory.interpolation() != Interpolation::Linear)?;
    let name = trajectory.joints().nth(joint)?.0;
    Some(format!("the trajectory {when} while {name} moves: what the robot does there was not looked at"))
}

const REACHED: [fn(&Trajectory, usize) -> Extreme; 3] =
    [Trajectory::fastest, Trajectory::hardest, Trajectory::jerkiest];

/// The limits that a trajectory exceeds.
fn limit_faults(kind: &dyn Robot, trajectory: &Trajectory, rates: &[[Option<f64>; 3]]) -> Vec<LimitFault> {
    let mut faults = Vec::new();
    let limits = kind.limits();
    for (joint, (name, _)) in trajectory.joints().enumerate() {
        let mut add = |of: &str, limit: f64, reached: f64, time: f64| {
            faults.push(LimitFault { joint: name.to_owned(), of: of.to_owned(), limit, reached, time });
        };
        if let Some(Some([low, high])) = limits.get(joint) {
            let [least, most] = trajectory.extremes(joint);
            for (at, beyond, limit) in [(least, low - least.amount, low), (most, most.amount - high, high)] {
                if beyond > HAIR {
                    add("position", *limit, at.amount, at.time);
                }
            }
        }
        for ((limit, of), reached) in rates[joint].iter().zip(RATES).zip(REACHED) {
            let Some(limit) = limit else { continue };
            let at = reached(trajectory, joint);
            if at.amount > limit * (1.0 + ROUNDED) {
                add(of, *limit, at.amount, at.time);
            }
        }
    }
    faults
}

impl TimedPath {
    /// A few lines for a person.
    #[must_use]
    pub fn summary(&self) -> String {
        let (duration, points) = (self.trajectory.duration(), self.trajectory.knots().times.len());
        let mut lines = vec![format!(
            "{} s, {}, {} curve, proved free{}",
            brief(duration),
            count(points, "point"),
            self.trajectory.interpolation(),
            if self.clearance.is_finite() { "" } else { ": there is nothing to hit" },
        )];
        if !self.tightened.is_empty() {
            let at = self.tightened.iter().map(|corner| {
                let how = if corner.deviation == 0.0 { ", where it stops" } else { "" };
                format!("configuration {} at {} s{how}", corner.configuration, brief(corner.time))
            });
            lines.push(format!(
                "{} of {} rounded less, for the curve to be free: {}",
                self.tightened.len(),
                count(self.corners, "corner"),
                at.collect::<Vec<_>>().join("; ")
            ));
        }
        lines.join("\n  ")
    }
}
