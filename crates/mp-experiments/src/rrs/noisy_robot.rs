//! A differential-drive robot with noisy wheels and a noisy laser, and the particle filter that estimates its
//! pose.

use mp_cspace::Rng;
use mp_geom::planar::PlanarWorld;
use nalgebra::{Point2, Vector2};
use rand::RngExt;
use std::f64::consts::TAU;

/// Seconds between two commands.
pub const TICK: f64 = 0.1;
/// Standard deviations of the wheel noise: of the speed per speed and turn rate, of the turn rate per speed
/// and turn rate.
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
pub struct Pose {
    /// Where its centre is, metres.
    pub at: Vector2<f64>,
    /// Where it looks, radians from the first axis.
    pub angle: f64,
}

/// The unit vector at `angle` from the first axis.
fn direction(angle: f64) -> Vector2<f64> {
    let (sine, cosine) = mp_math::sin_cos(angle);
    Vector2::new(cosine, sine)
}

/// A normal random number with mean 0.
fn normal(rng: &mut Rng, deviation: f64) -> f64 {
    let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
    deviation * (-2.0 * mp_math::ln(u)).sqrt() * mp_math::cos(TAU * v)
}

impl Pose {
    /// The pose after a tick at a speed and a turn rate, with wheel noise.
    pub fn driven(self, [speed, turn]: [f64; 2], rng: &mut Rng) -> Self {
        let [a, b, c, d] = WHEELS;
        let speed = speed + normal(rng, a * speed.abs() + b * turn.abs());
        let turn = turn + normal(rng, c * speed.abs() + d * turn.abs());
        let middle = self.angle + 0.5 * turn * TICK;
        Self { at: self.at + direction(middle) * speed * TICK, angle: self.angle + turn * TICK }
    }

    /// The laser ranges at this pose, with noise.
    pub fn scan(&self, world: &PlanarWorld, rng: &mut Rng) -> Vec<f64> {
        let measured = |i: usize| {
            let d = range(world, self.at, self.beam(i));
            d + normal(rng, LASER[0] + LASER[1] * d)
        };
        (0..BEAMS).map(measured).collect()
    }

    /// The direction of beam `i`.
    fn beam(&self, i: usize) -> Vector2<f64> {
        let angle = self.angle + (i as f64 / (BEAMS - 1) as f64 - 0.5) * 240.0_f64.to_radians();
        direction(angle)
    }
}

/// The length of a beam until it is within a millimetre of an obstacle.
#[must_use]
pub fn range(world: &PlanarWorld, from: Vector2<f64>, along: Vector2<f64>) -> f64 {
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
#[derive(Clone, Debug)]
pub struct ParticleFilter {
    poses: Vec<Pose>,
}

impl ParticleFilter {
    /// Particles around a start that is known to about a centimetre and a degree.
    pub fn about(pose: Pose, rng: &mut Rng) -> Self {
        let near = |rng: &mut Rng| Pose {
            at: pose.at + Vector2::new(normal(rng, 0.01), normal(rng, 0.01)),
            angle: pose.angle + normal(rng, 0.02),
        };
        Self { poses: (0..PARTICLES).map(|_| near(rng)).collect() }
    }

    /// The estimated pose: the mean of the particles.
    pub fn mean(&self) -> Pose {
        let n = self.poses.len() as f64;
        let at = self.poses.iter().map(|p| p.at).sum::<Vector2<f64>>() / n;
        let toward = self.poses.iter().map(|p| direction(p.angle)).sum::<Vector2<f64>>();
        Pose { at, angle: mp_math::atan2(toward.y, toward.x) }
    }

    /// The uncertainty of the position: the root of the mean squared distance of the particles from their
    /// mean, metres.
    pub fn uncertainty(&self) -> f64 {
        let mean = self.mean().at;
        let squares: f64 = self.poses.iter().map(|p| (p.at - mean).norm_squared()).sum();
        (squares / self.poses.len() as f64).sqrt()
    }

    /// Moves all particles by the motion model, and resamples them by how well they explain the laser ranges.
    pub fn update(&mut self, command: [f64; 2], seen: &[f64], world: &PlanarWorld, rng: &mut Rng) {
        let mut weights = Vec::with_capacity(self.poses.len());
        for pose in &mut self.poses {
            *pose = pose.driven(command, rng);
            let off =
                |(i, d): (usize, &f64)| (range(world, pose.at, pose.beam(i)) - d).abs().min(0.5) / JUDGED;
            let misfit: f64 = seen.iter().enumerate().map(off).map(|v| 0.5 * v * v).sum();
            // Errors of beams are correlated: the exponent is less than one.
            weights.push(mp_math::exp(-0.3 * misfit) + 1e-300);
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
