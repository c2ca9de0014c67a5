//! The parameters of snakes, and their ranges.

use crate::snake::Manner;
use mp_cspace::{ParameterError, Space};
use thiserror::Error;

/// Why a snake cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SnakeError {
    /// A parameter outside its range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The space does not implement velocities.
    #[error("the space knows no velocities: `Space::moved` and `Space::velocity_into` must answer")]
    NoVelocities,
}

/// Stiffness, weights and budget of a snake. Lengths (m) are in the metric of the space.
///
/// | field | paper | range | default, of a [range](Params::for_range) `r` |
/// |---|---|---|---|
/// | `membrane`: resists stretching | α of eq. 2 | ≥ 0 | 0.05 |
/// | `plate`: resists bending (m²) | β of eq. 2 | ≥ 0 | 0.01 r² |
/// | `straighten`: shortens, along the normal | γ of eq. 4 | ≥ 0 | 0.05 |
/// | `spacing`: between nodes (m) | | > 0 | r/2 |
/// | `pace`: length of an implicit step (m²) | | > 0 | r² |
/// | `iterations`: most steps, at each spacing of the nodes | | ≥ 1 | 40 |
/// | `tolerance`: converged when no node moves by more than this part of the spacing | | > 0 | 0.01 |
/// | `clearance`: wanted of a motion that is bent (m) | | ≥ 0 | r/2 |
///
/// The external energy has weight 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// α, how much the curve resists stretching (a membrane).
    pub membrane: f64,
    /// β (m²), how much it resists bending (a thin plate).
    pub plate: f64,
    /// γ, the weight of the length, whose force is along the normal and straightens.
    pub straighten: f64,
    /// Distance between nodes (m): curves are resampled to at most this distance.
    pub spacing: f64,
    /// Length of an implicit step (m²). Steps of more than a curvature radius of the external energy
    /// overshoot, and are halved.
    pub pace: f64,
    /// Most steps.
    pub iterations: u32,
    /// Converged when no node moves by more than this part of the spacing.
    pub tolerance: f64,
    /// The clearance (m) at which a snake that bends a motion need not relax further.
    pub clearance: f64,
}

impl Params {
    /// The defaults for obstacles that repel within `range` (m).
    ///
    /// # Errors
    /// When the range is not positive and finite.
    pub fn for_range(range: f64) -> Result<Self, ParameterError> {
        let r = positive("the range of repulsion", range)?;
        Ok(Self {
            membrane: 0.05,
            plate: 0.01 * r * r,
            straighten: 0.05,
            spacing: 0.5 * r,
            pace: r * r,
            iterations: 40,
            tolerance: 0.01,
            clearance: 0.5 * r,
        })
    }

    /// The same for edges of a tree, where a snake must be cheap: nodes a full range apart, four times the
    /// membrane stiffness, and converged at a tenth of the spacing.
    ///
    /// # Errors
    /// When the range is not positive and finite.
    pub fn for_edges(range: f64) -> Result<Self, ParameterError> {
        let whole = Self::for_range(range)?;
        Ok(Self { membrane: 4.0 * whole.membrane, spacing: range, tolerance: 0.1, ..whole })
    }

    /// These parameters, if all are within their ranges.
    ///
    /// # Errors
    /// When one is not.
    pub fn checked(self) -> Result<Self, ParameterError> {
        not_negative("the membrane stiffness", self.membrane)?;
        not_negative("the plate stiffness", self.plate)?;
        not_negative("the weight of straightening", self.straighten)?;
        positive("the spacing", self.spacing)?;
        positive("the pace", self.pace)?;
        within("the number of iterations", f64::from(self.iterations), 1.0, 1e6, "from 1 to a million")?;
        positive("the tolerance", self.tolerance)?;
        not_negative("the clearance wanted", self.clearance)?;
        Ok(self)
    }

    /// The two coefficients of the [matrix](crate::Band) of a step. The weight of the length is added to that
    /// of the membrane: for a curve of even spacing both vary alike across it.
    pub(crate) fn stiffness(&self, Manner { spacing, pace, .. }: Manner) -> [f64; 2] {
        let square = spacing * spacing;
        let first = pace * (self.membrane + self.straighten) / square;
        [first, pace * self.plate / (square * square)]
    }
}

/// The length (m) that a unit velocity of each degree of freedom travels in the metric of the space.
pub(crate) fn scale<C: Space>(space: &C) -> Result<Vec<f64>, SnakeError> {
    let dim = space.dim();
    let middle = space.unit_cube_to_state(&vec![0.5; dim]);
    let mut velocity = vec![0.0; dim];
    if !space.velocity_into(&middle, &middle, &mut velocity) {
        return Err(SnakeError::NoVelocities);
    }
    let short = 1e-3;
    let along = |k: usize| {
        let mut velocity = vec![0.0; dim];
        velocity[k] = 1.0;
        let moved = space.moved(&middle, &velocity, short).ok_or(SnakeError::NoVelocities)?;
        let length = space.distance(&middle, &moved) / short;
        Ok(positive("the length of a motion", length)?)
    };
    (0..dim).map(along).collect()
}

/// `value` when it is positive and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64, ParameterError> {
    within(name, value, f64::MIN_POSITIVE, f64::MAX, "positive and finite")
}

/// `value` when it is finite and not negative.
pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<f64, ParameterError> {
    within(name, value, 0.0, f64::MAX, "finite and not negative")
}

/// `value` when it is from `least` to `most`.
pub(crate) fn within(
    name: &'static str,
    value: f64,
    least: f64,
    most: f64,
    expected: &'static str,
) -> Result<f64, ParameterError> {
    if (least..=most).contains(&value) { Ok(value) } else { Err(ParameterError { name, expected, value }) }
}
