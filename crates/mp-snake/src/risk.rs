//! The risk landscape: where a robot that moves inexactly may hit an obstacle that was measured inexactly.
//!
//! After Fig. 1 and §3.1 of K. Baizid et al., *RRS: rapidly-exploring random snakes*: a step that turns and
//! goes straight ends in a banana-shaped cloud, the product of two Gaussians; a range sensor measures the
//! distance of obstacles with noise; the product of both probabilities is the risk. Models of S. Thrun, W.
//! Burgard and D. Fox, *Probabilistic robotics*, 2005.

use crate::params::{not_negative, positive};
use crate::{Grid, blurred};
use mp_cspace::{ParameterError, Path, angle::wrap_angle};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// The noise of a robot that executes a step: turn, then go straight. Deviations grow with the turn and the
/// distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionNoise {
    /// Constant deviation of the heading (rad).
    pub turn: f64,
    /// Further deviation of the heading per radian turned.
    pub turn_per_turn: f64,
    /// Constant deviation of the distance (m).
    pub way: f64,
    /// Further deviation of the distance per metre.
    pub way_per_way: f64,
}

/// That of a small robot on wheels, such as a Khepera, in the experiment of following paths.
impl Default for MotionNoise {
    fn default() -> Self {
        Self { turn: 0.05, turn_per_turn: 0.2, way: 0.01, way_per_way: 0.08 }
    }
}

impl MotionNoise {
    /// This noise with each deviation times `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        let Self { turn, turn_per_turn, way, way_per_way } = self;
        Self {
            turn: factor * turn,
            turn_per_turn: factor * turn_per_turn,
            way: factor * way,
            way_per_way: factor * way_per_way,
        }
    }

    /// This noise, if its numbers are in range.
    ///
    /// # Errors
    /// When one is not finite or negative, or one of the two constant deviations is not positive.
    pub fn checked(self) -> Result<Self, ParameterError> {
        positive("the deviation of a turn", self.turn)?;
        positive("the deviation of a way", self.way)?;
        not_negative("the deviation per radian", self.turn_per_turn)?;
        not_negative("the deviation per metre", self.way_per_way)?;
        Ok(self)
    }

    /// The probability density (1/m²) that the robot is at `p` after a step from `from` at `heading` (rad)
    /// that turns by `turn` (rad), then goes `way` (m). In polar coordinates about `from` both are Gaussian.
    #[must_use]
    pub fn density(
        &self,
        from: &Vector2<f64>,
        heading: f64,
        (turn, way): (f64, f64),
        p: &Vector2<f64>,
    ) -> f64 {
        let offset = p - from;
        let far = offset.norm();
        if far <= 0.0 {
            return 0.0;
        }
        let angle = wrap_angle(mp_math::atan2(offset.y, offset.x) - heading - turn);
        let turns = self.turn + self.turn_per_turn * turn.abs();
        let ways = self.way + self.way_per_way * way.abs();
        // The area of a cell in polar coordinates has a factor `far`.
        gauss(angle, turns) * gauss(far - way, ways) / far
    }

    /// The probability that a step of the path ends in each cell, `1 − Π(1 − pᵢ)` over all steps. Long steps
    /// should be [resampled](Path::resampled) first. The first step needs no turn; each later one starts
    /// exactly at its state.
    #[must_use]
    pub fn envelope(&self, path: &Path<Vector2<f64>>, of: &Grid) -> Grid {
        let (width, _) = of.size();
        let mut missed = vec![1.0; of.values().len()];
        let mut heading = None;
        for w in path.states.windows(2) {
            let way = w[1] - w[0];
            if way.norm() == 0.0 {
                continue;
            }
            let angle = mp_math::atan2(way.y, way.x);
            let before = heading.replace(angle).unwrap_or(angle);
            let step = (wrap_angle(angle - before), way.norm());
            for (n, missed) in missed.iter_mut().enumerate() {
                let middle = Vector2::new((n % width) as f64 + 0.5, (n / width) as f64 + 0.5) * of.cell();
                let density = self.density(&w[0], before, step, &(of.origin() + middle));
                *missed *= 1.0 - (density * of.cell() * of.cell()).min(1.0);
            }
        }
        of.with_values(missed.into_iter().map(|m| 1.0 - m).collect())
    }
}

/// The noise of a range sensor: the deviation of a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeNoise {
    /// Constant deviation (m).
    pub constant: f64,
    /// Further deviation per metre of distance.
    pub per_metre: f64,
}

/// That of a laser, in the experiment of following paths.
impl Default for RangeNoise {
    fn default() -> Self {
        Self { constant: 0.02, per_metre: 0.01 }
    }
}

impl RangeNoise {
    /// This noise with each deviation times `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { constant: factor * self.constant, per_metre: factor * self.per_metre }
    }

    /// The probability that each cell is occupied, of a map that is above one half where obstacles were seen
    /// from `distance` (m) away: the map blurred by the deviation at that distance.
    ///
    /// # Errors
    /// When the deviation is not positive and finite, or too wide for the map.
    pub fn occupancy(&self, seen: &Grid, distance: f64) -> Result<Grid, ParameterError> {
        not_negative("the deviation per metre", self.per_metre)?;
        let sigma = self.constant + self.per_metre * not_negative("a distance", distance)?;
        blurred(&seen.clone().map(|v| f64::from(u8::from(v > 0.5))), sigma)
    }
}

/// The product of two maps of the same cells, such as the probability that the robot passes and that the cell
/// is occupied: the landscape of Fig. 1 d. As a [`Field`](crate::Field) it pushes snakes out of the risk.
///
/// # Errors
/// When the maps differ in place, scale or size.
pub fn landscape(passing: &Grid, occupied: &Grid) -> Result<Grid, ParameterError> {
    let same = passing.origin() == occupied.origin() && passing.cell() == occupied.cell();
    if !same || passing.size() != occupied.size() {
        let expected = "those of the other: the same place, scale and size";
        return Err(ParameterError { name: "the cells of a map", expected, value: occupied.cell() });
    }
    let product = passing.values().iter().zip(occupied.values()).map(|(a, b)| a * b);
    Ok(passing.with_values(product.collect()))
}

/// The landscape of risk of a robot that may pass everywhere. At each place it is the probability of touching
/// an obstacle when a straight step of length `way` (m) was to end there, from any direction. The range
/// sensor has `seen` the obstacles from a metre away.
///
/// The cloud in which such steps end, in the mean of all directions, is taken as a Gaussian of the same
/// variance: half the sum of the variances along the step and across it.
///
/// # Errors
/// When a number of the noise or the step is out of range.
pub fn everywhere(
    seen: &Grid,
    motion: MotionNoise,
    sensor: RangeNoise,
    way: f64,
) -> Result<Grid, ParameterError> {
    let motion = motion.checked()?;
    let way = positive("the length of a step", way)?;
    let [along, across] = [motion.way + motion.way_per_way * way, motion.turn * way];
    let spread = (0.5 * (along * along + across * across)).sqrt();
    blurred(&sensor.occupancy(seen, 1.0)?, spread)
}

/// The landscape of risk of a path, and the two maps that it is the product of: Fig. 1 of the paper.
#[derive(Clone, Debug, PartialEq)]
pub struct RiskMaps {
    /// The probability that a step of the path ends in each cell.
    pub passing: Grid,
    /// The probability that each cell is occupied.
    pub occupied: Grid,
    /// The product of both.
    pub risk: Grid,
}

impl RiskMaps {
    /// The maps of a robot that follows `path` with noisy motions. `seen` is the map of obstacles that its range
    /// sensor has made from a metre away: above one half where the robot collides. Long steps of the path should
    /// be [resampled](Path::resampled) first.
    ///
    /// # Errors
    /// When a number of the noise is out of range.
    pub fn of_path(
        path: &Path<Vector2<f64>>,
        seen: &Grid,
        motion: MotionNoise,
        sensor: RangeNoise,
    ) -> Result<Self, ParameterError> {
        let _span =
            tracing::debug_span!("risk", cells = seen.values().len(), states = path.states.len()).entered();
        let occupied = sensor.occupancy(seen, 1.0)?;
        let passing = motion.checked()?.envelope(path, &occupied);
        let risk = landscape(&passing, &occupied)?;
        Ok(Self { passing, occupied, risk })
    }
}

fn gauss(x: f64, sigma: f64) -> f64 {
    mp_math::exp(-0.5 * mp_math::powi(x / sigma, 2)) / (sigma * TAU.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: MotionNoise = MotionNoise { turn: 0.2, turn_per_turn: 0.1, way: 0.03, way_per_way: 0.05 };

    fn cells(f: impl FnMut(Vector2<f64>) -> f64) -> Grid {
        Grid::from_fn([-2.0, -2.0], 0.02, (200, 200), f).unwrap()
    }

    /// The density integrates to 1 along an arc about the start: a banana.
    #[test]
    fn the_cloud_after_a_step_is_a_banana() {
        let from = Vector2::new(-0.5, -0.5);
        let at = |p: Vector2<f64>| NOISE.density(&from, 0.3, (0.5, 1.2), &p);
        let sum: f64 = cells(at).values().iter().sum::<f64>() * 0.02 * 0.02;
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
        let polar =
            |angle: f64, far: f64| at(from + Vector2::new(mp_math::cos(angle), mp_math::sin(angle)) * far);
        let peak = polar(0.8, 1.2);
        // A deviation to the side on the arc is as likely either way, and likelier than straight across it.
        assert!((polar(1.05, 1.2) - polar(0.55, 1.2)).abs() < 1e-9 && polar(1.05, 1.2) > 0.5 * peak);
        let across = from
            + Vector2::new(mp_math::cos(0.8), mp_math::sin(0.8)) * 1.2
            + Vector2::new(-mp_math::sin(0.8), mp_math::cos(0.8)) * 0.6;
        assert!(at(across) < polar(0.8 + mp_math::atan(0.6 / 1.2), 1.2));
    }

    /// The Gaussian of a step from anywhere has the variance of the cloud itself, in the mean of all
    /// directions.
    #[test]
    fn steps_from_everywhere_spread_as_much() {
        let noise = MotionNoise { turn: 0.1, turn_per_turn: 0.0, way: 0.03, way_per_way: 0.05 };
        let sensor = RangeNoise { constant: 1e-3, per_metre: 0.0 };
        let spike = cells(|p| f64::from(u8::from((p - Vector2::repeat(0.01)).norm() < 0.005)));
        let second = |grid: &Grid| {
            let moments = grid.values().iter().enumerate().map(|(n, v)| {
                let at = Vector2::new((n % 200) as f64, (n / 200) as f64) * 0.02 - Vector2::repeat(2.0);
                v * at.norm_squared()
            });
            moments.sum::<f64>() / grid.values().iter().sum::<f64>()
        };
        let from_the_left = cells(|p| noise.density(&Vector2::new(-0.39, 0.01), 0.0, (0.0, 0.4), &p));
        let [gaussian, cloud] =
            [everywhere(&spike, noise, sensor, 0.4).unwrap(), from_the_left].map(|g| second(&g));
        assert!((gaussian / cloud - 1.0).abs() < 0.05, "{gaussian} {cloud}");
        assert!(everywhere(&spike, noise, sensor, 0.0).is_err());
    }

    /// The risk is where the way and an obstacle come near, and a path that keeps away costs less.
    #[test]
    fn risk_is_between_the_way_and_the_obstacle() {
        let seen = cells(|p| f64::from(u8::from((p - Vector2::new(0.0, 0.25)).norm() < 0.2)));
        let occupied = RangeNoise { constant: 0.02, per_metre: 0.03 }.occupancy(&seen, 1.0).unwrap();
        let through = |y: f64| {
            Path::straight(vec![Vector2::new(-1.0, 0.0), Vector2::new(0.0, y), Vector2::new(1.0, 0.0)])
        };
        let path =
            through(0.0).resampled(&mp_cspace::Rn::<2>::new([-2.0; 2], [2.0; 2]).unwrap(), 0.3).unwrap();
        let passing = NOISE.checked().unwrap().envelope(&path, &occupied);
        let risk = landscape(&passing, &occupied).unwrap();
        let (worst, _) = risk.values().iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
        let at = Vector2::new((worst % 200) as f64, (worst / 200) as f64) * 0.02 - Vector2::repeat(1.99);
        assert!(at.x.abs() < 0.4 && (0.02..0.4).contains(&at.y), "{at}");
        assert!(risk.values().iter().all(|r| (0.0..=1.0).contains(r)));
        assert!(landscape(&passing, &seen.map(|_| 0.0)).is_ok());
        assert!(MotionNoise { turn: 0.0, ..NOISE }.checked().is_err());
    }
}
