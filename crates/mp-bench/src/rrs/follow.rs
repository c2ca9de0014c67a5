//! §6: a differential-drive robot with noisy wheels and a noisy laser follows paths of RRT and of RRS.
//!
//! The robot is a Khepera in a world of 5 × 2 m. It drives by pure pursuit toward a point of the path ahead of its
//! estimated position, which comes from a particle filter with odometry and laser ranges (Thrun, Burgard and
//! Fox 2005, *Probabilistic robotics*, tables 5.3, 6.1 and 8.2). Safety is measured at its true position.

use super::solve::{Case, PreparedWorld, planned};
use crate::error::{IntoError, Result};
use mp_cspace::shorten::{Effort, simplify};
use mp_cspace::{Cancel, Path, Rn, Rng, least_clearance};
use mp_geom::planar::PlanarWorld;
use mp_robot::DiscRobot;
use mp_scenes::source::disc_scenes::DiscScene;
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use std::f64::consts::{PI, TAU};

/// Seconds between two commands, greatest speed (m/s) and greatest turn rate (rad/s).
const TICK: f64 = 0.1;
const SPEED: f64 = 0.15;
const TURN: f64 = 2.0;
/// The lookahead distance on the path, metres.
const LOOKAHEAD: f64 = 0.12;
/// The robot has arrived when its estimated position is this near to the end, metres.
const ARRIVED: f64 = 0.03;
/// Standard deviations of the wheel noise: of the speed per speed and turn rate, of the turn rate per speed and turn rate.
const WHEELS: [f64; 4] = [0.08, 0.01, 0.4, 0.08];
/// The laser: beams over 240°, its range (m), and its standard deviation, constant (m) and per distance.
const BEAMS: usize = 24;
const REACH: f64 = 4.0;
const LASER: [f64; 2] = [0.01, 0.01];
const PARTICLES: usize = 80;
/// The standard deviation of a beam in the weights of particles, for the laser and the map together, metres.
const JUDGED: f64 = 0.06;

/// The position and heading of the robot.
#[derive(Clone, Copy, Debug)]
struct Pose {
    at: Vector2<f64>,
    angle: f64,
}

/// A normal random number with mean 0.
fn normal(rng: &mut Rng, deviation: f64) -> f64 {
    let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    deviation * (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
}

impl Pose {
    /// The pose after a tick at a speed and a turn rate, with wheel noise.
    fn driven(self, [speed, turn]: [f64; 2], rng: &mut Rng) -> Self {
        let [a, b, c, d] = WHEELS;
        let speed = speed + normal(rng, a * speed.abs() + b * turn.abs());
        let turn = turn + normal(rng, c * speed.abs() + d * turn.abs());
        let middle = self.angle + 0.5 * turn * TICK;
        Self {
            at: self.at + Vector2::new(middle.cos(), middle.sin()) * speed * TICK,
            angle: self.angle + turn * TICK,
        }
    }

    /// The direction of beam `i`.
    fn beam(&self, i: usize) -> Vector2<f64> {
        let angle = self.angle + (i as f64 / (BEAMS - 1) as f64 - 0.5) * 240.0_f64.to_radians();
        Vector2::new(angle.cos(), angle.sin())
    }
}

/// The length of a beam until it is within a millimetre of an obstacle.
fn range(world: &PlanarWorld, from: Vector2<f64>, along: Vector2<f64>) -> f64 {
    let mut gone = 0.0;
    while gone < REACH {
        let free = world.signed_distance(&Point2::from(from + along * gone));
        if free < 1e-3 {
            return gone;
        }
        gone += free;
    }
    REACH
}

/// The particle filter: samples of the pose.
struct ParticleFilter {
    poses: Vec<Pose>,
}

impl ParticleFilter {
    /// Particles around a start that is known to about a centimetre and a degree.
    fn about(pose: Pose, rng: &mut Rng) -> Self {
        let near = |rng: &mut Rng| Pose {
            at: pose.at + Vector2::new(normal(rng, 0.01), normal(rng, 0.01)),
            angle: pose.angle + normal(rng, 0.02),
        };
        Self { poses: (0..PARTICLES).map(|_| near(rng)).collect() }
    }

    fn mean(&self) -> Pose {
        let n = self.poses.len() as f64;
        let at = self.poses.iter().map(|p| p.at).sum::<Vector2<f64>>() / n;
        let toward =
            self.poses.iter().map(|p| Vector2::new(p.angle.cos(), p.angle.sin())).sum::<Vector2<f64>>();
        Pose { at, angle: toward.y.atan2(toward.x) }
    }

    /// Moves all particles by the motion model, and resamples them by how well they explain the laser ranges.
    fn update(&mut self, command: [f64; 2], seen: &[f64], world: &PlanarWorld, rng: &mut Rng) {
        let mut weights = Vec::with_capacity(self.poses.len());
        for pose in &mut self.poses {
            *pose = pose.driven(command, rng);
            let off =
                |(i, d): (usize, &f64)| (range(world, pose.at, pose.beam(i)) - d).abs().min(0.5) / JUDGED;
            let misfit: f64 = seen.iter().enumerate().map(off).map(|v| 0.5 * v * v).sum();
            // Errors of beams are correlated: the exponent is less than one.
            weights.push((-0.3 * misfit).exp() + 1e-300);
        }
        // Low-variance resampling.
        let total: f64 = weights.iter().sum();
        let step = total / PARTICLES as f64;
        let mut mark = rng.random::<f64>() * step;
        let (mut i, mut sum) = (0, weights[0]);
        let mut kept = Vec::with_capacity(PARTICLES);
        for _ in 0..PARTICLES {
            while mark > sum && i + 1 < weights.len() {
                i += 1;
                sum += weights[i];
            }
            kept.push(self.poses[i]);
            mark += step;
        }
        self.poses = kept;
    }
}

/// The result of following one path.
#[derive(Clone, Debug)]
pub(super) struct Followed {
    pub(super) path: Vec<Point2<f64>>,
    pub(super) driven: Vec<Point2<f64>>,
    /// The least clearances of the path, and of the robot that followed it, metres; negative in collision.
    pub(super) planned: f64,
    pub(super) executed: f64,
    /// The length of the path, metres.
    pub(super) length: f64,
    pub(super) arrived: bool,
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

/// Follows `path`, with the noise of `seed`.
pub(super) fn follow(
    robot: &DiscRobot,
    space: &Rn<2>,
    path: &Path<Vector2<f64>>,
    seed: u64,
) -> Option<Followed> {
    let world = robot.world();
    let points = &path.states;
    let first = points.get(1)? - points[0];
    let length = path.length(space);
    let planned = least_clearance(space, &mut robot.clone(), path, 1e-4)?.found;
    let mut rng = Rng::stream(seed, 6);
    let mut pose = Pose { at: points[0], angle: first.y.atan2(first.x) };
    let mut filter = ParticleFilter::about(pose, &mut rng);
    let (mut driven, mut executed, mut gone, mut arrived) =
        (vec![Point2::from(pose.at)], f64::INFINITY, 0.0, false);
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
        let error = (aim.y.atan2(aim.x) - here.angle + PI).rem_euclid(TAU) - PI;
        // The robot turns in place where the path turns sharply.
        let speed = if error.abs() > 0.6 { 0.0 } else { SPEED * (1.0 - error.abs() / 0.9) };
        let command = [speed, (3.0 * error).clamp(-TURN, TURN)];
        pose = pose.driven(command, &mut rng);
        driven.push(Point2::from(pose.at));
        executed = executed.min(robot.signed_clearance(&pose.at));
        if executed <= 0.0 {
            break;
        }
        let seen: Vec<f64> = (0..BEAMS)
            .map(|i| {
                let d = range(world, pose.at, pose.beam(i));
                d + normal(&mut rng, LASER[0] + LASER[1] * d)
            })
            .collect();
        filter.update(command, &seen, world, &mut rng);
    }
    let path = points.iter().map(|p| Point2::from(*p)).collect();
    Some(Followed { path, driven, planned, executed, length, arrived })
}

/// The kinds of path that are followed.
pub(super) const KINDS: [&str; 3] = ["rrt", "rrt smoothed", "rrs"];

/// Plans a path of a kind and follows it; `None` when no path was found.
pub(super) fn planned_and_followed(scene: &DiscScene, kind: &str, trial: u64) -> Result<Option<Followed>> {
    let prepared = PreparedWorld::new(scene.clone())?;
    let robot = &prepared.robot;
    let space = Rn::<2>::new([0.0; 2], scene.size).into_error()?;
    let planner = if kind == "rrs" { "rrs-upto" } else { "rrt-upto" };
    let case = Case { world: "follow".into(), planner: planner.into(), step: 50, trial };
    let Some((_, Some(mut path))) = planned(&prepared, &case, &Cancel::new())? else { return Ok(None) };
    if kind == "rrt smoothed" {
        let mut rng = Rng::stream(trial, 7);
        path = simplify(&space, &mut robot.clone(), &path, Effort::default(), &mut rng);
    }
    Ok(follow(robot, &space, &path, trial))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_scenes::source::disc_scenes::RADIUS;

    #[test]
    fn beams_end_at_walls() {
        let world = PlanarWorld::new(vec![], Some([[0.0, 0.0], [3.0, 2.0]])).unwrap();
        let from = Vector2::new(1.0, 1.0);
        assert!((range(&world, from, Vector2::new(1.0, 0.0)) - 2.0).abs() < 2e-3);
        assert!((range(&world, from, Vector2::new(0.6, 0.8)) - 1.25).abs() < 2e-3);
    }

    /// A wide way is followed to its end, near to it, and the same way again; a way along a wall is not safe.
    #[test]
    fn paths_are_followed() {
        let bar = vec![[1.0, 0.9], [4.0, 0.9], [4.0, 1.1], [1.0, 1.1]];
        let scene = DiscScene { size: [5.0, 2.0], obstacles: vec![bar], start: [0.5, 0.5], goal: [4.5, 0.5] };
        let robot = scene.robot().unwrap();
        let space = Rn::<2>::new([0.0; 2], scene.size).unwrap();
        let at = |y: f64| {
            Path::straight(
                [(0.5, 0.5), (1.0, y), (4.0, y), (4.5, 0.5)].map(|(x, y)| Vector2::new(x, y)).to_vec(),
            )
        };
        let done = follow(&robot, &space, &at(0.45), 1).unwrap();
        // The corner (1, 0.9) is nearest, seen from the line through (0.5, 0.5) and (1, 0.45).
        let corner = 0.225 / 0.5_f64.hypot(0.05) - RADIUS;
        assert!(done.arrived && done.executed > 0.25 && (done.planned - corner).abs() < 1e-3, "{done:?}");
        let again = follow(&robot, &space, &at(0.45), 1).unwrap();
        assert_eq!(done.driven, again.driven);
        let near = 0.9 - RADIUS - 0.002;
        let hits = (0..10).filter(|i| follow(&robot, &space, &at(near), *i).unwrap().executed <= 0.0).count();
        assert!(hits > 2, "{hits} of 10");
    }
}
