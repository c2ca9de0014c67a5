//! §6: a differential-drive robot with noisy wheels and a noisy laser follows paths of RRT and of RRS.
//!
//! The robot is a Khepera in a world of 5 × 2 m. It drives by pure pursuit toward a point of the path ahead
//! of its estimated position, which comes from a particle filter with odometry and laser ranges (Thrun,
//! Burgard and Fox 2005, *Probabilistic robotics*, tables 5.3, 6.1 and 8.2). Safety is measured at its true
//! position.

use super::noisy_robot::{ParticleFilter, Pose, TICK};
use super::trial::{Case, Point, PreparedWorld, RANGE, planned};
use crate::Result;
use mp_cspace::shorten::{Effort, simplify};
use mp_cspace::{Cancel, Clock, Path, Rn, Rng, least_clearance};
use mp_robot::DiscRobot;
use mp_scenes::source::disc_scenes::DiscScene;
use mp_snake::risk::{MotionNoise, RangeNoise, RiskMaps};
use mp_snake::{Grid, Params, Repulsion, With, relax};
use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Greatest speed (m/s) and greatest turn rate (rad/s).
const SPEED: f64 = 0.15;
const TURN: f64 = 2.0;
/// The lookahead distance on the path, metres.
const LOOKAHEAD: f64 = 0.12;
/// The robot has arrived when its estimated position is this near to the end, metres.
const ARRIVED: f64 = 0.03;

/// A path, and the line that the robot drove when it followed it.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The path, metres.
    pub path: Vec<Point2<f64>>,
    /// The places of the robot, one for each tick.
    pub driven: Vec<Point2<f64>>,
    /// How well it did.
    pub run: Following,
}

/// The result of following one path; lengths in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Following {
    /// Whether a path was found. Without one there is nothing else.
    pub found: bool,
    /// The least clearance of the path.
    pub planned: f64,
    /// The least clearance of the robot that followed it; negative in collision.
    pub executed: f64,
    /// The length of the path.
    pub length: f64,
    /// The mean distance of the robot from the path.
    pub error: f64,
    /// The uncertainty of its position at the end.
    pub uncertainty: f64,
    /// Whether it believes to be at the end of the path.
    pub arrived: bool,
}

/// The point `gone` metres along the path.
fn along(path: &[Vector2<f64>], mut gone: f64) -> Vector2<f64> {
    for w in path.windows(2) {
        let length = (w[1] - w[0]).norm();
        if gone < length {
            return w[0] + (w[1] - w[0]) * (gone / length);
        }
        gone -= length;
    }
    path[path.len() - 1]
}

/// Follows `path`, with the noise of `seed`. `None` when the path has less than two states.
pub fn follow(robot: &DiscRobot, space: &Rn<2>, path: &Path<Vector2<f64>>, seed: u64) -> Option<Followed> {
    let world = robot.world();
    let points = &path.states;
    let first = points.get(1)? - points[0];
    let length = path.length(space);
    let planned = least_clearance(space, &mut robot.clone(), path, 1e-4)?.found;
    let mut rng = Rng::stream(seed, 6);
    let mut pose = Pose { at: points[0], angle: mp_math::atan2(first.y, first.x) };
    let mut filter = ParticleFilter::about(pose, &mut rng);
    let (mut driven, mut executed, mut gone, mut arrived) =
        (vec![Point2::from(pose.at)], f64::INFINITY, 0.0, false);
    let (mut off_path, mut places) = (0.0, 0);
    // Twice the nominal time.
    let ticks = (2.0 * length / SPEED / TICK) as usize + 100;
    for _ in 0..ticks {
        let here = filter.mean();
        // The nearest point of the path at or shortly after the last one.
        let tried = (0..=20).map(|i| gone + 0.01 * f64::from(i));
        let off = |s: f64| (along(points, s) - here.at).norm();
        gone = tried.fold(gone, |best, s| if off(s) < off(best) { s } else { best }).min(length);
        if length - gone < ARRIVED && (points[points.len() - 1] - here.at).norm() < ARRIVED {
            arrived = true;
            break;
        }
        let aim = along(points, gone + LOOKAHEAD) - here.at;
        let error = (mp_math::atan2(aim.y, aim.x) - here.angle + PI).rem_euclid(TAU) - PI;
        // The robot turns in place where the path turns sharply.
        let speed = if error.abs() > 0.6 { 0.0 } else { SPEED * (1.0 - error.abs() / 0.9) };
        let command = [speed, (3.0 * error).clamp(-TURN, TURN)];
        pose = pose.driven(command, &mut rng);
        driven.push(Point2::from(pose.at));
        executed = executed.min(robot.signed_clearance(&pose.at));
        off_path += (-10..=10)
            .map(|i| (along(points, gone + 0.02 * f64::from(i)) - pose.at).norm())
            .fold(f64::MAX, f64::min);
        places += 1;
        if executed <= 0.0 {
            break;
        }
        let seen = pose.scan(world, &mut rng);
        filter.update(command, &seen, world, &mut rng);
    }
    let path = points.iter().map(|p| Point2::from(*p)).collect();
    let (error, uncertainty) = (off_path / f64::from(places.max(1)), filter.uncertainty());
    let run = Following { found: true, planned, executed, length, error, uncertainty, arrived };
    Some(Followed { path, driven, run })
}

/// The kinds of path that are followed: of RRT and of RRS, as they are found, made shorter, and then relaxed
/// on the landscape of risk.
pub const KINDS: [&str; 6] = ["rrt", "rrt shortened", "rrt relaxed", "rrs", "rrs shortened", "rrs relaxed"];

/// All paths are planned, shortened and relaxed for a robot larger by this, metres.
pub const MARGIN: f64 = 0.01;
/// The longest step, centimetres.
const STEP: u32 = 50;

/// Plans a path of one of [`KINDS`] and follows it; `None` when no path was found.
///
/// # Errors
/// When the scene is not valid, or there is no such planner.
pub fn planned_and_followed(scene: &DiscScene, kind: &str, trial: u64) -> Result<Option<Followed>> {
    let prepared = PreparedWorld::with_margin(scene.clone(), MARGIN)?;
    let space = Rn::<2>::new([0.0; 2], scene.size)?;
    let (planner, after) = kind.split_once(' ').unwrap_or((kind, ""));
    let case = Case { world: "follow".into(), planner: format!("{planner}-upto"), step: STEP, trial };
    let Some((_, Some(mut path))) = planned(&prepared, &case, Clock::default(), &Cancel::new())? else {
        return Ok(None);
    };
    if !after.is_empty() {
        let mut rng = Rng::stream(trial, 7);
        path = simplify(&space, &mut prepared.robot.clone(), &path, Effort::default(), &mut rng);
    }
    if after == "relaxed" {
        path = relaxed(&prepared, &space, &path)?;
    }
    Ok(follow(&scene.robot()?, &space, &path, trial))
}

/// The size of a cell of the landscape, and the length of the steps of the path in it, metres.
const CELL: f64 = 0.02;
const STRIDE: f64 = 0.25;
/// The greatest energy of the risk, beside that of repulsion, which is ½ where the robot touches an obstacle;
/// and how much longer a path may become.
const WEIGHT: f64 = 1.0;
const STRETCH: f64 = 1.15;
/// The length of an implicit step (m²), and the most steps. The risk changes over two or three cells: steps
/// as long as the range of repulsion overshoot.
const PACE: f64 = 1e-3;
const STEPS: u32 = 400;

/// The landscape of risk of a path (Fig. 1): the probability of passing each place, times that of hitting an
/// obstacle there.
///
/// # Errors
/// When the world is too large for its maps.
pub fn risk_of(prepared: &PreparedWorld, space: &Rn<2>, path: &Path<Point>) -> Result<RiskMaps> {
    let cells = prepared.scene.size.map(|s| (s / CELL).round() as usize).into();
    let seen = Grid::from_fn([0.0; 2], CELL, cells, |p| {
        f64::from(u8::from(prepared.robot.signed_clearance(&p) <= 0.0))
    });
    let (wheels, laser) = (MotionNoise::default(), RangeNoise::default());
    let steps = path.resampled(space, STRIDE)?;
    Ok(RiskMaps::of_path(&steps, &seen?, wheels, laser)?)
}

/// The path, relaxed by a snake that obstacles and risk push.
fn relaxed(prepared: &PreparedWorld, space: &Rn<2>, path: &Path<Point>) -> Result<Path<Point>> {
    let risk = risk_of(prepared, space, path)?.risk;
    let most = risk.values().iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let repulsion = Repulsion::new(&prepared.map, RANGE)?;
    let mut field = With::new(repulsion, risk.map(|v| v / most), WEIGHT)?;
    let params = Params { iterations: STEPS, pace: PACE, ..Params::for_range(RANGE)? };
    let relaxed = relax(space, &mut prepared.robot.clone(), &mut field, path, params, STRETCH);
    Ok(relaxed?.path)
}
